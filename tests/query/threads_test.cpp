// One large question on several threads: the same answer, to the bit.

#include <atomic>
#include <bit>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {
namespace {

TEST(Threads, ChangeNothingInALargeAnswer) {
  const TempFolder folder;
  const Terrain terrain = void_blobs(fit(fractal(1400, 1100, 3), SampleType::int16), 5, 9);
  RasterOptions file;
  file.type = SampleType::int16;
  write_raster(terrain, folder / "a.tif", file);
  IngestOptions options;
  ingest(folder / "a.tif", folder / "a.talus", options);
  options.finest_tolerance = Metres{4};
  ingest(folder / "a.tif", folder / "kept.talus", options);
  for (const char* name : {"a.talus", "kept.talus"}) {
    const Snapshot one = Database::open(folder / name, {.threads = 1}).snapshot();
    for (const GridRect region : {one.description().extent, GridRect{{17, 3}, {1333, 1001}}}) {
      for (const double tolerance : {0.0, 3.0, 40.0, 1e9}) {
        const Answer expected = one.ask({.region = region, .tolerance = Metres{tolerance}});
        const Mesh mesh = triangulate(expected.quadtree, 1);
        for (const int threads : {2, 3, 9, 0}) {
          const Snapshot many = Database::open(folder / name, {.threads = threads}).snapshot();
          const Answer answer = many.ask({.region = region, .tolerance = Metres{tolerance}});
          const RestrictedQuadtree &a = answer.quadtree, &e = expected.quadtree;
          EXPECT_EQ(a.vertices.size(), e.vertices.size());
          std::size_t missing = 0;
          e.vertices.for_each([&](GridPoint p) { missing += a.vertices.contains(p) ? 0 : 1; });
          EXPECT_EQ(missing, 0u);
          EXPECT_TRUE(a.heights == e.heights && a.covers == e.covers && a.level_errors == e.level_errors);
          EXPECT_EQ(a.bound, e.bound);
          EXPECT_EQ(answer.border_vertices, expected.border_vertices);
          if (name == std::string("a.talus")) {
            EXPECT_EQ(answer.cost.pages_read + answer.cost.pages_cached,
                      expected.cost.pages_read + expected.cost.pages_cached);
          }
          EXPECT_TRUE(triangulate(a, threads).triangles == mesh.triangles);
        }
      }
    }
  }
}

std::uint64_t digest(const RestrictedQuadtree& q) {
  std::uint64_t sum = 0;
  const auto add = [&](std::uint64_t word) { sum = (sum ^ word) * 0x9e3779b97f4a7c15 + 1; };
  q.vertices.for_each([&](GridPoint p) {
    add(std::uint64_t{static_cast<std::uint32_t>(p.col)} << 32 | static_cast<std::uint32_t>(p.row));
  });
  for (const double height : q.heights) add(std::bit_cast<std::uint64_t>(height));
  for (const std::uint8_t covers : q.covers) add(covers);
  add(std::bit_cast<std::uint64_t>(q.bound.value));
  return sum;
}

/// One of all kinds of questions, by its number.
std::uint64_t asked(const Snapshot& now, std::uint64_t number, int cols, int rows) {
  Random random(number);
  const int first_col = random.between(0, cols - 2), first_row = random.between(0, rows - 2);
  Question q;
  q.region = {{first_col, first_row},
              {random.between(first_col + 1, cols - 1), random.between(first_row + 1, rows - 1)}};
  q.tolerance = Metres{random.log_between(0.5, 300)};
  switch (random.between(0, 8)) {
    case 0: q.border = Border::cover; break;
    case 1: q.points = {q.region.first, q.region.last}; break;
    case 2: q.max_level = random.between(0, 9); break;
    case 3: q.field = patch_tolerance(q.region, 1, 2, {1, 50}); break;
    case 4:
      return digest(
          increment_of(now.ask({.region = q.region, .tolerance = Metres{q.tolerance.value / 2}, .from = q.tolerance}))
              .added);
    case 5: {
      const double x = random.unit() * cols, y = -random.unit() * rows;
      return std::bit_cast<std::uint64_t>(now.height(x, y).value_or(-1)) ^
             std::bit_cast<std::uint64_t>(now.height(x, y, q.tolerance).value_or(-1));
    }
    case 6: {
      const std::vector<Position> line{{1, -1}, {random.unit() * cols, -random.unit() * rows}, {cols - 2.5, -3.25}};
      std::uint64_t sum = 0;
      for (const auto& part : now.profile(line, q.tolerance).parts) {
        for (const ProfileVertex& v : part) sum = sum * 31 + std::bit_cast<std::uint64_t>(v.height);
      }
      return sum;
    }
    case 7:
      return std::bit_cast<std::uint64_t>(
          now.ask({.region = q.region, .budget = {.vertices = 40000}}).quadtree.tolerance.value);
    default: break;
  }
  const Answer answer = now.ask(q);
  return digest(answer.quadtree) ^ triangulate(answer.quadtree, 2).triangles.size();
}

/// Eight threads ask one snapshot at random, its cache too small for them, and get what one thread gets that keeps
/// nothing. TALUS_SOAK_SECONDS says how long; ./dev soak query runs it for ten minutes under the thread sanitizer.
TEST(Threads, EightThatAskAtRandomGetWhatOneGets) {
  const TempFolder folder;
  constexpr int kCols = 1300, kRows = 900;
  const Terrain terrain = void_blobs(fit(fractal(kCols, kRows, 4), SampleType::int16), 4, 2);
  RasterOptions file;
  file.type = SampleType::int16;
  write_raster(terrain, folder / "a.tif", file);
  ingest(folder / "a.tif", folder / "a.talus", {});
  constexpr std::uint64_t kQuestions = 60;
  std::vector<std::uint64_t> expected;
  {
    const Snapshot now = Database::open(folder / "a.talus", {.cache_bytes = 0}).snapshot();
    for (std::uint64_t i = 0; i < kQuestions; ++i) expected.push_back(asked(now, i, kCols, kRows));
  }
  const char* seconds = std::getenv("TALUS_SOAK_SECONDS");
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds == nullptr ? 2.0 : std::atof(seconds));
  const Database database = Database::open(folder / "a.talus", {.cache_bytes = 5 << 20, .threads = 2});
  const Snapshot shared = database.snapshot();
  std::atomic<std::uint64_t> asked_for = 0, different = 0;
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t who = 0; who < 8; ++who) {
      threads.emplace_back([&, who] {
        Random random(who);
        do {
          const auto number = static_cast<std::uint64_t>(random.between(0, kQuestions - 1));
          const bool alone = random.chance(0.1);  // a snapshot of its own
          const std::uint64_t got =
              alone ? asked(database.snapshot(), number, kCols, kRows) : asked(shared, number, kCols, kRows);
          different += got == expected[number] ? 0 : 1;
          ++asked_for;
        } while (std::chrono::steady_clock::now() < end);
      });
    }
  }
  EXPECT_EQ(different, 0u);
  std::printf("%llu questions from eight threads, %llu answers differed\n",
              static_cast<unsigned long long>(asked_for.load()), static_cast<unsigned long long>(different.load()));
}

}  // namespace
}  // namespace talus::support
