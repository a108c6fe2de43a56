#pragma once
// Ctrl-C, or a closed terminal: exit code 130, and no half-written file stays.

#include <csignal>
#include <string>

namespace talus::app {

/// From now on SIGINT, SIGTERM and SIGHUP (unless ignored, as under nohup) end the program with exit code 130.
void exit_when_interrupted();
/// From now on they are only noted, for work that asks interrupted() and ends itself.
void note_interrupts();
[[nodiscard]] bool interrupted();

/// Thrown after an interrupt. It is not a Failure.
struct Interrupted {
  std::string sentence = "interrupted";
};

/// Delays interrupts while a file is written and named.
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
