// Streams: what is read back, what any damage does.

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "engine/stream/stream_codec.hpp"
#include "talus/ingest.hpp"
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
    const RestrictedQuadtree answer = now.ask({.region = region, .tolerance = from}).quadtree;
    const Increment increment = increment_of(now.ask({.region = region, .tolerance = to, .from = from}));
    const Bytes first = encode({now.description(), answer}),
                second = encode({now.description(), increment}, {}, &answer);
    const Stream a = decode_stream(first), b = decode_stream(second, {}, &answer);
    const auto& answer_back = std::get<RestrictedQuadtree>(a.content);
    const auto& increment_back = std::get<Increment>(b.content);
    ASSERT_EQ(difference(answer_back, answer), "");
    ASSERT_EQ(difference(increment_back.added, increment.added), "");
    EXPECT_EQ(increment_back.from, from);
    EXPECT_EQ(difference(merge(answer_back, increment_back), now.ask({.region = region, .tolerance = to}).quadtree),
              "");
    StreamOptions options;
    options.stripes = 1 + static_cast<int>(seed % 4);
    options.threads = 2;
    const Bytes other = encode({now.description(), answer}, options);
    ASSERT_EQ(difference(std::get<RestrictedQuadtree>(decode_stream(other, {}, nullptr, 2).content), answer), "");
    options.threads = 1;
    EXPECT_TRUE(encode({now.description(), answer}, options) == other) << "threads change nothing";
    const Bytes more = encode({now.description(), increment}, options, &answer);
    ASSERT_EQ(difference(std::get<Increment>(decode_stream(more, {}, &answer).content).added, increment.added), "");
    StreamDecoder slowly;
    for (std::size_t at = 0; at < first.size();) {
      const auto count = std::min(first.size() - at, static_cast<std::size_t>(random.between(1, 300)));
      slowly.add(std::span(first).subspan(at, count));
      at += count;
    }
    slowly.require_whole();
    EXPECT_EQ(difference(std::get<RestrictedQuadtree>(slowly.stream().content), answer), "");
    EXPECT_TRUE(encode(a) == first && encode(b, {}, &answer) == second) << "one stream, one sequence of bytes";
    const Description &d = a.description, &said = now.description();
    EXPECT_TRUE(d.extent == said.extent && d.mapping == said.mapping && d.crs_wkt == said.crs_wkt &&
                d.step == said.step && d.vertical_unit == said.vertical_unit &&
                d.metres_per_unit == said.metres_per_unit);

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
  const RestrictedQuadtree answer = now.ask({.region = now.description().extent, .tolerance = Metres{2}}).quadtree;
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

/// A stream, and what it goes on from if it is an increment.
struct Example {
  Bytes bytes;
  std::optional<RestrictedQuadtree> base;
  StreamOptions options;
  [[nodiscard]] const RestrictedQuadtree* below() const { return base ? &*base : nullptr; }
};

void expect_corrupt(const Example& example, const Bytes& bytes, const std::string& what) {
  try {
    static_cast<void>(decode_stream(bytes, {}, example.below()));
    ADD_FAILURE() << what << " was not noticed";
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::corrupt) << what << ": " << f.what();
    EXPECT_THAT(f.what(), ::testing::StartsWith("corrupt: byte ")) << what;
  }
}

std::vector<Example> examples() {
  const Made made(small());
  const Snapshot now = made.now();
  Question cover;
  cover.region = {{5, 5}, {20, 17}};
  cover.tolerance = Metres{5};
  cover.border = Border::cover;
  const GridRect region{{3, 3}, {36, 30}};
  const RestrictedQuadtree base = now.ask({.region = region, .tolerance = Metres{10}}).quadtree,
                           finer = now.ask({.region = region, .tolerance = Metres{3}}).quadtree;
  std::vector<Example> made_of;
  for (const int stripes : {1, 2}) {
    const StreamOptions options{.stripes = stripes};
    made_of.push_back({encode({now.description(), finer}, options), std::nullopt, options});
    made_of.push_back({encode({now.description(),
                               increment_of(now.ask({.region = region, .tolerance = Metres{3}, .from = Metres{10}}))},
                              options, &base),
                       base, options});
    made_of.push_back({encode({now.description(), now.ask(cover).quadtree}, options), std::nullopt, options});
  }
  return made_of;
}

TEST(Streams, CutAnywhereAreCorrupt) {
  for (const Example& example : examples()) {
    const Bytes& bytes = example.bytes;
    for (std::size_t size = 0; size < bytes.size(); ++size)
      expect_corrupt(example, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)},
                     "cut to " + std::to_string(size));
    Bytes longer = bytes;
    longer.push_back(std::byte{0});
    expect_corrupt(example, longer, "a byte more");
  }
}

TEST(Streams, WithAnyByteFlippedAreCorrupt) {
  for (const Example& example : examples()) {
    for (std::size_t i = 0; i < example.bytes.size(); ++i) {
      for (const int bit : {0, 3, 7}) {
        Bytes flipped = example.bytes;
        flipped[i] ^= static_cast<std::byte>(1 << bit);
        expect_corrupt(example, flipped, "byte " + std::to_string(i));
      }
    }
  }
}

/// Makes the checksums fit again, as far as lengths lead through the bytes.
void reseal(Bytes& bytes) {
  const auto word = [&](std::size_t at) {
    std::uint32_t v = 0;
    if (at + 4 <= bytes.size()) std::memcpy(&v, &bytes[at], 4);
    return v;
  };
  std::size_t begin = 0, size = word(12);
  if (size < 40 || size > bytes.size()) return;
  std::uint64_t seed = XXH3_64bits_withSeed(bytes.data(), size - 8, 0);
  std::memcpy(bytes.data() + size - 8, &seed, 8);
  for (begin = size; begin + 12 <= bytes.size(); begin += size) {
    size = std::size_t{12} + word(begin);
    if (size > bytes.size() - begin) return;
    seed = XXH3_64bits_withSeed(bytes.data() + begin, size - 4, seed);
    std::memcpy(bytes.data() + begin + size - 4, &seed, 4);
  }
}

TEST(Streams, WrittenByAnEnemyAreRefusedOrSound) {
  const int cases = property_cases(30000);
  std::size_t accepted = 0, refused = 0;
  Random random(11);
  const std::vector<Example> sound = examples();
  for (int i = 0; i < cases; ++i) {
    const Example& example = sound[static_cast<std::size_t>(random.between(0, static_cast<int>(sound.size()) - 1))];
    Bytes bytes = example.bytes;
    std::uint32_t header = 0;
    std::memcpy(&header, &bytes[12], 4);
    for (int changes = random.between(1, 3); changes > 0; --changes) {
      const bool in_header = random.chance(0.3);
      const auto at =
          static_cast<std::size_t>(random.between(0, static_cast<int>(in_header ? header : bytes.size()) - 1));
      static const int values[] = {0, 1, 0x7f, 0x80, 0xff};
      bytes[at] = random.chance(0.5) ? static_cast<std::byte>(values[random.between(0, 4)])
                                     : static_cast<std::byte>(random.between(0, 255));
    }
    reseal(bytes);
    try {
      StreamLimits limits;
      limits.mask_bytes = 1 << 20;
      const Stream stream = decode_stream(bytes, limits, example.below());
      const Stream again = decode_stream(encode(stream, example.options, example.below()), {}, example.below());
      const auto* answer = std::get_if<RestrictedQuadtree>(&stream.content);
      EXPECT_EQ(answer != nullptr
                    ? difference(*answer, std::get<RestrictedQuadtree>(again.content))
                    : difference(std::get<Increment>(stream.content).added, std::get<Increment>(again.content).added),
                "")
          << "what is read can be written";
      if (answer != nullptr && answer->origin.border == Border::constrain) static_cast<void>(triangulate(*answer));
      ++accepted;
    } catch (const Failure& f) {
      EXPECT_TRUE(f.cause() == Cause::corrupt || f.cause() == Cause::unsupported ||
                  f.cause() == Cause::invalid_argument)
          << f.what();
      ++refused;
    }
  }
  std::printf("%zu refused, %zu read\n", refused, accepted);
  EXPECT_GT(refused, 0u);
  EXPECT_GT(accepted, 0u);
}

TEST(Streams, OfAnotherVersionAreNotDamaged) {
  Bytes bytes = examples().front().bytes;
  bytes[8] = std::byte{2};
  reseal(bytes);
  try {
    static_cast<void>(decode_stream(bytes));
    ADD_FAILURE();
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::unsupported);
    EXPECT_THAT(f.what(), ::testing::HasSubstr("version 2"));
  }
}

TEST(Streams, OfErrorsAndCodingsOfEarlierVersionsAreNotDamaged) {
  const auto refused_with = [](std::size_t at, unsigned bits, const char* named) {
    Bytes bytes = examples().front().bytes;
    bytes[at] = (at == 232 ? std::byte{0} : bytes[at]) | static_cast<std::byte>(bits);
    reseal(bytes);
    try {
      static_cast<void>(stream_info(bytes));
      ADD_FAILURE() << named;
    } catch (const Failure& f) {
      EXPECT_EQ(f.cause(), Cause::unsupported) << f.what();
      EXPECT_THAT(f.what(), ::testing::HasSubstr(named));
    }
  };
  refused_with(16, 128, "nested or midpoint errors");
  refused_with(17, 1, "nested or midpoint errors");
  for (const unsigned coding : {0u, 2u, 3u}) refused_with(232, coding, "reads coding 1 only");
}

TEST(Streams, WithALargerMaskThanAllowedAreRefusedBeforeItIsMade) {
  try {
    static_cast<void>(decode_stream(examples().front().bytes, {100}));
    ADD_FAILURE();
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::unsupported);
    EXPECT_THAT(f.what(), ::testing::HasSubstr("StreamLimits allow 100"));
  }
}

TEST(Streams, OfMoreVerticesThanAllowedAreRefused) {
  try {
    StreamLimits limits;
    limits.vertices = 10;
    static_cast<void>(decode_stream(examples().front().bytes, limits));
    ADD_FAILURE();
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::unsupported);
    EXPECT_THAT(f.what(), ::testing::HasSubstr("StreamLimits allow 10"));
  }
}

TEST(Streams, AFileOfAFewBytesMayNotPromiseAnyNumberOfVertices) {
  Bytes bytes = examples().front().bytes;
  const StreamInfo info = stream_info(bytes);
  ASSERT_GT(info.vertices, 3u);
  std::uint32_t header = 0;
  std::memcpy(&header, &bytes[12], 4);
  std::size_t at = 0;  // where the header says how many there are
  for (std::size_t i = 88; i + 8 < header && at == 0; ++i) at = std::memcmp(&bytes[i], &info.vertices, 8) == 0 ? i : 0;
  ASSERT_NE(at, 0u);
  const std::uint64_t promised = std::uint64_t{1} << 29;
  std::memcpy(&bytes[at], &promised, 8);
  reseal(bytes);
  const TempFolder folder;
  std::ofstream(folder / "forged.rqt", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  try {
    static_cast<void>(read_stream(folder / "forged.rqt"));
    ADD_FAILURE();
  } catch (const Failure& f) {
    EXPECT_EQ(f.cause(), Cause::unsupported);
    EXPECT_THAT(f.what(), ::testing::HasSubstr("StreamLimits allow"));
    EXPECT_EQ(f.file(), folder / "forged.rqt");
  }
}

TEST(Streams, FloatsThatAreWholeNumbersTakeNoMoreThanWholeNumbers) {
  const Terrain whole = fit(fractal(90, 70, 4, 600), SampleType::int16);
  const auto bytes_of = [](const Terrain& terrain, SampleType type) {
    RasterOptions file;
    file.type = type;
    const Made made(terrain, file);
    const Snapshot now = made.now();
    const RestrictedQuadtree answer = now.ask({.region = now.description().extent, .tolerance = Metres{2}}).quadtree;
    const Bytes bytes = encode({now.description(), answer});
    const Stream back = decode_stream(bytes);
    const auto& heights = std::get<RestrictedQuadtree>(back.content).heights;
    EXPECT_EQ(heights.size(), answer.heights.size());
    for (std::size_t i = 0; i < heights.size(); ++i)
      EXPECT_EQ(std::bit_cast<std::uint64_t>(heights[i]), std::bit_cast<std::uint64_t>(answer.heights[i]));
    return bytes.size();
  };
  const std::size_t short_ints = bytes_of(whole, SampleType::int16), floats = bytes_of(whole, SampleType::float32),
                    doubles = bytes_of(whole, SampleType::float64);
  EXPECT_LE(floats, short_ints + 16);
  EXPECT_LE(doubles, short_ints + 16);
  Terrain odd = whole;
  odd.at(45, 35) = -0.0;  // no whole number has that sign
  EXPECT_GT(bytes_of(odd, SampleType::float32), 2 * short_ints);
  odd.at(45, 35) = 700.5;
  EXPECT_GT(bytes_of(odd, SampleType::float32), 2 * short_ints);
}

TEST(Streams, FilesAreNamedWhereTheyAreDamagedOrMissing) {
  const TempFolder folder;
  const Bytes bytes = examples().front().bytes;
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
