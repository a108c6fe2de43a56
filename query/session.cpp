#include "talus/session.hpp"

#include <utility>

#include "engine/machine/fail.hpp"
#include "engine/quadtree/merge.hpp"
#include "query/pages/watch.hpp"
#include "query/selection/refusals.hpp"
#include "query/snapshot_view.hpp"

namespace talus {
namespace {

/// The part of an answer whose vertices are not in a mask.
RestrictedQuadtree without(const RestrictedQuadtree& answer, const VertexMask& had) {
  RestrictedQuadtree rest = answer;
  rest.vertices = VertexMask(answer.vertices.region());
  rest.heights.clear();
  rest.covers.clear();
  std::size_t i = 0;
  answer.vertices.for_each([&](GridPoint p) {
    if (!had.region().contains(p) || !had.contains(p)) {
      rest.vertices.insert(p);
      rest.heights.push_back(answer.heights[i]);
      if (!answer.covers.empty()) rest.covers.push_back(answer.covers[i]);
    }
    ++i;
  });
  rest.vertices.seal();
  return rest;
}

}  // namespace

std::uint64_t Session::bytes() const { return knows_ ? bytes_of_mask(vertices_.region()) : 0; }

void Session::forget() {
  knows_ = false;
  vertices_ = VertexMask();
}

Difference Session::next(const Snapshot& now, GridRect region, Metres tolerance) {
  require_inside(pages_of(now), region);
  Difference difference;
  const bool same_state = knows_ && origin_.identity == pages_of(now).identity();
  difference.starts_over = !same_state;
  if (same_state) {
    difference.region_before = vertices_.region();
    difference.added.from = tolerance_;
  }
  VertexMask has;
  if (same_state && region == vertices_.region() && tolerance < tolerance_) {
    difference.is_increment = true;
    difference.added = increment_of(now.ask({.region = region, .tolerance = tolerance, .from = tolerance_}));
    has = std::move(vertices_);
    has.insert(difference.added.added.vertices);
  } else {
    Answer answer = now.ask({.region = region, .tolerance = tolerance});
    difference.added.cost = answer.cost;
    if (same_state) {
      difference.added.added = without(answer.quadtree, vertices_);
      vertices_.for_each([&](GridPoint p) {
        if (region.contains(p) && !answer.quadtree.vertices.contains(p)) difference.removed.push_back(p);
      });
      has = std::move(answer.quadtree.vertices);
    } else {
      has = answer.quadtree.vertices;
      difference.added.added = std::move(answer.quadtree);
    }
  }
  difference.remembered = bytes_of_mask(region) <= most_bytes_;
  if (!difference.remembered) {
    forget();
    return difference;
  }
  knows_ = true;
  origin_ = difference.added.added.origin;
  tolerance_ = tolerance;
  vertices_ = std::move(has);
  return difference;
}

RestrictedQuadtree apply(const RestrictedQuadtree& client, const Difference& difference) {
  const RestrictedQuadtree& added = difference.added.added;
  if (difference.starts_over) return added;
  if (client.origin != added.origin || !(client.region == difference.region_before) ||
      client.tolerance != difference.added.from) {
    refuse(
        "the difference continues an answer at {} m, but the client has another answer, at {} m: call Session::forget "
        "and ask again",
        difference.added.from.value, client.tolerance.value);
  }
  return difference.is_increment ? merge(client, difference.added) : united(client, difference.removed, added);
}

}  // namespace talus
