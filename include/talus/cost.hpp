#pragma once
// What questions cost.

#include <cstdint>

namespace talus {

/// What an answer cost. Bytes are those of all page values fetched, header and coarse pages included.
struct QueryCost {
  std::uint64_t pages_read = 0, bytes_read = 0;
  double seconds = 0;
  std::uint64_t pages_cached = 0;  ///< found decoded, and neither read nor counted as read

  QueryCost& operator+=(const QueryCost& other) {
    pages_read += other.pages_read;
    bytes_read += other.bytes_read;
    seconds += other.seconds;
    pages_cached += other.pages_cached;
    return *this;
  }
};

}  // namespace talus
