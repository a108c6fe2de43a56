// The walk from one spacing to half of it, against loops over all grid points. Held up are the candidates, what is
// expected of each, and the vertices that come out.

#include "engine/stream/level_walk.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/random_answers.hpp"

namespace talus::support {
namespace {

// ---- arithmetic ------------------------------------------------------------------------------------------

template <class Code, class Wide>
void expect_wrapping_arithmetic() {
  using Limits = std::numeric_limits<Code>;
  Random random(1);
  for (int time = 0; time < 20000; ++time) {
    const auto any = [&] {
      if (random.chance(0.1)) return random.chance(0.5) ? Limits::min() : Limits::max();
      return static_cast<Code>(static_cast<Code>(random.next()) >> random.between(0, 8 * int{sizeof(Code)} - 1));
    };
    const Code a = any(), b = any();
    const Wide sum = static_cast<Wide>(a) + b;
    EXPECT_EQ(halfway(a, b), static_cast<Code>((sum - (sum % 2 != 0 && sum < 0 ? 1 : 0)) / 2)) << "rounded down";
    EXPECT_EQ(wrapped_sum(a, b), static_cast<Code>(sum));
    EXPECT_EQ(wrapped_difference(a, b), static_cast<Code>(static_cast<Wide>(a) - b));
    EXPECT_EQ(wrapped_sum(b, wrapped_difference(a, b)), a);
  }
}

TEST(LevelWalk, ArithmeticOfCodesWrapsAndNeverOverflows) {
  expect_wrapping_arithmetic<std::int32_t, std::int64_t>();
  __extension__ typedef __int128 Int128;
  expect_wrapping_arithmetic<std::int64_t, Int128>();
}

/// Eighths of a tolerance, of a residual or its complement where it is negative.
std::uint8_t plain_size(double residual, double tolerance) {
  const double size = (residual < 0 ? -residual - 1 : residual) * 8 / std::clamp(tolerance, 1.0, 1e9);
  return static_cast<std::uint8_t>(std::min(255.0, std::floor(size)));
}

TEST(LevelWalk, SizesAreEighthsOfTheToleranceAsFarAsAByteGoes) {
  for (const double tolerance : {0.0, 0.5, 1.0, 2.0, 64.0, 4096.0}) {
    const Scale scale(tolerance);
    for (const std::int32_t r : {0, 1, -1, -2, 7, 8, -9, 31, 32, 300, -5000, 1 << 20, -(1 << 20)}) {
      EXPECT_EQ(scale.of(r), plain_size(r, tolerance)) << r << " of " << tolerance;
      EXPECT_EQ(scale.of(std::int64_t{r}), plain_size(r, tolerance));
    }
    EXPECT_EQ(scale.of(std::numeric_limits<std::int64_t>::min()), 255);
    EXPECT_EQ(scale.of(std::numeric_limits<std::int32_t>::max()), 255);
  }
  EXPECT_EQ(Scale(1e300).factor(), Scale(1e9).factor());
}

/// Larger residuals around, larger contexts: the thresholds of docs/format/rqt-v1.md, section 5.
int plain_context(int kind, int sizes, int distance) {
  const int energy = sizes < 9 ? 0 : sizes < 16 ? 1 : sizes < 28 ? 2 : 3;
  const int apart = distance < 2 ? 0 : distance < 5 ? 1 : distance < 9 ? 2 : 3;
  return kind * 16 + energy * 4 + apart;
}

template <class Code>
void expect_expectations() {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto n = static_cast<std::size_t>(random.between(0, 150));
    const int kind = random.between(0, 1);
    const double tolerance = std::ldexp(1, random.between(0, 8));
    const Scale scale(tolerance);
    const auto codes = [&] {
      std::vector<Code> all(n);
      for (Code& c : all) c = static_cast<Code>(random.between(-3000, 3000));
      return all;
    };
    const auto small = [&] {
      std::vector<std::uint8_t> all(n);
      for (auto& c : all) c = static_cast<std::uint8_t>(random.between(0, random.chance(0.1) ? 255 : 20));
      return all;
    };
    const std::vector<Code> end1 = codes(), end2 = codes(), beside1 = codes(), beside2 = codes(), residuals = codes();
    const std::vector<std::uint8_t> size1 = small(), size2 = small();
    std::vector<Code> predicted(n), flips(n), heights(n);
    std::vector<std::uint8_t> contexts(n), sizes(n);
    expect_all({n, end1.data(), end2.data(), beside1.data(), beside2.data(), size1.data(), size2.data(),
                predicted.data(), flips.data(), contexts.data()},
               scale.factor(), kind);
    settle_all(n, predicted.data(), flips.data(), residuals.data(), scale.factor(), heights.data(), sizes.data());
    for (std::size_t i = 0; i < n; ++i) {
      const double middle = std::floor((static_cast<double>(end1[i]) + static_cast<double>(end2[i])) / 2),
                   beside = std::floor((static_cast<double>(beside1[i]) + static_cast<double>(beside2[i])) / 2);
      ASSERT_EQ(static_cast<double>(predicted[i]), middle);
      ASSERT_EQ(flips[i], beside < middle ? Code{-1} : Code{0}) << "where those beside are lower, rather less";
      ASSERT_EQ(contexts[i], plain_context(kind, size1[i] + size2[i], plain_size(beside - middle, tolerance)));
      const Code told = flips[i] == 0 ? residuals[i] : static_cast<Code>(-residuals[i] - 1);
      ASSERT_EQ(heights[i], predicted[i] + told);
      ASSERT_EQ(sizes[i], plain_size(static_cast<double>(residuals[i]), tolerance));
    }
  }
}

TEST(LevelWalk, ManyExpectationsAtOnceAreThoseOfOneAfterTheOther) {
  expect_expectations<std::int32_t>();
  expect_expectations<std::int64_t>();
}

// ---- the walk --------------------------------------------------------------------------------------------

struct Vertex {
  std::int64_t code;
  int size;
};
using Vertices = std::map<Point, Vertex>;  ///< those that are known so far

/// A candidate as the header describes it.
struct Candidate {
  GridPoint point;
  bool is_strict;
  std::int64_t predicted;
  int flip, context;
};

class PlainWalk {
 public:
  PlainWalk(GridRect window, const Vertices& before, double tolerance, bool has_loose)
      : window_(window), before_(before), tolerance_(tolerance), has_loose_(has_loose) {}

  /// Nothing, if p is none.
  [[nodiscard]] std::optional<Candidate> candidate(GridPoint p) const {
    const Diamond d = diamond(p);
    const int kind = is_centre(p) ? 0 : 1;
    const bool one = has(d.apexes[0]), two = has(d.apexes[1]);
    const bool have_ends = has(d.ends[0]) && has(d.ends[1]);
    // A side midpoint on the window's side has one triangle there; a centre has its two.
    const auto is_beyond = [&](GridPoint apex) {
      if (kind == 0) return false;
      return (p.row == window_.first.row && apex.row < p.row) || (p.row == window_.last.row && apex.row > p.row) ||
             (p.col == window_.first.col && apex.col < p.col) || (p.col == window_.last.col && apex.col > p.col);
    };
    if (have_ends && (one || two) && (one || is_beyond(d.apexes[0])) && (two || is_beyond(d.apexes[1])))
      return strict(p, d, kind);
    if (has_loose_ && (one || two)) return loose(p, d, kind);
    return std::nullopt;
  }
  /// The size that stands for the residual of a vertex which is known beforehand.
  [[nodiscard]] int size_of_known(GridPoint p, std::int64_t code) const {
    const Diamond d = diamond(p);
    if (!has(d.ends[0]) || !has(d.ends[1])) return 8;
    return plain_size(static_cast<double>(code - middle(at(d.ends[0]).code, at(d.ends[1]).code)), tolerance_);
  }

 private:
  [[nodiscard]] bool has(GridPoint p) const { return before_.contains(key(p)); }
  [[nodiscard]] const Vertex& at(GridPoint p) const { return before_.at(key(p)); }
  static std::int64_t middle(std::int64_t a, std::int64_t b) { return (a + b) >> 1; }

  [[nodiscard]] Candidate strict(GridPoint p, const Diamond& d, int kind) const {
    const std::int64_t predicted = middle(at(d.ends[0]).code, at(d.ends[1]).code);
    const Vertex &a = at(has(d.apexes[0]) ? d.apexes[0] : d.apexes[1]),
                 &b = at(has(d.apexes[1]) ? d.apexes[1] : d.apexes[0]);
    const std::int64_t apart = middle(a.code, b.code) - predicted;
    const int distance = plain_size(static_cast<double>(apart), tolerance_);
    return {p, true, predicted, apart < 0 ? -1 : 0, plain_context(kind, a.size + b.size, distance)};
  }
  [[nodiscard]] Candidate loose(GridPoint p, const Diamond& d, int kind) const {
    std::int64_t predicted = 0;
    for (const auto& pair : {d.apexes, d.ends}) {
      if (has(pair[0]) && has(pair[1])) {
        predicted = middle(at(pair[0]).code, at(pair[1]).code);
      } else if (has(pair[0]) || has(pair[1])) {
        predicted = at(has(pair[0]) ? pair[0] : pair[1]).code;
      }
    }
    return {p, false, predicted, 0, kStrictContexts + kind};
  }
  GridRect window_;
  const Vertices& before_;
  double tolerance_;
  bool has_loose_;
};

/// An answer whose vertices need not be a closed set where there are gaps, with codes for heights.
struct Walked {
  GridRect window;
  std::map<Point, std::int64_t> codes;
  bool has_loose;
  double tolerance;
  int root = 0;
};
Walked random_walked(Random& random) {
  Walked w;
  w.window = random_rect(random, random.chance(0.3) ? 150 : 40);
  if (random.chance(0.1)) w.window.last.row = w.window.first.row;  // a line has no triangles
  if (random.chance(0.1)) w.window.last.col = w.window.first.col;
  const RestrictedQuadtree answer = random_answer(random, w.window, random.between(0, 300));
  w.has_loose = random.chance(0.5);
  answer.vertices.for_each([&](GridPoint p) {
    if (!w.has_loose || random.chance(0.9)) w.codes[key(p)] = random.between(-2000, 2000);
  });
  w.tolerance = std::ldexp(1, random.between(0, 8));
  while (std::int32_t{1} << w.root < root_side(w.window)) ++w.root;
  return w;
}

template <class Code>
LevelVertices<Code> as_level(const Walked& w, const Vertices& vertices, int shift) {
  LevelVertices<Code> level;
  level.bits = BitLattice(w.window, shift);
  level.row_start = {0};
  for (std::int32_t j = 0; j < level.bits.rows; ++j) {
    for (std::int32_t i = 0; i < level.bits.cols; ++i) {
      const auto found = vertices.find(key(level.bits.at(i, j)));
      if (found == vertices.end()) continue;
      level.bits.insert(level.bits.at(i, j));
      level.heights.push_back(static_cast<Code>(found->second.code));
      level.sizes.push_back(static_cast<std::uint8_t>(found->second.size));
    }
    level.row_start.push_back(level.heights.size());
  }
  return level;
}

template <class Code>
void expect_level(const LevelVertices<Code>& level, const Vertices& expected) {
  std::size_t next = 0;
  for (std::int32_t j = 0; j < level.bits.rows; ++j) {
    ASSERT_EQ(level.row_start[static_cast<std::size_t>(j)], next);
    for (std::int32_t i = 0; i < level.bits.cols; ++i) {
      const GridPoint p = level.bits.at(i, j);
      const auto found = expected.find(key(p));
      ASSERT_EQ(level.bits.contains(i, j), found != expected.end()) << name_of(p);
      if (found == expected.end()) continue;
      ASSERT_EQ(level.heights[next], found->second.code) << name_of(p);
      ASSERT_EQ(level.sizes[next], found->second.size) << name_of(p);
      ++next;
    }
  }
  ASSERT_EQ(level.heights.size(), next);
}

/// One half of a level: the candidates of all rows are the plain ones, in their order, and the coder tells what they
/// are. Adds the vertices of the half to `vertices`.
template <class Code>
void walk_half(LevelWalk<Code>& walk, const Walked& w, int shift, bool centres, Vertices& vertices, Random& random) {
  const PlainWalk plain(w.window, vertices, w.tolerance, w.has_loose);
  const BitLattice lattice(w.window, shift);
  KnownVertices<Code> known;
  std::vector<std::vector<Candidate>> expected(static_cast<std::size_t>(lattice.rows));
  Vertices found;
  for (std::int32_t j = 0; j < lattice.rows; ++j) {
    std::vector<Candidate> strict, loose;
    for (std::int32_t i = 0; i < lattice.cols; ++i) {
      const GridPoint p = lattice.at(i, j);
      if (spacing(p) != std::int32_t{1} << shift || is_centre(p) != centres) continue;
      const auto candidate = plain.candidate(p);
      const auto vertex = w.codes.find(key(p));
      const bool is_vertex = vertex != w.codes.end();
      if (is_vertex && (!candidate || random.chance(0.1))) {
        known.points.push_back(p);
        known.heights.push_back(static_cast<Code>(vertex->second));
        found[key(p)] = {vertex->second, plain.size_of_known(p, vertex->second)};
      } else if (candidate) {
        (candidate->is_strict ? strict : loose).push_back(*candidate);
        if (!is_vertex) continue;
        const std::int64_t residual = vertex->second - candidate->predicted;
        const std::int64_t told = candidate->flip == 0 ? residual : -residual - 1;
        found[key(p)] = {vertex->second, plain_size(static_cast<double>(told), w.tolerance)};
      }
    }
    strict.insert(strict.end(), loose.begin(), loose.end());
    expected[static_cast<std::size_t>(j)] = std::move(strict);
  }
  std::size_t candidates = 0;
  const auto coder = [&](CandidateRow<Code>& row) {
    const auto& wanted = expected[static_cast<std::size_t>(row.row)];
    ASSERT_EQ(row.count, wanted.size()) << "row " << row.row << (centres ? " of centres" : " of sides");
    candidates += row.count;
    for (std::size_t k = 0; k < row.count; ++k) {
      const Candidate& c = wanted[k];
      ASSERT_EQ(lattice.at(static_cast<std::int32_t>(row.columns[k]), row.row), c.point);
      ASSERT_EQ(row.predicted[k], c.predicted) << name_of(c.point);
      ASSERT_EQ(row.flips[k], c.flip) << name_of(c.point);
      ASSERT_EQ(row.contexts[k], c.context) << name_of(c.point);
      const auto vertex = w.codes.find(key(c.point));
      row.present[k] = vertex != w.codes.end() ? 1 : 0;
      row.residuals[k] = 0;
      if (row.present[k] != 0)
        row.residuals[k] = static_cast<Code>((vertex->second - c.predicted) ^ std::int64_t{row.flips[k]});
    }
  };
  // In stripes of any rows.
  std::vector<typename LevelWalk<Code>::WalkedRows> parts;
  for (std::int32_t first = 0; first < walk.rows();) {
    const std::int32_t last = random.between(first + 1, walk.rows());
    parts.push_back(centres ? walk.centres(first, last, known, coder) : walk.sides(first, last, known, coder));
    first = last;
  }
  if (parts.empty()) parts.push_back(centres ? walk.centres(0, 0, known, coder) : walk.sides(0, 0, known, coder));
  centres ? walk.take_centres(std::move(parts)) : walk.take_all(std::move(parts));
  std::size_t wanted = 0;
  for (const auto& row : expected) wanted += row.size();
  EXPECT_EQ(candidates, wanted);
  vertices.insert(found.begin(), found.end());
}

template <class Code>
void expect_walks(std::uint64_t seeds) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Walked w = random_walked(random);
    Vertices vertices;
    for (const auto& [p, code] : w.codes) {
      if (spacing(point(p)) >= std::int32_t{1} << w.root) vertices[p] = {code, 8};
    }
    LevelVertices<Code> level = as_level<Code>(w, vertices, w.root);
    for (int shift = w.root - 1; shift >= 0; --shift) {
      SCOPED_TRACE(shift);
      LevelWalk<Code> walk(w.window, level, Scale(w.tolerance), w.has_loose, w.codes.size());
      walk_half(walk, w, shift, true, vertices, random);
      if (::testing::Test::HasFailure()) return;
      walk_half(walk, w, shift, false, vertices, random);
      if (::testing::Test::HasFailure()) return;
      level = walk.take_vertices();
      expect_level(level, vertices);
      if (::testing::Test::HasFailure()) return;
    }
    EXPECT_EQ(vertices.size(), w.codes.size());
  }
}

TEST(LevelWalk, CandidatesAndVerticesAreThoseOfPlainLoops) { expect_walks<std::int32_t>(120); }
TEST(LevelWalk, WideCandidatesAndVerticesAreThoseOfPlainLoops) { expect_walks<std::int64_t>(40); }

TEST(LevelWalk, MoreVerticesThanTheHeaderSaysAreCorrupt) {
  const GridRect window{{0, 0}, {64, 64}};
  Walked w{window, {}, false, 1, 7};
  for_each_point(window, [&](GridPoint p) {
    if (spacing(p) >= 8) w.codes[key(p)] = 0;
  });
  Vertices vertices;
  for (const auto& [p, code] : w.codes) vertices[p] = {code, 8};
  const LevelVertices<std::int32_t> coarse = as_level<std::int32_t>(w, vertices, 3);
  const auto all = [](CandidateRow<std::int32_t>& row) {
    std::fill_n(row.present, row.count, std::uint8_t{1});
    std::fill_n(row.residuals, row.count, 0);
  };
  for (const std::size_t most : {std::size_t{64}, std::size_t{63}}) {
    LevelWalk<std::int32_t> walk(window, coarse, Scale(1), false, most);
    try {
      static_cast<void>(walk.centres(0, walk.rows(), {}, all));
      EXPECT_EQ(most, 64u);
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::corrupt);
      EXPECT_EQ(most, 63u) << "there are 8 x 8 centres";
    }
  }
}

}  // namespace
}  // namespace talus::support
