// Danger: a thousand increments, each to a tolerance that thousands of errors tie with. Whoever takes both ends of an
// interval for inside it sends those vertices twice.

#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/stream/stream_codec.hpp"
#include "tests/support/float_exceptions.hpp"
#include "tests/support/hard_case.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

constexpr int kSteps = 1000;

double tolerance(int step) { return (kSteps - step) / 2.0; }

std::size_t naive_count(std::span<const double> errors, double from, double to) {
  std::size_t count = 0;
  for (const double error : errors) count += to <= error && error <= from;
  return count;
}

HardCase hard_case() { return {.terrain = fit(fractal(90, 70, 31, 1500), SampleType::int16)}; }

TEST(IncrementsByTheThousand, SendTheirTiesTwice) {
  const HardDatabase database(hard_case());
  const auto whole = database.now().ask({.region = database.extent(), .tolerance = Metres{0}}).quadtree;
  const std::vector<double> errors = errors_of(database.now(), whole);
  std::size_t sent = 0;
  for (int step = 1; step <= kSteps; ++step) sent += naive_count(errors, tolerance(step - 1), tolerance(step));
  EXPECT_GT(sent, whole.vertices.size() * 3 / 2);
}

TEST(IncrementsByTheThousand, KeepThePromise) {
  const HardDatabase database(hard_case());
  database.hold_to_the_promise();
  const Snapshot& now = database.now();
  RestrictedQuadtree client = now.ask({.region = database.extent(), .tolerance = Metres{tolerance(0)}}).quadtree;
  std::size_t sent = client.vertices.size();
  for (int step = 1; step <= kSteps; ++step) {
    const Increment more = increment_of(now.ask(
        {.region = database.extent(), .tolerance = Metres{tolerance(step)}, .from = Metres{tolerance(step - 1)}}));
    sent += more.added.vertices.size();
    const auto bytes = encode({now.description(), more}, {}, &client);
    client = without_float_exceptions(
        [&] { return merge(client, std::get<Increment>(decode_stream(bytes, {}, &client).content)); },
        FE_DIVBYZERO | FE_OVERFLOW);
    if (step % 50 != 0) continue;
    ASSERT_EQ(difference(client, now.ask({.region = database.extent(), .tolerance = Metres{tolerance(step)}}).quadtree),
              "")
        << step;
  }
  EXPECT_EQ(sent, client.vertices.size()) << "each vertex once";
  EXPECT_EQ(client.tolerance.value, 0);
  (void)database.streamed(client);
}

}  // namespace
}  // namespace talus::support
