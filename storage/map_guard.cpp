#include "storage/map_guard.hpp"

#include <cerrno>
#include <csignal>
#include <mutex>

#include <sys/mman.h>
#include <unistd.h>

namespace talus {

/// A node of a list that only grows, so a signal handler can read it at any time. A node without a range is free.
struct MapGuard::Watched {
  std::atomic<std::uintptr_t> begin = 0, end = 0;
  std::atomic<bool> has_lost_bytes = false;
  bool is_free = false;  ///< guarded by the mutex
  Watched* next = nullptr;
};

namespace {

std::atomic<MapGuard::Watched*> first_watched = nullptr;
std::mutex list_mutex;
struct sigaction handler_before {};
std::uintptr_t page_bytes = 4096;

static_assert(std::atomic<std::uintptr_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler cannot wait for a lock");

/// Maps zeros from an address's page to the end of its map. mmap is a system call, which is safe here on Linux.
bool put_zeros(std::uintptr_t address) {
  for (MapGuard::Watched* w = first_watched.load(std::memory_order_acquire); w != nullptr; w = w->next) {
    const std::uintptr_t begin = w->begin.load(std::memory_order_acquire), end = w->end.load(std::memory_order_acquire);
    if (address < begin || address >= end) continue;
    const std::uintptr_t page = address / page_bytes * page_bytes;
    w->has_lost_bytes.store(true, std::memory_order_release);
    return ::mmap(reinterpret_cast<void*>(page), end - page, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1,
                  0) != MAP_FAILED;
  }
  return false;
}

void on_bus_error(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  const bool is_ours = info->si_code == BUS_ADRERR && put_zeros(reinterpret_cast<std::uintptr_t>(info->si_addr));
  errno = error;
  if (is_ours) return;
  const bool is_sent = info->si_code <= 0;  // by kill or raise: the instruction will not fail again
  const auto before = handler_before.sa_handler;
  if (before != SIG_DFL && before != SIG_IGN) {  // test these first: flags mean nothing for them
    return (handler_before.sa_flags & SA_SIGINFO) != 0 ? handler_before.sa_sigaction(signal, info, context)
                                                       : before(signal);
  }
  if (before == SIG_IGN && is_sent) return;
  struct sigaction end_the_program {};
  end_the_program.sa_handler = SIG_DFL;
  ::sigaction(SIGBUS, &end_the_program, nullptr);
  if (is_sent) ::raise(signal);
}

void install_handler() {
  page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  struct sigaction ours {};
  ours.sa_sigaction = on_bus_error;
  ours.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  ::sigaction(SIGBUS, nullptr, &handler_before);  // before our handler can run
  ::sigaction(SIGBUS, &ours, nullptr);
}

}  // namespace

MapGuard::MapGuard() {
  static std::once_flag once;
  std::call_once(once, install_handler);
  const std::lock_guard lock(list_mutex);
  for (watched_ = first_watched.load(); watched_ != nullptr && !watched_->is_free;) watched_ = watched_->next;
  if (watched_ != nullptr) {
    watched_->is_free = false;
    watched_->has_lost_bytes = false;
    return;
  }
  watched_ = new Watched;  // never deleted: a handler may be reading it
  watched_->next = first_watched.load();
  first_watched.store(watched_, std::memory_order_release);
}

MapGuard::~MapGuard() {
  watched_->end = 0;
  watched_->begin = 0;
  const std::lock_guard lock(list_mutex);
  watched_->is_free = true;
}

void MapGuard::watch(const void* begin, std::size_t bytes) {
  const auto from = reinterpret_cast<std::uintptr_t>(begin);
  if (watched_->begin == from && watched_->end == from + bytes) return;
  watched_->end = 0;
  watched_->begin = from;
  watched_->end = from + bytes;
}

bool MapGuard::has_lost_bytes() const { return watched_->has_lost_bytes.load(std::memory_order_acquire); }

}  // namespace talus
