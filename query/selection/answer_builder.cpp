#include "query/selection/answer_builder.hpp"

#include <algorithm>
#include <bit>

#include "engine/dense/kernels.hpp"
#include "engine/machine/cpu.hpp"
#include "engine/machine/parallel.hpp"
#include "query/pages/stopwatch.hpp"

namespace talus {
namespace {

/// Writes the heights of a square where their vertices are among those of the mask.
TALUS_INLINE void write_square(const SquareOfAnswer& square, const HeightStep& step, const VertexMask& vertices,
                               std::span<double> heights) {
  const std::int16_t* from = square.numbers;
  for (std::int32_t row = 0; row < kPageSide; ++row) {
    const auto& bits = square.bits[static_cast<std::size_t>(row)];
    if ((bits[0] | bits[1]) == 0) continue;
    const int col = bits[0] != 0 ? std::countr_zero(bits[0]) : 64 + std::countr_zero(bits[1]);
    const int count = std::popcount(bits[0]) + std::popcount(bits[1]);
    double* to = &heights[vertices.rank({square.first.col + col, square.first.row + row})];
    for (int i = 0; i < count; ++i) to[i] = step.value(static_cast<double>(square.base + from[i]));
    from += count;
  }
}
TALUS_POPCNT void write_square_popcnt(const SquareOfAnswer& square, const HeightStep& step, const VertexMask& vertices,
                                      std::span<double> heights) {
  write_square(square, step, vertices, heights);
}

}  // namespace

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
    here.heights[k] = kept_.is_kept(page, i, here.at[k]) ? page.height(i) : kept_.at(here.at[k]);
    if (!page.covers.empty()) here.covers[k] = page.covers[i];
    // The codec decodes some number for a void that no triangle needs. It may lie far outside the range of heights.
    if (!page.covers.empty() && page.covers[i] == 0 && !is_height(here.heights[k])) here.heights[k] = 0;
  }
}

bool AnswerBuilder::is_height(double code) const {
  const Description& d = pages_.manifest().description;
  const double height = d.step.value(code);
  return height >= d.minimum_height && height <= d.maximum_height;
}

void AnswerBuilder::take(const TileSlice& slice, std::span<const std::uint32_t> chosen, std::span<const GridPoint> at) {
  if (chosen.empty()) return;
  OfPage& here = pages_found_.emplace_back(&memory_);
  here.at.assign(at.begin(), at.end());
  here.heights.resize(chosen.size());
  if (!slice.covers.empty()) here.covers.resize(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    here.heights[k] = slice.heights[chosen[k]];
    if (slice.covers.empty()) continue;
    here.covers[k] = slice.covers[chosen[k]];
    if (here.covers[k] == 0 && !is_height(here.heights[k])) here.heights[k] = 0;  // perhaps a void, as above
  }
}

void AnswerBuilder::take(const Page& page, const SquareBits& bits) {
  const std::size_t count = talus::count(bits);
  constexpr std::size_t kWrittenBehind = 32;
  auto* numbers = static_cast<std::int16_t*>(
      memory_.allocate((count + kWrittenBehind) * sizeof(std::int16_t), alignof(std::int16_t)));
  detail::eighths_kernel(instruction_set()).gather(page.squares.front().numbers, bits.data(), numbers);
  squares_found_.push_back({page_square(page.id).first, page.base, bits, numbers});
}

RestrictedQuadtree AnswerBuilder::quadtree(GridRect region, VertexMask vertices) const {
  const Stopwatch gathering(cost_.gathering_seconds);
  std::size_t count = 0;
  for (const OfPage& page : pages_found_) count += page.at.size();
  vertices.seal();
  if (vertices.size() != count) {  // some border vertices lie amid voids, in pages that are not stored
    vertices = VertexMask(vertices.region());
    for (const OfPage& page : pages_found_) {
      for (const GridPoint p : page.at) vertices.insert(p);
    }
  }
  const AnswerBuilder* const self = this;
  return quadtree({&self, 1}, region, std::move(vertices), 1);
}

void AnswerBuilder::write_squares(const VertexMask& vertices, std::span<double> heights) const {
  const HeightStep& step = pages_.manifest().description.step;
  const auto write = has_popcnt() ? write_square_popcnt : write_square;
  for (const SquareOfAnswer& square : squares_found_) write(square, step, vertices, heights);
}

void AnswerBuilder::write_pages(const VertexMask& vertices, RestrictedQuadtree& answer) const {
  const HeightStep& step = pages_.manifest().description.step;
  std::vector<std::uint32_t> ranks;
  for (const OfPage& page : pages_found_) {
    ranks.resize(page.at.size());
    vertices.ranks(page.at, ranks);
    for (std::size_t i = 0; i < ranks.size(); ++i) answer.heights[ranks[i]] = step.value(page.heights[i]);
    for (std::size_t i = 0; !answer.covers.empty() && i < page.covers.size(); ++i)
      answer.covers[ranks[i]] = page.covers[i];
  }
}

RestrictedQuadtree AnswerBuilder::quadtree(std::span<const AnswerBuilder* const> parts, GridRect region,
                                           VertexMask vertices, int threads) {
  RestrictedQuadtree answer;
  answer.region = region;
  bool all_covered = true;
  for (const AnswerBuilder* part : parts) {
    for (const OfPage& page : part->pages_found_)
      all_covered =
          all_covered && std::all_of(page.covers.begin(), page.covers.end(), [](std::uint8_t c) { return c == 15; });
  }
  vertices.seal();
  answer.heights.resize(vertices.size());
  if (!all_covered) answer.covers.resize(vertices.size(), 15);
  // Squares have vertices of coarser bands, too, which pages then write again.
  for_each_task(threads, parts.size(),
                [&](int, std::size_t task) { parts[task]->write_squares(vertices, answer.heights); });
  for_each_task(threads, parts.size(), [&](int, std::size_t task) { parts[task]->write_pages(vertices, answer); });
  answer.vertices = std::move(vertices);
  return answer;
}

}  // namespace talus
