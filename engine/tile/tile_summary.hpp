#pragma once
// The tile record: what the file keeps of a tile beside its pages, so that coarse levels, resume and later tiles need
// not read its samples again.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/page/page_codec.hpp"
#include "engine/tile/tile.hpp"

namespace talus {

/// Numbers of vertices with an error above each rung: 0, then 1, 2, 5 a decade from 1 mm to 50 km, in metres.
inline constexpr std::size_t kErrorRungs = 25;
[[nodiscard]] double error_rung(std::size_t i);
using ErrorHistogram = std::array<std::uint64_t, kErrorRungs>;

struct TileSummary {
  TileRecord record;
  /// Codes of every 64th sample of the tile's square, row by row, and whether they are valid; 0 outside the extent.
  static constexpr std::size_t kPosts = static_cast<std::size_t>(kTileBlocks) * kTileBlocks;
  std::array<double, kPosts> posts{};
  std::array<std::uint8_t, kPosts> post_valid{};
  ChildEntry entry;  ///< what the page of band 2 needs of the tile's page of band 1
  std::uint64_t valid_samples = 0;
  double lowest = 0, highest = 0;  ///< heights of valid samples, in the vertical unit; meaningless without any
  ErrorHistogram errors{};         ///< errors of the tile's vertices of bands 0 and 1
};

/// cost  makes a few kB in about 50 µs
[[nodiscard]] std::vector<std::byte> encode(const TileSummary& summary);
/// fails  corrupt: the bytes are not a summary
[[nodiscard]] TileSummary decode_tile_summary(std::span<const std::byte> bytes);

}  // namespace talus
