// Answers of different detail that share sides: they meet in the same vertices, and each keeps its own promise.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "talus/talus.hpp"
#include "tests/support/asked.hpp"

namespace talus::support {
namespace {

/// Cuts a rectangle into patches of any thinness, side by side, until there are enough. Along most lines the border
/// needs every sample or every other; along multiples of 16 there is more to match.
std::vector<GridRect> random_patches(Random& random, GridRect whole, std::size_t count) {
  std::vector<GridRect> patches{whole};
  const auto line = [&](int first, int last) {
    const int at = random.between(first + 1, last - 1), rounded = at & -16;
    return rounded > first && random.chance(0.6) ? rounded : at;
  };
  for (int tries = 0; patches.size() < count && tries < 40; ++tries) {
    const auto i = static_cast<std::size_t>(random.between(0, static_cast<int>(patches.size()) - 1));
    GridRect one = patches[i], other = one;
    if (random.chance(0.5)) {
      if (one.cols() < 3) continue;
      one.last.col = other.first.col = line(one.first.col, one.last.col);
    } else {
      if (one.rows() < 3) continue;
      one.last.row = other.first.row = line(one.first.row, one.last.row);
    }
    patches[i] = one;
    patches.push_back(other);
  }
  return patches;
}

/// All patches as one mesh, which no judge could tell from one that was made in one piece.
void expect_one_piece(const Asked& asked, const std::vector<Mesh>& meshes, GridRect whole, double largest_bound,
                      const std::string& name) {
  Mesh all = meshes.front();
  for (std::size_t i = 1; i < meshes.size(); ++i) all = join(all, meshes[i], whole);
  all.region = whole;
  const OracleReport report = check_mesh(all, asked.raster.terrain, asked.now->description().metres_per_unit,
                                         largest_bound, asked.raster.judging);
  EXPECT_TRUE(report.sound()) << name << ": " << report.summary();
}

bool has_voids(const Asked& asked) {
  const auto& valid = asked.raster.terrain.valid;
  return std::find(valid.begin(), valid.end(), 0) != valid.end();
}

/// On a line where one ends and the other begins, each has the other's vertices.
void expect_shared(const RestrictedQuadtree& one, const RestrictedQuadtree& other) {
  const GridRect &a = one.region, &b = other.region;
  if (a.last.col != b.first.col && a.last.row != b.first.row) return;
  one.vertices.for_each([&](GridPoint p) {
    if (b.contains(p)) {
      EXPECT_TRUE(other.vertices.contains(p)) << p.col << ',' << p.row;
    }
  });
  other.vertices.for_each([&](GridPoint p) {
    if (a.contains(p)) {
      EXPECT_TRUE(one.vertices.contains(p)) << p.col << ',' << p.row;
    }
  });
}

TEST(Matching, PatchesOfOneCallMeetAtAnyTolerances) {
  for_rasters(150, [](Asked& asked) {
    const GridRect whole = random_region(asked.random, asked.raster.terrain);
    if (whole.cols() < 2 || whole.rows() < 2) return;
    // Triangles that mix data and void end where their tolerance says: beside voids patches of several tolerances share
    // the vertices of their sides, but not all triangles on either side of them.
    const double tolerance = random_tolerance(asked.random);
    const bool one_tolerance = has_voids(asked) && asked.random.chance(0.5);
    std::vector<Question> patches;
    for (const GridRect& region :
         random_patches(asked.random, whole, static_cast<std::size_t>(asked.random.between(2, 9)))) {
      Question& q = patches.emplace_back();
      q.region = region;
      q.tolerance = Metres{one_tolerance ? tolerance : random_tolerance(asked.random)};
      if (asked.random.chance(0.2)) q.points.push_back(region.first);
    }
    const std::vector<Answer> answers = asked.now->ask_together(patches);
    std::vector<Mesh> meshes;
    double largest = 0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      asked.expect_sound(patches[i], answers[i]);
      EXPECT_TRUE(answers[i].unmatched.empty());
      // All that the patch has by itself, it has here.
      const Answer alone = asked.now->ask({.region = patches[i].region, .tolerance = patches[i].tolerance});
      alone.quadtree.vertices.for_each(
          [&](GridPoint p) { EXPECT_TRUE(answers[i].quadtree.vertices.contains(p)) << asked.name(patches[i]); });
      largest = std::max(largest, answers[i].quadtree.bound.value);
      meshes.push_back(triangulate(answers[i].quadtree));
    }
    for (std::size_t i = 0; i < patches.size(); ++i) {
      for (std::size_t k = 0; k < patches.size(); ++k) expect_shared(answers[i].quadtree, answers[k].quadtree);
    }
    if (one_tolerance || !has_voids(asked)) expect_one_piece(asked, meshes, whole, largest, asked.name(patches[0]));
  });
}

TEST(Matching, ACoarserAnswerTakesAFinerNeighboursVertices) {
  int differing = 0;
  for_rasters(150,
              [&](Asked& asked) {
                if (has_voids(asked)) return;
                const GridRect whole = random_region(asked.random, asked.raster.terrain);
                const auto patches = random_patches(asked.random, whole, 2);
                if (patches.size() < 2 || whole.cols() < 2 || whole.rows() < 2) return;
                const double a = asked.random.chance(0.5) ? 0 : random_tolerance(asked.random);
                const double b = asked.random.chance(0.5) ? HUGE_VAL : random_tolerance(asked.random);
                const Answer fine = asked.now->ask({.region = patches[0], .tolerance = Metres{std::min(a, b)}});
                Question q;
                q.region = patches[1];
                q.tolerance = Metres{std::max(a, b)};
                q.neighbours = {&fine.quadtree};
                const Answer coarse = asked.now->ask(q);
                asked.expect_sound(q, coarse);
                const Answer alone = asked.now->ask({.region = q.region, .tolerance = q.tolerance});
                EXPECT_EQ(coarse.quadtree.vertices.size(), alone.quadtree.vertices.size() + coarse.matching_vertices)
                    << asked.name(q);
                differing += coarse.matching_vertices > 0 ? 1 : 0;
                const double bound = std::max(fine.quadtree.bound.value, coarse.quadtree.bound.value);
                if (coarse.unmatched.empty())
                  return expect_one_piece(asked, {triangulate(fine.quadtree), triangulate(coarse.quadtree)}, whole,
                                          bound, asked.name(q));
                // A thin answer's vertices on its far side may reach the near one. Then the neighbour takes those in
                // its turn.
                Question back;
                back.region = patches[0];
                back.tolerance = Metres{std::min(a, b)};
                back.neighbours = {&coarse.quadtree};
                const Answer again = asked.now->ask(back);
                EXPECT_TRUE(again.unmatched.empty());
                expect_one_piece(asked, {triangulate(again.quadtree), triangulate(coarse.quadtree)}, whole, bound,
                                 asked.name(q));
              },
              {70, 50, 200, 150});
  EXPECT_GE(differing, property_cases(20) / 2);
}

TEST(Matching, AFinerAnswerSaysWhatItsNeighbourLacks) {
  int found = 0;
  for_rasters(100,
              [&](Asked& asked) {
                if (has_voids(asked)) return;
                const GridRect whole = random_region(asked.random, asked.raster.terrain);
                const auto patches = random_patches(asked.random, whole, 2);
                if (patches.size() < 2 || whole.cols() < 2 || whole.rows() < 2) return;
                const Answer coarse = asked.now->ask({.region = patches[0], .tolerance = Metres{1e9}});
                Question q;
                q.region = patches[1];
                q.tolerance = Metres{0};
                q.neighbours = {&coarse.quadtree};
                const Answer fine = asked.now->ask(q);
                std::vector<GridPoint> lacks;
                fine.quadtree.vertices.for_each([&](GridPoint p) {
                  if (patches[0].contains(p) && !coarse.quadtree.vertices.contains(p)) lacks.push_back(p);
                });
                EXPECT_EQ(fine.unmatched, lacks) << asked.name(q);
                found += lacks.empty() ? 0 : 1;
              },
              {70, 50, 200, 150});
  EXPECT_GE(found, property_cases(20) / 2);
}

TEST(Matching, WhatCannotMeetIsRefused) {
  Asked one(1, {40, 40, 60, 60}), other(2, {40, 40, 60, 60});
  const GridRect left{{0, 0}, {20, 30}}, right{{20, 0}, {39, 30}};
  const Answer answer = one.now->ask({.region = left, .tolerance = Metres{1}});
  const auto refused = [&](const Asked& where, GridRect region, const RestrictedQuadtree& neighbour, Border border) {
    Question q;
    q.region = region;
    q.border = border;
    q.neighbours = {&neighbour};
    EXPECT_THROW(static_cast<void>(where.now->ask(q)), Failure);
  };
  refused(other, right, answer.quadtree, Border::constrain);
  refused(one, {{21, 0}, {39, 30}}, answer.quadtree, Border::constrain);
  refused(one, {{20, 30}, {39, 35}}, answer.quadtree, Border::constrain);  // a corner is no side
  refused(one, right, answer.quadtree, Border::cover);
  Question cover;
  cover.region = left;
  cover.border = Border::cover;
  refused(one, right, one.now->ask(cover).quadtree, Border::constrain);
  RestrictedQuadtree broken = answer.quadtree;
  broken.region.last.col += 5;
  refused(one, {{25, 0}, {39, 30}}, broken, Border::constrain);
  EXPECT_THROW(static_cast<void>(one.now->ask_together(std::vector<Question>{cover})), Failure);
  EXPECT_TRUE(one.now->ask_together({}).empty());
}

}  // namespace
}  // namespace talus::support
