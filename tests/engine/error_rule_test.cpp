// Errors of other kinds: held to their definitions, by plain recursion over triangles.

#include "engine/error/error_rule.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "engine/error/other_errors.hpp"
#include "engine/error/saturation.hpp"
#include "engine/tile/coarse_levels.hpp"
#include "tests/engine/fields.hpp"
#include "tests/engine/terrains.hpp"

namespace talus::support {
namespace {

constexpr CodeDistance kMetres;

ErrorRule rule(ErrorKind kind, ErrorMetric metric = ErrorMetric::vertical) {
  return {kind, metric, [](std::int32_t) { return CellSize{3, 5}; }};
}

TEST(ErrorRule, SharesAreCosines) {
  const HalfDiamond half = half_diamond({1, 0}, 0);
  const auto share = [&](double right, double down) {
    return rule(ErrorKind::exact, ErrorMetric::perpendicular).share(half, {0, 0, 0, right, down}, kMetres);
  };
  EXPECT_EQ(share(0, 0), 1);
  EXPECT_NEAR(share(3, 0), std::sqrt(0.5), 3e-15);   // 3 m up over 3 m
  EXPECT_NEAR(share(0, -5), std::sqrt(0.5), 3e-15);  // 5 m down over 5 m
  EXPECT_NEAR(share(3, 5), std::sqrt(1.0 / 3), 3e-15);
  EXPECT_GE(share(3, 5), std::sqrt(1.0 / 3));
  EXPECT_EQ(rule(ErrorKind::exact).share(half, {0, 0, 0, 3, 5}, kMetres), 1);
  const ErrorRule at_a_pole{ErrorKind::exact, ErrorMetric::perpendicular, [](std::int32_t) { return CellSize{0, 5}; }};
  EXPECT_EQ(at_a_pole.share(half, {0, 0, 0, 1, 0}, kMetres), 0);
  EXPECT_EQ(at_a_pole.share(half, {0, 0, 0, 0, 0}, kMetres), 1);
}

TEST(ErrorRule, OnlyNestedErrorsAddUp) {
  const ErrorCode one = error_code(1), two = error_code(2);
  EXPECT_EQ(rule(ErrorKind::exact).over(one, two), two);
  EXPECT_EQ(rule(ErrorKind::midpoint).over(two, one), two);
  EXPECT_EQ(rule(ErrorKind::nested).over(one, two), error_code(3));
  EXPECT_EQ(rule(ErrorKind::nested).over(0, two), two);
  EXPECT_EQ(rule(ErrorKind::nested).over(two, 0), two);
  EXPECT_GE(rule(ErrorKind::nested).over(kLastFiniteError, kLastFiniteError), kLastFiniteError);
  for (ErrorCode a = 1; a < kLastFiniteError; a = static_cast<ErrorCode>(a + 173)) {
    for (ErrorCode b = 1; b < kLastFiniteError; b = static_cast<ErrorCode>(b + 211)) {
      const long double sum = static_cast<long double>(error_of(a)) + error_of(b);
      EXPECT_GE(static_cast<long double>(error_of(rule(ErrorKind::nested).over(a, b))), sum);
    }
  }
}

/// By the definition, one vertex after another.
class Plain {
 public:
  Plain(const Field& field, const ErrorRule& rule) : field_(field), rule_(rule) {}

  [[nodiscard]] ErrorCode of(GridPoint p) const {
    ErrorCode below = 0;
    const Children all = children(p);
    for (int i = 0; i < all.count; ++i) below = std::max(below, of(all.at[static_cast<std::size_t>(i)]));
    return rule_.over(own(p), below);
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
      double metres = 0;
      const Plane<double> plane = plane_of(t, [&](GridPoint q) { return f[q]; });
      if (rule_.kind == ErrorKind::exact) {
        metres = largest_distance(f, t, plane);
      } else {
        metres = std::abs(f[p] - (f[t.a] + f[t.b]) / 2);
      }
      metres *= rule_.share(t, plane, f.distance);
      if (holds == kMixed) metres = std::max(metres, field_.input.ground_side(t));
      largest = std::max(largest, error_code(metres));
    }
    return largest;
  }
  const Field& field_;
  const ErrorRule& rule_;
};

void expect_plain(Field& field, const ErrorRule& rule) {
  field.input.rule = rule;
  LevelGrid<ErrorCode> errors(field.extent, kTileLevels, 0);
  detail::other_errors(field.input, errors);
  const Plain plain(field, rule);
  std::size_t different = 0;
  for_each_vertex(errors, [&](GridPoint p) {
    if (!field.extent.contains(p)) return;
    const ErrorCode expected = plain.of(p);
    if (errors[p] == expected || ++different > 3) return;
    ADD_FAILURE() << name_of(rule.kind) << " " << name_of(rule.metric) << " error of " << name_of(p) << ": "
                  << error_of(errors[p]) << " m, plain " << error_of(expected) << " m";
  });
  EXPECT_EQ(different, 0u);
}

TEST(OtherErrors, AreThoseOfTheDefinition) {
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
    expect_plain(field, rule(ErrorKind::midpoint));
    expect_plain(field, rule(ErrorKind::nested));
    expect_plain(field, rule(ErrorKind::exact, ErrorMetric::perpendicular));
    expect_plain(field, rule(ErrorKind::midpoint, ErrorMetric::perpendicular));
  }
}

TEST(OtherErrors, OfExactKindAreTheUsualOnes) {
  Random random(6);
  const Terrain terrain = surface(150, 90, [&](int col, int row) { return 40 * std::sin(col / 9.0) + row; });
  Field field(terrain, {-30, 17});
  LevelGrid<ErrorCode> errors(field.extent, kTileLevels, 0), usual = reference_errors(field.input, kTileLevels);
  detail::other_errors(field.input, errors);
  saturate(field.input, usual);
  for_each_vertex(errors, [&](GridPoint p) { ASSERT_EQ(errors[p], usual[p]) << name_of(p); });
}

TEST(OtherErrors, NestedAreNeverBelowExactAndMidpointNeverAbove) {
  Random random(7);
  const Terrain terrain = surface(129, 129, [&](int, int) { return random.between(0, 500); });
  Field field(terrain, {0, 0});
  LevelGrid<ErrorCode> exact = reference_errors(field.input, kTileLevels), nested(field.extent, kTileLevels, 0),
                       midpoint = nested;
  saturate(field.input, exact);
  field.input.rule = rule(ErrorKind::nested);
  detail::other_errors(field.input, nested);
  field.input.rule = rule(ErrorKind::midpoint);
  detail::other_errors(field.input, midpoint);
  std::size_t above = 0, below = 0;
  for_each_vertex(exact, [&](GridPoint p) {
    ASSERT_GE(nested[p], exact[p]);
    ASSERT_LE(midpoint[p], exact[p]);
    above += nested[p] > exact[p];
    below += midpoint[p] < exact[p];
  });
  EXPECT_GT(above, 1000u);
  EXPECT_GT(below, 1000u);
}

}  // namespace
}  // namespace talus::support
