#include "app/terminal/progress.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <unistd.h>

#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"

namespace talus::app {
namespace {

constexpr double kQuiet = 1.0;     // seconds before the first line
constexpr double kInterval = 0.2;  // seconds between lines

std::string line_of(const IngestProgress& now) {
  std::string line = "0";
  for (int i = 1; i <= static_cast<int>(std::clamp(now.fraction, 0.0, 1.0) * 10); ++i)
    line += fmt::format("...{}", 10 * i);
  if (now.fraction >= 1) return line + " - done.";
  line += fmt::format("  {}", now.stage);
  if (now.samples > now.samples_before && now.seconds > 0) {
    const auto done = static_cast<double>(now.samples - now.samples_before);
    line += fmt::format(", {:.3g} million samples/s", done / 1e6 / now.seconds);
  }
  if (now.seconds_left >= 0) line += fmt::format(", {} s left", std::ceil(now.seconds_left));
  return line;
}

}  // namespace

Progress::Progress(Telling telling)
    : telling_(telling == Telling::people && ::isatty(STDERR_FILENO) != 1 ? Telling::nobody : telling) {}

Progress::~Progress() {
  if (telling_ == Telling::people) end_progress();
}

void Progress::show(double fraction, const char* stage) {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  const double left = fraction > 0.02 ? seconds * (1 - fraction) / fraction : -1;
  show({fraction, stage, 0, 0, seconds, left});
}

void Progress::show(const IngestProgress& now) {
  if (telling_ == Telling::nobody) return;
  const auto time = Clock::now();
  const bool done = now.fraction >= 1;
  const bool begins = now.samples > 0 && !has_begun_;  // the first samples are said at once
  if (!done && !begins && std::chrono::duration<double>(time - last_).count() < kInterval) return;
  if (telling_ == Telling::people && std::chrono::duration<double>(time - start_).count() < kQuiet) return;
  last_ = time;
  has_begun_ = has_begun_ || begins;
  if (telling_ == Telling::people) {
    show_progress(line_of(now));
  } else {
    const Json json{{"fraction", now.fraction},
                    {"stage", now.stage},
                    {"samples", now.samples},
                    {"samples_before", now.samples_before},
                    {"all_samples", now.all_samples},
                    {"seconds", now.seconds},
                    {"seconds_left", now.seconds_left >= 0 ? Json(now.seconds_left) : Json()}};
    write_to_log(json.dump() + "\n");
  }
}

}  // namespace talus::app
