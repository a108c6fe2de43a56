// Danger: an answer at tolerance 0 beside one at infinity, and a strip one cell wide between two others. Asked one by
// one they meet at the corners only: every sample on the fine side hangs in an edge of the coarse one.

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr GridRect kWest{{0, 0}, {64, 89}}, kEast{{64, 0}, {139, 89}}, kBoth{{0, 0}, {139, 89}};

HardCase hard_case() { return {.terrain = fit(fractal(140, 90, 19, 900), SampleType::int16)}; }

Question question(GridRect region, double tolerance) {
  Question q;
  q.region = region;
  q.tolerance = Metres{tolerance};
  return q;
}

OracleReport naive_report(const HardDatabase& database) {
  const auto ask = [&](GridRect part, double tolerance) {
    return triangulate(database.now().ask({.region = part, .tolerance = Metres{tolerance}}).quadtree);
  };
  return check_mesh(join(ask(kWest, 0), ask(kEast, kInfinity), kBoth), database.truth(), 1, kInfinity);
}

TEST(NeighboursOfFarTolerances, CrackIfAskedOneByOne) {
  const OracleReport report = naive_report(HardDatabase(hard_case()));
  EXPECT_GT(report.t_junctions, 20u) << report.summary();
}

TEST(NeighboursOfFarTolerances, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const std::vector<std::vector<Question>> patches = {
      {question(kWest, 0), question(kEast, kInfinity)},
      {question(kWest, std::numeric_limits<double>::denorm_min()), question(kEast, 1e300)},
      {question({{0, 0}, {64, 89}}, kInfinity), question({{64, 0}, {65, 89}}, 0), question({{65, 0}, {139, 89}}, 30)}};
  for (const std::vector<Question>& questions : patches) {
    const std::vector<Answer> answers =
        without_float_exceptions([&] { return database.now().ask_together(questions); });
    Mesh all;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const Mesh mesh = triangulate(answers[i].quadtree);
      const OracleReport report = check_mesh(mesh, database.truth(), 1, questions[i].tolerance.value);
      EXPECT_TRUE(report.sound()) << report.summary();
      all = i == 0 ? mesh : join(all, mesh, {all.region.first, mesh.region.last});
    }
    const OracleReport report = check_mesh(all, database.truth(), 1, kInfinity);
    EXPECT_TRUE(report.sound()) << report.summary();
  }
}

}  // namespace
}  // namespace talus::support
