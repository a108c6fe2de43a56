// The slice of a tile: what goes in comes out, and other bytes are refused.

#include "engine/page/tile_slice.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/page/digest.hpp"
#include "engine/page/page_codec.hpp"
#include "engine/quadtree/grid.hpp"
#include "talus/failure.hpp"
#include "tests/support/failure_of.hpp"
#include "tests/support/random.hpp"

namespace talus::support {
namespace {

std::size_t below(Random& random, std::size_t end) { return random.next() % end; }

/// A slice, and the tile and extent it is of.
struct Case {
  TileId id;
  GridRect extent;
  CodeDistance distance;
  TileSlice slice;
};

/// Feet: rungs of the ladder are no eighths.
CodeDistance distance_of(bool whole) { return CodeDistance({1, 1, 0, whole}, whole ? 0.3048 : 1); }

/// Vertices that were chosen at random, with all their parents in the tile and the extent, and saturated errors.
Case random_case(Random& random) {
  Case made;
  const bool whole = random.chance(0.6);
  made.distance = distance_of(whole);
  made.id = {random.between(-3, 3), random.between(-3, 3)};
  const GridPoint corner{made.id.x * kTileSide, made.id.y * kTileSide};
  made.extent = {{corner.col - 500, corner.row - 500}, {corner.col + 2000, corner.row + 2000}};
  if (random.chance(0.5)) {
    made.extent.first = {corner.col + random.between(0, 600), corner.row + random.between(0, 600)};
    made.extent.last = {made.extent.first.col + random.between(0, 900), made.extent.first.row + random.between(0, 900)};
  }
  const GridRect part = common({corner, {corner.col + kTileSide - 1, corner.row + kTileSide - 1}}, made.extent);
  made.slice.above = random.chance(0.2) ? 0 : random.between(1, whole ? 4000 : 3900);
  const int most = whole ? random.chance(0.1) ? 1'000'000'000 : 3000 : kAlwaysSelected - 1 - made.slice.above;
  std::map<std::pair<int, int>, std::int32_t> errors;  // by row and column
  const auto add = [&](auto&& self, GridPoint p, std::int32_t error) -> void {
    if (!part.contains(p) || spacing(p) >= kBlockSide) return;
    const auto [here, is_new] = errors.try_emplace({p.row, p.col}, error);
    if (!is_new && here->second >= error) return;
    here->second = error;
    for (const GridPoint parent : diamond(p).apexes) self(self, parent, error);
  };
  const int count = random.chance(0.1) ? 0 : random.between(1, 1500);
  for (int i = 0; i < count; ++i) {
    const GridPoint p{random.between(part.first.col, part.last.col), random.between(part.first.row, part.last.row)};
    add(add, p, made.slice.above + (random.chance(0.1) ? 0 : random.between(1, most)));
  }
  const double rough = std::pow(10, random.between(0, 3));
  const double unit = whole || random.chance(0.5) ? 1 : random.chance(0.8) ? 10 : 3.1;
  const auto height = [&](GridPoint p) {
    return std::round(300 * std::sin(p.col / 90.0) + rough * random.between(-100, 100) / 50.0) / unit + 0.0;  // not -0
  };
  const bool has_covers = random.chance(0.4);
  for (const auto& [at, error] : errors) {
    const GridPoint p{at.second, at.first};
    made.slice.places.push_back(place_in_tile(p));
    made.slice.heights.push_back(height(p));
    made.slice.errors.push_back(error);
    if (has_covers)
      made.slice.covers.push_back(static_cast<std::uint8_t>(random.chance(0.7) ? 15 : random.between(0, 15)));
  }
  for (std::size_t i = 0; i < made.slice.posts.size(); ++i)
    made.slice.posts[i] = height({static_cast<int>(i % 16) * 64, static_cast<int>(i / 16) * 64});
  return made;
}

using Vertex = std::tuple<std::uint32_t, double, std::int32_t, int>;
std::set<Vertex> vertices_of(const TileSlice& slice) {
  std::set<Vertex> vertices;
  for (std::size_t i = 0; i < slice.size(); ++i) {
    vertices.insert(
        {slice.places[i], slice.heights[i], slice.errors[i], slice.covers.empty() ? 15 : int{slice.covers[i]}});
  }
  return vertices;
}

TEST(TileSlice, ComesBackVertexByVertex) {
  SliceCoder writer, reader;
  int kept = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Case made = random_case(random);
    const auto bytes = writer.encode(made.id, made.extent, made.distance, made.slice);
    if (SliceCoder::threshold_of(bytes) == kNoSlice) continue;
    ++kept;
    const TileSlice& back = reader.decode(made.id, made.extent, made.distance, bytes);
    ASSERT_EQ(back.above, made.slice.above);
    ASSERT_EQ(SliceCoder::threshold_of(bytes), made.slice.above);
    ASSERT_EQ(back.size(), made.slice.size());
    ASSERT_EQ(vertices_of(back), vertices_of(made.slice));
    ASSERT_EQ(back.posts, made.slice.posts);
    const std::set<std::uint32_t> places(made.slice.places.begin(), made.slice.places.end());
    for (int i = 0; i < 500; ++i) {
      const auto place = static_cast<std::uint32_t>(random.between(0, kTileSide * kTileSide - 1));
      const bool is_post = place % kTileSide % kBlockSide == 0 && place / kTileSide % kBlockSide == 0;
      ASSERT_TRUE(is_post || reader.has(place) == places.contains(place));
    }
  }
  EXPECT_GT(kept, 80) << "most can be sliced, but no doubles with all their bits";
}

TEST(TileSlice, HasTheSameBytesInAnyOrder) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    Case made = random_case(random);
    SliceCoder writer;
    const auto bytes = writer.encode(made.id, made.extent, made.distance, made.slice);
    TileSlice& s = made.slice;
    for (std::size_t i = s.size(); i > 1; --i) {
      const std::size_t j = below(random, i);
      std::swap(s.places[i - 1], s.places[j]);
      std::swap(s.heights[i - 1], s.heights[j]);
      std::swap(s.errors[i - 1], s.errors[j]);
      if (!s.covers.empty()) std::swap(s.covers[i - 1], s.covers[j]);
    }
    ASSERT_EQ(writer.encode(made.id, made.extent, made.distance, s), bytes) << seed;
  }
}

TEST(TileSlice, HoldsNothingWhereAVertexLacksAParentOrAHeightIsTooFar) {
  const GridRect extent{{0, 0}, {4000, 4000}};
  const CodeDistance distance = distance_of(true);
  SliceCoder coder;
  TileSlice slice;
  slice.places = {place_in_tile({33, 32})};  // its parents have spacings 1 and more, and none is there
  slice.heights = {7};
  slice.errors = {9};
  const auto nothing = coder.encode({0, 0}, extent, distance, slice);
  EXPECT_EQ(SliceCoder::threshold_of(nothing), kNoSlice);
  EXPECT_EQ(nothing.size(), 8u);
  EXPECT_EQ(coder.decode({0, 0}, extent, distance, nothing).size(), 0u);
  slice.errors = {0};
  const auto left_out = coder.encode({0, 0}, extent, distance, slice);
  EXPECT_EQ(SliceCoder::threshold_of(left_out), 0) << "not above: only the border of the extent asked for it";
  EXPECT_EQ(coder.decode({0, 0}, extent, distance, left_out).size(), 0u);
  slice.errors = {9};
  slice.places = {place_in_tile({32, 32})};  // between posts
  EXPECT_EQ(SliceCoder::threshold_of(coder.encode({0, 0}, extent, distance, slice)), 0);
  slice.heights = {5e9};
  EXPECT_EQ(SliceCoder::threshold_of(coder.encode({0, 0}, extent, distance, slice)), kNoSlice);
  slice.heights = {0.5};
  EXPECT_EQ(SliceCoder::threshold_of(coder.encode({0, 0}, extent, distance, slice)), kNoSlice) << "not whole";
  slice.heights = {7};
  slice.errors = {kMostEighths};
  EXPECT_EQ(SliceCoder::threshold_of(coder.encode({0, 0}, extent, distance, slice)), kNoSlice);
}

/// The distance of a vertex may be more than its error: a void has a height that nobody measured.
TEST(TileSlice, MayHaveErrorsBelowTheDistanceFromTheMiddle) {
  const GridRect extent{{0, 0}, {1023, 1023}};
  for (const bool whole : {true, false}) {
    TileSlice slice;
    slice.above = 10;
    slice.places = {place_in_tile({32, 32}), place_in_tile({32, 96})};
    slice.heights = {3000, 1};
    slice.errors = {11, 12};
    SliceCoder coder;
    const auto bytes = coder.encode({0, 0}, extent, distance_of(whole), slice);
    EXPECT_EQ(vertices_of(coder.decode({0, 0}, extent, distance_of(whole), bytes)), vertices_of(slice));
  }
}

/// Damaged bytes are refused, or are another slice of the same tile: one that could be written.
TEST(TileSlice, DamagedBytesAreRefusedOrSound) {
  SliceCoder writer, reader;
  int refused = 0, read = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Case made = random_case(random);
    auto bytes = writer.encode(made.id, made.extent, made.distance, made.slice);
    switch (below(random, 4)) {
      case 0: bytes.resize(below(random, bytes.size())); break;
      case 1: bytes.resize(bytes.size() + 1 + below(random, 9)); break;
      default:
        for (int i = random.between(1, 3); i > 0; --i)
          bytes[below(random, random.chance(0.5) ? bytes.size() : std::min<std::size_t>(bytes.size(), 150))] ^=
              static_cast<std::byte>(1u << below(random, 8));
    }
    try {
      const TileSlice& slice = reader.decode(made.id, made.extent, made.distance, bytes);
      ++read;
      for (std::size_t i = 0; i < slice.size(); ++i) {
        ASSERT_LT(slice.places[i], static_cast<std::uint32_t>(kTileSide * kTileSide));
        ASSERT_GE(slice.errors[i], slice.above);
        ASSERT_TRUE(std::isfinite(slice.heights[i]));
      }
    } catch (const Failure& f) {
      ++refused;
      ASSERT_EQ(f.cause(), Cause::corrupt) << f.what();
    }
  }
  EXPECT_GT(refused, 200);
  EXPECT_LT(read, 200);
}

// ---- pages that are in a slice ----------------------------------------------------------------------------

/// A page with voids and nothing else, as encode_in_slice() takes it.
Page page_of_voids(PageId id, GridRect extent, double voids, Random& random) {
  Page page;
  page.id = id;
  page.bands = band_count(extent);
  page.grid = page_grid(id, extent);
  for (std::size_t i = 0; voids > 0 && i < page.grid.size(); ++i) {
    page.valid.push_back(random.chance(voids) ? 0 : 1);
    page.covers.push_back(0);
  }
  for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
    if (voids > 0 && page.is_own(p)) page.covers[i] = static_cast<std::uint8_t>(random.chance(voids) ? 0 : 15);
  });
  if (id.band > 0) page.children.resize(kChildrenAcross * kChildrenAcross);
  return page;
}

struct Slicing {
  Case of;
  std::vector<std::byte> bytes;
  [[nodiscard]] PageDecoder::BytesOf given() const {
    return [this](PageId id, PageDecoder::Content what) {
      EXPECT_EQ(what, PageDecoder::Content::slice);
      EXPECT_EQ(id, (PageId{1, of.id.x, of.id.y}));
      return std::span<const std::byte>(bytes);
    };
  }
};

/// A slice of codes.
Slicing slicing(std::uint64_t seed) {
  Slicing made;
  do {
    Random random(seed);
    made.of = random_case(random);
    made.bytes = SliceCoder().encode(made.of.id, made.of.extent, made.of.distance, made.of.slice);
    seed += 1000;
  } while (made.of.distance.is_whole() || SliceCoder::threshold_of(made.bytes) == kNoSlice);
  return made;
}

TEST(TileSlice, PagesInItHaveItsHeightsAndErrors) {
  PageDecoder decoder;  // for all tiles: the last slice must not serve another one
  PageEncoder encoder;
  std::size_t own_held = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    const Slicing s = slicing(seed);
    const auto& [id, extent, distance, slice] = s.of;
    const GridPoint corner{id.x * kTileSide, id.y * kTileSide};
    std::map<std::uint32_t, std::size_t> at;
    for (std::size_t i = 0; i < slice.size(); ++i) at[slice.places[i]] = i;
    Random random(seed);
    std::vector<PageId> ids{{1, id.x, id.y}};
    for (std::size_t k = 0; k < 64; k += 9) ids.push_back(child_page(ids.front(), k));
    for (const PageId page_id : ids) {
      // Near the border a page must have all heights, so where the tile is cut all is void.
      const bool is_amid = extent.contains(corner) && extent.contains({corner.col + 1500, corner.row + 1500});
      const Page page = page_of_voids(page_id, extent, is_amid ? random.chance(0.5) ? 0.4 : 0 : 1, random);
      if (page.grid.size() == 0) continue;
      const auto bytes = encoder.encode_in_slice(page, digest_of(s.bytes));
      const Page& back = decoder.decode(page_id, extent, page.bands, distance, bytes, s.given());
      EXPECT_TRUE(back.is_sliced());
      EXPECT_EQ(back.valid, page.valid);
      EXPECT_EQ(back.covers, page.covers);
      for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
        const std::uint32_t place = place_in_tile(p);
        if (spacing(p) >= kBlockSide) {
          ASSERT_EQ(back.height(i), slice.posts[place / kTileSide / 64 * 16 + place % kTileSide / 64]);
          ASSERT_FALSE(back.is_dropped(i));
          return;
        }
        const auto found = at.find(place);
        ASSERT_EQ(back.is_dropped(i), found == at.end());
        const std::int32_t error = found == at.end() ? 0 : slice.errors[found->second];
        ASSERT_EQ(back.error(i, distance), back.is_own(p) && error > slice.above ? error : 0);
        if (found == at.end()) return;
        ASSERT_EQ(back.height(i), slice.heights[found->second]);
        own_held += back.is_own(p) ? 1 : 0;
      });
    }
  }
  EXPECT_GT(own_held, 3000u);
}

TEST(TileSlice, PagesInAnotherOneAreRefused) {
  const Slicing s = slicing(3), other = slicing(4);
  const auto& [id, extent, distance, slice] = s.of;
  Random random(1);
  const PageId page_id{1, id.x, id.y};
  const Page page = page_of_voids(page_id, extent, 1, random);
  const auto refusal = [&](std::span<const std::byte> bytes, const PageDecoder::BytesOf& given,
                           const CodeDistance& in) -> std::string {
    try {
      static_cast<void>(PageDecoder().decode(page_id, extent, page.bands, in, bytes, given));
      return "";
    } catch (const Failure& f) {
      EXPECT_EQ(f.cause(), Cause::corrupt);
      return f.what();
    }
  };
  PageEncoder encoder;
  const auto bytes = encoder.encode_in_slice(page, digest_of(s.bytes));
  EXPECT_EQ(refusal(bytes, s.given(), distance), "");
  const auto says = [](const std::string& what, const char* word) {
    EXPECT_NE(what.find(word), std::string::npos) << what;
  };
  says(refusal(bytes, {}, distance), "the slice of its tile is missing");
  says(refusal(encoder.encode_in_slice(page, digest_of(other.bytes)), s.given(), distance), "another slice");
  says(refusal(bytes, s.given(), distance_of(true)), "cannot be in a slice");
  Slicing none = s;
  TileSlice nothing;
  nothing.above = kNoSlice;
  none.bytes = SliceCoder().encode(id, extent, distance, nothing);
  says(refusal(encoder.encode_in_slice(page, digest_of(none.bytes)), none.given(), distance), "holds nothing");
  for (const std::size_t at : {1, 3, 6, 16, 20}) {  // coding, form, width, lengths
    auto changed = bytes;
    changed[at] ^= std::byte{at == 6 ? std::uint8_t{6} : std::uint8_t{1}};
    EXPECT_NE(refusal(changed, s.given(), distance), "") << at;
  }
}

TEST(TileSlice, ThatIsAllHoldsAllOrNothing) {
  const GridRect extent{{0, 0}, {4000, 4000}};
  TileSlice slice;
  slice.places = {place_in_tile({32, 32}), place_in_tile({1, 0})};  // the second lacks its parents
  slice.heights = {7, 8};
  slice.errors = {9, 0};
  const auto threshold = [&] {
    return SliceCoder::threshold_of(SliceCoder().encode({0, 0}, extent, distance_of(false), slice));
  };
  EXPECT_EQ(threshold(), 0) << "it is left out";
  slice.is_all = true;
  EXPECT_EQ(threshold(), kNoSlice);
}

}  // namespace
}  // namespace talus::support
