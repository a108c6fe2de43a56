// Random questions to real terrain, voids included, in every border mode; each answer laid over every sample. Two
// thousand a mode: ./dev soak query.

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/random.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/real_models.hpp"

namespace talus::support {
namespace {

/// Which part of the plane an answer must fill.
struct Window {
  double west, north, east, south;
  [[nodiscard]] bool contains(int col, int row) const {
    return col >= west && col <= east && row >= north && row <= south;
  }
};

class RealQuestions : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const RealModel model = real_model(GetParam(), folder_);
    if (!model.file) GTEST_SKIP() << model.why_not;
    raster_ = read_raster(*model.file);
    ingest(*model.file, folder_ / "model.talus");
    now_.emplace(Database::open(folder_ / "model.talus").snapshot());
    metres_per_unit_ = now_->description().metres_per_unit;
  }
  [[nodiscard]] static int cases() { return property_cases(10); }

  [[nodiscard]] std::size_t at(int col, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(raster_.cols) + static_cast<std::size_t>(col);
  }
  GridRect random_rect(int least) {
    const int cols = std::min(raster_.cols - 1, random_.between(least, 160)),
              rows = std::min(raster_.rows - 1, random_.between(least, 160));
    const int col = random_.between(0, raster_.cols - 1 - cols), row = random_.between(0, raster_.rows - 1 - rows);
    return {{col, row}, {col + cols, row + rows}};
  }
  double random_metres() { return random_.chance(0.1) ? 0 : random_.log_between(0.05, 200); }

  /// Lays each triangle over the samples in it: none may be farther than the tolerance there, and each sample of the
  /// window that data covers must lie in one.
  template <class ToleranceAt>
  void expect_filled(const Mesh& mesh, const Window& window, GridRect samples, ToleranceAt&& tolerance_at,
                     const std::string& name) {
    std::set<std::pair<int, int>> under;
    double worst = 0;
    for (const auto& t : mesh.triangles) {
      const Place a = mesh.place(t[0]), b = mesh.place(t[1]), c = mesh.place(t[2]);
      const double area = (b.col - a.col) * (c.row - a.row) - (b.row - a.row) * (c.col - a.col);
      if (area == 0) continue;  // a sliver of a cut
      for (int row = int(std::ceil(std::min({a.row, b.row, c.row})));
           row <= std::floor(std::max({a.row, b.row, c.row})); ++row) {
        for (int col = int(std::ceil(std::min({a.col, b.col, c.col})));
             col <= std::floor(std::max({a.col, b.col, c.col})); ++col) {
          const double u = ((b.col - col) * (c.row - row) - (b.row - row) * (c.col - col)) / area;
          const double v = ((c.col - col) * (a.row - row) - (c.row - row) * (a.col - col)) / area;
          if (u < -1e-9 || v < -1e-9 || u + v > 1 + 1e-9) continue;
          if (window.contains(col, row)) under.insert({col, row});
          if (raster_.valid[at(col, row)] == 0) continue;
          const double surface = u * mesh.heights[t[0]] + v * mesh.heights[t[1]] + (1 - u - v) * mesh.heights[t[2]];
          const double over =
              std::abs(raster_.values[at(col, row)] - surface) * metres_per_unit_ - tolerance_at(GridPoint{col, row});
          worst = std::max(worst, over);
        }
      }
    }
    EXPECT_LE(worst, 1e-6) << name;
    std::size_t bare = 0;
    for (int row = samples.first.row; row <= samples.last.row; ++row) {
      for (int col = samples.first.col; col <= samples.last.col; ++col) {
        if (window.contains(col, row) && is_covered(raster_, samples, {col, row}) && !under.contains({col, row}))
          ++bare;
      }
    }
    EXPECT_EQ(bare, 0u) << name;
  }
  static Window window_of(GridRect r) {
    return {double(r.first.col), double(r.first.row), double(r.last.col), double(r.last.row)};
  }
  [[nodiscard]] std::string name(GridRect r, double tolerance) const {
    return std::string(GetParam()) + ", columns " + std::to_string(r.first.col) + " to " + std::to_string(r.last.col) +
           ", rows " + std::to_string(r.first.row) + " to " + std::to_string(r.last.row) + " at " +
           std::to_string(tolerance);
  }

  TempFolder folder_;
  Terrain raster_;
  std::optional<Snapshot> now_;
  double metres_per_unit_ = 1;
  Random random_{11};
};

TEST_P(RealQuestions, Constrained) {
  for (int i = 0; i < cases() && !HasFailure(); ++i) {
    const GridRect region = random_rect(1);
    const double tolerance = random_metres();
    const Mesh mesh = triangulate(now_->ask({.region = region, .tolerance = Metres{tolerance}}).quadtree);
    const OracleReport report = check_mesh(mesh, raster_, metres_per_unit_, tolerance);
    EXPECT_TRUE(report.sound()) << name(region, tolerance) << ": " << report.summary();
    expect_filled(
        mesh, window_of(region), region, [&](GridPoint) { return tolerance; }, name(region, tolerance));
  }
}

TEST_P(RealQuestions, Covered) {
  for (int i = 0; i < cases() && !HasFailure(); ++i) {
    Question q;
    q.region = random_rect(1);
    q.tolerance = Metres{random_metres()};
    q.border = Border::cover;
    const Answer answer = now_->ask(q);
    EXPECT_LE(answer.quadtree.bound.value, q.tolerance.value);
    const Mesh mesh = triangulate(answer.quadtree);
    expect_filled(
        mesh, window_of(q.region), q.region, [&](GridPoint) { return answer.quadtree.bound.value; },
        name(q.region, q.tolerance.value));
  }
}

/// Edges of one triangle only that lie on a column, from north to south, by the places and heights of their ends.
std::set<std::array<double, 4>> open_edges_along(const Mesh& mesh, double column) {
  std::set<std::array<double, 4>> open;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t from = t[k], to = t[(k + 1) % 3];
      if (mesh.place(from).col != column || mesh.place(to).col != column) continue;
      if (mesh.place(from).row > mesh.place(to).row) std::swap(from, to);
      open.insert({mesh.place(from).row, mesh.heights[from], mesh.place(to).row, mesh.heights[to]});
    }
  }
  return open;
}

TEST_P(RealQuestions, ClippedAndItsNeighbour) {
  for (int i = 0; i < cases() && !HasFailure(); ++i) {
    const GridRect around = random_rect(4);
    const double tolerance = random_metres(), width = double(around.cols() - 1), height = double(around.rows() - 1);
    const auto between = [&](double low, double high) { return low + random_.unit() * (high - low); };
    const Frame whole{around.first.col + between(0, width / 4), around.first.row + between(0, height / 4),
                      around.last.col - between(0, width / 4), around.last.row - between(0, height / 4)};
    const double middle = between(whole.west + 0.1, whole.east - 0.1);
    std::array<Mesh, 2> meshes;
    const std::array<Frame, 2> frames{Frame{whole.west, whole.north, middle, whole.south},
                                      Frame{middle, whole.north, whole.east, whole.south}};
    for (std::size_t k = 0; k < 2; ++k) {
      const Frame& f = frames[k];
      Question q;
      q.region = {{int(std::floor(f.west)), int(std::floor(f.north))},
                  {int(std::ceil(f.east)), int(std::ceil(f.south))}};
      q.tolerance = Metres{tolerance};
      q.border = Border::clip;
      const Answer answer = now_->ask(q);
      EXPECT_LE(answer.quadtree.bound.value, tolerance);
      meshes[k] = clip_mesh(triangulate(answer.quadtree), f);
      expect_filled(
          meshes[k], {f.west, f.north, f.east, f.south}, q.region,
          [&](GridPoint) { return answer.quadtree.bound.value; }, name(q.region, tolerance));
    }
    EXPECT_EQ(open_edges_along(meshes[0], middle), open_edges_along(meshes[1], middle))
        << name(around, tolerance) << " column " << middle;
  }
}

TEST_P(RealQuestions, NeighboursMeetAtOneToleranceAndAtTwo) {
  for (int i = 0; i < cases() && !HasFailure(); ++i) {
    const GridRect both = random_rect(33);
    GridRect one = both, other = both;
    one.last.col = other.first.col = random_.between(both.first.col + 16, both.last.col - 16);
    const auto expect_joined = [&](const RestrictedQuadtree& a, const RestrictedQuadtree& b, double tolerance) {
      const OracleReport report =
          check_mesh(join(triangulate(a), triangulate(b), both), raster_, metres_per_unit_, tolerance);
      EXPECT_TRUE(report.sound()) << name(both, tolerance) << " column " << one.last.col << ": " << report.summary();
    };
    const double tolerance = random_metres(), coarser = tolerance + random_metres();
    expect_joined(now_->ask({.region = one, .tolerance = Metres{tolerance}}).quadtree,
                  now_->ask({.region = other, .tolerance = Metres{tolerance}}).quadtree, tolerance);

    std::vector<Question> patches(2);
    patches[0].region = one;
    patches[0].tolerance = Metres{tolerance};
    patches[1].region = other;
    patches[1].tolerance = Metres{coarser};
    const std::vector<Answer> answers = now_->ask_together(patches);
    for (std::size_t k = 0; k < 2; ++k) {
      expect_filled(
          triangulate(answers[k].quadtree), window_of(patches[k].region), patches[k].region,
          [&](GridPoint) { return patches[k].tolerance.value; }, name(patches[k].region, patches[k].tolerance.value));
    }
    // Where triangles mix data and void their own tolerance ends them: only without voids there is one piece.
    if (!raster_.has_voids()) expect_joined(answers[0].quadtree, answers[1].quadtree, coarser);
    for (int row = both.first.row; row <= both.last.row; ++row) {
      const GridPoint p{one.last.col, row};
      EXPECT_EQ(answers[0].quadtree.vertices.contains(p), answers[1].quadtree.vertices.contains(p))
          << name(both, coarser);
    }
  }
}

TEST_P(RealQuestions, AFocusHoldsEverySampleWithinItsOwnTolerance) {
  const Description& d = now_->description();
  for (int i = 0; i < cases() && !HasFailure(); ++i) {
    Question q;
    q.region = random_rect(8);
    const double col = random_.between(q.region.first.col, q.region.last.col),
                 row = random_.between(q.region.first.row, q.region.last.row);
    q.field =
        focus_tolerance(d, d.mapping.x(col), d.mapping.y(row), random_.log_between(1e-4, 0.1), Metres{random_metres()});
    const Mesh mesh = triangulate(now_->ask(q).quadtree);
    expect_filled(
        mesh, window_of(q.region), q.region, [&](GridPoint p) { return q.field->at(p).value; }, name(q.region, -1));
  }
}

INSTANTIATE_TEST_SUITE_P(Of, RealQuestions,
                         ::testing::Values("srtm3_S36E149.tif", "bigtujunga_30m_utm11.tif", "tirol5m_avaPfa.tif",
                                           "srtm3_N46E008.tif", "jacksboro"),
                         [](const auto& about) {
                           std::string name = about.param;
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

}  // namespace
}  // namespace talus::support
