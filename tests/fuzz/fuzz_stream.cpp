// Arbitrary bytes as a stream, and the same with checksums that fit: refused, or one that is written and read again.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include <xxhash.h>

#include "engine/stream_codec.hpp"
#include "engine/triangulation.hpp"
#include "talus/failure.hpp"

namespace {

using namespace talus;

void require(bool holds) {
  if (!holds) std::abort();
}

void look_at(std::span<const std::byte> bytes) {
  const StreamLimits limits{std::uint64_t{1} << 22};
  try {
    static_cast<void>(decode_stream_prefix(bytes, limits));
  } catch (const Failure& failure) {
    require(failure.cause() == Cause::corrupt || failure.cause() == Cause::unsupported);
  }
  try {
    const Stream stream = decode_stream(bytes, limits);
    const auto once = encode(stream);
    require(encode(decode_stream(once)) == once);
    const auto* answer = std::get_if<RestrictedQuadtree>(&stream.content);
    if (answer != nullptr && answer->origin.border == Border::constrain) static_cast<void>(triangulate(*answer, 1));
  } catch (const Failure& failure) {
    require(failure.cause() == Cause::corrupt || failure.cause() == Cause::unsupported);
  }
}

template <class T>
T at(const std::vector<std::byte>& bytes, std::size_t where) {
  T value{};
  if (where + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + where, sizeof value);
  return value;
}

/// Makes each checksum that the sizes lead to fit.
void reseal(std::vector<std::byte>& bytes) {
  std::uint64_t seed = 0;
  std::size_t begin = 0;
  const auto seal = [&](std::uint64_t size) {
    if (size < 8 || size > bytes.size() - begin) return false;
    seed = XXH3_64bits_withSeed(bytes.data() + begin, static_cast<std::size_t>(size - 8), seed);
    std::memcpy(bytes.data() + begin + size - 8, &seed, 8);
    begin += static_cast<std::size_t>(size);
    return true;
  };
  if (!seal(at<std::uint32_t>(bytes, 12))) return;
  const bool has_covers = (at<std::uint32_t>(bytes, 16) & 4) != 0;
  const std::int64_t sides[] = {at<std::int32_t>(bytes, 56), at<std::int32_t>(bytes, 60), at<std::int32_t>(bytes, 64),
                                at<std::int32_t>(bytes, 68)};
  for (bool first = true; begin < bytes.size(); first = false) {
    const std::uint32_t shift = at<std::uint32_t>(bytes, begin + 4) & 31;
    const auto count = at<std::uint64_t>(bytes, begin + 8);
    if (count > bytes.size()) return;
    const auto across = [&](std::size_t i) {
      const std::int64_t low = (sides[i] + (std::int64_t{1} << shift) - 1) >> shift;
      return static_cast<std::uint64_t>(std::max<std::int64_t>(0, (sides[i + 2] >> shift) - low + 1));
    };
    const std::uint64_t mask = count == 0 ? 0 : (across(0) * across(1) + 7) / 8;
    if (!seal(32 + (first ? 8 * count : mask) + 8 * count + (has_covers ? (count + 1) / 2 : 0) + 8)) return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  look_at(bytes);
  std::vector<std::byte> fitting(bytes.begin(), bytes.end());
  reseal(fitting);
  look_at(fitting);
  return 0;
}
