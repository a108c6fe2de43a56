#pragma once
// One page in memory, and the bytes it becomes. docs/format/v1.md has the bytes.

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/error_ladder.hpp"
#include "engine/height_field.hpp"
#include "engine/page_layout.hpp"

namespace talus {

/// What a page knows of one of the pages below it, so that those with nothing to give are never read.
struct ChildEntry {
  bool present = false;           ///< it is stored; one that holds voids only is not
  ErrorCode largest = 0;          ///< saturated error of any vertex in it or in pages below it
  float lowest = 0, highest = 0;  ///< heights in the vertical unit, rounded outward; +inf and -inf: voids only
  std::uint32_t generation = 0;   ///< the update that wrote it, so that a stale page is noticed
  friend bool operator==(const ChildEntry&, const ChildEntry&) = default;
};

/// What the page above both must know: the larger error, the wider range of heights.
[[nodiscard]] ChildEntry joined(const ChildEntry& a, const ChildEntry& b);

struct Page {
  PageId id;
  int bands = 1;  ///< of the database: the coarsest holds all vertices above it, too
  PageGrid grid;
  std::vector<double> heights;    ///< height codes, row by row
  std::vector<ErrorCode> errors;  ///< saturated; 0 for vertices of coarser bands
  /// True in pages of data only of the finest band: the errors of side midpoints whose side lies in the
  /// page are not stored, `errors` has 0, finest_error() of the heights gives them.
  bool implied_midpoints = false;
  std::vector<std::uint8_t> valid;   ///< 1 where the sample is data; empty: all are
  std::vector<std::uint8_t> covers;  ///< RestrictedQuadtree::covers of own vertices; empty: all 15
  std::vector<ChildEntry> children;  ///< kChildrenAcross² row by row; empty in the finest band

  [[nodiscard]] std::size_t index(std::int32_t col, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.cols) + static_cast<std::size_t>(col);
  }
  [[nodiscard]] bool is_own(GridPoint p) const { return band_of(p, bands) == id.band; }
  [[nodiscard]] bool is_implied(GridPoint p, std::int32_t col, std::int32_t row) const {
    if (!implied_midpoints || spacing(p) != 1 || is_centre(p)) return false;
    return (p.col & 1) != 0 ? col > 0 && col + 1 < grid.cols : row > 0 && row + 1 < grid.rows;
  }
  /// Residual ends of an implied midpoint are its neighbours along the odd coordinate.
  [[nodiscard]] double implied_error(GridPoint p, std::int32_t col, std::int32_t row, const CodeDistance& distance,
                                     bool exact) const;
};

/// An entry with the range of a page's valid heights, and no error yet.
[[nodiscard]] ChildEntry range_of(const Page& page, const HeightStep& step);

/// Lossless: decode(encode(page)) is page, heights bit for bit, but for heights of voids that no triangle
/// needs. Pure: the same page gives the same bytes anywhere.
///
/// cost    about 10 ns a sample
/// source  residuals to the midpoint prediction, byte planes, zstd
[[nodiscard]] std::vector<std::byte> encode(const Page& page);

/// Reads pages one after the other into the same memory.
class PageDecoder {
 public:
  PageDecoder();
  ~PageDecoder();
  PageDecoder(PageDecoder&&) noexcept;
  PageDecoder& operator=(PageDecoder&&) noexcept;

  /// The page, until the next call.
  /// fails  corrupt: anything the bytes of a page of this id and extent cannot be. Memory never exceeds
  ///        what a page of kPageSide² samples takes, whatever the bytes say.
  [[nodiscard]] const Page& decode(PageId id, GridRect extent, int bands, std::span<const std::byte> bytes);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace talus
