// Pages of whole numbers in the dense form: which pages have it, and that its errors are those of the definition.

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "engine/dense/square_bits.hpp"
#include "engine/error/saturation.hpp"
#include "engine/error/vertex_error.hpp"
#include "engine/page/page_codec.hpp"
#include "query/selection/threshold.hpp"
#include "talus/failure.hpp"
#include "tests/engine/fields.hpp"
#include "tests/support/given_page.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

/// A page of a terrain as ingest makes it.
struct Made {
  Made(const Terrain& terrain, PageId id, HeightStep step = {}, GridPoint first = {0, 0})
      : field(terrain, first, step), distance(step, 1) {
    LevelGrid<ErrorCode> errors = reference_errors(field.input, levels_of(field.extent));
    saturate(field.input, errors);
    given.id = id;
    given.bands = band_count(field.extent);
    given.grid = page_grid(id, field.extent);
    for_each_sample(given.grid, [&](std::size_t, GridPoint p) {
      const bool is_own = given.is_own(p);
      given.heights.push_back(field.input.field[p]);
      given.errors.push_back(!is_own                                ? ErrorCode{0}
                             : height_in_tree(p) >= errors.levels() ? kAlwaysSelected
                                                                    : errors[p]);
      given.valid.push_back(field.valid[field.input.field.index(p)]);
      given.covers.push_back(is_own && field.voids ? field.voids->apex_triangles_with_data(p) : std::uint8_t{0});
    });
    if (!field.voids) given.valid.clear(), given.covers.clear();
  }
  /// What the decoder makes of its bytes.
  const Page& decoded() {
    page = decoder.decode(given.id, field.extent, given.bands, distance, encode(given, distance));
    return page;
  }
  Field field;
  CodeDistance distance;
  Page given, page;
  PageDecoder decoder;
};

/// The fewest eighths of a height code that are not below a rung, by trying one after the other.
std::int32_t eighths_above(ErrorCode code, const CodeDistance& distance) {
  std::int32_t eighths = 0;
  while (distance.metres(eighths / 8.0) < error_of(code)) ++eighths;
  return eighths;
}

void expect_as_given(Made& made) {
  const Page& page = made.decoded();
  ASSERT_TRUE(page.is_dense);
  const SquareBits implied = implied_places(data_samples(page));
  std::size_t followed = 0;
  for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
    if (page.is_data(i) || made.given.covers[i] != 0) {
      ASSERT_EQ(page.height(i), made.given.heights[i]) << name_of(p);
    }
    if (!page.is_own(p)) {
      ASSERT_EQ(page.dense_error(i), -1) << name_of(p);
      return;
    }
    const bool follows = has(implied, page.in_square(i));
    followed += follows ? 1 : 0;
    ASSERT_TRUE(!follows || page.has_distance(i)) << name_of(p);
    if (follows || !made.distance.is_whole()) {
      ASSERT_EQ(page.error(i, made.distance), made.given.errors[i]) << name_of(p);
    } else {
      ASSERT_EQ(page.dense_error(i), eighths_above(made.given.errors[i], made.distance)) << name_of(p);
    }
  });
  EXPECT_EQ(page.valid, made.given.valid);
  EXPECT_EQ(page.covers, made.given.covers);
  if (page.grid.size() > 10000 && page.valid.empty()) {
    EXPECT_GT(followed, 10000u);
  }
}

TEST(DensePage, OfWholeNumbersHasTheHeightsAndErrorsThatItWasGiven) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const PageId id : {PageId{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
      SCOPED_TRACE(seed);
      Made made(whole(fractal(150, 140, seed)), id);
      expect_as_given(made);
    }
  }
}

TEST(DensePage, StandsWhereverThePageStands) {
  for (const GridPoint first : {GridPoint{-40, -100}, {1000, -128}, {77, 3}}) {
    const Terrain terrain = whole(fractal(100, 110, 9));
    for (const PageId id : pages_of_band(0, {first, {first.col + 99, first.row + 109}})) {
      Made made(terrain, id, {}, first);
      expect_as_given(made);
    }
  }
}

TEST(DensePage, MayHaveVoids) {
  for (const bool scattered : {false, true}) {
    const Terrain ground = whole(fractal(140, 130, 6));
    Made made(scattered ? random_voids(ground, 0.01, 6) : void_blobs(ground, 4, 6), {0, 0, 0});
    expect_as_given(made);
  }
}

TEST(DensePage, InFeetRoundsStoredErrorsUpToEighths) {
  Made made(whole(fractal(128, 128, 2)), {0, 0, 0}, {0.3048, 1, 0, true});
  expect_as_given(made);
}

TEST(DensePage, OfWholeNumbersAmongFloatsHasCodesWhereErrorsDoNotFollow) {
  for (const HeightStep& step : {HeightStep{}, HeightStep{0.3048, 1, 0, false}, HeightStep{1, 8, 0, false}}) {
    HeightStep floats = step;
    floats.integer = false;
    for (const PageId id : {PageId{0, 0, 0}, {0, 1, 1}}) {
      const Terrain ground = whole(fractal(150, 140, 3));
      for (const Terrain& terrain : {ground, random_voids(ground, 0.01, 3), void_blobs(ground, 4, 3)}) {
        Made made(terrain, id, floats);
        expect_as_given(made);
        EXPECT_EQ(made.page.coded.empty(), false);
        std::size_t codes = 0;
        for (std::size_t i = 0; i < made.page.grid.size(); ++i) {
          const bool is_listed =
              std::count(made.page.coded.begin(), made.page.coded.end(), made.page.in_square(i)) == 1;
          if (made.page.dense_error(i) != -1) {
            ASSERT_EQ(is_listed, !made.page.has_distance(i)) << i;
          }
          codes += is_listed ? 1 : 0;
        }
        EXPECT_EQ(codes, made.page.coded.size());
      }
    }
  }
}

TEST(DensePage, IsMadeOnlyWhereSixteenBitsHoldEverything) {
  const auto is_dense = [](Made&& made) { return made.decoded().is_dense; };
  EXPECT_TRUE(is_dense(Made(whole(fractal(128, 128, 1)), {0, 0, 0})));
  EXPECT_TRUE(is_dense(Made(whole(fractal(128, 128, 1)), {0, 0, 0}, {1, 1, 0, false}))) << "heights are whole";
  EXPECT_FALSE(is_dense(Made(rounded(fractal(128, 128, 1), 10), {0, 0, 0}))) << "heights are not whole";
  EXPECT_FALSE(is_dense(Made(whole(noise(128, 128, 1, 0, 66000)), {0, 0, 0}))) << "a range of more than 16 bits";
  EXPECT_FALSE(is_dense(Made(whole(noise(128, 128, 1, 0, 20000)), {0, 0, 0}))) << "errors of more than 16 bits";
  EXPECT_TRUE(is_dense(Made(whole(noise(128, 128, 1, 0, 1000)), {0, 0, 0})));
  Made coarse(whole(fractal(200, 200, 1)), {1, 0, 0});
  coarse.given.children.resize(64);
  EXPECT_FALSE(is_dense(std::move(coarse))) << "a page of a coarser band";
  Made wrong(whole(fractal(128, 128, 1)), {0, 0, 0});
  wrong.given.errors[wrong.given.index(60, 60)] = 0;  // below those of vertices that depend on it
  EXPECT_FALSE(is_dense(std::move(wrong))) << "an error that does not follow from heights";
}

TEST(DensePage, WithAnyErrorsThatAreStoredComesBackAsGiven) {
  // Such a page is written in another form where the dense one would change it.
  for (const bool integer : {true, false}) {
    const Made made(whole(fractal(128, 128, 7)), {0, 0, 0}, {1, 1, 0, integer});
    Page other = made.given;
    Random random(5);
    for (int i = 0; i < 50; ++i) {
      const std::size_t at = static_cast<std::size_t>(random.between(0, 16383));
      if (!other.is_own(other.grid.at(static_cast<int>(at % 128), static_cast<int>(at / 128)))) continue;
      other.errors[at] = static_cast<ErrorCode>(random.between(0, kAlwaysSelected));
      PageDecoder decoder;
      const Page& back =
          decoder.decode(other.id, made.field.extent, other.bands, made.distance, encode(other, made.distance));
      for (std::size_t k = 0; k < other.errors.size(); ++k) {
        if (!other.is_own(other.grid.at(static_cast<int>(k % 128), static_cast<int>(k / 128)))) continue;
        if (back.is_dense && integer && back.error(k, made.distance) != other.errors[k]) {
          ASSERT_EQ(back.dense_error(k), eighths_above(other.errors[k], made.distance)) << k;
        } else {
          ASSERT_EQ(back.error(k, made.distance), other.errors[k]) << k;
        }
      }
    }
  }
}

/// The rule that makes pages of both forms fit: whatever the tolerance, a stored error is selected in both or in none.
TEST(DensePage, SelectsTheStoredErrorsThatTheirCodesSelect) {
  Made made(void_blobs(whole(fractal(128, 128, 3, 60)), 3, 3), {0, 0, 0}, {1, 3, 0, true});
  const Page dense = made.decoded();
  ASSERT_TRUE(dense.is_dense);
  const Page plain = made.given;  // all are codes
  const SquareBits implied = implied_places(data_samples(dense));
  Random random(3);
  std::size_t differ = 0;
  for (int attempt = 0; attempt < 60; ++attempt) {
    const double tolerance = attempt == 0 ? 0 : random.log_between(0.01, 30);
    const Threshold above(tolerance, made.distance);
    for_each_sample(dense.grid, [&](std::size_t i, GridPoint p) {
      if (!dense.is_own(p)) return;
      const auto at = static_cast<int>(dense.in_square(i));
      if (!has(implied, at % 128, at / 128)) {
        ASSERT_EQ(above(dense, i), above(plain, i)) << name_of(p) << " at " << tolerance;
      }
      ASSERT_EQ(above(dense, i), dense.error_m(i, made.distance) > tolerance) << name_of(p) << " at " << tolerance;
      differ += above(dense, i) != (error_of(plain.errors[i]) > tolerance) ? 1 : 0;
    });
  }
  EXPECT_GT(differ, 0u) << "tolerances between eighths make a difference";
}

// ---- damage --------------------------------------------------------------------------------------------

bool is_refused(const Made& made, std::span<const std::byte> bytes, const CodeDistance& distance) {
  PageDecoder decoder;
  try {
    const Page& page = decoder.decode(made.given.id, made.field.extent, made.given.bands, distance, bytes);
    for (std::size_t i = 0; i < page.grid.size(); ++i) EXPECT_TRUE(std::isfinite(page.height(i)));
    return false;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::corrupt) << failure.what();
    return true;
  }
}

TEST(DensePage, TruncatedLengthenedOrForAnotherDatabaseIsRefused) {
  const Made made(void_blobs(whole(fractal(140, 130, 6)), 4, 6), {0, 0, 0});
  auto bytes = encode(made.given, made.distance);
  for (std::size_t size = 0; size < bytes.size(); size += size < 64 ? 1 : 7)
    ASSERT_TRUE(is_refused(made, std::span(bytes).first(size), made.distance)) << size;
  EXPECT_TRUE(is_refused(made, bytes, CodeDistance({1, 1, 0, false}, 1))) << "whose codes are not whole";
  const Made floats(whole(fractal(140, 130, 6)), {0, 0, 0}, {1, 1, 0, false});
  EXPECT_TRUE(is_refused(floats, encode(floats.given, floats.distance), made.distance)) << "whose codes are whole";
  bytes.push_back(std::byte{0});
  EXPECT_TRUE(is_refused(made, bytes, made.distance));
}

TEST(DensePage, AnyFlippedBitIsRefusedOrGivesAPage) {
  for (const bool integer : {true, false}) {
    const Made made(whole(fractal(128, 128, 6)), {0, 0, 0}, {1, 1, 0, integer});
    auto bytes = encode(made.given, made.distance);
    std::size_t refused = 0;
    for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += bit < 8 * 80 ? 1 : 37) {
      bytes[bit / 8] ^= std::byte{1} << (bit % 8);
      refused += is_refused(made, bytes, made.distance) ? 1 : 0;
      bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    }
    EXPECT_GT(refused, 64u);
  }
}

TEST(DensePage, HeadsThatContradictThemselvesAreRefused) {
  const Made made(whole(fractal(128, 128, 6)), {0, 0, 0});
  const auto changed = [&](std::size_t at, int value) {
    auto bytes = encode(made.given, made.distance);
    EXPECT_NE(bytes[at], static_cast<std::byte>(value)) << "no change at " << at;
    bytes[at] = static_cast<std::byte>(value);
    return is_refused(made, bytes, made.distance);
  };
  EXPECT_TRUE(changed(1, 1)) << "decimals";
  EXPECT_TRUE(changed(2, 16)) << "heights were dropped";
  EXPECT_TRUE(changed(3, 5)) << "codes beside eighths";
  EXPECT_TRUE(changed(3, 6)) << "a form that is unknown";
  EXPECT_TRUE(changed(6, 4)) << "wider numbers";
  EXPECT_TRUE(changed(15, 0x40)) << "a base that doubles do not hold";
  EXPECT_TRUE(changed(17, 0)) << "fewer bytes of heights";
  EXPECT_TRUE(changed(20, 0)) << "fewer bytes of errors";
}

}  // namespace
}  // namespace talus::support
