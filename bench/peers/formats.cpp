// Three ways to close a set of vertices into a mesh and to hand it on, over the same window of a model, in the form of
// the tables of Abásolo et al.; prints Markdown. docs/formats-compared.md says what is learnt.
//
//   formats MODEL COL ROW SIDE METRES...     a window of SIDE + 1 samples each way, without voids
//
// Selected is every vertex with a sample farther from one of its two triangles than the tolerance, and what the
// window's sides need. BT is the bitree: as published (its true error is printed), and verified, which is what all
// other columns are of. QT is the least restricted quadtree that holds the same selection. [A Table 1, Table 2]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gdal_priv.h>

#include "engine/quadtree/border.hpp"
#include "engine/quadtree/construction.hpp"
#include "engine/quadtree/half_diamond.hpp"
#include "engine/stream/stream_codec.hpp"
#include "query/accuracy/true_error.hpp"
#include "talus/bitree.hpp"
#include "talus/ingest.hpp"
#include "talus/strip.hpp"
#include "talus/talus.hpp"

namespace talus::bench {
namespace {

/// What the best code by symbols of each level apart takes at least: their empirical entropy, tables not counted. The
/// same yardstick for both hierarchies, for only one of them has a stream.
class Entropy {
 public:
  void take(int level, int kind, std::int64_t symbol) { ++counts_[{level, kind}][symbol]; }
  [[nodiscard]] double bytes() const {
    double bits = 0;
    for (const auto& [where, symbols] : counts_) {
      double all = 0;
      for (const auto& [symbol, count] : symbols) all += static_cast<double>(count);
      for (const auto& [symbol, count] : symbols) {
        const auto n = static_cast<double>(count);
        bits += n * std::log2(all / n);
      }
    }
    return bits / 8;
  }

 private:
  std::map<std::pair<int, int>, std::map<std::int64_t, std::uint64_t>> counts_;
};

enum { kSplit, kChosen, kHeight };

struct Window {
  Description description;
  SampleWindow samples;

  [[nodiscard]] TrueError judge(const Mesh& mesh) const {
    return true_error(mesh, description, [&](GridRect part) {
      SampleWindow out{part, {}, {}};
      for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
        for (std::int32_t col = part.first.col; col <= part.last.col; ++col) {
          const std::size_t i = samples.index({col, row});
          out.values.push_back(samples.values[i]);
          out.valid.push_back(samples.valid[i]);
        }
      }
      return out;
    });
  }
};

/// What lies between the two ends of a vertex's diamond, as far as they are there.
template <class Height>
double predicted(GridPoint p, const GridRect& region, Height&& height_of) {
  const Diamond d = diamond(p);
  double sum = 0;
  int ends = 0;
  for (const GridPoint end : d.ends) {
    if (!region.contains(end)) continue;
    sum += height_of(end);
    ++ends;
  }
  return ends == 0 ? 0 : sum / ends;
}

/// One bit a diamond whose triangles are there, unless the window's sides say it; each height against the middle.
double quadtree_bytes(const RestrictedQuadtree& q, const VertexMask& given, std::int32_t root) {
  Entropy entropy;
  const auto height = [&](GridPoint p) { return q.vertices.contains(p) ? q.heights[q.vertices.rank(p)] : 0; };
  for (std::int32_t row = q.region.first.row; row <= q.region.last.row; ++row) {
    for (std::int32_t col = q.region.first.col; col <= q.region.last.col; ++col) {
      const GridPoint p{col, row};
      if (spacing(p) >= root) continue;
      const int level = 2 * height_in_tree(p) + (is_centre(p) ? 1 : 0);
      const Diamond d = diamond(p);
      const bool is_candidate = std::all_of(d.apexes.begin(), d.apexes.end(), [&](GridPoint apex) {
        return !q.region.contains(apex) || q.vertices.contains(apex);
      });
      if (is_candidate && !given.contains(p)) entropy.take(level, kSplit, q.vertices.contains(p));
      if (q.vertices.contains(p))
        entropy.take(level, kHeight, std::llround(2 * (height(p) - predicted(p, q.region, height))));
    }
  }
  return entropy.bytes();
}

/// One bit a triangle that is there; where both of a diamond are split one more, whether the vertex was chosen; heights
/// of those that were.
double bitree_bytes(const Bitree& b, const VertexMask& given, std::int32_t root) {
  Entropy entropy;
  const auto kind = [&](GridPoint p) { return b.vertices.contains(p) ? b.kinds[b.vertices.rank(p)] : std::uint8_t{0}; };
  const auto height = [&](GridPoint p) { return b.vertices.contains(p) ? b.heights[b.vertices.rank(p)] : 0; };
  constexpr std::uint8_t kBoth = Bitree::kSplitsFirst | Bitree::kSplitsSecond;
  for (std::int32_t row = b.region.first.row; row <= b.region.last.row; ++row) {
    for (std::int32_t col = b.region.first.col; col <= b.region.last.col; ++col) {
      const GridPoint p{col, row};
      if (spacing(p) >= root) continue;
      const int level = 2 * height_in_tree(p) + (is_centre(p) ? 1 : 0);
      if (!given.contains(p)) {
        for (const int side : {0, 1}) {
          const HalfDiamond t = half_diamond(p, side);
          if (!inside(t, b.region)) continue;
          const GridPoint above = diamond(t.apex).apexes[0];
          const std::uint8_t in = above == t.a || above == t.b ? Bitree::kSplitsFirst : Bitree::kSplitsSecond;
          if (spacing(t.apex) < root && (kind(t.apex) & in) == 0) continue;
          const std::uint8_t bit = side == 0 ? Bitree::kSplitsFirst : Bitree::kSplitsSecond;
          entropy.take(level, kSplit, (kind(p) & bit) != 0);
        }
        if ((kind(p) & kBoth) == kBoth) entropy.take(level, kChosen, (kind(p) & Bitree::kSelected) != 0);
      }
      // Fictitious ends lie on halves of halves of cells' heights: nobody sends more than whole numbers need.
      if ((kind(p) & Bitree::kSelected) != 0)
        entropy.take(level, kHeight, std::llround(2 * (height(p) - predicted(p, b.region, height))));
    }
  }
  return entropy.bytes();
}

/// The least one that holds what the bitree selected.
RestrictedQuadtree quadtree_of(const Bitree& bitree, const SampleWindow& samples, std::int32_t root) {
  RestrictedQuadtree q;
  q.region = bitree.region;
  q.vertices = VertexMask(bitree.region);
  bitree.vertices.for_each([&](GridPoint p) {
    if ((bitree.kinds[bitree.vertices.rank(p)] & Bitree::kSelected) != 0) q.vertices.insert(p);
  });
  close_bottom_up(q.vertices, root);
  q.vertices.seal();
  q.vertices.for_each([&](GridPoint p) { q.heights.push_back(samples.values[samples.index(p)]); });
  q.tolerance = q.bound = bitree.tolerance;
  return q;
}

/// As in the paper: vertices farther than the tolerance from the middle of their diamond's ends, whatever lies around
/// them.
VertexMask chosen_alone(const SampleWindow& samples, const VertexMask& given, std::int32_t root, double tolerance) {
  VertexMask chosen(samples.region);
  const auto height = [&](GridPoint p) { return samples.values[samples.index(p)]; };
  for (std::int32_t row = samples.region.first.row; row <= samples.region.last.row; ++row) {
    for (std::int32_t col = samples.region.first.col; col <= samples.region.last.col; ++col) {
      const GridPoint p{col, row};
      const bool is_far = spacing(p) < root && std::abs(height(p) - predicted(p, samples.region, height)) > tolerance;
      if (is_far || given.contains(p)) chosen.insert(p);
    }
  }
  chosen.seal();
  return chosen;
}

std::string saved(double bitree, double quadtree) {
  return quadtree == 0 ? "–" : fmt::format("{:.0f} %", 100 * (1 - bitree / quadtree));
}

/// A row of the paper's first table, by its own choice of vertices.
std::string alone(const Window& window, const VertexMask& given, std::int32_t root, double tolerance) {
  const VertexMask chosen = chosen_alone(window.samples, given, root, tolerance);
  std::vector<double> heights;
  chosen.for_each([&](GridPoint p) { heights.push_back(window.samples.values[window.samples.index(p)]); });
  Bitree bitree = complete_bitree(chosen, heights);
  bitree.tolerance = Metres{tolerance};
  const RestrictedQuadtree quadtree = quadtree_of(bitree, window.samples, root);
  const Mesh cut = mesh_of(bitree), mesh = triangulate(quadtree, 1);
  const auto sent = static_cast<double>(chosen.size()), other_sent = static_cast<double>(quadtree.vertices.size());
  const auto triangles = static_cast<double>(leaf_triangles(bitree)),
             other = static_cast<double>(mesh.triangles.size());
  const auto references = static_cast<double>(alternating_indices(cut).size());
  const auto other_references = static_cast<double>(alternating_indices(strip_of(quadtree)).size());
  return fmt::format(
      "| {:g} | {} | {} | {} | {} | {:.0f} | {:.0f} | {} | {:.0f} | {:.0f} | {} | {:.0f} | {:.0f} | {} | {:.2f} | "
      "{:.2f} |\n",
      tolerance, chosen.size(), bitree.fictitious(), quadtree.vertices.size() - chosen.size(),
      saved(static_cast<double>(bitree.fictitious()), other_sent - sent), sent, other_sent, saved(sent, other_sent),
      triangles, other, saved(triangles, other), references, other_references, saved(references, other_references),
      window.judge(cut).largest_m, window.judge(mesh).largest_m);
}

void compare(const std::string& model, GridPoint first, std::int32_t side, const std::vector<double>& tolerances) {
  const GridRect region{first, {first.col + side, first.row + side}};
  const Raster raster(model);
  const Window window{raster.description(), raster.read(region)};
  if (std::find(window.samples.valid.begin(), window.samples.valid.end(), 0) != window.samples.valid.end())
    throw Failure(Cause::invalid_argument, "the window has voids: choose another");
  const std::int32_t root = root_side(region);
  VertexMask given(region);
  for (const GridPoint p : border_vertices(region, root)) given.insert(p);

  std::string chosen =
      "| ε m | chosen | added BT | QT | saved | to send BT | QT | saved | triangles BT | QT | saved | references BT | "
      "QT | "
      "saved | true error BT m | QT m |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::string counted =
      "| ε m | selected | added BT | QT | to send BT | QT | saved | triangles BT | cut | QT | references BT | QT |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::string measured =
      "| ε m | bytes BT | QT | saved | QT as .rqt | QT as strip | true error BT as published m | BT m | QT m |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  std::string stripped =
      "| ε m | triangles BT | separate | lines | strip | saved | triangles QT | separate | lines | strip | saved |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const double tolerance : tolerances) {
    chosen += alone(window, given, root, tolerance);
    const Bitree published = bitree_of(window.samples, Metres{tolerance}, {.verified = false});
    const Bitree bitree = bitree_of(window.samples, Metres{tolerance});
    const RestrictedQuadtree quadtree = quadtree_of(published, window.samples, root);
    const Mesh cut = mesh_of(bitree), mesh = triangulate(quadtree, 1);
    const TriangleStrip strip = strip_of(quadtree);
    const auto references = static_cast<double>(alternating_indices(cut).size());
    const auto other_references = static_cast<double>(alternating_indices(strip).size());
    const double bytes = bitree_bytes(bitree, given, root), other = quadtree_bytes(quadtree, given, root);
    const auto sent = static_cast<double>(bitree.selected), other_sent = static_cast<double>(quadtree.vertices.size());
    counted +=
        fmt::format("| {:g} | {} | {} + {} | {} | {:.0f} | {:.0f} | {} | {} | {} | {} | {:.0f} | {:.0f} |\n", tolerance,
                    published.selected, bitree.fictitious(), bitree.corrected,
                    quadtree.vertices.size() - published.selected, sent, other_sent, saved(sent, other_sent),
                    leaf_triangles(bitree), cut.triangles.size(), mesh.triangles.size(), references, other_references);
    const TrueError errors[] = {window.judge(mesh_of(published)), window.judge(cut), window.judge(mesh)};
    for (const TrueError& e : errors) {
      if (e.uncovered + e.stray > 0) throw Failure(Cause::corrupt, "samples that no triangle touches");
    }
    measured += fmt::format("| {:g} | {:.0f} | {:.0f} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", tolerance, bytes,
                            other, saved(bytes, other), encode(Stream{window.description, quadtree}).size(),
                            encode_strip(strip).size(), errors[0].largest_m, errors[1].largest_m, errors[2].largest_m);
    const auto row = [](std::size_t triangles, double indices) {
      const double separate = 3 * static_cast<double>(triangles);
      return fmt::format("{} | {:.0f} | {:.0f} | {:.0f} | {}", triangles, separate,
                         indices - 2 - static_cast<double>(triangles), indices, saved(indices, separate));
    };
    stripped += fmt::format("| {:g} | {} | {} |\n", tolerance, row(cut.triangles.size(), references),
                            row(mesh.triangles.size(), other_references));
  }
  fmt::print("{} samples at column {}, row {}\n\nChosen alone:\n\n{}\nSelected by exact errors:\n\n{}\n{}\n{}\n",
             region.samples(), first.col, first.row, chosen, counted, measured, stripped);
}

}  // namespace
}  // namespace talus::bench

int main(int count, char** words) try {
  if (count < 6) {
    std::fputs("formats MODEL COL ROW SIDE METRES...\n", stderr);
    return 2;
  }
  std::vector<double> tolerances;
  for (int i = 5; i < count; ++i) tolerances.push_back(std::stod(words[i]));
  GDALAllRegister();
  talus::bench::compare(words[1], {std::stoi(words[2]), std::stoi(words[3])}, std::stoi(words[4]), tolerances);
} catch (const std::exception& failure) {
  std::fprintf(stderr, "formats: %s\n", failure.what());
  return 1;
}
