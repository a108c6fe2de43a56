// Increments, sessions and progressive order, each held against answers asked in one go.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/quadtree/border.hpp"
#include "engine/quadtree/grid.hpp"
#include "query/snapshot_view.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/forged_database.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/quadtrees.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/real_models.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Made {
  explicit Made(std::uint64_t seed, const IngestOptions& options = {}) : raster(random_raster(seed)) {
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    IngestOptions chosen = options;
    chosen.void_weight = raster.void_weight;
    ingest(folder / "a.tif", folder / "a.talus", chosen);
  }
  [[nodiscard]] Snapshot now() const { return Database::open(folder / "a.talus").snapshot(); }
  TempFolder folder;
  RandomRaster raster;
};

std::vector<std::uint64_t> seeds(int usual, std::uint64_t first) {
  if (const auto one = property_seed()) return {*one};
  std::vector<std::uint64_t> all;
  for (int i = 0; i < property_cases(usual); ++i) all.push_back(first + static_cast<std::uint64_t>(i));
  return all;
}

/// Falling, each once.
std::vector<double> random_chain(Random& random, const Snapshot& now) {
  const Description& d = now.description();
  std::set<double, std::greater<>> chain;
  const int length = random.between(2, 6);
  const double range = std::max(1e-3, (d.maximum_height - d.minimum_height) * d.metres_per_unit);
  while (static_cast<int>(chain.size()) < length)
    chain.insert(random.chance(0.5) ? random_tolerance(random) : random.log_between(1e-3 * range, range));
  return {chain.begin(), chain.end()};
}

void expect_chain(const Snapshot& now, GridRect region, const std::vector<double>& chain) {
  RestrictedQuadtree client = now.ask({.region = region, .tolerance = Metres{chain.front()}}).quadtree;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    SCOPED_TRACE(std::to_string(chain[i - 1]) + " m to " + std::to_string(chain[i]) + " m");
    const Increment increment =
        increment_of(now.ask({.region = region, .tolerance = Metres{chain[i]}, .from = Metres{chain[i - 1]}}));
    const Answer whole = now.ask({.region = region, .tolerance = Metres{chain[i]}});
    // Exactly what the client lacks, and none of it there already.
    std::size_t lacking = 0;
    whole.quadtree.vertices.for_each([&](GridPoint p) {
      const bool has = client.vertices.contains(p);
      lacking += has ? 0 : 1;
      ASSERT_NE(has, increment.added.vertices.contains(p)) << p.col << "/" << p.row;
    });
    ASSERT_EQ(increment.added.vertices.size(), lacking);
    EXPECT_LE(increment.cost.pages_read + increment.cost.pages_cached, whole.cost.pages_read + whole.cost.pages_cached);
    client = merge(client, increment);
    ASSERT_EQ(difference(client, whole.quadtree), "");
  }
  if (chain.size() > 2) {
    const RestrictedQuadtree first = now.ask({.region = region, .tolerance = Metres{chain.front()}}).quadtree;
    const auto at_once = merge(
        first,
        increment_of(now.ask({.region = region, .tolerance = Metres{chain.back()}, .from = Metres{chain.front()}})));
    EXPECT_EQ(difference(at_once, client), "") << "a chain and one step";
  }
}

TEST(Increments, OfAnyChainMergeToTheAnswerAskedInOneGo) {
  for (const std::uint64_t seed : seeds(300, 71000)) {
    const Made made(seed);
    SCOPED_TRACE(made.raster.description);
    const Snapshot now = made.now();
    Random random(seed);
    for (int i = 0; i < 3; ++i) {
      expect_chain(now, random_region(random, made.raster.terrain), random_chain(random, now));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Increments, OfADatabaseThatKeptATolerancesVerticesEndThere) {
  for (const std::uint64_t seed : seeds(100, 72000)) {
    Random random(seed);
    IngestOptions options;
    const double finest = random.log_between(0.1, 50);
    options.finest_tolerance = Metres{finest};
    const Made made(seed, options);
    SCOPED_TRACE(made.raster.description + " kept " + std::to_string(finest));
    const Snapshot now = made.now();
    const GridRect region = random_region(random, made.raster.terrain);
    expect_chain(now, region, {kInfinity, 4 * finest, finest, finest / 2, 0});
    if (HasFatalFailure()) return;
    const Increment none =
        increment_of(now.ask({.region = region, .tolerance = Metres{finest / 3}, .from = Metres{finest}}));
    EXPECT_EQ(none.added.vertices.size(), 0u);
    EXPECT_EQ(none.added.tolerance.value, finest / 3) << "as asked; the bound says what it is";
    EXPECT_EQ(none.added.bound.value, now.ask({.region = region, .tolerance = Metres{finest}}).quadtree.bound.value);
  }
}

TEST(Increments, OfRoundedHeightsMergeToo) {
  for (const std::uint64_t seed : seeds(40, 73000)) {
    Random random(seed);
    IngestOptions options;
    options.inputs.height_step = Metres{random.log_between(0.01, 5)};
    const Made made(seed, options);
    SCOPED_TRACE(made.raster.description);
    const Snapshot now = made.now();
    expect_chain(now, random_region(random, made.raster.terrain), random_chain(random, now));
    if (HasFatalFailure()) return;
  }
}

/// Reads the tables of pages that can hold something above a tolerance, by plain recursion.
std::uint64_t pages_above(const StoredPages& pages, PageId id, std::uint32_t generation, GridRect region,
                          double tolerance) {
  PageDecoder decoder;
  QueryCost unused;
  const std::vector<ChildEntry> children = pages.get(id, generation, decoder, unused).children;
  std::uint64_t count = 1;
  for (std::size_t i = 0; i < children.size(); ++i) {
    const PageId child = child_page(id, i);
    if (children[i].present && overlap(page_square(child), region) && error_of(children[i].largest) > tolerance)
      count += pages_above(pages, child, children[i].generation, region, tolerance);
  }
  return count;
}

TEST(Increments, ReadOnlyPagesThatHoldSomethingAboveTheFinerTolerance) {
  const TempFolder folder;
  Terrain terrain = fit(fractal(1500, 1400, 5, 300), SampleType::int16);
  for (int row = 0; row < 700; ++row) {
    for (int col = 0; col < 800; ++col) terrain.at(col, row) = 1000;  // nothing to say here
  }
  write_raster(terrain, folder / "a.tif");
  ingest(folder / "a.tif", folder / "sliced.talus");
  Forgery pages_only(folder / "sliced.talus");
  static_cast<void>(pages_only.empty_slices());
  pages_only.write(folder / "a.talus");
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const Snapshot sliced = Database::open(folder / "sliced.talus").snapshot();
  const StoredPages& pages = pages_of(now);
  const Manifest& manifest = pages.manifest();
  Random random(1);
  int with_slices = 0;
  for (int i = 0; i < 40; ++i) {
    const GridRect region = random_region(random, terrain);
    const double to = random.log_between(0.3, 100);
    std::uint64_t expected = 1;  // the header
    const auto tops = pages_of_band(manifest.bands - 1, manifest.description.extent);
    for (std::size_t t = 0; t < tops.size(); ++t) {
      if (overlap(page_square(tops[t]), region))
        expected += pages_above(pages, tops[t], manifest.top_generations[t], region, to);
    }
    const Question question{.region = region, .tolerance = Metres{to}, .from = Metres{2 * to}};
    const QueryCost cost = increment_of(now.ask(question)).cost;
    EXPECT_EQ(cost.pages_read + cost.pages_cached, expected) << to;
    const QueryCost of_sliced = increment_of(sliced.ask(question)).cost;
    std::uint64_t from_slices = 0;
    for (const BandCost& band : of_sliced.bands) from_slices += band.from_slice;
    EXPECT_LE(of_sliced.pages_read + of_sliced.pages_cached + from_slices, expected) << to;
    EXPECT_TRUE(from_slices == 0 || of_sliced.bands.at(1).slices_read > 0) << to;
    with_slices += from_slices > 0 ? 1 : 0;
  }
  EXPECT_GT(with_slices, 3);
}

std::string refusal(const RestrictedQuadtree& answer, const Increment& increment) {
  try {
    static_cast<void>(merge(answer, increment));
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::invalid_argument);
    return f.what();
  }
  ADD_FAILURE() << "was merged";
  return "";
}

TEST(Increments, ThatDoNotFitAreRefused) {
  const TempFolder folder;
  const Terrain terrain = fit(fractal(200, 150, 5, 300), SampleType::int16);
  Terrain other = terrain;
  other.at(50, 50) += 1;  // the same extremes, the same everything in the manifest
  write_raster(terrain, folder / "a.tif");
  ingest(folder / "a.tif", folder / "a.talus");
  std::filesystem::create_directory(folder / "other");
  write_raster(other, folder / "other" / "a.tif");
  ingest(folder / "other" / "a.tif", folder / "other" / "a.talus");
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const Snapshot elsewhere = Database::open(folder / "other" / "a.talus").snapshot();
  EXPECT_NE(now.provenance().identity, elsewhere.provenance().identity);
  ingest(folder / "a.tif", folder / "again.talus");
  EXPECT_EQ(now.provenance().identity, Database::open(folder / "again.talus").snapshot().provenance().identity)
      << "one content, one identity";
  const GridRect region{{10, 10}, {150, 120}};
  const RestrictedQuadtree base = now.ask({.region = region, .tolerance = Metres{20}}).quadtree;

  EXPECT_THAT(
      refusal(base, increment_of(elsewhere.ask({.region = region, .tolerance = Metres{5}, .from = Metres{20}}))),
      ::testing::HasSubstr("another database"));
  EXPECT_THAT(
      refusal(base,
              increment_of(now.ask({.region = {{10, 10}, {150, 119}}, .tolerance = Metres{5}, .from = Metres{20}}))),
      ::testing::HasSubstr("region"));
  EXPECT_THAT(refusal(base, increment_of(now.ask({.region = region, .tolerance = Metres{5}, .from = Metres{21}}))),
              ::testing::HasSubstr("at 20 m"));
  Increment updated = increment_of(now.ask({.region = region, .tolerance = Metres{5}, .from = Metres{20}}));
  updated.added.origin.identity.generation = 3;
  EXPECT_THAT(refusal(base, updated), ::testing::HasSubstr("update 3"));

  Question points;
  points.region = region;
  points.tolerance = Metres{20};
  points.points = {{33, 33}};
  EXPECT_THAT(refusal(now.ask(points).quadtree,
                      increment_of(now.ask({.region = region, .tolerance = Metres{5}, .from = Metres{20}}))),
              ::testing::HasSubstr("no increment can follow"));
  points.points.clear();
  EXPECT_EQ(difference(now.ask(points).quadtree, base), "") << "asked for no more than a range";

  for (const auto& [from, to] : {std::pair{5.0, 5.0}, {5.0, 6.0}, {5.0, -1.0}, {NAN, 1.0}, {5.0, NAN}, {-1.0, -2.0}}) {
    try {
      static_cast<void>(increment_of(now.ask({.region = region, .tolerance = Metres{to}, .from = Metres{from}})));
      ADD_FAILURE() << from << " to " << to;
    } catch (const Failure& f) {
      EXPECT_EQ(f.cause(), Cause::invalid_argument);
    }
  }
  EXPECT_THROW(static_cast<void>(
                   increment_of(now.ask({.region = {{0, 0}, {200, 10}}, .tolerance = Metres{1}, .from = Metres{5}}))),
               Failure);
}

TEST(Increments, OfAnUpdatedDatabaseDoNotFitTheOldAnswer) {
  const TempFolder folder;
  const Terrain terrain = fit(fractal(200, 150, 5, 300), SampleType::int16);
  write_raster(terrain, folder / "a.tif");
  ingest(folder / "a.tif", folder / "a.talus");
  RestrictedQuadtree base;
  const GridRect region{{10, 10}, {150, 120}};
  {
    const Snapshot now = Database::open(folder / "a.talus").snapshot();
    base = now.ask({.region = region, .tolerance = Metres{20}}).quadtree;
  }
  Terrain changed = terrain;
  changed.at(199, 149) += 1;  // beyond the region: nothing of the answer changes
  write_raster(changed, folder / "b.tif");
  static_cast<void>(update({folder / "b.tif"}, folder / "a.talus"));
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  EXPECT_THAT(refusal(base, increment_of(now.ask({.region = region, .tolerance = Metres{5}, .from = Metres{20}}))),
              ::testing::HasSubstr("update 1"));
}

// ---- sessions -------------------------------------------------------------------------------------------

/// A window that moves, grows, shrinks or jumps.
GridRect moved(Random& random, GridRect window, const Terrain& terrain) {
  if (random.chance(0.15)) return random_region(random, terrain);
  const auto clamp = [](int v, int most) { return std::clamp(v, 0, most); };
  const int dx = random.between(-20, 20), dy = random.between(-20, 20);
  const int grow = random.chance(0.3) ? random.between(-9, 9) : 0;
  GridRect next{
      {clamp(window.first.col + dx - grow, terrain.cols - 1), clamp(window.first.row + dy - grow, terrain.rows - 1)},
      {clamp(window.last.col + dx + grow, terrain.cols - 1), clamp(window.last.row + dy + grow, terrain.rows - 1)}};
  if (next.first.col > next.last.col) std::swap(next.first.col, next.last.col);
  if (next.first.row > next.last.row) std::swap(next.first.row, next.last.row);
  return next;
}

/// Nothing that the client had is added, and nothing is removed that it had not.
void expect_minimal(const RestrictedQuadtree& client, const Difference& d) {
  if (d.starts_over) return;
  const auto has = [&](GridPoint p) { return client.vertices.region().contains(p) && client.vertices.contains(p); };
  d.added.added.vertices.for_each([&](GridPoint p) { EXPECT_FALSE(has(p)) << p.col << "/" << p.row << " was there"; });
  for (const GridPoint p : d.removed) {
    EXPECT_TRUE(has(p)) << p.col << "/" << p.row << " was not there";
    EXPECT_TRUE(d.added.added.region.contains(p));
  }
}

void expect_session(const Snapshot& now, const Terrain& terrain, Random& random, int steps) {
  Session session(std::uint64_t{1} << 20);
  RestrictedQuadtree client;
  GridRect window = random_region(random, terrain);
  double tolerance = random_tolerance(random);
  for (int i = 0; i < steps; ++i) {
    const Difference d = session.next(now, window, Metres{tolerance});
    EXPECT_EQ(d.starts_over, i == 0);
    EXPECT_TRUE(d.remembered);
    EXPECT_LE(session.bytes(), std::uint64_t{1} << 20);
    expect_minimal(client, d);
    client = apply(client, d);
    ASSERT_EQ(difference(client, now.ask({.region = window, .tolerance = Metres{tolerance}}).quadtree), "")
        << "step " << i;
    const int what = random.between(0, 4);
    if (what <= 2) window = moved(random, window, terrain);
    if (what == 3) tolerance = tolerance == 0 ? 0.0 : std::isinf(tolerance) ? 100 : tolerance * random.unit();
    if (what == 4 || what == 0) tolerance = random_tolerance(random);
  }
}

TEST(Sessions, LeadToTheAnswerAskedInOneGoWhereverTheyGo) {
  for (const std::uint64_t seed : seeds(200, 74000)) {
    const Made made(seed);
    SCOPED_TRACE(made.raster.description);
    Random random(seed);
    expect_session(made.now(), made.raster.terrain, random, 12);
    if (HasFailure()) return;
  }
}

TEST(Sessions, AskForAnIncrementWhereOnlyTheToleranceFell) {
  const Made made(74500);
  const Snapshot now = made.now();
  Session session(1 << 20);
  const GridRect region = now.description().extent;
  EXPECT_TRUE(session.next(now, region, Metres{50}).starts_over);
  EXPECT_TRUE(session.next(now, region, Metres{5}).is_increment);
  const Difference same = session.next(now, region, Metres{5});
  EXPECT_FALSE(same.is_increment);
  EXPECT_EQ(same.added.added.vertices.size() + same.removed.size(), 0u);
  const Difference coarser = session.next(now, region, Metres{50});
  EXPECT_EQ(coarser.added.added.vertices.size(), 0u);
}

TEST(Sessions, ForgetWhatIsMoreThanTheyMayRememberAndSaySo) {
  const Made made(74501);
  const Snapshot now = made.now();
  const GridRect region = now.description().extent;
  Session session(0);
  RestrictedQuadtree client;
  for (const double tolerance : {50.0, 5.0, 20.0}) {
    const Difference d = session.next(now, region, Metres{tolerance});
    EXPECT_TRUE(d.starts_over);
    EXPECT_FALSE(d.remembered);
    EXPECT_EQ(session.bytes(), 0u);
    client = apply(client, d);
    EXPECT_EQ(difference(client, now.ask({.region = region, .tolerance = Metres{tolerance}}).quadtree), "");
  }
  Session roomy(1 << 20);
  client = apply({}, roomy.next(now, region, Metres{50}));
  EXPECT_GT(roomy.bytes(), 0u);
  roomy.forget();
  EXPECT_EQ(roomy.bytes(), 0u);
  EXPECT_TRUE(roomy.next(now, region, Metres{5}).starts_over);
  const Difference next = roomy.next(now, region, Metres{1});
  EXPECT_THROW(static_cast<void>(apply(client, next)), Failure) << "the client missed one";
}

TEST(Sessions, StartOverWithAnotherDatabase) {
  const Made one(74502), other(74503);
  Session session(1 << 20);
  RestrictedQuadtree client = apply({}, session.next(one.now(), one.now().description().extent, Metres{5}));
  const Snapshot now = other.now();
  const Difference d = session.next(now, now.description().extent, Metres{1});
  EXPECT_TRUE(d.starts_over);
  EXPECT_EQ(
      difference(apply(client, d), now.ask({.region = now.description().extent, .tolerance = Metres{1}}).quadtree), "");
}

// ---- progressive order ----------------------------------------------------------------------------------

bool is_closed(const RestrictedQuadtree& q) {
  try {
    static_cast<void>(triangulate(q));
    return true;
  } catch (const Failure&) {
    return false;
  }
}

TEST(Progressions, OfAnyPrefixAreQuadtreesThatKeepTheirBounds) {
  for (const std::uint64_t seed : seeds(100, 75000)) {
    const Made made(seed);
    SCOPED_TRACE(made.raster.description);
    const Snapshot now = made.now();
    Random random(seed);
    const GridRect region = random_region(random, made.raster.terrain);
    const RestrictedQuadtree answer =
        now.ask({.region = region, .tolerance = Metres{random_tolerance(random)}}).quadtree;
    const std::vector<double> errors = errors_of(now, answer);
    ASSERT_EQ(errors.size(), answer.vertices.size());
    const Progression plain(answer), ordered(answer, errors);
    double before = kInfinity;
    for (std::size_t step = 0; step < plain.steps(); ++step) {
      const RestrictedQuadtree prefix = plain.prefix(answer, step + 1);
      EXPECT_LE(plain.bound(step).value, before);
      before = plain.bound(step).value;
      const Mesh mesh = triangulate(prefix);
      if (std::isfinite(prefix.bound.value)) {
        const auto report = check_mesh(mesh, made.raster.terrain, now.description().metres_per_unit, prefix.bound.value,
                                       made.raster.judging);
        EXPECT_LE(report.largest_error, prefix.bound.value + (report.exact ? 0 : 1e-9)) << "step " << step;
        EXPECT_EQ(report.uncovered_samples, 0u) << "step " << step;
      }
      EXPECT_EQ(difference(prefix, ordered.prefix(answer, step + 1)), "");
      if (step + 1 < plain.steps() && !ordered.ranks(step + 1).empty()) {
        const auto ranks = ordered.ranks(step + 1);
        EXPECT_TRUE(std::is_sorted(ranks.begin(), ranks.end(), [&](auto a, auto b) { return errors[a] > errors[b]; }));
        const auto more = static_cast<std::size_t>(random.between(0, static_cast<int>(ranks.size())));
        EXPECT_TRUE(is_closed(ordered.prefix(answer, step + 1, more))) << more << " of step " << step + 1;
      }
    }
    EXPECT_EQ(difference(plain.prefix(answer, plain.steps()), answer), "");
    EXPECT_EQ(plain.bound(plain.steps() - 1), answer.bound);
    if (HasFailure()) return;
  }
}

TEST(Progressions, OfLevelsAreAnswersWithALargestLevel) {
  for (const std::uint64_t seed : seeds(60, 76000)) {
    const Made made(seed);
    SCOPED_TRACE(made.raster.description);
    const Snapshot now = made.now();
    Random random(seed);
    const GridRect region = random_region(random, made.raster.terrain);
    const RestrictedQuadtree answer =
        now.ask({.region = region, .tolerance = Metres{random_tolerance(random)}}).quadtree;
    const Progression levels(answer);
    for (std::size_t step = 1; step < levels.steps(); ++step) {
      Question question;
      question.region = region;
      question.tolerance = answer.tolerance;
      question.max_level = static_cast<int>(step) - 1;
      const RestrictedQuadtree asked = now.ask(question).quadtree, prefix = levels.prefix(answer, step + 1);
      ASSERT_EQ(prefix.vertices.size(), asked.vertices.size()) << "step " << step;
      prefix.vertices.for_each([&](GridPoint p) { EXPECT_TRUE(asked.vertices.contains(p)); });
    }
  }
}

TEST(Progressions, OfIncrementsMakeQuadtreesThatKeepTheirBounds) {
  for (const std::uint64_t seed : seeds(60, 78000)) {
    const Made made(seed);
    SCOPED_TRACE(made.raster.description);
    const Snapshot now = made.now();
    Random random(seed);
    const GridRect region = random_region(random, made.raster.terrain);
    const Metres to{random.log_between(0.01, 30)}, from{to.value * random.within(1.1, 20)};
    const RestrictedQuadtree base = now.ask({.region = region, .tolerance = from}).quadtree;
    const Increment increment = increment_of(now.ask({.region = region, .tolerance = to, .from = from}));
    const Progression levels(increment.added);
    for (std::size_t step = 1; step <= levels.steps(); ++step) {
      const RestrictedQuadtree merged = merge(base, {levels.prefix(increment.added, step), from, {}});
      if (step == levels.steps()) {
        EXPECT_EQ(difference(merged, now.ask({.region = region, .tolerance = to}).quadtree), "");
      }
      const auto report = check_mesh(triangulate(merged), made.raster.terrain, now.description().metres_per_unit,
                                     merged.bound.value, made.raster.judging);
      EXPECT_LE(report.largest_error, merged.bound.value + (report.exact ? 0 : 1e-9)) << "step " << step;
      EXPECT_EQ(report.uncovered_samples, 0u) << "step " << step;
    }
    if (HasFailure()) return;
  }
}

TEST(Progressions, OfVertexErrorsSayWhatSelectedThem) {
  for (const std::uint64_t seed : seeds(60, 77000)) {
    const Made made(seed);
    SCOPED_TRACE(made.raster.description);
    const Snapshot now = made.now();
    Random random(seed);
    const GridRect region = random_region(random, made.raster.terrain);
    const double tolerance = random_tolerance(random);
    const RestrictedQuadtree answer = now.ask({.region = region, .tolerance = Metres{tolerance}}).quadtree;
    const std::vector<double> errors = errors_of(now, answer);
    std::set<std::pair<int, int>> forced;
    for (const GridPoint p : border_vertices(region, root_side(now.description().extent))) forced.emplace(p.col, p.row);
    std::size_t i = 0;
    answer.vertices.for_each([&](GridPoint p) {
      EXPECT_TRUE(forced.contains({p.col, p.row}) || errors[i] > tolerance) << errors[i];
      ++i;
    });
  }
}

// ---- real terrain ---------------------------------------------------------------------------------------

TEST(RealIncrements, MergeAndMoveOverSwissGermany) {
  const TempFolder folder;
  const RealModel model = real_model("swiss_germany_3s/swiss_germany.vrt", folder);
  if (!model.file) GTEST_SKIP() << model.why_not;
  ingest(*model.file, folder / "model.talus");
  const Snapshot now = Database::open(folder / "model.talus").snapshot();
  Random random(9);
  const GridRect extent = now.description().extent;
  for (int i = 0; i < 6; ++i) {
    const int col = random.between(0, extent.last.col - 900), row = random.between(0, extent.last.row - 800);
    expect_chain(now, {{col, row}, {col + random.between(100, 900), row + random.between(100, 800)}},
                 {kInfinity, 200, 50, 20, 10, 5, 1, 0});
    if (HasFatalFailure()) return;
  }
  Session session(std::uint64_t{1} << 20);
  RestrictedQuadtree client;
  GridRect window{{1000, 1000}, {1400, 1300}};
  std::uint64_t added = 0, whole = 0;
  for (int i = 0; i < 30; ++i) {
    const double tolerance = i % 7 == 0 ? 10 : i % 7 == 3 ? 40 : 20;
    const Difference d = session.next(now, window, Metres{tolerance});
    expect_minimal(client, d);
    client = apply(client, d);
    const Answer answer = now.ask({.region = window, .tolerance = Metres{tolerance}});
    ASSERT_EQ(difference(client, answer.quadtree), "") << i;
    if (i > 0) added += d.added.added.vertices.size(), whole += answer.quadtree.vertices.size();
    window.first.col += 16, window.last.col += 16, window.first.row += 8, window.last.row += 8;
  }
  std::printf("a moving window is sent %.1f %% of its answers' vertices\n",
              100 * static_cast<double>(added) / static_cast<double>(whole));
}

}  // namespace
}  // namespace talus::support
