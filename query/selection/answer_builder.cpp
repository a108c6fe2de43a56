#include "query/selection/answer_builder.hpp"

#include <algorithm>

#include "engine/machine/parallel.hpp"
#include "query/pages/stopwatch.hpp"

namespace talus {

void AnswerBuilder::take(const Page& page, std::span<const PageSample> samples) {
  if (samples.empty()) return;
  OfPage& here = pages_found_.emplace_back(&memory_);
  here.at.resize(samples.size());
  here.heights.resize(samples.size());
  if (!page.covers.empty()) here.covers.resize(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto [col, row] = samples[k];
    const std::size_t i = page.index(col, row);
    here.at[k] = page.grid.at(col, row);
    here.heights[k] = kept_.is_kept(page, i, here.at[k]) ? page.heights[i] : kept_.at(here.at[k]);
    if (!page.covers.empty()) here.covers[k] = page.covers[i];
    // The codec decodes some number for a void that no triangle needs. It may lie far outside the range of heights.
    if (!page.is_data(i) && !is_height(here.heights[k])) here.heights[k] = 0;
  }
}

bool AnswerBuilder::is_height(double code) const {
  const Description& d = pages_.manifest().description;
  const double height = d.step.value(code);
  return height >= d.minimum_height && height <= d.maximum_height;
}

RestrictedQuadtree AnswerBuilder::quadtree(GridRect region, VertexMask vertices) const {
  const Stopwatch gathering(cost_.gathering_seconds);
  const AnswerBuilder* const self = this;
  return quadtree({&self, 1}, region, std::move(vertices), 1);
}

RestrictedQuadtree AnswerBuilder::quadtree(std::span<const AnswerBuilder* const> parts, GridRect region,
                                           VertexMask vertices, int threads) {
  RestrictedQuadtree answer;
  answer.region = region;
  std::size_t count = 0;
  bool all_covered = true;
  for (const AnswerBuilder* part : parts) {
    for (const OfPage& page : part->pages_found_) {
      count += page.at.size();
      all_covered =
          all_covered && std::all_of(page.covers.begin(), page.covers.end(), [](std::uint8_t c) { return c == 15; });
    }
  }
  vertices.seal();
  if (vertices.size() != count) {  // some border vertices lie amid voids, in pages that are not stored
    vertices = VertexMask(vertices.region());
    for (const AnswerBuilder* part : parts) {
      for (const OfPage& page : part->pages_found_) {
        for (const GridPoint p : page.at) vertices.insert(p);
      }
    }
    vertices.seal();
  }
  answer.heights.resize(count);
  if (!all_covered) answer.covers.resize(count, 15);
  for_each_task(threads, parts.size(), [&](int, std::size_t task) {
    const AnswerBuilder& part = *parts[task];
    const HeightStep& step = part.pages_.manifest().description.step;
    std::vector<std::uint32_t> ranks;
    for (const OfPage& page : part.pages_found_) {
      ranks.resize(page.at.size());
      vertices.ranks(page.at, ranks);
      for (std::size_t i = 0; i < ranks.size(); ++i) answer.heights[ranks[i]] = step.value(page.heights[i]);
      for (std::size_t i = 0; !all_covered && i < page.covers.size(); ++i) answer.covers[ranks[i]] = page.covers[i];
    }
  });
  answer.vertices = std::move(vertices);
  return answer;
}

}  // namespace talus
