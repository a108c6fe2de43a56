// Which errors follow from heights, as bits; and those that do not, as bytes.

#include "engine/dense/stored_eighths.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/page/page_errors.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

using detail::SortedSquare;

constexpr int kSide = kPageSide;

SquareBits rectangle(const PresentRect& rect) {
  SquareBits bits{};
  for (int row = rect.first_row; row < rect.end_row; ++row) {
    for (int col = rect.first_col; col < rect.end_col; ++col) insert(bits, col, row);
  }
  return bits;
}

PresentRect some_rectangle(Random& random) {
  PresentRect rect;
  rect.first_col = random.between(0, kSide - 1);
  rect.end_col = random.between(rect.first_col + 1, kSide);
  rect.first_row = random.between(0, kSide - 1);
  rect.end_row = random.between(rect.first_row + 1, kSide);
  return rect;
}

/// Without some rectangles and some samples.
SquareBits with_voids(SquareBits data, Random& random) {
  const auto remove = [&](int col, int row) {
    data[static_cast<std::size_t>(row)][col / 64] &= ~(std::uint64_t{1} << (col % 64));
  };
  for (int i = random.between(0, 3); i > 0; --i) {
    const PresentRect hole = some_rectangle(random);
    if ((hole.end_col - hole.first_col) * (hole.end_row - hole.first_row) > 4000) continue;
    for_each_bit(rectangle(hole), remove);
  }
  for (int i = random.between(0, 20); i > 0; --i) remove(random.between(0, kSide - 1), random.between(0, kSide - 1));
  return data;
}

TEST(SquareBits, ImpliedPlacesOfARectangleAreThoseByPlace) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const PresentRect rect = seed == 0 ? PresentRect{} : some_rectangle(random);
    const SquareBits implied = implied_places(rectangle(rect));
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) {
        const bool inside = col >= rect.first_col && col < rect.end_col && row >= rect.first_row && row < rect.end_row;
        ASSERT_EQ(has(implied, col, row), inside && is_implied_by_place(col, row, rect)) << col << ", " << row;
      }
    }
  }
}

TEST(SquareBits, ImpliedPlacesBesideVoidsAreThoseWhereAnErrorIsComputed) {
  ImpliedErrors<std::int32_t> errors;
  std::vector<std::int32_t> square(kSquare, 0), computed(kSquare);
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const PresentRect rect = random.chance(0.5) ? PresentRect{} : some_rectangle(random);
    SquareBits data = with_voids(rectangle(rect), random);
    std::vector<std::uint8_t> valid(kSquare, 0);
    for_each_bit(data, [&](int col, int row) { valid[static_cast<std::size_t>(row * kSide + col)] = 1; });
    errors.compute(square, rect, valid, computed);
    const SquareBits implied = implied_places(data);
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col)
        ASSERT_EQ(has(implied, col, row), computed[static_cast<std::size_t>(row * kSide + col)] >= 0)
            << col << ", " << row;
    }
  }
}

struct Asked {
  SquareBits data, present;
  std::vector<std::int16_t> square = std::vector<std::int16_t>(kSquare);
  SortedSquare errors{};  ///< of all present vertices

  /// Calls visit(error) for those that are stored.
  template <class Visit>
  void for_each_stored(SortedSquare& all, Visit&& visit) const {
    const SquareBits implied = implied_places(data);
    for_each_bit(present, [&](int col, int row) {
      if (((col | row) & 7) != 0 && !has(implied, col, row)) visit(all.numbers[SortedSquare::index_of(col, row)]);
    });
  }
};

/// Errors that are at least those of their children, as saturated ones are.
std::unique_ptr<Asked> some_errors(Random& random) {
  auto asked = std::make_unique<Asked>();
  const PresentRect rect = random.chance(0.5) ? PresentRect{} : some_rectangle(random);
  asked->data = with_voids(rectangle(rect), random);
  asked->present = rectangle(rect);
  const int rough = random.between(1, 300);
  for (std::int16_t& height : asked->square) height = static_cast<std::int16_t>(random.between(-rough, rough));
  for (std::int16_t& error : asked->errors.numbers) error = -1;
  const int most = random.between(0, 8 * rough);
  for_each_bit(asked->present, [&](int col, int row) {
    if (((col | row) & 7) == 0) return;  // of a coarser band
    const int level = ((col | row) & 1) != 0 ? 0 : ((col | row) & 2) != 0 ? 1 : 2;
    const bool centre = ((col & row) & (1 << level)) != 0;
    asked->errors.numbers[SortedSquare::index_of(col, row)] =
        static_cast<std::int16_t>(random.between(0, most) + (2 * level + (centre ? 1 : 0)) * most + 8 * 4 * rough);
  });
  return asked;
}

/// The errors as a reader has them before it reads: implied ones only.
std::unique_ptr<SortedSquare> implied_only(const Asked& asked) {
  auto errors = std::make_unique<SortedSquare>(asked.errors);
  asked.for_each_stored(*errors, [](std::int16_t& error) { error = -7; });
  return errors;
}

TEST(StoredEighths, ComeBack) {
  for (std::uint32_t seed = 0; seed < 80; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto asked = some_errors(random);
    const StoredEighths stored(asked->present, asked->data);
    auto written = std::make_unique<SortedSquare>(asked->errors);
    std::vector<std::byte> bytes;
    stored.put(asked->square, *written, bytes);
    for_each_bit(asked->present, [&](int col, int row) {
      const int i = SortedSquare::index_of(col, row);
      ASSERT_EQ(written->numbers[i], asked->errors.numbers[i]) << "saturated errors are possible errors";
    });
    const auto read = implied_only(*asked);
    const std::size_t size = bytes.size();
    bytes.push_back(std::byte{0xff});  // others may follow
    ASSERT_EQ(stored.get(bytes, asked->square, *read), size);
    for_each_bit(asked->present, [&](int col, int row) {
      const int i = SortedSquare::index_of(col, row);
      ASSERT_EQ(read->numbers[i], asked->errors.numbers[i]) << col << ", " << row;
    });
  }
}

TEST(StoredEighths, OfAWholePageAre657) { EXPECT_EQ(StoredEighths(rectangle({}), rectangle({})).count(), 657u); }

TEST(StoredEighths, AnErrorTooSmallIsRaisedToTheLeastPossibleOneWhichTakesNothing) {
  Random random(5);
  const auto asked = some_errors(random);
  asked->for_each_stored(asked->errors, [](std::int16_t& error) { error = 0; });
  const StoredEighths stored(asked->present, asked->data);
  ASSERT_GT(stored.count(), 300u);
  auto written = std::make_unique<SortedSquare>(asked->errors);
  std::vector<std::byte> bytes;
  stored.put(asked->square, *written, bytes);
  EXPECT_EQ(bytes.size(), 1u) << "as all are";
  const auto read = implied_only(*asked);
  ASSERT_EQ(stored.get(bytes, asked->square, *read), bytes.size());
  EXPECT_TRUE(std::equal(std::begin(read->numbers), std::end(read->numbers), std::begin(written->numbers)));
  asked->for_each_stored(*read, [](std::int16_t& error) { EXPECT_GE(error, 0); });
}

TEST(StoredEighths, AnyBytesAreReadWithinBoundsAndTruncationsRefused) {
  int read_anyway = 0;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto asked = some_errors(random);
    const StoredEighths stored(asked->present, asked->data);
    auto written = std::make_unique<SortedSquare>(asked->errors);
    std::vector<std::byte> bytes;
    stored.put(asked->square, *written, bytes);
    const auto read = implied_only(*asked);
    for (std::size_t cut = bytes.size(); cut-- > 0 && cut + 3 > bytes.size();)
      EXPECT_EQ(stored.get(std::span(bytes).first(cut), asked->square, *read), 0u);
    for (std::byte& byte : bytes) {
      if (random.chance(0.1)) byte = static_cast<std::byte>(random.next());
    }
    const std::size_t end = stored.get(bytes, asked->square, *read);
    EXPECT_LE(end, bytes.size());
    read_anyway += end > 0 ? 1 : 0;
  }
  EXPECT_GT(read_anyway, 0);
}

}  // namespace
}  // namespace talus::support
