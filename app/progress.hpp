#pragma once
// Progress as GDAL prints it, on a terminal only.

#include <chrono>

namespace talus::app {

/// 0...10...20...30  preparing pages, 12 s left
///
/// Written over itself on standard error, from the first second on; silent where that is no terminal.
class Progress {
 public:
  Progress();
  ~Progress();  ///< ends the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(double fraction, const char* stage);

 private:
  using Clock = std::chrono::steady_clock;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point start_ = Clock::now(), last_{};
};

}  // namespace talus::app
