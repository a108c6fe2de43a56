#pragma once
// Progress on standard error, in the style of GDAL or as JSON.

#include <chrono>
#include <string>

#include "talus/ingest.hpp"

namespace talus::app {

/// Who reads the progress: people at a terminal, a program that wants a JSON object on each line, or nobody.
enum class Telling { people, json, nobody };

/// 0...10...20...30  tiles, 12.3 million samples/s, 12 s left
///
/// One line that is overwritten, from the first second on. Silent where standard error is not a terminal.
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
  bool has_begun_ = false;  ///< samples were shown
};

}  // namespace talus::app
