#include "app/terminal/interrupt.hpp"

#include <array>

#include <unistd.h>

#include "app/terminal/exit.hpp"
#include "app/terminal/say.hpp"

namespace talus::app {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t noted = 0;

void install(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // a read or a write goes on until somebody asks interrupted()
  sigemptyset(&action.sa_mask);
  for (const int signal : kSignals) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;  // started with nohup
    sigaction(signal, &action, nullptr);
  }
}

}  // namespace

void exit_when_interrupted() {
  install([](int) {
    end_progress();
    ::_exit(static_cast<int>(Exit::interrupted));
  });
}

void note_interrupts() {
  install([](int) { noted = 1; });
}

bool interrupted() { return noted != 0; }

HoldInterrupts::HoldInterrupts() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : kSignals) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

HoldInterrupts::~HoldInterrupts() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

}  // namespace talus::app
