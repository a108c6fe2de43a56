// Pages and their bytes: nothing is lost, and damage is refused.

#include "engine/page/page_codec.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/error/saturation.hpp"
#include "engine/error/vertex_error.hpp"
#include "talus/failure.hpp"
#include "tests/engine/fields.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct PageKind {
  GridRect extent{{0, 0}, {127, 127}};
  PageId id{};
  bool voids = false;
};

/// A page with random errors, masks and tables over heights of height(random).
template <class Height>
Page random_page(Random& random, const PageKind& kind, Height&& height) {
  Page page;
  page.id = kind.id;
  page.bands = band_count(kind.extent);
  page.grid = page_grid(kind.id, kind.extent);
  const std::size_t n = page.grid.size();
  for (std::size_t i = 0; i < n; ++i) page.heights.push_back(height(random));
  page.errors.assign(n, 0);
  if (kind.voids) {
    for (std::size_t i = 0; i < n; ++i) {
      page.valid.push_back(random.chance(0.5) ? 1 : 0);
      page.covers.push_back(static_cast<std::uint8_t>(random.chance(0.5) ? 0 : random.between(1, 15)));
    }
  }
  for (std::int32_t row = 0; row < page.grid.rows; ++row) {
    for (std::int32_t col = 0; col < page.grid.cols; ++col) {
      const GridPoint p = page.grid.at(col, row);
      if (!page.is_own(p)) {
        if (kind.voids) page.covers[page.index(col, row)] = 0;
        continue;
      }
      page.errors[page.index(col, row)] =
          static_cast<ErrorCode>(random.chance(0.1) ? kAlwaysSelected : random.between(0, kAlwaysSelected));
    }
  }
  if (kind.id.band > 0) {
    for (int i = 0; i < kChildrenAcross * kChildrenAcross; ++i) {
      ChildEntry entry;
      if (random.chance(0.8)) {
        const auto low = static_cast<float>(random.within(-100, 100));
        entry = {true, static_cast<ErrorCode>(random.between(0, kAlwaysSelected)), low, low + 5,
                 static_cast<std::uint32_t>(random.chance(0.5) ? 7 : random.next())};
        if (random.chance(0.1)) entry.lowest = static_cast<float>(kInfinity), entry.highest = -entry.lowest;
      }
      page.children.push_back(entry);
    }
  }
  return page;
}

/// `b` is what came of `a`: bit for bit, but for heights of voids that no triangle needs.
void expect_same(const Page& a, const Page& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.bands, b.bands);
  EXPECT_EQ(a.grid.cols, b.grid.cols);
  EXPECT_EQ(a.grid.rows, b.grid.rows);
  EXPECT_EQ(a.grid.first, b.grid.first);
  ASSERT_TRUE(b.is_dense || a.errors.size() == b.errors.size());
  for (std::size_t i = 0; i < a.errors.size(); ++i)
    ASSERT_EQ(a.errors[i], b.error(i, CodeDistance())) << "sample " << i;
  EXPECT_EQ(a.valid, b.valid);
  EXPECT_EQ(a.covers, b.covers);
  EXPECT_EQ(a.children, b.children);
  ASSERT_TRUE(b.is_dense || a.heights.size() == b.heights.size());
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    if (!a.valid.empty() && a.valid[i] == 0 && a.covers[i] == 0) continue;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a.heights[i]), std::bit_cast<std::uint64_t>(b.height(i)))
        << "sample " << i << ": " << a.heights[i] << " became " << b.height(i);
  }
}

void expect_round_trip(const Page& page, GridRect extent) {
  PageDecoder decoder;
  const auto bytes = encode(page, CodeDistance());
  try {
    expect_same(page, decoder.decode(page.id, extent, page.bands, CodeDistance(), bytes));
  } catch (const Failure& failure) {
    ADD_FAILURE() << failure.what();
  }
}

bool is_refused(PageDecoder& decoder, const Page& page, GridRect extent, std::span<const std::byte> bytes) {
  try {
    static_cast<void>(decoder.decode(page.id, extent, page.bands, CodeDistance(), bytes));
    return false;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::corrupt) << failure.what();
    return true;
  }
}

double smooth(Random& random) { return 500 + random.between(-3, 3); }

/// Each kind of number a source may hold.
double (*const kHeights[])(Random&) = {
    smooth,
    [](Random& r) { return static_cast<double>(r.between(-2147483647, 2147483647)); },
    [](Random& r) { return static_cast<double>(r.next() >> 32); },
    [](Random& r) { return r.between(-9999, 9999) / 10.0; },
    [](Random& r) { return r.between(-9999, 9999) / 100.0; },
    [](Random& r) { return r.between(-999999, 999999) / 1000.0; },
    [](Random& r) { return static_cast<double>(static_cast<float>(r.between(-9999, 9999) / 10.0)); },
    [](Random& r) { return static_cast<double>(static_cast<float>(r.between(-9999, 9999) / 100.0)); },
    [](Random& r) { return static_cast<double>(static_cast<float>(r.between(-999999, 999999) / 1000.0)); },
    [](Random& r) { return static_cast<double>(static_cast<float>(r.within(-9e3, 9e3))); },
    [](Random& r) { return r.within(-9e3, 9e3); },
    [](Random& r) { return r.chance(0.5) ? -0.0 : 0.0; },
    [](Random& r) { return r.chance(0.5) ? 5e-324 * r.between(-99, 99) : 1e-40 * r.between(-99, 99); },
    [](Random& r) { return (r.chance(0.5) ? 1 : -1) * r.log_between(1e-150, 1e150); },
    [](Random& r) {
      return static_cast<double>(
          static_cast<float>((r.chance(0.5) ? 1 : -1) * r.log_between(1e-44, 3e-6) * (r.chance(0.5) ? 1 : 1e43)));
    },
    [](Random& r) { return r.chance(0.01) ? 0.3 : r.between(-9, 9); },
    [](Random&) { return 42.0; },
};

TEST(PageCodec, DecodeOfEncodeIsThePageForEveryKindOfNumber) {
  std::uint64_t seed = 1;
  for (std::size_t kind = 0; kind < std::size(kHeights); ++kind) {
    SCOPED_TRACE("heights of kind " + std::to_string(kind));
    for (const bool voids : {false, true}) {
      Random random(seed++);
      PageKind page;
      page.extent = {{0, 0}, {random.between(30, 127), random.between(30, 127)}};
      page.voids = voids;
      expect_round_trip(random_page(random, page, kHeights[kind]), page.extent);
    }
  }
}

TEST(PageCodec, DecodeOfEncodeIsThePageForEveryShape) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    PageKind kind;
    kind.extent.first =
        random.chance(0.3) ? GridPoint{0, 0} : GridPoint{random.between(-300, 300), random.between(-300, 300)};
    kind.extent.last = {kind.extent.first.col + random.between(0, random.chance(0.3) ? 3 : 400),
                        kind.extent.first.row + random.between(0, random.chance(0.3) ? 3 : 400)};
    const int band = random.between(0, band_count(kind.extent) - 1);
    const auto pages = pages_of_band(band, kind.extent);
    if (pages.empty()) continue;  // a small extent far out may hold no sample of a coarse band
    kind.id = pages[static_cast<std::size_t>(random.between(0, static_cast<int>(pages.size()) - 1))];
    kind.voids = random.chance(0.4);
    expect_round_trip(random_page(random, kind, kHeights[static_cast<std::size_t>(random.between(0, 16))]),
                      kind.extent);
    if (HasFailure()) return;
  }
}

/// Whether a triangle has a finest one with three valid corners, by splitting it.
template <class IsValid>
bool holds_data(const Triangle& t, const IsValid& is_valid) {
  if (spacing(t.apex) == 1 && !is_centre(t.apex)) return is_valid(t.apex) && is_valid(t.left) && is_valid(t.right);
  const GridPoint split = midpoint(t.left, t.right);
  return holds_data({split, t.apex, t.left}, is_valid) || holds_data({split, t.apex, t.right}, is_valid);
}

/// Covers inside a page that are what its voids say take no bytes; the format says so, and readers rely on it.
TEST(PageCodec, CoversThatFollowFromVoidsAreNotStored) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    PageKind kind;
    kind.extent = {{-500, -500}, {700, 700}};
    Page page = random_page(random, kind, smooth);
    page.valid.assign(page.grid.size(), 1);
    for (int voids = random.between(1, seed % 2 == 0 ? 5 : 4000); voids > 0; --voids)
      page.valid[static_cast<std::size_t>(random.between(0, kPageSide * kPageSide - 1))] = 0;
    page.covers.assign(page.grid.size(), 0);
    std::size_t inner = 0;
    for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
      if (!page.is_own(p)) return;
      const auto triangles = apex_triangles(p);
      unsigned covers = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto is_valid = [&](GridPoint q) {
          const bool is_here = q.col >= 0 && q.row >= 0 && q.col < kPageSide && q.row < kPageSide;
          return !is_here || page.valid[page.index(q)] != 0;
        };
        covers |= (holds_data(triangles[k], is_valid) ? 1u : 0u) << k;
      }
      page.covers[i] = static_cast<std::uint8_t>(covers);
      inner += covers != 15 ? 1 : 0;
    });
    EXPECT_GT(inner, 0u);
    constexpr unsigned kInnerCoversFollow = 8;
    EXPECT_NE(std::to_integer<unsigned>(encode(page, CodeDistance())[2]) & kInnerCoversFollow, 0u);
    expect_round_trip(page, kind.extent);
  }
}

TEST(PageCodec, TinyPagesAreNoSpecialCase) {
  for (const auto& [cols, rows] : {std::pair{1, 1}, {1, 2}, {2, 1}, {1, 128}, {128, 1}, {3, 3}}) {
    for (const GridPoint first : {GridPoint{0, 0}, {127, 127}, {-1, -1}, {77, -300}}) {
      PageKind kind;
      kind.extent = {first, {first.col + cols - 1, first.row + rows - 1}};
      for (const PageId id : pages_of_band(0, kind.extent)) {
        kind.id = id;
        Random random(7);
        expect_round_trip(random_page(random, kind, smooth), kind.extent);
      }
    }
  }
}

TEST(PageCodec, ADecoderForgetsThePageBefore) {
  Random random(3);
  const GridRect extent{{0, 0}, {2000, 2000}};
  PageKind coarse{extent, {1, 0, 0}, true}, fine{extent, {0, 3, 3}, false};
  const Page one = random_page(random, coarse, smooth), two = random_page(random, fine, smooth);
  const auto first = encode(one, CodeDistance()), second = encode(two, CodeDistance());
  PageDecoder decoder;
  static_cast<void>(decoder.decode(one.id, extent, one.bands, CodeDistance(), first));
  expect_same(two, decoder.decode(two.id, extent, two.bands, CodeDistance(), second));
  expect_same(one, decoder.decode(one.id, extent, one.bands, CodeDistance(), first));
}

TEST(PageCodec, VoidsAmidRawDoublesOfBothSignsDoNotSpoilThePage) {
  // What a void's height becomes is the codec's choice; it must still be a number.
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    PageKind kind;
    kind.voids = true;
    const Page page =
        random_page(random, kind, [](Random& r) { return (r.chance(0.5) ? 1 : -1) * r.log_between(1e-3, 1e6); });
    expect_round_trip(page, kind.extent);
    if (HasFailure()) return;
  }
}

TEST(PageCodec, SmoothWholeNumbersTakeUnderTwoBitsASampleErrorsIncluded) {
  const Field field(
      surface(128, 128, [](int col, int row) { return std::nearbyint(200 * std::sin(col / 40.0) + row); }));
  LevelGrid<ErrorCode> errors = reference_errors(field.input, levels_of(field.extent));
  saturate(field.input, errors);
  Random random(1);
  Page page = random_page(random, {}, smooth);
  for (std::size_t i = 0; i < page.heights.size(); ++i) page.heights[i] = code_at(field.input.field.heights, i);
  for (std::int32_t row = 0; row < 128; ++row) {
    for (std::int32_t col = 0; col < 128; ++col) {
      const GridPoint p{col, row};
      if (page.is_own(p))
        page.errors[page.index(col, row)] = height_in_tree(p) >= errors.levels() ? kAlwaysSelected : errors[p];
    }
  }
  EXPECT_LT(encode(page, CodeDistance()).size() * 8, page.heights.size() * 2);
}

// ---- damage ----------------------------------------------------------------------------------------

std::vector<Page> sample_pages() {
  Random random(5);
  const GridRect extent{{0, 0}, {300, 260}};
  return {random_page(random, {extent, {0, 0, 0}, false}, smooth),
          random_page(random, {extent, {0, 2, 2}, true}, smooth),
          random_page(random, {extent, {1, 0, 0}, true}, [](Random& r) { return r.within(-9, 9); })};
}
constexpr GridRect kSampleExtent{{0, 0}, {300, 260}};

TEST(PageCodec, EveryTruncationIsCorrupt) {
  for (const Page& page : sample_pages()) {
    const auto bytes = encode(page, CodeDistance());
    PageDecoder decoder;
    const std::size_t step = std::max<std::size_t>(bytes.size() / 600, 1);
    for (std::size_t size = 0; size < bytes.size(); size += size < 64 ? 1 : step) {
      EXPECT_TRUE(is_refused(decoder, page, kSampleExtent, std::span(bytes).first(size))) << size << " bytes";
    }
    EXPECT_TRUE(is_refused(decoder, page, kSampleExtent, std::span(bytes).first(bytes.size() - 1)));
  }
}

TEST(PageCodec, BytesAfterThePageAreCorrupt) {
  for (const Page& page : sample_pages()) {
    auto bytes = encode(page, CodeDistance());
    bytes.push_back(std::byte{0});
    PageDecoder decoder;
    EXPECT_TRUE(is_refused(decoder, page, kSampleExtent, bytes));
  }
}

TEST(PageCodec, EveryFlippedBitIsCorruptOrAPageWithinLimits) {
  for (const Page& page : sample_pages()) {
    auto bytes = encode(page, CodeDistance());
    PageDecoder decoder;
    std::size_t refused = 0;
    const std::size_t bits = 8 * bytes.size(), step = std::max<std::size_t>(bits / 3000, 1) | 1;
    for (std::size_t bit = 0; bit < bits; bit += bit < 8 * 64 ? 1 : step) {
      bytes[bit / 8] ^= std::byte{1} << (bit % 8);
      if (is_refused(decoder, page, kSampleExtent, bytes)) {
        ++refused;
      } else {
        const Page& got = decoder.decode(page.id, kSampleExtent, page.bands, CodeDistance(), bytes);
        ASSERT_EQ(got.heights.size(), page.heights.size());
        ASSERT_EQ(got.errors.size(), page.errors.size());
        for (const double h : got.heights) ASSERT_TRUE(std::isfinite(h));
        for (const ErrorCode e : got.errors) ASSERT_LE(e, kAlwaysSelected);
        for (const std::uint8_t c : got.covers) ASSERT_LE(c, 15);
        for (const ChildEntry& c : got.children) ASSERT_LE(c.largest, kAlwaysSelected);
      }
      bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    }
    EXPECT_GT(refused, 64u);
  }
}

TEST(PageCodec, HeadersThatContradictThemselvesAreCorrupt) {
  const auto pages = sample_pages();
  const auto changed = [&](std::size_t which, std::size_t at, int value) {
    auto bytes = encode(pages[which], CodeDistance());
    EXPECT_NE(bytes[at], static_cast<std::byte>(value)) << "no change at " << at;
    bytes[at] = static_cast<std::byte>(value);
    PageDecoder decoder;
    return is_refused(decoder, pages[which], kSampleExtent, bytes);
  };
  EXPECT_TRUE(changed(0, 0, 1)) << "another version";
  EXPECT_TRUE(changed(0, 1, 9)) << "no such coding";
  EXPECT_TRUE(changed(0, 2, 32)) << "no such flag";
  EXPECT_TRUE(changed(0, 2, 8)) << "covers that follow where there are none";
  EXPECT_TRUE(changed(0, 2, 4)) << "pages below the finest";
  EXPECT_TRUE(changed(1, 2, 1)) << "voids but no covers";
  EXPECT_TRUE(changed(2, 2, 3)) << "no table of pages below";
  EXPECT_TRUE(changed(0, 3, 5)) << "no such form of errors";
  EXPECT_TRUE(changed(0, 3, 4)) << "the dense form where codes are not whole";
  EXPECT_TRUE(changed(2, 3, 1)) << "implied errors in a coarse band";
  EXPECT_TRUE(changed(0, 4, 127)) << "another size";
  EXPECT_TRUE(changed(0, 6, 3)) << "no such width";
  EXPECT_TRUE(changed(0, 7, 1)) << "no such width";
  EXPECT_TRUE(changed(0, 18, 1)) << "more bytes of heights than there are";
  EXPECT_TRUE(changed(0, 20, 1)) << "eighths where errors are codes";
}

TEST(PageCodec, APageOfAnotherPlaceIsCorruptWhereItsSizeDiffers) {
  const auto pages = sample_pages();
  PageDecoder decoder;
  EXPECT_THROW(
      static_cast<void>(decoder.decode({0, 2, 0}, kSampleExtent, 2, CodeDistance(), encode(pages[0], CodeDistance()))),
      Failure);
  EXPECT_THROW(
      static_cast<void>(decoder.decode({1, 0, 0}, kSampleExtent, 2, CodeDistance(), encode(pages[0], CodeDistance()))),
      Failure);
}

}  // namespace
}  // namespace talus::support
