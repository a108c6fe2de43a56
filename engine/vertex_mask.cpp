#include <algorithm>
#include <limits>

#include "talus/failure.hpp"
#include "talus/quadtree.hpp"

namespace talus {

VertexMask::VertexMask(GridRect region)
    : region_(region), words_per_row_((static_cast<std::size_t>(region.cols()) + 63) / 64),
      words_(words_per_row_ * static_cast<std::size_t>(region.rows())) {}

void VertexMask::seal() {
  before_.resize(words_.size());
  std::size_t count = 0;
  for (std::size_t w = 0; w < words_.size(); ++w) {
    before_[w] = static_cast<std::uint32_t>(count);
    count += static_cast<std::size_t>(std::popcount(words_[w]));
  }
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    throw Failure(Cause::invalid_argument, "the answer has more than 4294967295 vertices; ask for a smaller rectangle or a larger tolerance");
  }
  size_ = count;
}

}  // namespace talus
