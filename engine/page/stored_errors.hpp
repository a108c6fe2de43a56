#pragma once
// Codes of the errors that a page's heights do not imply. Each code is stored as its difference from a lower bound that
// follows from the page.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/page/number_coder.hpp"
#include "engine/page/page_codec.hpp"

namespace talus {

/// One for side midpoints and one for centres, of spacings 1, 2, 4 and more, each with lower bound 0 and above 0.
inline constexpr int kErrorContexts = 16;

/// The lower bound of a vertex's error is the larger of two: the distance of its sample from the middle of its side or
/// diagonal, if the page has heights, and its children's errors. Children come first: the order is finest level first,
/// side midpoints before centres, row by row.
class StoredErrors {
 public:
  /// Writes the codes `all` of own vertices, and copies them to `page`, which is as get() expects it: its errors are 0.
  void put(const std::vector<ErrorCode>& all, Page& page, const CodeDistance& distance, int context, NumberWriter& out);
  /// returns  false if a number is too large for a code
  [[nodiscard]] bool get(Page& page, const CodeDistance& distance, int context, NumberReader& in);

 private:
  struct Vertex {
    std::uint32_t index;
    std::int16_t col, row;  ///< in the page's grid
    std::int16_t spacing;   ///< in spacings of the band; 0: a corner that is coarser than all levels of the page
    std::uint8_t kind;      ///< context of the number
  };
  /// Page indices of the ends of a vertex's side or diagonal, and of its children, as far as they are in the page.
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
  std::array<std::int32_t, 6> listed_for_{-1};  ///< vertices_ is listed once for pages of one shape
};

}  // namespace talus
