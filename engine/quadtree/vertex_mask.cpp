#include <limits>

#include "engine/machine/cpu.hpp"
#include "engine/machine/fail.hpp"
#include "talus/quadtree.hpp"

namespace talus {

VertexMask::VertexMask(GridRect region)
    : region_(region),
      words_per_row_((static_cast<std::size_t>(region.cols()) + 63) / 64),
      words_(words_per_row_ * static_cast<std::size_t>(region.rows())) {}

namespace {

TALUS_INLINE void ranks_of(const VertexMask& mask, std::span<const GridPoint> points, std::span<std::uint32_t> out) {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = mask.rank(points[i]);
}
TALUS_POPCNT void ranks_popcnt(const VertexMask& mask, std::span<const GridPoint> points,
                               std::span<std::uint32_t> out) {
  ranks_of(mask, points, out);
}

TALUS_INLINE std::size_t count_before(std::span<const std::uint64_t> words, std::span<std::uint32_t> before) {
  std::size_t count = 0;
  for (std::size_t w = 0; w < words.size(); ++w) {
    before[w] = static_cast<std::uint32_t>(count);
    count += static_cast<std::size_t>(std::popcount(words[w]));
  }
  return count;
}
TALUS_POPCNT std::size_t count_before_popcnt(std::span<const std::uint64_t> words, std::span<std::uint32_t> before) {
  return count_before(words, before);
}

}  // namespace

void VertexMask::ranks(std::span<const GridPoint> points, std::span<std::uint32_t> out) const {
  has_popcnt() ? ranks_popcnt(*this, points, out) : ranks_of(*this, points, out);
}

void VertexMask::insert(const VertexMask& other) {
  if (!(other.region_ == region_)) refuse("the two sets of vertices are of different regions");
  for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= other.words_[w];
}

void VertexMask::seal() {
  before_.resize(words_.size());
  const std::size_t count = has_popcnt() ? count_before_popcnt(words_, before_) : count_before(words_, before_);
  if (count > std::numeric_limits<std::uint32_t>::max())
    refuse("the answer has more than 4294967295 vertices: ask for a smaller rectangle or a larger tolerance");
  size_ = count;
}

}  // namespace talus
