// Perpendicular errors: held to their definition, by plain recursion over triangles.

#include "engine/error/error_rule.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "engine/error/saturation.hpp"
#include "engine/tile/coarse_levels.hpp"
#include "tests/engine/fields.hpp"
#include "tests/engine/terrains.hpp"

namespace talus::support {
namespace {

constexpr CodeDistance kMetres;

const ErrorRule kPerpendicular{ErrorMetric::perpendicular, [](std::int32_t) { return CellSize{3, 5}; }};

TEST(ErrorRule, SharesAreCosines) {
  const HalfDiamond half = half_diamond({1, 0}, 0);
  const auto share = [&](double right, double down) {
    return kPerpendicular.share(half, {0, 0, 0, right, down}, kMetres);
  };
  EXPECT_EQ(share(0, 0), 1);
  EXPECT_NEAR(share(3, 0), std::sqrt(0.5), 3e-15);   // 3 m up over 3 m
  EXPECT_NEAR(share(0, -5), std::sqrt(0.5), 3e-15);  // 5 m down over 5 m
  EXPECT_NEAR(share(3, 5), std::sqrt(1.0 / 3), 3e-15);
  EXPECT_GE(share(3, 5), std::sqrt(1.0 / 3));
  EXPECT_EQ(ErrorRule{}.share(half, {0, 0, 0, 3, 5}, kMetres), 1);
  const ErrorRule at_a_pole{ErrorMetric::perpendicular, [](std::int32_t) { return CellSize{0, 5}; }};
  EXPECT_EQ(at_a_pole.share(half, {0, 0, 0, 1, 0}, kMetres), 0);
  EXPECT_EQ(at_a_pole.share(half, {0, 0, 0, 0, 0}, kMetres), 1);
}

/// By the definition, one vertex after another.
class Plain {
 public:
  explicit Plain(const Field& field) : field_(field) {}

  [[nodiscard]] ErrorCode of(GridPoint p) const {
    ErrorCode below = 0;
    const Children all = children(p);
    for (int i = 0; i < all.count; ++i) below = std::max(below, of(all.at[static_cast<std::size_t>(i)]));
    return std::max(own(p), below);
  }

 private:
  [[nodiscard]] ErrorCode own(GridPoint p) const {
    const HeightField& f = field_.input.field;
    ErrorCode largest = 0;
    for (const int side : {0, 1}) {
      const HalfDiamond t = half_diamond(p, side);
      if (!inside(t, f.extent)) continue;
      const Holds holds = field_.voids ? field_.voids->half(p, side) : kData;
      if ((holds & kData) == 0) continue;
      const Plane<double> plane = plane_of(t, [&](GridPoint q) { return f[q]; });
      double metres = largest_distance(f, t, plane) * kPerpendicular.share(t, plane, f.distance);
      if (holds == kMixed) metres = std::max(metres, field_.input.ground_side(t));
      largest = std::max(largest, error_code(metres));
    }
    return largest;
  }
  const Field& field_;
};

void expect_plain(Field& field) {
  field.input.rule = kPerpendicular;
  LevelGrid<ErrorCode> errors = reference_errors(field.input, kTileLevels);
  saturate(field.input, errors);
  const Plain plain(field);
  std::size_t different = 0;
  for_each_vertex(errors, [&](GridPoint p) {
    if (!field.extent.contains(p)) return;
    const ErrorCode expected = plain.of(p);
    if (errors[p] == expected || ++different > 3) return;
    ADD_FAILURE() << "error of " << name_of(p) << ": " << error_of(errors[p]) << " m, plain " << error_of(expected)
                  << " m";
  });
  EXPECT_EQ(different, 0u);
}

TEST(PerpendicularErrors, AreThoseOfTheDefinition) {
  Random random(5);
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    const int cols = random.between(1, 70), rows = random.between(1, 70);
    Terrain terrain = surface(cols, rows, [&](int, int) { return random.between(-300, 300); });
    if (i % 3 == 1) {
      for (auto& v : terrain.values) v += 0.25;  // floats, whose interpolation is exact
    }
    if (i % 4 == 3) {
      for (auto& valid : terrain.valid) valid = random.between(0, 9) > 0 ? 1 : 0;
      terrain.valid[0] = 1;
    }
    const GridPoint first{random.between(-200, 200), random.between(-200, 200)};
    Field field(terrain, first);
    expect_plain(field);
  }
}

}  // namespace
}  // namespace talus::support
