// The pyramid of Dick et al. over a window of a model, and an answer of Talus over the same window.
//
//   pyramid MODEL COL ROW SIDE METRES     SIDE is 512 · 2^n; the window has SIDE + 1 samples each way
//
// Level 0 is the window itself, each level above it has a quarter of the samples, means of four, and twice the
// tolerance. A level is cut into tiles of 513² samples that are meshed apart: triangles farther from their samples than
// the tolerance are split until there is none, over heights that are rounded before by at most a quarter of the
// tolerance. What the tiles take is printed twice: by the paper's layout (k + 2 bits a triangle and two more entries,
// 32 bits every sixteen triangles), and as our strips are written, header and checksums included. Skirts, textures and
// indices are not counted.
//
// The answer keeps the same tolerance against the window's samples in one mesh without cracks; its strip rounds by the
// same quarter, so it is asked for at three quarters. The pyramid promises nothing above level 0: means are not
// samples. source  [D09 §4]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gdal_priv.h>

#include "bench/kept.hpp"
#include "engine/quadtree/construction.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "engine/stream/stream_codec.hpp"
#include "query/accuracy/true_error.hpp"
#include "talus/ingest.hpp"
#include "talus/strip.hpp"
#include "talus/talus.hpp"

namespace talus::bench {
namespace {

constexpr std::int32_t kTile = 512;
constexpr double kRounding = 0.25;  ///< of the tolerance: [D09 §4] found it good

/// A level's heights, side + 1 each way.
struct Level {
  std::int32_t side = 0;
  std::vector<double> heights;
  [[nodiscard]] double at(std::int32_t col, std::int32_t row) const {
    return heights[static_cast<std::size_t>(std::min(row, side)) * static_cast<std::size_t>(side + 1) +
                   static_cast<std::size_t>(std::min(col, side))];
  }
};

Level coarser(const Level& finer) {
  Level level{finer.side / 2, {}};
  for (std::int32_t row = 0; row <= level.side; ++row) {
    for (std::int32_t col = 0; col <= level.side; ++col) {
      level.heights.push_back((finer.at(2 * col, 2 * row) + finer.at(2 * col + 1, 2 * row) +
                               finer.at(2 * col, 2 * row + 1) + finer.at(2 * col + 1, 2 * row + 1)) /
                              4);
    }
  }
  return level;
}

/// One tile's mesh: split where a triangle is too far from its samples, closed, and looked at again.
class Tile {
 public:
  Tile(const Level& level, std::int32_t col, std::int32_t row, double tolerance) : tolerance_(tolerance) {
    const double step = 2 * kRounding * tolerance;
    for (std::int32_t r = 0; r <= kTile; ++r) {
      for (std::int32_t c = 0; c <= kTile; ++c) {
        samples_.push_back(level.at(col + c, row + r));
        rounded_.push_back(std::nearbyint(samples_.back() / step) * step);
      }
    }
    for (auto& errors : errors_) errors.resize(samples_.size(), -1);
    VertexMask& vertices = quadtree_.vertices = VertexMask(kRect);
    for (const GridPoint p : {GridPoint{0, 0}, {kTile, 0}, {0, kTile}, {kTile, kTile}, {kTile / 2, kTile / 2}})
      vertices.insert(p);
    bool grown = true;
    while (grown) {
      seal();
      grown = split();
    }
  }

  [[nodiscard]] const RestrictedQuadtree& quadtree() const { return quadtree_; }
  /// k: [D09 §4]
  [[nodiscard]] int height_bits() const {
    const auto [low, high] = std::minmax_element(samples_.begin(), samples_.end());
    return std::max(0, static_cast<int>(std::ceil(std::log2((*high - *low) / (2 * kRounding * tolerance_)))));
  }

 private:
  static constexpr GridRect kRect{{0, 0}, {kTile, kTile}};
  static std::size_t index(GridPoint p) {
    return static_cast<std::size_t>(p.row) * (kTile + 1) + static_cast<std::size_t>(p.col);
  }

  void seal() {
    quadtree_.vertices.seal();
    quadtree_.heights.clear();
    quadtree_.vertices.for_each([&](GridPoint p) { quadtree_.heights.push_back(rounded_[index(p)]); });
  }

  /// Whether there was a triangle to split.
  bool split() {
    const Mesh mesh = triangulate(quadtree_, 1);
    bool found = false;
    for (const auto& t : mesh.triangles) {
      const GridPoint apex = mesh.points[t[0]], a = mesh.points[t[1]], b = mesh.points[t[2]];
      if (((a.col ^ b.col) & 1) != 0) continue;  // the finest: its corners are all its samples
      const GridPoint middle = midpoint(a, b);
      if (error(middle, diamond(middle).apexes[0] == apex ? 0 : 1) <= tolerance_) continue;
      quadtree_.vertices.insert(middle);
      found = true;
    }
    if (found) close_bottom_up(quadtree_.vertices, kTile);
    return found;
  }

  /// Of the rounded triangle over the samples, worked out once.
  double error(GridPoint vertex, int side) {
    float& kept = errors_[side][index(vertex)];
    if (kept >= 0) return kept;
    const HalfDiamond t = half_diamond(vertex, side);
    const Plane<double> plane = plane_of(t, [&](GridPoint p) { return rounded_[index(p)]; });
    double worst = 0;
    for (std::int32_t row = t.top(); row <= t.bottom(); ++row) {
      const double base = plane.on_row(row);
      const auto [lo, hi] = t.columns(row);
      for (std::int32_t col = lo; col <= hi; ++col)
        worst = std::max(worst, std::abs(samples_[index({col, row})] - (base + plane.right * (col - plane.col))));
    }
    return kept = static_cast<float>(worst);
  }

  double tolerance_;
  std::vector<double> samples_, rounded_;
  std::vector<float> errors_[2];  ///< of halves of diamonds, -1: not looked at
  RestrictedQuadtree quadtree_;
};

struct Sum {
  std::size_t tiles = 0, triangles = 0;
  double by_layout = 0, as_written = 0, jumps = 0;
};

void print(const std::string& what, double tolerance, const Sum& s) {
  const auto triangles = static_cast<double>(s.triangles);
  fmt::print("{:<8} {:>9.2f} {:>6} {:>11} {:>12.0f} {:>12.0f} {:>7.2f} {:>7.2f} {:>7.0f}\n", what, tolerance, s.tiles,
             s.triangles, s.by_layout, s.as_written, 8 * s.by_layout / triangles, 8 * s.as_written / triangles,
             s.jumps);
}

Sum meshed(const Level& level, double tolerance) {
  Sum sum;
  for (std::int32_t row = 0; row < level.side; row += kTile) {
    for (std::int32_t col = 0; col < level.side; col += kTile) {
      const Tile tile(level, col, row, tolerance);
      const TriangleStrip strip = strip_of(tile.quadtree());
      ++sum.tiles;
      sum.triangles += strip.triangles();
      sum.jumps += static_cast<double>(strip.jumps());
      sum.by_layout +=
          static_cast<double>(((strip.triangles() + 2) * static_cast<std::size_t>(tile.height_bits() + 2) + 7) / 8 +
                              (strip.triangles() + 15) / 16 * 4);
      sum.as_written += static_cast<double>(encode_strip(strip, {2 * kRounding * tolerance}).size());
    }
  }
  return sum;
}

/// A void has the height of the sample before it, as martini's peers.cpp has it.
Level window_of(const std::filesystem::path& model, GridRect window) {
  const SampleWindow samples = Raster(model).read(window);
  Level level{static_cast<std::int32_t>(window.cols()) - 1, {}};
  double last = 0;
  for (std::size_t i = 0; i < samples.values.size(); ++i) {
    if (samples.valid[i] != 0) last = samples.values[i];
    level.heights.push_back(last);
  }
  return level;
}

void compare(const std::filesystem::path& model, GridPoint first, std::int32_t side, double tolerance) {
  const GridRect window{first, {first.col + side, first.row + side}};
  fmt::print("{} {} + {}/{}, metres\n{:<8} {:>9} {:>6} {:>11} {:>12} {:>12} {:>7} {:>7} {:>7}\n", model.stem().string(),
             side + 1, first.col, first.row, "level", "tolerance", "tiles", "triangles", "layout B", "written B",
             "bits", "bits", "jumps");
  Level level = window_of(model, window);
  Sum total;
  double e = tolerance;
  for (int number = 0;; ++number) {
    const Sum sum = meshed(level, e);
    print(fmt::format("{}", number), e, sum);
    total.tiles += sum.tiles;
    total.triangles += sum.triangles;
    total.by_layout += sum.by_layout;
    total.as_written += sum.as_written;
    total.jumps += sum.jumps;
    if (level.side == kTile) break;
    level = coarser(level);
    e *= 2;
  }
  print("all", tolerance, total);

  const auto file = kept_database(model.stem().string(), [&] { return model; });
  const Snapshot now = Database::open(file, {.threads = 1}).snapshot();
  const TriangleStrip strip =
      strip_of(now.ask({.region = window, .tolerance = Metres{(1 - kRounding) * tolerance}}).quadtree);
  const auto written = static_cast<double>(encode_strip(strip, {2 * kRounding * tolerance}).size());
  print("talus", tolerance, {1, strip.triangles(), written, written, static_cast<double>(strip.jumps())});
  const Stream stream{
      now.description(),
      now.ask({.region = window, .tolerance = Metres{tolerance}, .heights = {.kind = HeightKind::bounded}}).quadtree};
  const auto streamed = static_cast<double>(encode(stream).size());
  print("stream", tolerance,
        {1, triangulate(std::get<RestrictedQuadtree>(stream.content), 1).triangles.size(), streamed, streamed, 0});
  fmt::print("database {} bytes, every sample exact, the model's whole extent ({} samples; the window has {})\n",
             std::filesystem::file_size(file), now.description().extent.samples(), window.samples());
}

}  // namespace
}  // namespace talus::bench

int main(int count, char** words) try {
  if (count != 6) {
    std::fputs("pyramid MODEL COL ROW SIDE METRES\n", stderr);
    return 2;
  }
  const int side = std::stoi(words[4]);
  if (side < talus::bench::kTile || (side & (side - 1)) != 0) {
    std::fputs("pyramid: SIDE is 512, 1024, 2048 and so on\n", stderr);
    return 2;
  }
  GDALAllRegister();
  talus::bench::compare(words[1], {std::stoi(words[2]), std::stoi(words[3])}, side, std::stod(words[5]));
} catch (const std::exception& failure) {
  std::fprintf(stderr, "pyramid: %s\n", failure.what());
  return 1;
}
