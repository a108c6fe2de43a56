// One question, one door: what does not go together is refused, and a question that is cancelled or too large ends.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <semaphore>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "query/pages/watch.hpp"
#include "query/selection/combinations.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/failure_of.hpp"
#include "tests/support/quadtrees.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::string> lines_of(const std::string& file) {
  std::vector<std::string> lines;
  std::ifstream in(std::filesystem::path(TALUS_SOURCE_DIR) / file);
  EXPECT_TRUE(in) << file;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// ---- the header ----------------------------------------------------------------------------------------

/// Declarations between "class Snapshot" and "private:" that are no special members. One begins two spaces in, with a
/// word, and may go on below.
std::vector<std::string> public_methods_of_snapshot() {
  std::vector<std::string> methods;
  bool is_inside = false, is_public = false;
  for (const std::string& line : lines_of("include/talus/database.hpp")) {
    if (line.starts_with("class Snapshot {")) is_inside = true;
    if (!is_inside) continue;
    if (line.starts_with("};")) break;
    if (line.starts_with(" public:")) is_public = true;
    if (line.starts_with(" private:") || line.starts_with(" protected:")) is_public = false;
    if (!is_public || line.size() < 3 || !line.starts_with("  ") || line[2] == ' ' || line[2] == '/') continue;
    if (line.find('(') == std::string::npos) continue;
    if (line.find("Snapshot(") != std::string::npos || line.find("operator=") != std::string::npos) continue;
    methods.push_back(line);
  }
  return methods;
}

TEST(Snapshot, HasTwelveWordsAtMost) {
  const std::vector<std::string> methods = public_methods_of_snapshot();
  EXPECT_GE(methods.size(), 8u) << "the header is written otherwise than this test reads it";
  EXPECT_LE(methods.size(), 12u) << ::testing::PrintToString(methods);
  for (const char* word : {" ask(", " mesh(", " height(", " profile(", " samples("})
    EXPECT_THAT(methods, ::testing::Contains(::testing::HasSubstr(word)));
}

// ---- what does not go together --------------------------------------------------------------------------

class NoField final : public ToleranceField {
 public:
  [[nodiscard]] Metres at(GridPoint) const override { return Metres{5}; }
  [[nodiscard]] Metres least(GridRect) const override { return Metres{5}; }
};

/// Asks for one thing more.
void add(Question& question, Feature feature, const RestrictedQuadtree& neighbour) {
  switch (feature) {
    case Feature::region: question.region = {{0, 0}, {20, 20}}; break;
    case Feature::rectangle: question.rectangle = Rectangle{0, -20, 20, 0}; break;
    case Feature::tolerance: question.tolerance = Metres{5}; break;
    case Feature::budget: question.budget.triangles = 100000; break;
    case Feature::field: question.field = std::make_shared<NoField>(); break;
    case Feature::from: question.from = Metres{50}; break;
    case Feature::border: question.border = Border::cover; break;
    case Feature::exact: question.heights.kind = HeightKind::exact; break;
    case Feature::bounded_alone: question.heights.kind = HeightKind::bounded; break;
    case Feature::fitted: question.heights.kind = HeightKind::fitted; break;
    case Feature::dense: question.heights.kind = HeightKind::dense; break;
    case Feature::rounded: question.heights = {HeightKind::bounded, Metres{1}}; break;
    case Feature::quantum: question.heights.quantum = Metres{1}; break;
    case Feature::max_level: question.max_level = 3; break;
    case Feature::points: question.points = {{3, 4}}; break;
    case Feature::neighbours: question.neighbours = {&neighbour}; break;
    case Feature::together: break;
  }
}

/// A database of rough ground, and one large enough for several threads.
class Ask : public ::testing::Test {
 protected:
  void make(const Terrain& terrain) {
    RasterOptions file;
    file.type = SampleType::int16;
    write_raster(terrain, folder_ / "a.tif", file);
    ingest(folder_ / "a.tif", folder_ / "a.talus", {.overwrite = true});
    database_.emplace(Database::open(folder_ / "a.talus"));
    now_.emplace(database_->snapshot());
  }
  void SetUp() override { make(void_blobs(fit(fractal(300, 260, 5), SampleType::int16), 4, 3)); }

  [[nodiscard]] GridRect extent() const { return now_->description().extent; }

  /// Questions of every kind, by name.
  [[nodiscard]] std::vector<std::pair<std::string, Question>> kinds() const {
    std::vector<std::pair<std::string, Question>> all;
    const auto kind = [&](const char* name, Question question) { all.emplace_back(name, std::move(question)); };
    const GridRect part{{10, 20}, {250, 240}};
    kind("plain", {.region = part, .tolerance = Metres{4}});
    kind("increment", {.region = part, .tolerance = Metres{4}, .from = Metres{30}});
    kind("cover", {.region = part, .tolerance = Metres{4}, .border = Border::cover});
    kind("field", {.region = part, .field = patch_tolerance(part, 2, 2, {3, 9, 5, 20})});
    kind("level", {.region = part, .tolerance = Metres{4}, .max_level = 5});
    kind("points", {.region = part, .tolerance = Metres{40}, .points = {{33, 44}, {99, 100}}});
    kind("bounded", {.region = part, .tolerance = Metres{4}, .heights = {.kind = HeightKind::bounded}});
    kind("nested", {.region = part, .tolerance = Metres{4}, .heights = {HeightKind::bounded, Metres{1}}});
    kind("fitted", {.region = part, .tolerance = Metres{8}, .heights = {.kind = HeightKind::fitted}});
    kind("dense", {.region = part, .tolerance = Metres{4}, .heights = {.kind = HeightKind::dense}});
    kind("budget", {.region = part, .budget = {.vertices = 9000}});
    return all;
  }

  TempFolder folder_;
  std::optional<Database> database_;
  std::optional<Snapshot> now_;
};

TEST_F(Ask, RefusesEveryPairOfTheTableAndNamesBoth) {
  const RestrictedQuadtree neighbour = now_->ask({.region = {{20, 0}, {40, 20}}, .tolerance = Metres{5}}).quadtree;
  for (const Combination& pair : kRefused) {
    const std::string sentence(pair.sentence);
    SCOPED_TRACE(sentence);
    Question question;
    add(question, pair.one, neighbour);
    add(question, pair.other, neighbour);
    const bool together = pair.one == Feature::together || pair.other == Feature::together;
    ASSERT_TRUE(asks_for(question, pair.one, together) && asks_for(question, pair.other, together));
    const auto failure = failure_of([&] {
      if (together) {
        static_cast<void>(now_->ask_together({&question, 1}));
      } else {
        static_cast<void>(now_->ask(question));
      }
    });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->cause(), Cause::invalid_argument);
    EXPECT_EQ(failure->what(), sentence);
    for (const Feature feature : {pair.one, pair.other})
      EXPECT_THAT(sentence, ::testing::HasSubstr(std::string(words_of(feature).field)));
  }
}

TEST_F(Ask, EachFeatureAloneIsAnswered) {
  const RestrictedQuadtree neighbour = now_->ask({.region = {{20, 0}, {40, 20}}, .tolerance = Metres{5}}).quadtree;
  for (const FeatureWords& words : kFeatures) {
    SCOPED_TRACE(std::string(words.field));
    EXPECT_EQ(words_of(words.feature).field, words.field) << "in another order than the enumeration";
    Question question;
    if (words.feature == Feature::quantum) continue;  // goes with heights that are not exact
    if (words.feature == Feature::neighbours) question.region = {{0, 0}, {20, 20}};
    if (words.feature == Feature::bounded_alone || words.feature == Feature::fitted ||
        words.feature == Feature::dense || words.feature == Feature::rounded)
      question.tolerance = Metres{5};
    add(question, words.feature, neighbour);
    EXPECT_NO_THROW(static_cast<void>(now_->ask(question)));
  }
}

/// docs/questions.md prints the table; a row that is missing or old shows here with the one that belongs there.
TEST(Questions, TheDocumentHasTheTable) {
  std::vector<std::string> expected, found;
  for (const Combination& pair : kRefused) {
    expected.push_back(
        fmt::format("| `{}` | `{}` | {} |", words_of(pair.one).field, words_of(pair.other).field, pair.sentence));
  }
  for (const FeatureWords& words : kFeatures)
    expected.push_back(fmt::format("| `{}` | {} |", words.field, words.meaning));
  for (const std::string& line : lines_of("docs/questions.md")) {
    if (line.starts_with("| `")) found.push_back(line);
  }
  EXPECT_THAT(found, ::testing::UnorderedElementsAreArray(expected));
}

// ---- the same thing said in other words ------------------------------------------------------------------

TEST_F(Ask, AQuestionThatSaysNothingAsksForAll) {
  const RestrictedQuadtree all = now_->ask({}).quadtree;
  EXPECT_EQ(all.region, extent());
  EXPECT_EQ(difference(all, now_->ask({.region = extent(), .tolerance = Metres{0}}).quadtree), "");
}

TEST_F(Ask, RectanglesPlacesAndLinesAreTheSamplesTheyCover) {
  const Rectangle rectangle{30.2, -200.7, 150.9, -41};
  const PlacedRectangle placed = now_->region(rectangle);
  const Description& d = now_->description();
  EXPECT_FALSE(placed.is_cut);
  Question by_samples{.region = placed.samples, .tolerance = Metres{30}};
  EXPECT_EQ(
      difference(now_->ask({.rectangle = rectangle, .tolerance = Metres{30}}).quadtree, now_->ask(by_samples).quadtree),
      "");
  Question by_places = by_samples;
  by_places.places = {{60.4, -77.2}};
  by_places.lines = {{{50, -60}, {90, -120}}};
  by_samples.points = samples_nearest(d, placed.samples, by_places.places);
  const auto along = samples_along(d, placed.samples, by_places.lines);
  by_samples.points.insert(by_samples.points.end(), along.begin(), along.end());
  const Answer places = now_->ask(by_places), samples = now_->ask(by_samples);
  EXPECT_EQ(difference(places.quadtree, samples.quadtree), "");
  EXPECT_EQ(places.points, by_samples.points.size());
  EXPECT_EQ(places.point_vertices, samples.point_vertices);
}

TEST_F(Ask, ABudgetIsTheSmallestToleranceThatFitsAndSaysWhatTheSearchCost) {
  const Answer answer = now_->ask({.budget = {.vertices = 5000}});
  EXPECT_LE(answer.quadtree.vertices.size(), 5000u);
  EXPECT_GT(answer.search.pages_read + answer.search.pages_cached, 0u);
  const Metres found = answer.quadtree.tolerance;
  EXPECT_EQ(difference(answer.quadtree, now_->ask({.tolerance = found}).quadtree), "");
  EXPECT_GT(now_->ask({.tolerance = Metres{found.value / 1.02}}).quadtree.vertices.size(), 5000u);
  EXPECT_EQ(now_->ask({.tolerance = found}).search.pages_read, 0u) << "nobody searched";
}

/// Single voids leave no triangle without data. Triangles that hold one are split for their size all the same.
TEST_F(Ask, HeightsOfEachKindKeepTheOutlineOfSingleVoids) {
  Terrain flat = plane(129, 129, 0, 0, 0);
  for (int row = 0; row < 129; row += 8) {
    for (int col = 0; col < 129; col += 8) flat.make_void(col, row);
  }
  make(flat);
  const auto longest_side = [&](HeightKind kind) {
    const Question question{.region = extent(), .tolerance = Metres{8}, .heights = {.kind = kind}};
    const Mesh mesh = triangulate(now_->ask(question).quadtree);
    double longest = 0;
    for (const auto& t : mesh.triangles) {
      const GridPoint a = mesh.points[t[1]], b = mesh.points[t[2]];  // the right angle is first
      longest = std::max(longest, std::hypot(a.col - b.col, a.row - b.row));
    }
    return longest;
  };
  const double exact = longest_side(HeightKind::exact);
  EXPECT_LT(exact, 40);
  EXPECT_LE(longest_side(HeightKind::bounded), exact);
  EXPECT_LE(longest_side(HeightKind::fitted), exact);
}

TEST_F(Ask, OnlyAnAnswerToFromIsAnIncrement) {
  const Answer added = now_->ask({.tolerance = Metres{4}, .from = Metres{30}});
  EXPECT_EQ(added.from, Metres{30});
  const RestrictedQuadtree merged = merge(now_->ask({.tolerance = Metres{30}}).quadtree, increment_of(added));
  const Answer whole = now_->ask({.tolerance = Metres{4}});
  EXPECT_EQ(difference(merged, whole.quadtree), "");
  EXPECT_FALSE(whole.from);
  EXPECT_EQ(failure_of([&] { static_cast<void>(increment_of(whole)); })->cause(), Cause::invalid_argument);
}

// ---- progress, stop and limits ---------------------------------------------------------------------------

TEST_F(Ask, TellsHowFarItIsAndChangesNothing) {
  for (auto& [name, question] : kinds()) {
    SCOPED_TRACE(name);
    const Answer expected = now_->ask(question);
    std::vector<double> told;
    question.progress = [&](double fraction, const char* stage) {
      EXPECT_NE(std::string(stage), "");
      told.push_back(fraction);
    };
    question.limits = {std::uint64_t{1} << 40, std::uint64_t{1} << 40};
    EXPECT_EQ(difference(now_->ask(question).quadtree, expected.quadtree), "");
    ASSERT_GE(told.size(), 2u);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end())) << ::testing::PrintToString(told);
    EXPECT_GE(told.front(), 0);
    EXPECT_EQ(told.back(), 1);
  }
}

/// Asks, and stops at each of the first calls of the progress function in turn: by `stop`, which gets the question's
/// source. Nothing may be told after it.
void expect_cancelled(const Snapshot& now, Question question, const std::function<void(std::stop_source&)>& stop) {
  int calls_in_all = 0;
  question.progress = [&](double, const char*) { ++calls_in_all; };
  static_cast<void>(now.ask(question));
  const int last = std::min(calls_in_all - 1, 12);  // behind the last call nothing is left to stop
  ASSERT_GE(last, 1);
  for (int wanted = 1; wanted <= last; ++wanted) {
    std::stop_source source;
    int calls = 0;
    question.stop = source.get_token();
    question.progress = [&](double, const char*) {
      if (++calls == wanted) stop(source);
    };
    const auto failure = failure_of([&] { static_cast<void>(now.ask(question)); });
    ASSERT_TRUE(failure) << "stopped at call " << wanted << " of " << calls_in_all;
    EXPECT_EQ(failure->cause(), Cause::cancelled) << failure->what();
    EXPECT_EQ(calls, wanted) << "went on after it was stopped";
  }
}

TEST_F(Ask, IsCancelledFromTheProgressFunction) {
  for (const auto& [name, question] : kinds()) {
    SCOPED_TRACE(name);
    expect_cancelled(*now_, question, [](std::stop_source& source) { source.request_stop(); });
  }
}

TEST_F(Ask, IsCancelledFromAnotherThread) {
  for (const auto& [name, question] : kinds()) {
    SCOPED_TRACE(name);
    expect_cancelled(*now_, question,
                     [](std::stop_source& source) { std::jthread([&] { source.request_stop(); }).join(); });
  }
}

TEST_F(Ask, IsCancelledBeforeItBegins) {
  std::stop_source source;
  source.request_stop();
  for (auto [name, question] : kinds()) {
    SCOPED_TRACE(name);
    question.stop = source.get_token();
    const auto failure = failure_of([&] { static_cast<void>(now_->ask(question)); });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->cause(), Cause::cancelled);
  }
  const RestrictedQuadtree answer = now_->ask({.tolerance = Metres{4}}).quadtree;
  for (const int threads : {1, 3}) {
    const auto failure = failure_of([&] { static_cast<void>(triangulate(answer, threads, source.get_token())); });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->cause(), Cause::cancelled);
  }
}

TEST_F(Ask, OnSeveralThreadsIsCancelledToo) {
  make(fit(fractal(1500, 1200, 6), SampleType::int16));
  // Where other threads take all tasks, the one that reports has nothing to say a second time: ask again.
  const auto ask = [&](int threads) {
    std::stop_source source;
    std::binary_semaphore is_working(0);
    std::atomic<bool> is_stopped = false;
    const std::jthread other([&] {
      is_working.acquire();
      source.request_stop();
      is_stopped = true;
    });
    std::atomic<int> calls = 0;
    const auto failure = failure_of([&] {
      static_cast<void>(
          now_->ask({.threads = threads, .stop = source.get_token(), .progress = [&](double share, const char*) {
                       if (share >= 1) return;  // nothing is left to be stopped
                       if (++calls == 2) is_working.release();
                       while (calls >= 2 && !is_stopped) std::this_thread::yield();
                     }}));
    });
    is_working.release();
    if (calls < 2) return false;
    EXPECT_TRUE(failure && failure->cause() == Cause::cancelled);
    return true;
  };
  for (const int threads : {1, 2, 5}) {
    bool is_tried = false;
    for (int i = 0; i < 200 && !is_tried; ++i) is_tried = ask(threads);
    EXPECT_TRUE(is_tried) << threads << " threads";
  }
}

TEST_F(Ask, PassesOnWhatTheProgressFunctionThrows) {
  for (auto [name, question] : kinds()) {
    SCOPED_TRACE(name);
    question.progress = [](double, const char*) { throw std::runtime_error("enough"); };
    EXPECT_THROW(static_cast<void>(now_->ask(question)), std::runtime_error);
  }
}

TEST_F(Ask, HasAsManyVerticesAsItMayAndNotOneMore) {
  for (auto [name, question] : kinds()) {
    SCOPED_TRACE(name);
    const Answer expected = now_->ask(question);
    const std::uint64_t vertices = expected.quadtree.vertices.size();
    question.limits.vertices = vertices;
    EXPECT_EQ(difference(now_->ask(question).quadtree, expected.quadtree), "");
    for (const std::uint64_t fewer : {vertices - 1, vertices / 2, std::uint64_t{1}}) {
      question.limits.vertices = fewer;
      const auto failure = failure_of([&] { static_cast<void>(now_->ask(question)); });
      ASSERT_TRUE(failure) << fewer << " of " << vertices;
      EXPECT_EQ(failure->cause(), Cause::too_large);
      EXPECT_THAT(failure->what(), ::testing::HasSubstr("Limits::vertices"));
    }
  }
}

TEST_F(Ask, TakesAsManyBytesAsItMayAndNotOneMore) {
  for (auto [name, question] : kinds()) {
    SCOPED_TRACE(name);
    const Answer expected = now_->ask(question);
    const std::uint64_t vertices = expected.quadtree.vertices.size();
    // A mask and the vertices are the least that any kind takes.
    const std::uint64_t least = bytes_of_mask(question.region) + vertices * kBytesAVertex;
    for (const std::uint64_t bytes : {std::uint64_t{1}, bytes_of_mask(question.region), least - 1}) {
      question.limits.memory_bytes = bytes;
      const auto failure = failure_of([&] { static_cast<void>(now_->ask(question)); });
      ASSERT_TRUE(failure) << bytes;
      EXPECT_EQ(failure->cause(), Cause::too_large);
      EXPECT_THAT(failure->what(), ::testing::HasSubstr("Limits::memory_bytes"));
    }
    if (name == "plain" || name == "increment")
      question.limits.memory_bytes = least;
    else
      question.limits.memory_bytes = std::uint64_t{1} << 32;
    EXPECT_EQ(difference(now_->ask(question).quadtree, expected.quadtree), "");
  }
}

TEST_F(Ask, TogetherEachHasItsOwnLimitsAndStop) {
  std::vector<Question> both{{.region = {{0, 0}, {128, 128}}, .tolerance = Metres{5}},
                             {.region = {{128, 0}, {256, 128}}, .tolerance = Metres{20}}};
  EXPECT_NO_THROW(static_cast<void>(now_->ask_together(both)));
  both[1].limits.vertices = 10;
  EXPECT_EQ(failure_of([&] { static_cast<void>(now_->ask_together(both)); })->cause(), Cause::too_large);
  both[1].limits = {};
  std::stop_source source;
  source.request_stop();
  both[1].stop = source.get_token();
  EXPECT_EQ(failure_of([&] { static_cast<void>(now_->ask_together(both)); })->cause(), Cause::cancelled);
}

/// Stands for a system without memory.
class Greedy final : public ToleranceField {
 public:
  [[nodiscard]] Metres at(GridPoint) const override { return Metres{5}; }
  [[nodiscard]] Metres least(GridRect) const override { throw std::bad_alloc(); }
};

TEST_F(Ask, WithoutMemoryIsAFailureWithItsCause) {
  const auto failure = failure_of([&] { static_cast<void>(now_->ask({.field = std::make_shared<Greedy>()})); });
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->cause(), Cause::out_of_memory);
}

TEST_F(Ask, RefusesWhatMakesNoSense) {
  const auto refused = [&](const Question& question) {
    const auto failure = failure_of([&] { static_cast<void>(now_->ask(question)); });
    return failure && failure->cause() == Cause::invalid_argument ? std::string(failure->what()) : "";
  };
  EXPECT_NE(refused({.region = {{0, 0}, {1000, 10}}}), "");
  EXPECT_NE(refused({.region = {{5, 5}, {4, 5}}}), "");
  EXPECT_NE(refused({.tolerance = Metres{-1}}), "");
  EXPECT_NE(refused({.max_level = -1}), "");
  EXPECT_NE(refused({.tolerance = Metres{5}, .from = Metres{5}}), "");
  EXPECT_NE(refused({.tolerance = Metres{5}, .from = Metres{-5}}), "");
  EXPECT_NE(refused({.budget = {.vertices = 3}}), "");
  EXPECT_NE(refused({.budget = {.vertices = 5000}, .from = Metres{0.01}}), "") << "finer than what fits";
  EXPECT_NE(refused({.tolerance = Metres{kInfinity}, .heights = {.kind = HeightKind::fitted}}), "");
  EXPECT_NE(refused({.rectangle = Rectangle{900, -20, 1000, -10}}), "");
  EXPECT_NE(refused({.places = {{900, -20}}}), "");
  EXPECT_NE(refused({.lines = {{{9, -20}}}}), "");
}

// ---- an open database whose file is replaced --------------------------------------------------------------

TEST_F(Ask, AnOpenDatabaseKeepsItsFileAndReopenOpensTheNewOne) {
  EXPECT_TRUE(database_->is_current());
  const Database same = database_->reopen();
  EXPECT_EQ(same.snapshot().provenance().identity, now_->provenance().identity);
  const RestrictedQuadtree before = now_->ask({.tolerance = Metres{10}}).quadtree;

  const Terrain terrain = fit(fractal(300, 260, 77), SampleType::int16);
  RasterOptions file;
  file.type = SampleType::int16;
  write_raster(terrain, folder_ / "b.tif", file);
  update({folder_ / "b.tif"}, folder_ / "a.talus");
  EXPECT_FALSE(database_->is_current());
  EXPECT_FALSE(same.is_current());
  EXPECT_EQ(difference(database_->snapshot().ask({.tolerance = Metres{10}}).quadtree, before), "");

  const Database anew = database_->reopen();
  EXPECT_TRUE(anew.is_current());
  EXPECT_EQ(anew.snapshot().provenance().generation, 1u);
  EXPECT_EQ(anew.snapshot().provenance().identity.generation, 1u);
  EXPECT_NE(difference(anew.snapshot().ask({.tolerance = Metres{10}}).quadtree, before), "");

  std::filesystem::remove(folder_ / "a.talus");
  EXPECT_FALSE(anew.is_current());
  EXPECT_EQ(failure_of([&] { static_cast<void>(anew.reopen()); })->cause(), Cause::not_found);
  EXPECT_EQ(difference(now_->ask({.tolerance = Metres{10}}).quadtree, before), "");
}

TEST_F(Ask, AFileThatAnotherProgramWritesIntoIsAFailureUntilItIsOpenedAgain) {
  static_cast<void>(now_->ask({.tolerance = Metres{10}}));  // pages of the old content stay in the cache
  RasterOptions file;
  file.type = SampleType::int16;
  write_raster(fit(fractal(700, 500, 9), SampleType::int16), folder_ / "b.tif", file);
  ingest(folder_ / "b.tif", folder_ / "b.talus");
  std::filesystem::copy_file(folder_ / "b.talus", folder_ / "a.talus",
                             std::filesystem::copy_options::overwrite_existing);  // into the open file, as cp does
  EXPECT_FALSE(database_->is_current());
  const auto failure = failure_of([&] { static_cast<void>(database_->snapshot()); });
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->cause(), Cause::io);
  EXPECT_EQ(failure->file(), folder_ / "a.talus");
  const auto finer = failure_of([&] { static_cast<void>(now_->ask({.tolerance = Metres{0}})); });
  if (finer) {
    EXPECT_EQ(finer->cause(), Cause::io) << finer->what();  // else all its pages were in the cache
  }

  const Database anew = database_->reopen();
  EXPECT_TRUE(anew.is_current());
  const Database expected = Database::open(folder_ / "b.talus");
  EXPECT_EQ(difference(anew.snapshot().ask({.tolerance = Metres{3}}).quadtree,
                       expected.snapshot().ask({.tolerance = Metres{3}}).quadtree),
            "");
}

}  // namespace
}  // namespace talus::support
