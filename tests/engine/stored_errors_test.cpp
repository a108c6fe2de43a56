// Which errors follow from heights, as bits; and those that do not, as bytes.

#include "engine/page/stored_errors.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
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

/// The codes of eighths in metres, by trying one after the other.
const std::array<ErrorCode, 1 << 15>& codes_of_eighths() {
  static const auto codes = [] {
    auto made = std::make_unique<std::array<ErrorCode, 1 << 15>>();
    for (std::size_t i = 0; i < made->size(); ++i) {
      ErrorCode code = i == 0 ? ErrorCode{0} : (*made)[i - 1];
      while (error_of(code) < static_cast<double>(i) / 8) ++code;
      (*made)[i] = code;
    }
    return made;
  }();
  return *codes;
}

/// A dense page with voids, cut or whole.
struct Asked {
  explicit Asked(std::uint32_t seed, bool has_codes) : codes(has_codes ? &codes_of_eighths() : nullptr) {
    Random random(seed);
    const PresentRect rect = random.chance(0.5) ? PresentRect{} : some_rectangle(random);
    present = rectangle(rect);
    const SquareBits data = random.chance(0.3) ? present : with_voids(present, random);
    page.id = {0, 0, 0};
    page.bands = 3;
    page.grid = page_grid(page.id, {{rect.first_col, rect.first_row}, {rect.end_col - 1, rect.end_row - 1}});
    for_each_sample(page.grid,
                    [&](std::size_t, GridPoint p) { page.valid.push_back(has(data, p.col, p.row) ? 1 : 0); });
    if (std::count(page.valid.begin(), page.valid.end(), 0) == 0) page.valid.clear();
    implied = implied_places(data);
    const int rough = random.between(1, 300);
    for (std::int16_t& height : squares->numbers) height = static_cast<std::int16_t>(random.between(-rough, rough));
    for (std::int16_t& error : squares->errors.numbers) error = -1;
    const int most = random.between(0, 8 * rough);
    const bool saturated = random.chance(0.8);
    for_each_bit(present, [&](int col, int row) {
      if (((col | row) & 7) == 0) return;  // of a coarser band
      const int level = ((col | row) & 1) != 0 ? 0 : ((col | row) & 2) != 0 ? 1 : 2;
      const bool centre = ((col & row) & (1 << level)) != 0;
      int error = random.between(0, most) + (2 * level + (centre ? 1 : 0)) * most + 8 * 4 * rough;
      if (!saturated) error = random.between(0, 32767);
      const bool as_code = codes != nullptr && !has(implied, col, row);
      squares->errors.numbers[SortedSquare::index_of(col, row)] =
          as_code ? coded(saturated ? (*codes)[static_cast<std::size_t>(error)] : random.between(0, kAlwaysSelected))
                  : static_cast<std::int16_t>(error);
    });
    stored.list(page, codes == nullptr ? ErrorForm::dense : ErrorForm::dense_and_codes);
    stored.put(*squares, codes, bytes);
  }
  /// The page as a reader has it before it reads: with implied errors only.
  [[nodiscard]] std::unique_ptr<DenseSquares> implied_only() const {
    auto made = std::make_unique<DenseSquares>(*squares);
    for_each_bit(without(present, implied), [&](int col, int row) {
      if (((col | row) & 7) != 0) made->errors.numbers[SortedSquare::index_of(col, row)] = -7;
    });
    return made;
  }
  CodesOfEighths codes;
  Page page;
  SquareBits present{}, implied{};
  std::unique_ptr<DenseSquares> squares = std::make_unique<DenseSquares>();
  StoredErrors stored;
  std::vector<std::byte> bytes;
};

TEST(StoredErrors, OfDensePagesComeBackWhateverTheyAre) {
  for (std::uint32_t seed = 0; seed < 160; ++seed) {
    SCOPED_TRACE(seed);
    const Asked asked(seed, seed % 2 != 0);
    const auto read = asked.implied_only();
    ASSERT_TRUE(asked.stored.get(asked.bytes, *read, asked.codes));
    for_each_bit(asked.present, [&](int col, int row) {
      const int i = SortedSquare::index_of(col, row);
      ASSERT_EQ(read->errors.numbers[i], asked.squares->errors.numbers[i]) << col << ", " << row;
    });
  }
}

std::size_t count_of(const StoredErrors& stored) {
  std::vector<std::uint16_t> places;
  stored.places(places);
  return places.size();
}

Page page_of_band(int band, int bands, GridRect extent, PageId id = {}) {
  Page page;
  page.id = {band, id.x, id.y};
  page.bands = bands;
  page.grid = page_grid(page.id, extent);
  page.errors.assign(page.grid.size(), 0);
  return page;
}

/// Pages of all bands, rough and flat, with codes that heights explain and with any others.
TEST(StoredErrors, OfOtherPagesComeBackWhateverTheyAre) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int band = random.between(0, 2);
    const GridPoint first{random.between(-30000, 30000), random.between(-30000, 30000)};
    const GridRect extent{first, {first.col + random.between(0, 9000), first.row + random.between(0, 9000)}};
    Page page = page_of_band(band, 3, extent);
    page.id = page_of({first.col + random.between(0, 500), first.row + random.between(0, 500)}, band);
    page.grid = page_grid(page.id, extent);
    const std::size_t n = page.grid.size();
    page.errors.assign(n, 0);
    const bool has_heights = random.chance(0.7);
    if (random.chance(0.5)) {
      for (std::size_t i = 0; i < n; ++i) page.valid.push_back(random.chance(0.9) ? 1 : 0);
    }
    for (std::size_t i = 0; i < n; ++i) page.heights.push_back(has_heights ? random.between(0, 4000) / 10.0 : 0);
    const int most = random.chance(0.5) ? kAlwaysSelected : random.between(0, 40);
    std::vector<ErrorCode> all(n, 0);
    std::size_t own = 0;
    for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
      if (!page.is_own(p)) return;
      all[i] = static_cast<ErrorCode>(random.between(0, most));
      ++own;
    });
    StoredErrors stored;
    std::vector<std::byte> bytes;
    stored.list(page, ErrorForm::none);
    EXPECT_EQ(count_of(stored), own);
    Page written = page;
    stored.put(all, written, CodeDistance(), bytes);
    EXPECT_EQ(written.errors, all);
    ASSERT_TRUE(stored.get(bytes, page, CodeDistance()));
    ASSERT_EQ(page.errors, all);
  }
}

TEST(StoredErrors, OfAWholeDensePageAre657) {
  StoredErrors stored;
  stored.list(page_of_band(0, 3, {{0, 0}, {500, 500}}), ErrorForm::dense);
  EXPECT_EQ(count_of(stored), 657u);
}

/// A flat page takes one byte, and so do errors that are exactly what heights and children explain.
TEST(StoredErrors, ThatAreTheLeastPossibleOnesTakeOneByte) {
  Page page = page_of_band(1, 3, {{0, 0}, {3000, 3000}});
  Random random(1);
  for (std::size_t i = 0; i < page.grid.size(); ++i) page.heights.push_back(random.between(0, 4000));
  StoredErrors stored;
  stored.list(page, ErrorForm::none);
  const std::vector<std::byte> nothing{std::byte{0}};
  ASSERT_TRUE(stored.get(nothing, page, CodeDistance()));
  EXPECT_GT(*std::max_element(page.errors.begin(), page.errors.end()), 1000u);
  std::vector<std::byte> bytes;
  const std::vector<ErrorCode> all = page.errors;
  stored.put(all, page, CodeDistance(), bytes);
  EXPECT_EQ(bytes, nothing);
}

TEST(StoredErrors, AnyBytesAreReadWithinBoundsAndTruncationsRefused) {
  int read_anyway = 0;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Asked asked(seed, seed % 2 != 0);
    const auto read = asked.implied_only();
    for (std::size_t cut = asked.bytes.size(); cut-- > 0 && cut + 3 > asked.bytes.size();)
      EXPECT_FALSE(asked.stored.get(std::span(asked.bytes).first(cut), *read, asked.codes));
    std::vector<std::byte> longer = asked.bytes;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(asked.stored.get(longer, *read, asked.codes));
    for (std::byte& byte : asked.bytes) {
      if (random.chance(0.1)) byte = static_cast<std::byte>(random.next());
    }
    if (!asked.stored.get(asked.bytes, *read, asked.codes)) continue;
    ++read_anyway;
    for_each_bit(asked.present, [&](int col, int row) {
      const int error = read->errors.numbers[SortedSquare::index_of(col, row)];
      ASSERT_GE(error, asked.codes == nullptr ? -1 : coded(kAlwaysSelected)) << col << ", " << row;
    });
  }
  EXPECT_GT(read_anyway, 0);
}

}  // namespace
}  // namespace talus::support
