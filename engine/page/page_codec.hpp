#pragma once
// One page in memory, and the bytes it becomes. docs/format has the bytes; page_heights, page_errors, page_voids and
// number_coder are its parts.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/error/error_ladder.hpp"
#include "engine/error/height_field.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

/// What a page knows of one of the pages below it, so that those with nothing to give are never read.
struct ChildEntry {
  bool present = false;           ///< it is stored; one that holds voids only is not
  ErrorCode largest = 0;          ///< saturated error of any vertex in it or in pages below it
  float lowest = 0, highest = 0;  ///< heights in the vertical unit, rounded outward; +inf and -inf: voids only
  std::uint32_t generation = 0;   ///< the update that wrote it last
  friend bool operator==(const ChildEntry&, const ChildEntry&) = default;
};

/// What the page above both must know: the larger error, the wider range of heights, the later generation.
[[nodiscard]] ChildEntry joined(const ChildEntry& a, const ChildEntry& b);

struct Page {
  PageId id;
  int bands = 1;  ///< of the database: the coarsest holds all vertices above it, too
  PageGrid grid;
  std::vector<double> heights;  ///< height codes, row by row
  /// Saturated; 0 for vertices of coarser bands. To be encoded: of all own vertices. Decoded: 0 where implied.
  std::vector<ErrorCode> errors;
  /// Of a decoded page: errors that follow from its heights (engine/page/page_errors.hpp), exact and on no ladder, as
  /// distances in height codes; -1 elsewhere. One of the two, in eighths where heights are whole numbers, or neither:
  /// then nothing is implied. A vertex is selected iff distance or code is above the tolerance's.
  std::vector<std::int32_t> eighths;
  std::vector<double> distances;
  std::vector<std::uint8_t> valid;   ///< 1 where the sample is data; empty: all are
  std::vector<std::uint8_t> covers;  ///< RestrictedQuadtree::covers of own vertices; empty: all 15
  std::vector<ChildEntry> children;  ///< kChildrenAcross² row by row; empty in the finest band

  /// Heights of own vertices with error 0 are not stored, save near the border: they lie on the surface that the others
  /// make, and a reader finds them there (KeptHeights). Decoded they are anything.
  bool drops_heights = false;
  GridRect extent{{0, 0}, {-1, -1}};  ///< of all data; says where the border is, where heights are dropped

  [[nodiscard]] std::size_t index(std::int32_t col, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.cols) + static_cast<std::size_t>(col);
  }
  [[nodiscard]] std::size_t index(GridPoint p) const {
    const GridPoint here = grid.local(p);
    return index(here.col, here.row);
  }
  [[nodiscard]] bool is_own(GridPoint p) const { return band_of(p, bands) == id.band; }
  /// Of a page with errors, encoded or decoded.
  [[nodiscard]] bool is_dropped(std::int32_t col, std::int32_t row) const {
    const GridPoint p = grid.at(col, row);
    return drops_heights && errors[index(col, row)] == 0 && is_own(p) && !is_near_border(p, extent);
  }
  /// Of a decoded page.
  [[nodiscard]] bool is_implied(std::size_t i) const {
    return eighths.empty() ? !distances.empty() && distances[i] >= 0 : eighths[i] >= 0;
  }
  /// In height codes, of an implied vertex.
  [[nodiscard]] double implied_distance(std::size_t i) const {
    return eighths.empty() ? distances[i] : eighths[i] / 8.0;
  }
  /// The code of any own vertex, stored or implied.
  [[nodiscard]] ErrorCode error(std::size_t i, const CodeDistance& distance) const {
    return is_implied(i) ? error_code(distance.metres(implied_distance(i))) : errors[i];
  }
};

/// An entry with the range of a page's valid heights (those it holds, if some were dropped), and no error yet.
[[nodiscard]] ChildEntry range_of(const Page& page, const HeightStep& step);

/// Writes pages one after the other with the same memory.
class PageEncoder {
 public:
  PageEncoder();
  ~PageEncoder();
  PageEncoder(PageEncoder&&) noexcept;
  PageEncoder& operator=(PageEncoder&&) noexcept;

  /// Lossless: decode(encode(page)) is page, heights bit for bit, but for heights of voids that no triangle needs and
  /// those that the page drops.
  /// What `errors` of a page says is never changed: an error is implied only if what follows from the heights is
  /// that very code. Pure: the same page gives the same bytes anywhere.
  ///
  /// distance  from height codes to metres, as in decode
  /// cost      about 12 ns a sample
  [[nodiscard]] std::vector<std::byte> encode(const Page& page, const CodeDistance& distance);

  /// About how many bits the parts of the last page took. For measurements.
  struct Parts {
    double heights = 0, errors = 0, voids = 0, children = 0;
  };
  [[nodiscard]] Parts parts() const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

/// The same for a single page.
[[nodiscard]] std::vector<std::byte> encode(const Page& page, const CodeDistance& distance);

/// Reads pages one after the other into the same memory.
class PageDecoder {
 public:
  PageDecoder();
  ~PageDecoder();
  PageDecoder(PageDecoder&&) noexcept;
  PageDecoder& operator=(PageDecoder&&) noexcept;

  /// The page, until the next call.
  ///
  /// fails  corrupt: anything the bytes of a page of this id and extent cannot be. Memory never exceeds
  ///        what a page of kPageSide² samples takes, whatever the bytes say.
  /// cost   about 4 ns a sample
  [[nodiscard]] const Page& decode(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                   std::span<const std::byte> bytes);
  /// Without the errors, which stay empty unless heights were dropped by them, and unchecked.
  [[nodiscard]] const Page& decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                           std::span<const std::byte> bytes);

 private:
  struct Scratch;
  /// All but errors that follow from heights, or come behind them.
  void decode_most(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                   std::span<const std::byte> bytes);
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace talus
