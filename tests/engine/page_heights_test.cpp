// Heights coarse to fine: a page cut by the extent goes through a part of its square, and must not notice.

#include "engine/page/page_heights.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

template <class Number>
std::vector<std::byte> written(std::vector<Number> square, std::span<const std::uint8_t> coded,
                               const PresentRect& present) {
  NumberWriter out;
  HeightLevels<Number>().put(square, coded, present, out);
  std::vector<std::byte> bytes;
  out.finish(bytes);
  return bytes;
}

template <class Number>
std::vector<Number> read(const std::vector<std::byte>& bytes, std::span<const std::uint8_t> coded,
                         const PresentRect& present) {
  NumberReader in;
  in.start(bytes);
  std::vector<Number> square(kSquare, 0);
  HeightLevels<Number>().get(square, coded, present, in);
  EXPECT_TRUE(in.is_intact());
  return square;
}

/// Columns or rows, few as often as many.
std::pair<int, int> some_lines(Random& random) {
  const int count = static_cast<int>(random.chance(0.5) ? random.between(1, 9) : random.between(1, kPageSide));
  const int first = static_cast<int>(random.between(0, kPageSide - count));
  return {first, first + count};
}

template <class Number>
class PageHeights : public testing::Test {};
using Numbers = testing::Types<std::int32_t, std::int64_t>;
TYPED_TEST_SUITE(PageHeights, Numbers);

TYPED_TEST(PageHeights, APartIsCodedAsIfTheWholeSquareWereGoneThrough) {
  using Number = TypeParam;
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto [first_col, end_col] = some_lines(random);
    const auto [first_row, end_row] = some_lines(random);
    const PresentRect present{first_col, end_col, first_row, end_row};
    const double share = random.chance(0.5) ? 1 : random.within(0, 1);
    const bool rough = random.chance(0.5);
    std::vector<Number> square(kSquare, 0);
    std::vector<std::uint8_t> coded(kSquare, 0);
    for (int row = first_row; row < end_row; ++row) {
      for (int col = first_col; col < end_col; ++col) {
        const auto i = static_cast<std::size_t>(row * kPageSide + col);
        coded[i] = random.chance(share) ? 1 : 0;
        const auto any =
            static_cast<Number>(static_cast<std::int64_t>(random.next()) >> (sizeof(Number) == 4 ? 38 : 4));
        square[i] = rough ? any : static_cast<Number>((col - row) * 20 + random.between(-50, 50));
      }
    }
    const std::vector<std::byte> bytes = written(square, coded, present);
    ASSERT_EQ(bytes, written(square, coded, PresentRect{}));
    const std::vector<Number> part = read<Number>(bytes, coded, present),
                              whole = read<Number>(bytes, coded, PresentRect{});
    for (int row = first_row; row < end_row; ++row) {
      for (int col = first_col; col < end_col; ++col) {
        const auto i = static_cast<std::size_t>(row * kPageSide + col);
        ASSERT_EQ(part[i], whole[i]) << col << ", " << row;  // where none is coded, too: what is predicted
        if (coded[i] != 0) {
          ASSERT_EQ(part[i], square[i]) << col << ", " << row;
        }
      }
    }
  }
}

}  // namespace
}  // namespace talus::support
