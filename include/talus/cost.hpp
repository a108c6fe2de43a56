#pragma once
// The cost of questions.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace talus {

/// Pages of one band that a question met. A question goes from the coarsest pages down, and a page tells which pages
/// below it are needed. Each page counts once. Questions about points and lines fill in the last three numbers only.
struct BandCost {
  std::int32_t spacing = 1;     ///< of the band's finest vertices, in cells; the coarsest band has all levels above
  std::uint64_t in_region = 0;  ///< squares of pages that meet the region, stored or not

  // Pages that were used:
  std::uint64_t wanted = 0;  ///< an error in or below them may be above the tolerance
  std::uint64_t needed = 0;  ///< only the border or a point of interest needs them
  std::uint64_t beyond = 0;  ///< outside the region: triangles that cross its side end there

  // Pages that were left out:
  std::uint64_t from_slice = 0;       ///< the slice of their tile was read in their place
  std::uint64_t below_tolerance = 0;  ///< all errors in and below them are within the tolerance
  std::uint64_t too_fine = 0;         ///< their levels are finer than Question::max_level
  std::uint64_t only_voids = 0;       ///< they are not stored, because they hold voids only
  std::uint64_t outside = 0;          ///< they lie outside the region, but a page above them does not

  // What was read. A page that is used twice may be read twice, or found in the cache twice. Slices of tiles belong to
  // the band of spacing 8, and its bytes include theirs.
  std::uint64_t pages_read = 0, slices_read = 0, bytes_read = 0, pages_cached = 0;

  /// Adds the numbers of the same band.
  BandCost& operator+=(const BandCost& other) {
    for (const auto count :
         {&BandCost::in_region, &BandCost::wanted, &BandCost::needed, &BandCost::beyond, &BandCost::from_slice,
          &BandCost::below_tolerance, &BandCost::too_fine, &BandCost::only_voids, &BandCost::outside,
          &BandCost::pages_read, &BandCost::slices_read, &BandCost::bytes_read, &BandCost::pages_cached})
      this->*count += other.*count;
    return *this;
  }
  /// Pages in the region that were not looked at, because a page above them was left out.
  [[nodiscard]] std::uint64_t unasked() const {
    return in_region - wanted - needed - from_slice - below_tolerance - too_fine - only_voids;
  }
};

/// The cost of an answer. `bytes_read` includes the header and the coarse pages.
struct QueryCost {
  std::uint64_t pages_read = 0, bytes_read = 0;
  double seconds = 0;
  std::uint64_t pages_cached = 0;  ///< pages found in the cache; pages_read does not include them
  double reading_seconds = 0;      ///< part of `seconds` for reading, checking, decoding pages; mean of all threads
  double gathering_seconds = 0;    ///< part of `seconds` for making the quadtree; the rest is selection
  std::vector<BandCost> bands;     ///< finest first; the header belongs to no band

  QueryCost& operator+=(const QueryCost& other) {
    pages_read += other.pages_read;
    bytes_read += other.bytes_read;
    seconds += other.seconds;
    pages_cached += other.pages_cached;
    reading_seconds += other.reading_seconds;
    gathering_seconds += other.gathering_seconds;
    if (bands.size() < other.bands.size()) bands.resize(other.bands.size());
    for (std::size_t band = 0; band < other.bands.size(); ++band) bands[band] += other.bands[band];
    return *this;
  }
};

}  // namespace talus
