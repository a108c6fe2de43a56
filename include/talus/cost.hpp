#pragma once
// What questions cost.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace talus {

/// What became of the pages of one band. A question about a region goes from the coarsest pages down: it looks into a
/// page, and what that says of the pages below it decides which of these it looks into. A page is counted once, however
/// often it is looked into. Questions about points and lines only count what they read.
struct BandCost {
  std::int32_t spacing = 1;  ///< of the band's finest vertices, in cells; the coarsest band has all coarser ones, too
  std::uint64_t in_region = 0;  ///< squares of pages that meet the region, stored or not

  // Looked into, because
  std::uint64_t wanted = 0;  ///< they may hold something above the tolerance, or of a coarser band's lie above such
  std::uint64_t needed =
      0;  ///< the border or a point asked for needs something there, though nothing is above the tolerance
  std::uint64_t beyond = 0;  ///< triangles that reach out of the region end there; not among those of the region

  // Left out, because
  std::uint64_t below_tolerance = 0;  ///< nothing in them or below them is above it
  std::uint64_t too_fine = 0;         ///< their levels are finer than the one asked for
  std::uint64_t only_voids = 0;       ///< they are not stored
  std::uint64_t outside = 0;          ///< they do not meet the region, but a page above them does

  // What that took; a page looked into twice may be read, or found decoded, twice.
  std::uint64_t pages_read = 0, bytes_read = 0, pages_cached = 0;

  /// Of the same band.
  BandCost& operator+=(const BandCost& other) {
    for (const auto count : {&BandCost::in_region, &BandCost::wanted, &BandCost::needed, &BandCost::beyond,
                             &BandCost::below_tolerance, &BandCost::too_fine, &BandCost::only_voids, &BandCost::outside,
                             &BandCost::pages_read, &BandCost::bytes_read, &BandCost::pages_cached})
      this->*count += other.*count;
    return *this;
  }
  /// In the region, and never asked about: the page above was left out.
  [[nodiscard]] std::uint64_t unasked() const {
    return in_region - wanted - needed - below_tolerance - too_fine - only_voids;
  }
};

/// What an answer cost. Bytes are those of all page values fetched, header and coarse pages included.
struct QueryCost {
  std::uint64_t pages_read = 0, bytes_read = 0;
  double seconds = 0;
  std::uint64_t pages_cached = 0;  ///< found decoded, and neither read nor counted as read
  double reading_seconds = 0;      ///< of `seconds`: fetching, checking and decoding pages; of several threads the mean
  double gathering_seconds = 0;    ///< and making a quadtree of what was chosen; the rest is choosing
  std::vector<BandCost> bands;     ///< finest first; the header is in none

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
