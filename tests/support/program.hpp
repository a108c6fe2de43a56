#pragma once
// A program as a child process: what it said, and how it ended.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace talus::support {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif
/// How much longer a program may take that a sanitizer watches, or that is not optimised.
#if defined(NDEBUG)
inline constexpr int kPatience = kIsSanitized ? 10 : 1;
#else
inline constexpr int kPatience = 10;
#endif

struct Outcome {
  int exit_code = -1;  ///< -1 if a signal ended it
  int signal = 0;      ///< 0 if it ended by itself
  std::string out, err;
};

struct RunOptions {
  std::optional<std::chrono::milliseconds> kill_after;  ///< SIGKILL, as a power cut would
  std::chrono::seconds at_most{120};                    ///< SIGKILL too, so that a test never hangs; × kPatience
  std::string input;                                    ///< a file to be the standard input; empty: an empty one
  std::string folder;                                   ///< to run in; empty: this process's
};

/// Runs `arguments[0]` with the rest.
Outcome run_program(const std::vector<std::string>& arguments, const RunOptions& options = {});

}  // namespace talus::support
