#pragma once
// The errors of a page that its heights do not imply: codes on the ladder, each by what it is above the most that
// the page already says of it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/page/number_coder.hpp"
#include "engine/page/page_codec.hpp"

namespace talus {

/// Side midpoints and centres of spacing 1, 2, 4 and more, each with and without something to start from.
inline constexpr int kErrorContexts = 16;

/// A vertex's error is at least the distance of its own sample from the middle of its side or diagonal, and at least
/// its children's errors, which come before it (of a page without heights, those only): finest level first, side
/// midpoints before centres, row by row.
class StoredErrors {
 public:
  /// `all` codes of own vertices; `page` as decode would have it by now, errors 0. Fills them in.
  void put(const std::vector<ErrorCode>& all, Page& page, const CodeDistance& distance, int context, NumberWriter& out);
  /// false: a number that no code can be
  [[nodiscard]] bool get(Page& page, const CodeDistance& distance, int context, NumberReader& in);

 private:
  struct Vertex {
    std::uint32_t index;
    std::int16_t col, row;  ///< in the page's grid
    std::int16_t spacing;   ///< in units; 0: a corner above all levels of the page
    std::uint8_t kind;      ///< context
  };
  /// What of a vertex's diamond the page has, by index: both ends of its side or diagonal, and its children.
  struct Around {
    bool has_ends = false;
    std::array<std::size_t, 2> ends{};
    std::array<std::size_t, 4> below{};
    std::size_t count = 0;
  };
  [[nodiscard]] static Around around(const Page& page, const Vertex& v);
  void list(const Page& page);
  [[nodiscard]] ErrorCode at_least(const Page& page, const Vertex& v, const CodeDistance& distance) const;

  std::vector<Vertex> vertices_;
  std::array<std::int32_t, 6> listed_for_{-1};  ///< most pages of a query are alike
};

}  // namespace talus
