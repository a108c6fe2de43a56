#pragma once
// One page in memory and as bytes. docs/format has the bytes; page_heights, page_errors, page_voids and number_coder
// code the parts.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/error/error_ladder.hpp"
#include "engine/error/height_field.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {

/// What a page knows of one of its child pages, so that questions read only those that they need.
struct ChildEntry {
  bool present = false;           ///< it is stored; false: it has voids only
  ErrorCode largest = 0;          ///< largest saturated error in it and in pages below it
  float lowest = 0, highest = 0;  ///< heights in the vertical unit, rounded outward; +inf and -inf: voids only
  std::uint32_t generation = 0;   ///< the last update that wrote it
  friend bool operator==(const ChildEntry&, const ChildEntry&) = default;
};

/// One entry for both: the larger error, the joined range of heights, the later generation.
[[nodiscard]] ChildEntry joined(const ChildEntry& a, const ChildEntry& b);

struct Page {
  PageId id;
  int bands = 1;  ///< bands of the database; the coarsest also holds all levels above
  PageGrid grid;
  std::vector<double> heights;  ///< height codes, row by row
  /// Saturated; 0 for vertices of coarser bands. For encoding: of all own vertices. Decoded: 0 where implied.
  std::vector<ErrorCode> errors;
  /// Decoded: errors that follow from heights (engine/page/page_errors.hpp) as exact distances in height codes; -1
  /// where there is none. In eighths if heights are whole numbers. Both empty: no error is implied. A vertex is
  /// selected if its distance or code is above that of the tolerance.
  std::vector<std::int32_t> eighths;
  std::vector<double> distances;
  std::vector<std::uint8_t> valid;   ///< 1: valid, 0: void; empty: all are valid
  std::vector<std::uint8_t> covers;  ///< RestrictedQuadtree::covers of own vertices; empty: all 15
  std::vector<ChildEntry> children;  ///< kChildrenAcross² row by row; empty in the finest band

  /// Heights of own vertices with error 0 are not stored, except near the border: they lie on the surface of the
  /// others, and KeptHeights computes them. Decoded, they are unspecified.
  bool drops_heights = false;
  GridRect extent{{0, 0}, {-1, -1}};  ///< extent of the database, whose border matters if heights are dropped

  [[nodiscard]] std::size_t index(std::int32_t col, std::int32_t row) const { return grid.index(col, row); }
  [[nodiscard]] std::size_t index(GridPoint p) const {
    const GridPoint here = grid.local(p);
    return index(here.col, here.row);
  }
  [[nodiscard]] bool is_own(GridPoint p) const { return band_of(p, bands) == id.band; }
  [[nodiscard]] bool is_data(std::size_t i) const { return valid.empty() || valid[i] != 0; }
  /// Sample i, at p, of a page with errors, encoded or decoded.
  [[nodiscard]] bool is_dropped(std::size_t i, GridPoint p) const {
    return drops_heights && errors[i] == 0 && is_own(p) && !is_near_border(p, extent);
  }
  /// For a decoded page.
  [[nodiscard]] bool is_implied(std::size_t i) const {
    return eighths.empty() ? !distances.empty() && distances[i] >= 0 : eighths[i] >= 0;
  }
  /// Error of an implied vertex in height codes.
  [[nodiscard]] double implied_distance(std::size_t i) const {
    return eighths.empty() ? distances[i] : eighths[i] / 8.0;
  }
  /// Error of an own vertex in metres, stored or implied.
  [[nodiscard]] double error_m(std::size_t i, const CodeDistance& distance) const {
    return is_implied(i) ? distance.metres(implied_distance(i)) : error_of(errors[i]);
  }
  /// The same as a code.
  [[nodiscard]] ErrorCode error(std::size_t i, const CodeDistance& distance) const {
    return is_implied(i) ? error_code(distance.metres(implied_distance(i))) : errors[i];
  }
};

/// An entry with the range of the page's valid stored heights, without an error.
[[nodiscard]] ChildEntry range_of(const Page& page, const HeightStep& step);

/// Encodes pages one after the other, reusing its memory.
class PageEncoder {
 public:
  PageEncoder();
  ~PageEncoder();
  PageEncoder(PageEncoder&&) noexcept;
  PageEncoder& operator=(PageEncoder&&) noexcept;

  /// decode(encode(page)) is the page, heights bit for bit, except heights that the page drops or that are void and not
  /// needed by a triangle. An error is implied only if the heights give exactly its code. The same page always has the
  /// same bytes.
  ///
  /// distance  from height codes to metres, as in decode
  /// cost      about 12 ns a sample
  [[nodiscard]] std::vector<std::byte> encode(const Page& page, const CodeDistance& distance);

  /// Approximate sizes of the parts of the last page in bits. For measurements.
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

/// Decodes pages one after the other, reusing its memory.
class PageDecoder {
 public:
  PageDecoder();
  ~PageDecoder();
  PageDecoder(PageDecoder&&) noexcept;
  PageDecoder& operator=(PageDecoder&&) noexcept;

  /// The page, valid until the next call.
  ///
  /// fails  corrupt: bytes that cannot be a page of this id and extent. Memory never exceeds that of a page of
  ///        kPageSide² samples
  /// cost   about 4 ns a sample
  [[nodiscard]] const Page& decode(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                   std::span<const std::byte> bytes);
  /// The page without errors, unchecked. If heights were dropped, it has the errors that say which.
  [[nodiscard]] const Page& decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                           std::span<const std::byte> bytes);

 private:
  struct Scratch;
  /// Everything except errors that follow from heights or are stored after them.
  void decode_most(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                   std::span<const std::byte> bytes);
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace talus
