#pragma once
// Ctrl-C, or a terminal that is closed: exit code 130, and nothing half-written stays.

#include <csignal>
#include <string>

namespace talus::app {

/// From now on SIGINT, SIGTERM and SIGHUP (unless ignored, as under nohup) end the program with exit code 130.
void exit_when_interrupted();
/// From now on they are only noted, for work that unwinds on its own.
void note_interrupts();
[[nodiscard]] bool interrupted();

/// Thrown to unwind after an interrupt; no failure, so not a Failure.
struct Interrupted {
  std::string sentence = "interrupted";
};

/// Puts interrupts off while a file is written and named.
class HoldInterrupts {
 public:
  HoldInterrupts();
  ~HoldInterrupts();
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace talus::app
