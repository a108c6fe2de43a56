// Arbitrary bytes as the slice of a tile: refused as corrupt, or a slice that encodes to the same slice again.
//
// The first byte chooses which tile of which database the rest claims to be of.

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <span>
#include <tuple>

#include "engine/page/tile_slice.hpp"
#include "talus/failure.hpp"

namespace {

using namespace talus;

struct Place {
  TileId id;
  GridRect extent;
};
constexpr Place kPlaces[] = {{{0, 0}, {{0, 0}, {1023, 1023}}},
                             {{0, 0}, {{0, 0}, {70, 40}}},
                             {{-1, 2}, {{-900, 16}, {80, 2100}}},
                             {{3, 3}, {{-9000, -9000}, {9000, 9000}}}};

void require(bool holds) {
  if (!holds) std::abort();
}

using Vertices = std::map<std::uint32_t, std::tuple<std::uint64_t, std::int32_t, int>>;
Vertices vertices_of(const TileSlice& slice) {
  Vertices vertices;
  for (std::size_t i = 0; i < slice.size(); ++i) {
    require(std::isfinite(slice.heights[i]) && slice.errors[i] >= slice.above);
    const int covers = slice.covers.empty() ? 15 : slice.covers[i];
    vertices[slice.places[i]] = {std::bit_cast<std::uint64_t>(slice.heights[i]), slice.errors[i], covers};
  }
  require(vertices.size() == slice.size());
  return vertices;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto& [id, extent] = kPlaces[data[0] % std::size(kPlaces)];
  const CodeDistance distance({1, 1, 0, (data[0] & 128) != 0}, 1);
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  SliceCoder coder, again;
  try {
    const TileSlice& slice = coder.decode(id, extent, distance, bytes);
    const Vertices vertices = vertices_of(slice);
    if (slice.above == kNoSlice) return 0;
    const auto written = again.encode(id, extent, distance, slice);
    // Posts may be numbers that no height has; heights need more bits then.
    if (SliceCoder::threshold_of(written) == kNoSlice) return 0;
    require(SliceCoder::threshold_of(written) == slice.above);
    require(vertices_of(again.decode(id, extent, distance, written)) == vertices);
  } catch (const Failure& failure) {
    require(failure.cause() == Cause::corrupt);
  }
  return 0;
}
