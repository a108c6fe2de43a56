// Multiples of one spacing in a window, a bit each, against loops over all grid points.

#include "engine/stream/bit_lattice.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/closed_sets.hpp"
#include "tests/engine/random_answers.hpp"

namespace talus::support {
namespace {

TEST(BitLattice, HasAPlaceForEachMultipleInItsWindowAndForNothingElse) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridPoint first{random.between(-300, 300), random.between(-300, 300)};
    const GridRect window{first, {first.col + random.between(0, 140), first.row + random.between(0, 40)}};
    const int shift = random.between(0, 8);
    BitLattice lattice(window, shift);
    std::vector<GridPoint> expected, found;
    for_each_point(window, [&](GridPoint p) {
      if (p.col % (1 << shift) == 0 && p.row % (1 << shift) == 0) expected.push_back(p);
    });
    for (std::int32_t j = 0; j < lattice.rows; ++j) {
      for (std::int32_t i = 0; i < lattice.cols; ++i) {
        EXPECT_FALSE(lattice.contains(i, j)) << "none is a member of a new one";
        found.push_back(lattice.at(i, j));
      }
    }
    if (expected.empty()) {
      EXPECT_TRUE(found.empty());
      continue;
    }
    ASSERT_EQ(found, expected);
    EXPECT_EQ(lattice.starts_odd(), static_cast<unsigned>(expected.front().col / (1 << shift) % 2 != 0));
    // Every second one becomes a member, and no other.
    for (std::size_t k = 0; k < expected.size(); k += 2) lattice.insert(expected[k]);
    std::size_t k = 0;
    for (std::int32_t j = 0; j < lattice.rows; ++j) {
      for (std::int32_t i = 0; i < lattice.cols; ++i) EXPECT_EQ(lattice.contains(i, j), k++ % 2 == 0);
      EXPECT_FALSE(lattice.contains(-1, j) || lattice.contains(lattice.cols, j));
    }
    EXPECT_FALSE(lattice.contains(0, -1) || lattice.contains(0, lattice.rows));
  }
}

TEST(BitLattice, HoldsTheMultiplesOfEachSpacing) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const GridRect window = random_rect(random, 200);
    VertexMask mask(window);
    for (int i = 0; i < 400; ++i) mask.insert(random_point(random, window));
    mask.seal();
    BitLattice bits = bits_of(mask);
    for (int shift = 0; shift < 7; ++shift) {
      ASSERT_EQ(bits.shift, shift);
      std::size_t members = 0, expected = 0;
      for (std::int32_t j = 0; j < bits.rows; ++j) {
        for (std::int32_t i = 0; i < bits.cols; ++i) {
          if (!bits.contains(i, j)) continue;
          ++members;
          ASSERT_TRUE(window.contains(bits.at(i, j)) && mask.contains(bits.at(i, j)));
        }
      }
      mask.for_each([&](GridPoint p) { expected += p.col % (1 << shift) == 0 && p.row % (1 << shift) == 0 ? 1 : 0; });
      EXPECT_EQ(members, expected);
      bits = coarser(bits, window);
    }
  }
}

TEST(BitLattice, SpreadBitsAreGatheredAgain) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t v = random.next() & 0xffffffffu, spread = spread_bits(v);
    for (int bit = 0; bit < 32; ++bit) ASSERT_EQ(spread >> (2 * bit) & 3u, v >> bit & 1u);
    EXPECT_EQ(gathered_bits(spread | (random.next() & 0xaaaaaaaaaaaaaaaau)), v);
  }
}

}  // namespace
}  // namespace talus::support
