// The levels above tiles, against loops over all samples of several tiles.

#include "engine/tile/coarse_levels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

using Point = std::pair<std::int32_t, std::int32_t>;

/// Whole numbers over an extent of several tiles, with voids or without.
struct Ground {
  GridRect extent;
  std::vector<std::int16_t> heights;
  std::vector<std::uint8_t> valid;

  [[nodiscard]] std::size_t index(GridPoint p) const {
    return static_cast<std::size_t>((p.row - extent.first.row) * extent.cols() + (p.col - extent.first.col));
  }
  [[nodiscard]] bool has(GridPoint p) const { return extent.contains(p) && valid[index(p)] != 0; }
};

Ground ground(const Terrain& terrain, GridPoint first) {
  Ground g{{first, {first.col + terrain.cols - 1, first.row + terrain.rows - 1}}, {}, terrain.valid};
  for (const double v : terrain.values) g.heights.push_back(static_cast<std::int16_t>(std::nearbyint(v)));
  return g;
}

double side_of(const HalfDiamond& t) { return static_cast<double>((t.centre ? 3 : 2) * t.s); }

/// What ingest hands to the coarse levels: tile by tile, and pages to read back.
class Tiles {
 public:
  explicit Tiles(const Ground& of) : ground_(of) {
    const GridRect& e = of.extent;
    for (std::int32_t y = (e.first.row >> kTileShift) - 1; y <= (e.last.row >> kTileShift) + 1; ++y) {
      for (std::int32_t x = (e.first.col >> kTileShift) - 1; x <= (e.last.col >> kTileShift) + 1; ++x) {
        if (!is_empty(tile_window({x, y}, e))) add({x, y});
      }
    }
  }
  [[nodiscard]] ForEachTile all() const {
    return [this](const auto& visit) {
      for (const auto& [id, summary] : summaries_) visit(id, summary);
    };
  }
  [[nodiscard]] ReadBack pages() {
    return [this](PageId id) -> const Page* {
      page_ = {};
      page_.id = id;
      page_.grid = page_grid(id, ground_.extent);
      if (page_.grid.size() == 0) return nullptr;
      bool any = false;
      for (std::int32_t row = 0; row < page_.grid.rows; ++row) {
        for (std::int32_t col = 0; col < page_.grid.cols; ++col) {
          const std::size_t i = ground_.index(page_.grid.at(col, row));
          page_.heights.push_back(ground_.heights[i]);
          page_.valid.push_back(ground_.valid[i]);
          any = any || ground_.valid[i] != 0;
        }
      }
      return any ? &page_ : nullptr;
    };
  }
  /// Of void samples on every 64th, the height that the tile gave them.
  [[nodiscard]] const std::map<Point, double>& fills() const { return fills_; }

 private:
  void add(TileId id) {
    const GridRect window = tile_window(id, ground_.extent);
    std::vector<std::int16_t> heights;
    std::vector<std::uint8_t> valid;
    for_each_point(window, [&](GridPoint p) {
      heights.push_back(ground_.heights[ground_.index(p)]);
      valid.push_back(ground_.valid[ground_.index(p)]);
    });
    const TileErrors made =
        tile_errors({id, ground_.extent, std::span<const std::int16_t>(heights), valid, {}, side_of, 1});
    if (made.all_void) return;
    auto summary = std::make_unique<TileSummary>();
    summary->record = made.record;
    const HeightField field{window, view(made.heights), {}, {}};
    for (std::int32_t y = 0; y < kTileBlocks; ++y) {
      for (std::int32_t x = 0; x < kTileBlocks; ++x) {
        const GridPoint p{id.x * kTileSide + x * kBlockSide, id.y * kTileSide + y * kBlockSide};
        if (!ground_.extent.contains(p)) continue;
        const auto post = static_cast<std::size_t>(y * kTileBlocks + x);
        summary->posts[post] = field[p];
        summary->post_valid[post] = ground_.has(p) ? 1 : 0;
        if (!ground_.has(p)) fills_[{p.col, p.row}] = field[p];
      }
    }
    summaries_.emplace_back(id, std::move(*summary));
  }
  const Ground& ground_;
  std::vector<std::pair<TileId, TileSummary>> summaries_;
  std::map<Point, double> fills_;
  Page page_;
};

// ---- plain loops -------------------------------------------------------------------------------------------

std::int64_t cross(GridPoint a, GridPoint b, GridPoint c) {
  return (std::int64_t{b.col} - a.col) * (std::int64_t{c.row} - a.row) -
         (std::int64_t{b.row} - a.row) * (std::int64_t{c.col} - a.col);
}

/// Without voids: every error is the largest distance in its own diamond and those of all vertices below.
class Plain {
 public:
  explicit Plain(const Ground& of) : ground_(of), known_(of.extent, 13, -1) {}

  [[nodiscard]] double saturated(GridPoint p) {
    if (!known_.holds(p)) return 0;
    if (known_[p] >= 0) return known_[p];
    double largest = std::max(own(p, 0), own(p, 1));
    const Children below = children(p);
    for (int i = 0; i < below.count; ++i) largest = std::max(largest, saturated(below.at[static_cast<std::size_t>(i)]));
    return known_[p] = largest;
  }

  /// Of one half alone.
  [[nodiscard]] double own(GridPoint vertex, std::size_t side) const {
    const Diamond d = diamond(vertex);
    const GridPoint a = d.ends[0], b = d.ends[1], apex = d.apexes[side];
    for (const GridPoint p : {a, b, apex}) {
      if (!ground_.extent.contains(p)) return 0;
    }
    const auto height = [&](GridPoint p) { return std::int64_t{ground_.heights[ground_.index(p)]}; };
    const std::int64_t area = std::abs(cross(apex, a, b)), sign = cross(apex, a, b) < 0 ? -1 : 1;
    std::int64_t largest = 0;
    const auto [left, right] = std::minmax({apex.col, a.col, b.col});
    const auto [top, bottom] = std::minmax({apex.row, a.row, b.row});
    for (std::int32_t row = top; row <= bottom; ++row) {
      for (std::int32_t col = left; col <= right; ++col) {
        const GridPoint p{col, row};
        const std::int64_t one = sign * cross(p, a, b), two = sign * cross(apex, p, b),
                           three = sign * cross(apex, a, p);
        if (one < 0 || two < 0 || three < 0) continue;
        largest =
            std::max(largest, std::abs(area * height(p) - one * height(apex) - two * height(a) - three * height(b)));
      }
    }
    return static_cast<double>(largest) / static_cast<double>(area);
  }

 private:
  const Ground& ground_;
  LevelGrid<double> known_;  ///< -1: not known yet
};

template <class Visit>
void for_each_post(GridRect extent, Visit&& visit) {
  for_each_point(
      {{(extent.first.col + 63) >> 6, (extent.first.row + 63) >> 6}, {extent.last.col >> 6, extent.last.row >> 6}},
      [&](GridPoint unit) {
        visit(GridPoint{unit.col * 64, unit.row * 64});
      });
}

/// So large that two triangles are larger than a tile, around (1024, 0).
Ground large_ground(std::uint64_t seed) { return ground(fractal(2081, 1047, seed), {-20, -12}); }

void expect_plain_errors(const Ground& g) {
  Tiles tiles(g);
  CoarseLevels levels(g.extent, {}, side_of, 1);
  levels.settle(tiles.all(), tiles.pages());
  EXPECT_FALSE(levels.has_voids());
  EXPECT_EQ(std::int32_t{1} << levels.root_height(), root_side(g.extent));
  Plain plain(g);
  for_each_post(g.extent, [&](GridPoint p) {
    EXPECT_EQ(levels.height(p), g.heights[g.index(p)]) << name_of(p);
    EXPECT_TRUE(levels.is_valid(p));
    if (height_in_tree(p) >= levels.root_height()) {
      EXPECT_EQ(levels.error(p), kAlwaysSelected) << name_of(p);
    } else {
      EXPECT_EQ(levels.error(p), error_code(plain.saturated(p))) << name_of(p) << ": " << plain.saturated(p) << " m";
    }
  });
}

TEST(CoarseLevels, ErrorsAreTheLargestDistancesOfAllThatHangsBelow) {
  expect_plain_errors(large_ground(1));
  expect_plain_errors(ground(plateaus(1300, 300), {-600, -200}));
}

TEST(CoarseLevels, ATriangleLargerThanATileIsMeasuredOverAllItsSamples) {
  // A hill as wide as the triangle: no vertex below is as far off. On it stand a block with a ramp and a spike at the
  // ramp's foot, and elsewhere a spike that is farther off.
  const Ground g = ground(surface(2081, 1047,
                                  [](int col, int row) {
                                    const int x = col - 20, y = row - 12;
                                    double h = 3000 - ((x - 1024) * (x - 1024) + (y - 400) * (y - 400)) / 400.0;
                                    if (x >= 960 && x < 1024 && y >= 384 && y < 448) h += (x - 992) * 6;
                                    if (x == 962 && y == 390) h += 500;
                                    if (x == 1110 && y == 402) h += 400;
                                    return h;
                                  }),
                          {-20, -12});
  Tiles tiles(g);
  CoarseLevels levels(g.extent, {}, side_of, 1);
  levels.settle(tiles.all(), tiles.pages());
  EXPECT_GT(levels.pages_read_back(), 0u);
  const double own = Plain(g).own({1024, 0}, diamond({1024, 0}).apexes[0].row > 0 ? 0 : 1);
  EXPECT_EQ(levels.error({1024, 0}), error_code(own)) << own << " m";
  EXPECT_LT(levels.error({1536, 512}), levels.error({1024, 0}));
}

TEST(CoarseLevels, WithoutPagesErrorsAreNeverTooSmall) {
  const Ground g = large_ground(9);
  Tiles tiles(g);
  CoarseLevels exact(g.extent, {}, side_of, 1), bounded(g.extent, {}, side_of, 1);
  exact.settle(tiles.all(), tiles.pages());
  bounded.settle(tiles.all(), {});
  EXPECT_EQ(bounded.pages_read_back(), 0u);
  int above = 0;
  for_each_post(g.extent, [&](GridPoint p) {
    EXPECT_GE(bounded.error(p), exact.error(p)) << name_of(p);
    above += bounded.error(p) > exact.error(p) ? 1 : 0;
  });
  EXPECT_GT(above, 0) << "of vertices whose triangles are larger than a tile";
}

TEST(CoarseLevels, APlaneHasNoError) {
  const Ground g = ground(plane(2081, 1047, 5, 2, -3), {-20, -12});
  Tiles tiles(g);
  CoarseLevels levels(g.extent, {}, side_of, 1);
  levels.settle(tiles.all(), tiles.pages());
  for_each_post(g.extent, [&](GridPoint p) {
    if (height_in_tree(p) < levels.root_height()) {
      EXPECT_EQ(levels.error(p), 0) << name_of(p);
    }
  });
}

// ---- voids -------------------------------------------------------------------------------------------------

/// Whether some finest triangle inside a triangle of the hierarchy has data, by going through all of them.
bool has_data(const Ground& g, const Triangle& t) {
  for (const GridPoint p : {t.apex, t.left, t.right}) {
    if (!g.extent.contains(p)) return false;
  }
  const GridPoint middle = midpoint(t.left, t.right);
  if (std::abs(cross(t.apex, t.left, t.right)) == 1) return g.has(t.apex) && g.has(t.left) && g.has(t.right);
  return has_data(g, {middle, t.apex, t.left}) || has_data(g, {middle, t.apex, t.right});
}

TEST(CoarseLevels, TrianglesWithDataAreThoseThatHoldAFinestOneWithData) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Terrain terrain = fractal(1300, 600, seed);
    terrain = seed % 2 == 0 ? void_blobs(std::move(terrain), 6, seed) : hole(std::move(terrain), 100, 0, 1250, 570);
    const Ground g = ground(terrain, {random.between(-1000, -200), random.between(-400, -100)});
    Tiles tiles(g);
    CoarseLevels levels(g.extent, {}, side_of, 1);
    levels.settle(tiles.all(), tiles.pages());
    EXPECT_TRUE(levels.has_voids());
    for_each_post(g.extent, [&](GridPoint p) {
      if (height_in_tree(p) >= levels.root_height()) return;
      unsigned expected = 0;
      const auto triangles = apex_triangles(p);
      for (std::size_t i = 0; i < 4; ++i) expected |= has_data(g, triangles[i]) ? 1u << i : 0u;
      EXPECT_EQ(levels.apex_triangles_with_data(p), expected) << name_of(p);
      EXPECT_EQ(levels.is_valid(p), g.has(p)) << name_of(p);
      if (g.has(p)) {
        EXPECT_EQ(levels.height(p), g.heights[g.index(p)]);
      }
    });
  }
}

TEST(CoarseLevels, AVoidFarFromDataGetsAHeightOfTheNearestBlocks) {
  // All data is 70 m high, and lies farther from the origin of the second tile than a tile looks for a fill.
  const Ground g = ground(hole(plane(1400, 300, 70, 0, 0), 300, 0, 1390, 280), {0, 0});
  Tiles tiles(g);
  CoarseLevels levels(g.extent, {}, side_of, 1);
  levels.settle(tiles.all(), tiles.pages());
  int needed = 0;
  for_each_post(g.extent, [&](GridPoint p) {
    if (g.has(p) || height_in_tree(p) >= levels.root_height() || levels.apex_triangles_with_data(p) == 0) return;
    EXPECT_EQ(levels.height(p), 70) << name_of(p);
    needed += tiles.fills().at({p.col, p.row}) != 70 ? 1 : 0;
  });
  EXPECT_GT(needed, 0) << "no tile left a vertex without a height";
}

TEST(CoarseLevels, NoErrorIsBelowThatOfAVertexBelowNorBelowTheSideOfAMixedTriangle) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Ground g = seed == 1 ? ground(void_blobs(fractal(2081, 1047, seed), 8, seed), {-20, -12})
                               : ground(void_blobs(fractal(1300, 500, seed), 8, seed),
                                        {random.between(-1000, 0), random.between(-400, 0)});
    Tiles tiles(g);
    CoarseLevels levels(g.extent, {}, side_of, 1);
    levels.settle(tiles.all(), tiles.pages());
    std::size_t mixed = 0;
    for_each_post(g.extent, [&](GridPoint p) {
      if (height_in_tree(p) >= levels.root_height()) return;
      const Children below = children(p);
      for (int i = 0; i < below.count && spacing(below.at[static_cast<std::size_t>(i)]) >= 64; ++i) {
        const GridPoint child = below.at[static_cast<std::size_t>(i)];
        if (g.extent.contains(child)) {
          EXPECT_GE(levels.error(p), levels.error(child)) << name_of(p) << " above " << name_of(child);
        }
      }
      for (const int side : {0, 1}) {
        const HalfDiamond t = half_diamond(p, side);
        if (!inside(t, g.extent)) continue;
        std::size_t valid = 0, all = 0;
        for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
          for (std::int32_t col = t.columns(row).lo; col <= t.columns(row).hi; ++col)
            ++all, valid += g.has({col, row}) ? 1 : 0;
        }
        if (valid == all || !has_data(g, {t.apex, t.a, t.b})) continue;
        ++mixed;
        EXPECT_GE(levels.error(p), error_code(side_of(t))) << name_of(p);
      }
    });
    EXPECT_GT(mixed, 0u);
  }
}

}  // namespace
}  // namespace talus::support
