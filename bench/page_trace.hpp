#pragma once
// Which bytes of the file a question reads.

#include <cstddef>
#include <span>
#include <vector>

#include "storage/page_store.hpp"

namespace talus::bench {

struct PageRead {
  int table = 0;
  std::span<const std::byte> bytes;  ///< in the map of the file: order and distance are the file's
};

/// Watches while it lives, one at a time, this thread's questions. Every page that is read is checked, so it stands in
/// the way of the checksum: the linker puts it there (bench/CMakeLists.txt), and the library is as everyone's.
class PageTrace {
 public:
  PageTrace();
  ~PageTrace();
  PageTrace(const PageTrace&) = delete;
  PageTrace& operator=(const PageTrace&) = delete;
  /// Pages in the order in which they were read, and the directories of their tiles.
  [[nodiscard]] const std::vector<PageRead>& reads() const { return reads_; }
  /// How many pieces of the file they are, in pages of the file of 4096 bytes; gaps of up to `gap` bytes do not part two
  /// pieces.
  [[nodiscard]] std::size_t runs(std::size_t gap) const;

 private:
  friend struct Watch;
  std::vector<PageRead> reads_;
};

}  // namespace talus::bench
