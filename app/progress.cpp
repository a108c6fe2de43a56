#include "app/progress.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace talus::app {

namespace {
constexpr double kQuiet = 1.0;     // seconds before anything is said
constexpr double kInterval = 0.2;  // seconds between lines
}  // namespace

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fputs("\n", stderr);
}

void Progress::show(double fraction, const char* stage) {
  if (!terminal_) return;
  const auto now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const bool done = fraction >= 1;
  if (elapsed < kQuiet || (!done && std::chrono::duration<double>(now - last_).count() < kInterval)) return;
  last_ = now;
  shown_ = true;

  const int tens = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * 10);
  std::string line = "0";
  for (int i = 1; i <= tens; ++i) line += fmt::format("...{}", 10 * i);
  if (done) {
    line += " - done.";
  } else if (fraction > 0.02) {
    line += fmt::format("  {}, {} s left", stage, std::ceil(elapsed * (1 - fraction) / fraction));
  } else {
    line += fmt::format("  {}", stage);
  }
  fmt::print(stderr, "\r{}\x1b[K", line);
  std::fflush(stderr);
}

}  // namespace talus::app
