// A tile knows from its window alone what plain loops over everything say.

#include "engine/tile/tile.hpp"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/error/kernel_choice.hpp"
#include "engine/error/saturation.hpp"
#include "engine/machine/instruction_set.hpp"
#include "talus/failure.hpp"
#include "tests/engine/fields.hpp"
#include "tests/engine/terrains.hpp"
#include "tests/support/forced_kernel.hpp"

namespace talus::support {
namespace {

/// What plain loops over a whole field give.
struct Reference {
  explicit Reference(const Field& of) : field(of), errors(reference_errors(of.input, kTileLevels)) {
    saturate(of.input, errors);
  }
  const Field& field;
  LevelGrid<ErrorCode> errors;  ///< saturated

  [[nodiscard]] bool is_valid(GridPoint p) const { return field.valid[field.index(p)] != 0; }
  [[nodiscard]] ErrorCode error(GridPoint p) const { return errors.holds(p) ? errors[p] : ErrorCode{0}; }
  [[nodiscard]] Holds holds(GridPoint p, int side) const {
    return !field.voids ? kData : field.voids->holds(p) ? field.voids->half(p, side) : kNothing;
  }
  /// A void vertex that no sample is near to has no fill of a tile's.
  [[nodiscard]] bool lacks_fill(GridPoint p) const {
    return field.extent.contains(p) && !is_valid(p) && !plain_fill(field.input.field, p);
  }
};

/// A window of a field as a tile's input; voids hold what they must not be read for.
struct Window {
  Window(const Field& field, TileId id) {
    const GridRect window = tile_window(id, field.extent);
    std::visit(
        [&](const auto& all) {
          std::decay_t<decltype(all)> part;
          using Code = typename std::decay_t<decltype(all)>::value_type;
          for_each_point(window, [&](GridPoint p) {
            const bool is_valid = field.valid[field.index(p)] != 0;
            valid.push_back(is_valid ? 1 : 0);
            part.push_back(is_valid                                   ? all[field.index(p)]
                           : std::numeric_limits<Code>::has_quiet_NaN ? std::numeric_limits<Code>::quiet_NaN()
                                                                      : static_cast<Code>(-32768));
          });
          codes = std::move(part);
        },
        field.codes);
    const ErrorInput& in = field.input;
    input = {id, field.extent, view(codes), {}, in.field.distance, in.ground_side, in.void_weight};
    if (in.voids != nullptr) input.valid = valid;
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  Codes codes;
  std::vector<std::uint8_t> valid;
  TileInput input;
};

GridRect square_of(TileId id) {
  const GridRect closed = closed_tile(id);
  return {closed.first, {closed.last.col - 1, closed.last.row - 1}};
}

void expect_errors(const Reference& reference, TileId id, const TileErrors& got) {
  std::size_t different = 0;
  const auto expect_vertex = [&](GridPoint p) {
    if (spacing(p) >= kBlockSide) return;
    const ErrorCode error = got.errors.holds(p) ? got.errors[p] : ErrorCode{0};
    if (error == reference.error(p) || ++different > 3) return;
    ADD_FAILURE() << "vertex " << name_of(p) << " of spacing " << spacing(p) << ": " << error_of(error) << " m, plain "
                  << error_of(reference.error(p)) << " m";
  };
  // Only near the extent can any error be: farther out all are zero.
  const GridRect e = reference.field.extent, square = square_of(id);
  const GridRect near{{std::max(square.first.col, e.first.col - 100), std::max(square.first.row, e.first.row - 100)},
                      {std::min(square.last.col, e.last.col + 100), std::min(square.last.row, e.last.row + 100)}};
  for_each_point(near, expect_vertex);
  EXPECT_EQ(different, 0u) << "vertices differ";
}

void expect_fills(const Reference& reference, TileId id, const TileErrors& got) {
  const GridRect window = tile_window(id, reference.field.extent);
  const HeightField field{window, view(got.heights), {}, {}};
  std::size_t different = 0;
  for_each_point(window, [&](GridPoint p) {
    const GridRect closed = closed_tile(id);
    if (!closed.contains(p)) return;
    if (field[p] == reference.field.input.field[p] || ++different > 3) return;
    ADD_FAILURE() << "height of " << name_of(p) << " is " << field[p] << ", expected " << reference.field.input.field[p]
                  << (reference.is_valid(p) ? "" : " (a fill)");
  });
  EXPECT_EQ(different, 0u) << "heights differ";
}

void expect_voids(const Reference& reference, TileId id, const TileErrors& got) {
  if (!got.voids) return;
  std::size_t different = 0;
  for_each_point(square_of(id), [&](GridPoint p) {
    if (spacing(p) >= kBlockSide || !reference.field.extent.contains(p)) return;
    if (got.voids->apex_triangles_with_data(p) != reference.field.voids->apex_triangles_with_data(p)) ++different;
    for (const int side : {0, 1}) {
      if (got.voids->half(p, side) != reference.holds(p, side)) ++different;
    }
  });
  EXPECT_EQ(different, 0u) << "triangles hold something else";
}

void expect_block(const Reference& reference, GridPoint corner, const TileRecord::Block& block) {
  SCOPED_TRACE("block at " + name_of(corner));
  const Field& field = reference.field;
  const GridPoint centre{corner.col + kBlockSide / 2, corner.row + kBlockSide / 2};
  EXPECT_EQ(block.error, reference.error(centre));
  for (const int side : {0, 1}) {
    const bool in = inside(half_diamond(centre, side), field.extent);
    EXPECT_EQ(block.holds >> (2 * side) & 3, in ? reference.holds(centre, side) : kNothing);
  }
  std::vector<double> heights;
  std::size_t beyond = 0;
  for_each_point({corner, {corner.col + kBlockSide - 1, corner.row + kBlockSide - 1}}, [&](GridPoint p) {
    if (!field.extent.contains(p) || !reference.is_valid(p)) return;
    const double h = field.input.field[p];
    heights.push_back(h);
    const double on_plane = static_cast<double>(block.middle) +
                            static_cast<double>(block.right) * (p.col - centre.col) +
                            static_cast<double>(block.down) * (p.row - centre.row);
    if (h > on_plane + static_cast<double>(block.above) || h < on_plane - static_cast<double>(block.below)) ++beyond;
  });
  EXPECT_EQ(beyond, 0u) << "samples are not near the plane";
  EXPECT_EQ(block.has_data, !heights.empty());
  if (heights.empty()) return;
  std::sort(heights.begin(), heights.end());
  const double middle = heights.front() + (heights.back() - heights.front()) / 2;
  EXPECT_EQ(block.typical, *std::min_element(heights.begin(), heights.end(), [&](double a, double b) {
              return std::abs(a - middle) < std::abs(b - middle);
            }));
  if (field.bits) {
    const GridPoint at{corner.col >> kBlockShift, corner.row >> kBlockShift};
    EXPECT_EQ(block.bits, (*field.bits)[at]);
  }
}

/// Raw errors and holds of the halves that lie in the tile.
void expect_far_vertex(const Reference& reference, TileId id, GridPoint p, ErrorCode error, std::uint8_t holds) {
  const ErrorInput& input = reference.field.input;
  double metres = 0;
  std::uint8_t expected = reference.lacks_fill(p) ? TileRecord::kNoFill : 0;
  for (const int side : {0, 1}) {
    if (spacing(p) >= kTileSide) continue;
    const HalfDiamond t = half_diamond(p, side);
    if (!inside(t, closed_tile(id)) || !inside(t, reference.field.extent)) continue;
    const Holds held = reference.holds(p, side);
    expected |= static_cast<std::uint8_t>(held << (2 * side));
    if ((held & kData) == 0) continue;
    if (held == kMixed) metres = std::max(metres, input.void_weight * input.ground_side(t));
    if (reference.lacks_fill(t.apex) || reference.lacks_fill(t.a) || reference.lacks_fill(t.b)) {
      expected |= TileRecord::kOpenHalf[side];
    } else {
      metres = std::max(metres, reference_half_error(input, p, side, held));
    }
  }
  EXPECT_EQ(error, error_code(metres)) << "vertex " << name_of(p) << ": " << error_of(error) << " m, plain " << metres;
  EXPECT_EQ(holds, expected) << "vertex " << name_of(p);
}

void expect_record(const Reference& reference, TileId id, const TileRecord& record) {
  const GridPoint first = closed_tile(id).first;
  for (std::int32_t y = 0; y < kTileBlocks; ++y) {
    for (std::int32_t x = 0; x < kTileBlocks; ++x) {
      expect_block(reference, {first.col + x * kBlockSide, first.row + y * kBlockSide},
                   record.blocks[static_cast<std::size_t>(y * kTileBlocks + x)]);
    }
  }
  for (std::int32_t y = 0; y <= kTileBlocks; ++y) {
    for (std::int32_t x = 0; x <= kTileBlocks; ++x) {
      const auto i = static_cast<std::size_t>(y * TileRecord::kAcross + x);
      expect_far_vertex(reference, id, {first.col + x * kBlockSide, first.row + y * kBlockSide}, record.errors[i],
                        record.holds[i]);
    }
  }
}

void expect_tile(const Reference& reference, TileId id) {
  SCOPED_TRACE("tile " + name_of({id.x, id.y}));
  const Window window(reference.field, id);
  const TileErrors got = tile_errors(window.input);
  if (got.all_void) {
    for_each_point(tile_window(id, reference.field.extent), [&](GridPoint p) { ASSERT_FALSE(reference.is_valid(p)); });
    for_each_vertex(reference.errors,
                    [&](GridPoint p) { ASSERT_TRUE(!square_of(id).contains(p) || reference.error(p) == 0); });
    return;
  }
  expect_errors(reference, id, got);
  expect_fills(reference, id, got);
  expect_voids(reference, id, got);
  expect_record(reference, id, got.record);
}

/// Every tile with a window.
template <class Visit>
void for_each_tile(GridRect extent, Visit&& visit) {
  for (std::int32_t y = (extent.first.row >> kTileShift) - 1; y <= (extent.last.row >> kTileShift) + 1; ++y) {
    for (std::int32_t x = (extent.first.col >> kTileShift) - 1; x <= (extent.last.col >> kTileShift) + 1; ++x) {
      if (!is_empty(tile_window({x, y}, extent))) visit(TileId{x, y});
    }
  }
}

void expect_all_tiles(const Terrain& terrain, GridPoint first, HeightStep step = {}) {
  const Field field(terrain, first, step);
  const Reference reference(field);
  for_each_tile(field.extent, [&](TileId id) { expect_tile(reference, id); });
}

HeightStep random_step(Random& random) { return random.chance(0.3) ? HeightStep{1, 10, 0, true} : HeightStep{}; }

TEST(TileErrors, AreThoseOfPlainLoopsOverSmallFields) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto numbers = static_cast<Numbers>(random.between(0, kNumbers - 1));
    const int cols = random.between(1, random.chance(0.2) ? 5 : 200);
    const int rows = random.between(1, random.chance(0.2) ? 5 : 200);
    const GridPoint first =
        random.chance(0.4) ? GridPoint{0, 0} : GridPoint{random.between(-1300, 1300), random.between(-1300, 1300)};
    expect_all_tiles(random_terrain(random, numbers, cols, rows), first, random_step(random));
    if (HasFailure()) return;
  }
}

TEST(TileErrors, DependOnTheWindowAloneWhereverTheTileLies) {
  for (std::uint64_t seed = 1; seed <= 14; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto numbers = static_cast<Numbers>(seed % kNumbers);
    const int cols = random.between(300, 1500), rows = random.between(200, 700);
    const GridPoint first{random.between(-1300, 200), random.between(-700, 0)};
    expect_all_tiles(random_terrain(random, numbers, cols, rows), first, random_step(random));
    if (HasFailure()) return;
  }
}

TEST(TileErrors, OfNineTilesAreThoseOfOneField) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Terrain terrain = fractal(3073, 3073, seed);
    for (double& v : terrain.values) v = seed == 1 ? std::nearbyint(v) : static_cast<double>(static_cast<float>(v));
    if (seed == 2) {
      terrain = void_blobs(hole(std::move(terrain), 900, 1000, 2300, 1900), 6, seed);
      for (int i = 0; i < 40; ++i) terrain.make_void((i * 797) % 3073, (i * 1009) % 3073);
    }
    expect_all_tiles(terrain, {-1024, -1500});
    if (HasFailure()) return;
  }
}

TEST(TileErrors, OfVoidsOnlyAreNone) {
  Terrain terrain = plane(70, 70);
  for (std::uint8_t& v : terrain.valid) v = 0;
  const Field field(terrain);
  const Window window(field, {0, 0});
  const TileErrors got = tile_errors(window.input);
  EXPECT_TRUE(got.all_void);
  EXPECT_FALSE(got.errors.holds({1, 1}));
}

TEST(TileErrors, ThinFieldsAreNoSpecialCase) {
  for (const auto& [cols, rows] : {std::pair{1, 1}, {1, 200}, {200, 1}, {2, 130}, {130, 2}, {65, 3}, {1100, 1}}) {
    Terrain terrain = noise(cols, rows, 3);
    for (double& v : terrain.values) v = std::nearbyint(v);
    expect_all_tiles(terrain, {-64, -65});
    expect_all_tiles(terrain, {1023, 1024});
  }
}

TEST(TileErrors, CarryWhatNoFloatHolds) {
  // Twenty kilometres and a millimetre, in millimetres: the nearest float is a rung of the ladder, the error is not.
  Terrain terrain = plane(65, 65, 0, 0, 0);
  terrain.at(31, 17) = 20000001;
  expect_all_tiles(terrain, {0, 0}, HeightStep{1, 1000, 0, true});
  const Field field(terrain, {0, 0}, HeightStep{1, 1000, 0, true});
  const Window window(field, {0, 0});
  EXPECT_EQ((tile_errors(window.input).errors[{31, 17}]), error_code(20000.001));
  EXPECT_NE(error_code(20000.001), error_code(20000));
  expect_all_tiles(checkerboard(130, 130, -2147483648.0, 2147483647.0), {0, 0});
  expect_all_tiles(checkerboard(130, 130, -32768, 32767), {0, 0});
}

TEST(TileErrors, AreTheSameBitsWhicheverKernelRuns) {
  for (const InstructionSet set : instruction_sets_here()) {
    const std::string name(to_string(set));
    SCOPED_TRACE(name);
    const ForcedKernel forced(name);
    for (std::uint64_t seed = 1; seed <= 3 * kNumbers; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(1000 + seed);
      const auto numbers = static_cast<Numbers>(seed % kNumbers);
      expect_all_tiles(random_terrain(random, numbers, random.between(60, 700), random.between(60, 200)),
                       {random.between(-100, 100), random.between(-100, 100)}, random_step(random));
      if (HasFailure()) return;
    }
  }
}

TEST(TileErrors, RefuseAKernelThatIsNone) {
  const ForcedKernel forced("abacus");
  EXPECT_THROW((void)detail::block_kernel(), Failure);
}

}  // namespace
}  // namespace talus::support
