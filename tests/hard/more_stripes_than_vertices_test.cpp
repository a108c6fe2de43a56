// Danger: a stream whose levels are cut into more stripes than they have vertices, or none at all. Vertices a stripe,
// rounded down, are none, and nobody can divide by that or skip ahead in steps of it.

#include <vector>

#include <gtest/gtest.h>

#include "engine/stream/stream_codec.hpp"
#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

constexpr int kStripes = 1000;

std::size_t naive_vertices_a_stripe(std::size_t vertices) { return vertices / kStripes; }

void expect_streams(const HardDatabase& database) {
  const Snapshot& now = database.now();
  for (const double tolerance : {0.0, 20.0, 1e9}) {
    const RestrictedQuadtree answer = now.ask({.region = database.extent(), .tolerance = Metres{tolerance}}).quadtree;
    for (const int threads : {0, 1, 3}) {
      const StreamOptions options{.threads = threads, .stripes = kStripes};
      const auto back = without_float_exceptions(
          [&] {
            return decode_stream(encode({now.description(), answer}, options), {}, nullptr, threads).content;
          },
          FE_DIVBYZERO | FE_OVERFLOW);
      EXPECT_EQ(difference(std::get<RestrictedQuadtree>(back), answer), "");
    }
  }
}

TEST(MoreStripesThanVertices, LeaveNoneForAStripe) {
  const HardDatabase database({.terrain = hills(9, 7)});
  const std::size_t all =
      database.now().ask({.region = database.extent(), .tolerance = Metres{0}}).quadtree.vertices.size();
  EXPECT_GT(all, 20u);
  EXPECT_EQ(naive_vertices_a_stripe(all), 0u);
}

TEST(MoreStripesThanVertices, KeepThePromise) {
  for (const GridPoint size : {GridPoint{9, 7}, {1, 1}, {1, 40}, {2, 2}, {65, 33}}) {
    SCOPED_TRACE(::testing::Message() << size.col << " x " << size.row);
    const HardDatabase database({.terrain = hills(size.col, size.row)});
    database.hold_to_the_promise();
    expect_streams(database);
  }
}

TEST(MoreStripesThanVertices, OfVoidsKeepThePromise) {
  HardCase hard{.terrain = random_voids(hills(66, 41), 0.9, 3)};
  hard.judging = {.cell_width_m = 1, .cell_height_m = 1};
  const HardDatabase database(hard);
  database.hold_to_the_promise();
  expect_streams(database);
}

}  // namespace
}  // namespace talus::support
