// Streams: what is read back, what any damage does.

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "engine/stream_codec.hpp"
#include "talus/talus.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/quadtrees.hpp"
#include "tests/support/random_raster.hpp"

namespace talus::support {
namespace {

using Bytes = std::vector<std::byte>;

struct Made {
  explicit Made(const Terrain& terrain, const RasterOptions& file = {}) {
    write_raster(terrain, folder / "a.tif", file);
    ingest(folder / "a.tif", folder / "a.talus");
  }
  [[nodiscard]] Snapshot now() const { return Database::open(folder / "a.talus").snapshot(); }
  TempFolder folder;
};

Terrain small() { return fit(random_voids(fractal(40, 33, 4, 200), 0.03, 5), SampleType::int16); }

TEST(Streams, AreReadBackBitForBit) {
  const int cases = property_cases(150);
  for (int i = 0; i < cases; ++i) {
    const auto seed = 81000 + static_cast<std::uint64_t>(i);
    const RandomRaster raster = random_raster(seed);
    SCOPED_TRACE(raster.description);
    const Made made(raster.terrain, raster.file);
    const Snapshot now = made.now();
    Random random(seed);
    const GridRect region = random_region(random, raster.terrain);
    const Metres to{random.log_between(0.01, 50)}, from{to.value * (1 + random.unit())};
    const RestrictedQuadtree answer = now.range(region, from).quadtree;
    const Increment increment = now.increment(region, from, to);
    const Bytes first = encode({now.description(), answer}), second = encode({now.description(), increment});
    const Stream a = decode_stream(first), b = decode_stream(second);
    const auto& answer_back = std::get<RestrictedQuadtree>(a.content);
    const auto& increment_back = std::get<Increment>(b.content);
    ASSERT_EQ(difference(answer_back, answer), "");
    ASSERT_EQ(difference(increment_back.added, increment.added), "");
    EXPECT_EQ(increment_back.from, from);
    EXPECT_EQ(difference(merge(answer_back, increment_back), now.range(region, to).quadtree), "");
    EXPECT_TRUE(encode(a) == first && encode(b) == second) << "one stream, one sequence of bytes";
    const Description &d = a.description, &said = now.description();
    EXPECT_TRUE(d.extent == said.extent && d.mapping == said.mapping && d.crs_wkt == said.crs_wkt && d.step == said.step &&
                d.vertical_unit == said.vertical_unit && d.metres_per_unit == said.metres_per_unit);

    Question question;
    question.region = region;
    question.tolerance = from;
    for (const Border border : {Border::cover, Border::clip, Border::constrain}) {
      question.border = border;
      question.max_level = border == Border::constrain ? 4 : 31;
      const RestrictedQuadtree asked = now.ask(question).quadtree;
      const Stream back = decode_stream(encode({said, asked}));
      EXPECT_EQ(difference(std::get<RestrictedQuadtree>(back.content), asked), "");
    }
  }
}

TEST(Streams, OfWhichOnlyWholePartsArrivedAreQuadtreesWithTheirBound) {
  const Terrain terrain = small();
  const Made made(terrain);
  const Snapshot now = made.now();
  const RestrictedQuadtree answer = now.range(now.description().extent, Metres{2}).quadtree;
  const Bytes bytes = encode({now.description(), answer});
  const Progression levels(answer);
  std::size_t parts = 0;
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    StreamPrefix prefix;
    try {
      prefix = decode_stream_prefix(std::span(bytes).first(size));
    } catch (const Failure& f) {
      EXPECT_EQ(f.cause(), Cause::corrupt);
      EXPECT_EQ(parts, 0u) << "header and first part are needed, and nothing else";
      continue;
    }
    EXPECT_GE(prefix.parts, parts);
    EXPECT_LE(prefix.bytes, size);
    if (prefix.parts == parts) continue;
    parts = prefix.parts;
    EXPECT_EQ(prefix.bytes, size) << "as soon as it is there";
    const auto& q = std::get<RestrictedQuadtree>(prefix.stream.content);
    const RestrictedQuadtree expected = levels.prefix(answer, parts);
    EXPECT_EQ(q.vertices.size(), expected.vertices.size());
    EXPECT_EQ(q.heights, expected.heights);
    EXPECT_EQ(q.bound, levels.bound(parts - 1));
    const auto report = check_mesh(triangulate(q), terrain, 1, q.bound.value);
    EXPECT_LE(report.largest_error, q.bound.value);
    EXPECT_EQ(report.uncovered_samples, 0u);
  }
  EXPECT_EQ(parts, levels.steps());
}

void expect_corrupt(const Bytes& bytes, const std::string& what) {
  try {
    static_cast<void>(decode_stream(bytes));
    ADD_FAILURE() << what << " was not noticed";
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::corrupt) << what << ": " << f.what();
    EXPECT_THAT(f.what(), ::testing::StartsWith("corrupt: byte ")) << what;
  }
}

std::vector<Bytes> examples() {
  const Made made(small());
  const Snapshot now = made.now();
  Question cover;
  cover.region = {{5, 5}, {20, 17}};
  cover.tolerance = Metres{5};
  cover.border = Border::cover;
  return {encode({now.description(), now.range({{3, 3}, {36, 30}}, Metres{3}).quadtree}),
          encode({now.description(), now.increment({{3, 3}, {36, 30}}, Metres{10}, Metres{3})}),
          encode({now.description(), now.ask(cover).quadtree})};
}

TEST(Streams, CutAnywhereAreCorrupt) {
  for (const Bytes& bytes : examples()) {
    for (std::size_t size = 0; size < bytes.size(); ++size)
      expect_corrupt({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}, "cut to " + std::to_string(size));
    Bytes longer = bytes;
    longer.push_back(std::byte{0});
    expect_corrupt(longer, "a byte more");
  }
}

TEST(Streams, WithAnyByteFlippedAreCorrupt) {
  for (const Bytes& bytes : examples()) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      for (const int bit : {0, 3, 7}) {
        Bytes flipped = bytes;
        flipped[i] ^= static_cast<std::byte>(1 << bit);
        expect_corrupt(flipped, "byte " + std::to_string(i));
      }
    }
  }
}

/// Makes the checksums fit again, as far as the sizes still lead through the bytes.
void reseal(Bytes& bytes, const std::vector<std::size_t>& ends) {
  std::uint64_t seed = 0;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    if (end > bytes.size()) return;
    seed = XXH3_64bits_withSeed(bytes.data() + begin, end - 8 - begin, seed);
    std::memcpy(bytes.data() + end - 8, &seed, 8);
    begin = end;
  }
}

TEST(Streams, WrittenByAnEnemyAreRefusedOrSound) {
  const int cases = property_cases(30000);
  std::size_t accepted = 0, refused = 0;
  Random random(11);
  const std::vector<Bytes> sound = examples();
  std::vector<std::vector<std::size_t>> ends(sound.size());
  for (std::size_t e = 0; e < sound.size(); ++e) {
    std::uint32_t header = 0;
    std::memcpy(&header, &sound[e][12], 4);
    ends[e] = {header};
    for (std::size_t size = header + 1; size <= sound[e].size(); ++size) {
      try {
        const auto at = decode_stream_prefix(std::span(sound[e]).first(size)).bytes;
        if (at != ends[e].back()) ends[e].push_back(at);
      } catch (const Failure&) {
      }
    }
    EXPECT_EQ(ends[e].back(), sound[e].size());
  }
  for (int i = 0; i < cases; ++i) {
    const auto e = static_cast<std::size_t>(random.between(0, static_cast<int>(sound.size()) - 1));
    Bytes bytes = sound[e];
    for (int changes = random.between(1, 3); changes > 0; --changes) {
      const bool in_header = random.chance(0.5);
      const auto at = static_cast<std::size_t>(
          random.between(0, static_cast<int>(in_header ? ends[e].front() : bytes.size()) - 1));
      static const int values[] = {0, 1, 0x7f, 0x80, 0xff};
      bytes[at] = random.chance(0.5) ? static_cast<std::byte>(values[random.between(0, 4)])
                                     : static_cast<std::byte>(random.between(0, 255));
    }
    reseal(bytes, ends[e]);
    try {
      StreamLimits limits;
      limits.mask_bytes = 1 << 20;
      const Stream stream = decode_stream(bytes, limits);
      const Stream again = decode_stream(encode(stream));
      const auto* answer = std::get_if<RestrictedQuadtree>(&stream.content);
      EXPECT_EQ(answer != nullptr ? difference(*answer, std::get<RestrictedQuadtree>(again.content))
                                  : difference(std::get<Increment>(stream.content).added, std::get<Increment>(again.content).added),
                "")
          << "what is read can be written";
      if (answer != nullptr) {
        if (answer->origin.border == Border::constrain) static_cast<void>(triangulate(*answer));
      }
      ++accepted;
    } catch (const Failure& f) {
      EXPECT_TRUE(f.cause() == Cause::corrupt || f.cause() == Cause::unsupported) << f.what();
      ++refused;
    }
  }
  std::printf("%zu refused, %zu read\n", refused, accepted);
  EXPECT_GT(refused, 0u);
  EXPECT_GT(accepted, 0u);
}

TEST(Streams, OfAnotherVersionAreNotDamaged) {
  Bytes bytes = examples().front();
  bytes[8] = std::byte{1};
  std::uint32_t header = 0;
  std::memcpy(&header, &bytes[12], 4);
  reseal(bytes, {header});
  try {
    static_cast<void>(decode_stream(bytes));
    ADD_FAILURE();
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::unsupported);
    EXPECT_THAT(f.what(), ::testing::HasSubstr("version 1"));
  }
}

TEST(Streams, WithALargerMaskThanAllowedAreRefusedBeforeItIsMade) {
  try {
    static_cast<void>(decode_stream(examples().front(), {100}));
    ADD_FAILURE();
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::unsupported);
    EXPECT_THAT(f.what(), ::testing::HasSubstr("100 are allowed"));
  }
}

TEST(Streams, FilesAreNamedWhereTheyAreDamagedOrMissing) {
  const TempFolder folder;
  const Bytes bytes = examples().front();
  const auto write = [&](std::size_t size) {
    std::ofstream out(folder / "a.rqt", std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(size));
  };
  const auto failure = [&](const std::string& name) {
    try {
      static_cast<void>(read_stream(folder / name));
    } catch (const Failure& f) {
      return std::string(to_string(f.cause())) + "|" + f.what();
    }
    return std::string();
  };
  write(bytes.size());
  EXPECT_EQ(failure("a.rqt"), "");
  write(200);
  EXPECT_THAT(failure("a.rqt"), ::testing::MatchesRegex("corrupt\\|corrupt: .*a.rqt: byte 200: .*"));
  write(0);
  EXPECT_THAT(failure("a.rqt"), ::testing::HasSubstr("byte 0"));
  EXPECT_THAT(failure("b.rqt"), ::testing::StartsWith("not found|cannot read"));
  EXPECT_THROW(write_stream(decode_stream(bytes), folder / "a.ply"), Failure);
}

}  // namespace
}  // namespace talus::support
