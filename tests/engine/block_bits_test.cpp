// The bits of blocks, against loops over their samples.

#include "engine/error/block_bits.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/fields.hpp"
#include "tests/engine/terrains.hpp"

namespace talus::support {
namespace {

/// Of the closed block, fills included.
BitRange plain_bits(const Field& field, GridPoint block) {
  BitRange bits;
  for_each_point({{block.col * 64, block.row * 64}, {block.col * 64 + 64, block.row * 64 + 64}}, [&](GridPoint p) {
    if (field.extent.contains(p)) bits.take(field.input.field[p]);
  });
  return bits;
}

TEST(BlockBits, AreThoseOfAllSamplesOfTheClosedBlock) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Field field(
        random_terrain(random, static_cast<Numbers>(seed % kNumbers), random.between(1, 200), random.between(1, 200)),
        {random.between(-150, 50), random.between(-150, 50)});
    const BlockBits bits(field.input.field);
    bool all_exact = true;
    for_each_point({{-4, -4}, {5, 5}}, [&](GridPoint block) {
      const BitRange expected = plain_bits(field, block);
      EXPECT_EQ(bits[block], expected) << "block " << name_of(block);
      all_exact = all_exact && expected.interpolates_exactly(64);
    });
    EXPECT_EQ(bits.all_exact(), all_exact);
    // A vertex is exact where the blocks that its half touches are, each alone and, of large ones, together.
    for_each_point(field.extent, [&](GridPoint p) {
      if (spacing(p) > 64 || (spacing(p) < 32 && random.chance(0.97))) return;
      for (const int side : {0, 1}) {
        const HalfDiamond t = half_diamond(p, side);
        if (!inside(t, field.extent)) continue;
        BitRange together;
        bool each = true;
        for_each_point({{-4, -4}, {5, 5}}, [&](GridPoint block) {
          bool touched = false;  // by more than a line: the middle of a unit cell's quarter lies inside
          for (std::int32_t row = std::max(t.top(), block.row * 64); row < std::min(t.bottom(), block.row * 64 + 64);
               ++row) {
            const auto [lo, hi] = t.columns(row);
            const auto [lo2, hi2] = t.columns(row + 1);
            const std::int32_t from = std::max(std::min(lo, lo2), block.col * 64),
                               to = std::min(std::max(hi, hi2), block.col * 64 + 64);
            touched = touched || from < to;
          }
          if (!touched) return;
          each = each && plain_bits(field, block).interpolates_exactly(64);
          together.take(plain_bits(field, block));
        });
        const bool expected = each && (t.s < 64 || together.interpolates_exactly(2 * t.s));
        EXPECT_EQ(bits.is_exact(p, side), expected) << name_of(p) << " side " << side;
      }
    });
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace talus::support
