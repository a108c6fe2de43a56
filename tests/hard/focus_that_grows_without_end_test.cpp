// Danger: a tolerance that grows from a focus by 10³⁰⁰ metres a metre, or hardly at all. Compared as squares, which
// saves a root, infinity times a distance of zero is no number, and the one sample that was to be exact is left out.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"
#include "tests/support/local_tolerance.hpp"

namespace talus::support {
namespace {

constexpr GridPoint kFocus{65, 64};
constexpr double kHeight = 50;

bool naive_selects(double error, double growth, double squared_distance) {
  return error * error > growth * growth * squared_distance;
}

TEST(FocusThatGrowsWithoutEnd, IsNoNumberAsASquare) {
  EXPECT_TRUE(naive_selects(kHeight, 1, 0));
  EXPECT_FALSE(naive_selects(kHeight, 1e300, 0));
}

TEST(FocusThatGrowsWithoutEnd, KeepsThePromise) {
  HardCase hard{.terrain = fit(fractal(200, 140, 77, 700), SampleType::int16)};
  hard.terrain.at(kFocus.col, kFocus.row) += kHeight;
  const HardDatabase database(hard);
  database.hold_to_the_promise();
  const Description& d = database.now().description();
  for (const double growth : {0.0, std::numeric_limits<double>::denorm_min(), 1e-300, 0.01, 1e8, 1e300}) {
    for (const double at_focus : {0.0, 5.0, std::numeric_limits<double>::infinity()}) {
      SCOPED_TRACE(::testing::Message() << at_focus << " m, growing by " << growth);
      Question question;
      question.region = database.extent();
      question.field = focus_tolerance(d, d.mapping.x(kFocus.col), d.mapping.y(kFocus.row), growth, Metres{at_focus});
      const Answer answer = without_float_exceptions([&] { return database.now().ask(question); });
      EXPECT_FALSE(std::isnan(answer.quadtree.bound.value));
      const Mesh mesh = triangulate(answer.quadtree);
      EXPECT_TRUE(at_focus > 0 || has_point(mesh, kFocus));
      const OracleReport report = check_mesh(mesh, database.truth(), 1, std::numeric_limits<double>::infinity());
      EXPECT_TRUE(report.sound()) << report.summary();
      expect_local_tolerance(mesh, database.truth(), 1, *question.field, "focus");
    }
  }
}

}  // namespace
}  // namespace talus::support
