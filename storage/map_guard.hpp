#pragma once
// A file that becomes shorter while it is mapped, or whose disk fails, must not end the program.

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace talus {

/// Watches the map of one file for as long as it lives. Where the system has no bytes for an address in it, it sends
/// SIGBUS to the thread that reads. The handler puts zeros there and remembers that: the reader goes on, and asks
/// afterwards.
///
/// The first one installs the handler for the process. It hands every other SIGBUS on to the handler that was there
/// before. A program that installs its own later must hand on what is not its own in the same way.
/// docs/decisions/0008-shrinking-files.md
class MapGuard {
 public:
  MapGuard();
  ~MapGuard();
  MapGuard(const MapGuard&) = delete;
  MapGuard& operator=(const MapGuard&) = delete;

  /// Where the map lies now.
  void watch(const void* begin, std::size_t bytes);
  /// Bytes that were asked for could not be had. What was read since then may be zeros. One load from memory.
  [[nodiscard]] bool has_lost_bytes() const;

  struct Watched;

 private:
  Watched* watched_;
};

}  // namespace talus
