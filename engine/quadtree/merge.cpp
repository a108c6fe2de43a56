#include "engine/quadtree/merge.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"

namespace talus {
namespace {

void require_whole(const RestrictedQuadtree& q) {
  const std::size_t n = q.vertices.size();
  if (q.heights.size() != n || (!q.covers.empty() && q.covers.size() != n))
    refuse("there are {} vertices, {} heights and {} covers: expected one of each", n, q.heights.size(),
           q.covers.size());
}

std::string spelled(GridRect r) {
  return fmt::format("columns {} to {}, rows {} to {}", r.first.col, r.last.col, r.first.row, r.last.row);
}

/// Heights and covers of the members of two sets of one region that have none in common, in the order of both together.
void join(const RestrictedQuadtree& one, const RestrictedQuadtree& other, RestrictedQuadtree& all) {
  std::size_t of_one = 0, of_other = 0, to = 0;
  const auto take = [&](const RestrictedQuadtree& from, std::size_t i) {
    all.heights[to] = from.heights[i];
    if (!from.covers.empty()) all.covers[to] = from.covers[i];
    ++to;
  };
  const GridRect region = one.vertices.region();
  for (std::int32_t row = region.first.row; row <= region.last.row; ++row) {
    const auto in_one = one.vertices.row_words(row), in_other = other.vertices.row_words(row);
    for (std::size_t w = 0; w < in_one.size(); ++w) {
      for (std::uint64_t rest = in_one[w] | in_other[w]; rest != 0; rest &= rest - 1)
        (in_other[w] & rest & -rest) != 0 ? take(other, of_other++) : take(one, of_one++);
    }
  }
}

}  // namespace

RestrictedQuadtree united(const RestrictedQuadtree& kept, std::span<const GridPoint> gone,
                          const RestrictedQuadtree& added) {
  require_whole(kept);
  require_whole(added);
  const GridRect region = added.vertices.region();
  RestrictedQuadtree all;
  all.region = added.region;
  all.tolerance = added.tolerance;
  all.bound = added.bound;
  all.origin = added.origin;
  all.level_errors = added.level_errors;

  VertexMask dropped;
  if (!gone.empty()) dropped = VertexMask(region);
  for (const GridPoint p : gone) {
    if (region.contains(p)) dropped.insert(p);
  }
  const auto stays = [&](GridPoint p) { return region.contains(p) && (gone.empty() || !dropped.contains(p)); };
  VertexMask vertices = added.vertices;
  std::size_t count = added.vertices.size();
  const bool is_joined = gone.empty() && kept.vertices.region() == region;
  if (is_joined) {
    vertices.insert(kept.vertices);
    count += kept.vertices.size();
  } else {
    kept.vertices.for_each([&](GridPoint p) {
      if (stays(p)) vertices.insert(p), ++count;
    });
  }
  vertices.seal();
  if (vertices.size() != count) refuse("a new vertex is already in the answer");

  all.heights.resize(count);
  if (!kept.covers.empty() || !added.covers.empty()) all.covers.assign(count, 15);
  const auto put = [&](const RestrictedQuadtree& from, auto&& wanted) {
    std::size_t i = 0;
    from.vertices.for_each([&](GridPoint p) {
      if (wanted(p)) {
        const std::uint32_t to = vertices.rank(p);
        all.heights[to] = from.heights[i];
        if (!from.covers.empty()) all.covers[to] = from.covers[i];
      }
      ++i;
    });
  };
  if (is_joined) {
    join(kept, added, all);
  } else {
    put(kept, stays);
    put(added, [](GridPoint) { return true; });
  }
  if (std::all_of(all.covers.begin(), all.covers.end(), [](std::uint8_t c) { return c == 15; })) all.covers.clear();
  all.vertices = std::move(vertices);
  return all;
}

void require_fit(const RestrictedQuadtree& answer, const Increment& increment) {
  const RestrictedQuadtree& added = increment.added;
  if (!answer.origin.is_plain) refuse("no increment can follow this answer: ask for a region and a tolerance only");
  if (answer.origin.identity != added.origin.identity || added.origin.identity.content == 0) {
    const Identity &a = answer.origin.identity, &b = added.origin.identity;
    refuse("{}",
           a.generation != b.generation
               ? fmt::format("the increment is from update {} of the database, the answer from update {}: ask again",
                             b.generation, a.generation)
               : fmt::format("the increment is from another database ({:016x}) than the answer ({:016x})", b.content,
                             a.content));
  }
  if (!(answer.region == added.region) || !(answer.vertices.region() == added.vertices.region())) {
    refuse("the region of the increment is {}, that of the answer is {}", spelled(added.region),
           spelled(answer.region));
  }
  if (answer.tolerance != increment.from) {
    refuse("the increment follows an answer at {} m, this one is at {} m", increment.from.value,
           answer.tolerance.value);
  }
  if (answer.origin.quantum != added.origin.quantum) {
    refuse(
        "the heights of the increment are multiples of {} m, those of the answer of {} m (0: exact): ask for both with "
        "the same Heights::quantum",
        added.origin.quantum.value, answer.origin.quantum.value);
  }
  if (answer.level_errors.size() != added.level_errors.size())
    refuse("the increment has {} levels, the answer has {}", added.level_errors.size(), answer.level_errors.size());
}

RestrictedQuadtree merge(const RestrictedQuadtree& answer, const Increment& increment) {
  require_fit(answer, increment);
  const RestrictedQuadtree& added = increment.added;
  RestrictedQuadtree merged = united(answer, {}, added);
  for (std::size_t i = 0; i < merged.level_errors.size(); ++i)
    merged.level_errors[i] = std::max(merged.level_errors[i], answer.level_errors[i]);
  return merged;
}

}  // namespace talus
