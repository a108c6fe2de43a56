#pragma once
// Keeps the program alive when a mapped file becomes shorter or its disk fails.

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace talus {

/// Watches the map of one file while it lives. If the system cannot read an address in it, it sends SIGBUS to the
/// thread; our handler maps zeros there and remembers it. The reader continues and asks has_lost_bytes() afterwards.
///
/// The first guard installs the handler, which passes every other SIGBUS to the earlier handler. A program that
/// installs its own later must do the same. docs/decisions/0008-shrinking-files.md
class MapGuard {
 public:
  MapGuard();
  ~MapGuard();
  MapGuard(const MapGuard&) = delete;
  MapGuard& operator=(const MapGuard&) = delete;

  /// Sets the range of the map.
  void watch(const void* begin, std::size_t bytes);
  /// Whether bytes could not be read. Everything read since then may be zeros. Costs one load from memory.
  [[nodiscard]] bool has_lost_bytes() const;

  struct Watched;

 private:
  Watched* watched_;
};

}  // namespace talus
