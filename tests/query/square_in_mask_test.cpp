// The bits of a square in the mask of an answer.

#include "query/selection/square_in_mask.hpp"

#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

TEST(SquaresInMasks, GoInAndComeOutWhereverTheSquareMeetsTheRegion) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridPoint from{random.between(-300, 300), random.between(-300, 300)};
    const GridRect region{from, {from.col + random.between(0, 400), from.row + random.between(0, 300)}};
    const GridPoint first{128 * random.between(-3, 4), 128 * random.between(-3, 4)};
    const bool shared = random.chance(0.5);
    VertexMask mask(region);
    std::set<std::pair<int, int>> before, in_square;
    for (int i = 0; i < 500; ++i) {  // of other pages
      const GridPoint p{random.between(region.first.col, region.last.col),
                        random.between(region.first.row, region.last.row)};
      mask.insert(p);
      before.insert({p.row, p.col});
    }
    SquareBits bits{};
    for (int i = 0; i < 2000; ++i) {
      const GridPoint p{first.col + random.between(0, 127), first.row + random.between(0, 127)};
      if (!region.contains(p)) continue;
      insert(bits, p.col - first.col, p.row - first.row);
      before.insert({p.row, p.col});
    }
    insert_square(bits, first, shared, mask);
    std::set<std::pair<int, int>> after;
    mask.for_each([&](GridPoint p) { after.insert({p.row, p.col}); });
    ASSERT_EQ(after, before);

    const SquareBits back = square_of(mask, first, shared);
    for (const auto& [row, col] : before) {
      if (col >= first.col && col < first.col + 128 && row >= first.row && row < first.row + 128)
        in_square.insert({row, col});
    }
    std::set<std::pair<int, int>> found;
    for_each_bit(back, [&](int col, int row) { found.insert({first.row + row, first.col + col}); });
    ASSERT_EQ(found, in_square);
  }
}

}  // namespace
}  // namespace talus::support
