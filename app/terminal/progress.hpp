#pragma once
// Progress on standard error: as GDAL prints it, or as JSON for programs.

#include <chrono>
#include <string>

#include "talus/ingest.hpp"

namespace talus::app {

/// How to tell: on a terminal only, as one JSON object a line, or not at all.
enum class Telling { people, json, nobody };
/// "auto", "json" or "none". Fails with invalid_argument.
[[nodiscard]] Telling parse_telling(const std::string& word);

/// 0...10...20...30  tiles, 12.3 million samples/s, 12 s left
///
/// Written over itself from the first second on; silent where standard error is no terminal.
class Progress {
 public:
  explicit Progress(Telling telling = Telling::people);
  ~Progress();  ///< ends the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const IngestProgress& now);
  void show(double fraction, const char* stage);

 private:
  using Clock = std::chrono::steady_clock;
  Telling telling_;
  Clock::time_point start_ = Clock::now(), last_{};
};

}  // namespace talus::app
