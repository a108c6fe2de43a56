// Arbitrary bytes as a stream, and the same with checksums that fit: refused, or one that is written and read again.
// Then as an increment of a small answer.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "engine/stream/stream_codec.hpp"
#include "engine/stream/stream_header.hpp"
#include "talus/failure.hpp"
#include "talus/quadtree.hpp"
#include "tests/fuzz/reseal.hpp"

namespace {

using namespace talus;

void require(bool holds) {
  if (!holds) std::abort();
}

bool is_refusal(const Failure& failure) {
  return failure.cause() == Cause::corrupt || failure.cause() == Cause::unsupported ||
         failure.cause() == Cause::invalid_argument;
}

const StreamLimits kLimits{std::uint64_t{1} << 20, std::uint64_t{1} << 20};

void look_at(std::span<const std::byte> bytes, const RestrictedQuadtree* base) {
  try {
    static_cast<void>(stream_info(bytes, kLimits));
  } catch (const Failure& failure) {
    require(is_refusal(failure));
  }
  try {
    static_cast<void>(decode_stream_prefix(bytes, kLimits, base));
  } catch (const Failure& failure) {
    require(is_refusal(failure));
  }
  Stream stream;
  try {
    stream = decode_stream(bytes, kLimits, base);
  } catch (const Failure& failure) {
    return require(is_refusal(failure));
  }
  const auto* answer = std::get_if<RestrictedQuadtree>(&stream.content);
  try {
    const auto once = encode(stream, {}, base);
    require(encode(decode_stream(once, {}, base), {}, base) == once);
    if (answer != nullptr && answer->origin.border == Border::constrain) static_cast<void>(triangulate(*answer, 1));
    if (answer == nullptr) static_cast<void>(merge(*base, std::get<Increment>(stream.content)));
  } catch (const Failure& failure) {
    require(is_refusal(failure));  // quanta that rounding does not lead back to
  }
}

/// What increments in these bytes could go on from: the corners of their region, as far as the header tells.
RestrictedQuadtree base_of(const std::vector<std::byte>& bytes) {
  RestrictedQuadtree q;
  q.region = {{0, 0}, {16, 16}};
  const auto header = [&]() -> std::optional<StreamHeader> {
    try {
      return take_header(bytes, kLimits);
    } catch (const Failure&) {
      return std::nullopt;
    }
  }();
  if (header) q = header->quadtree;
  if (header) q.tolerance = header->from;
  q.vertices = VertexMask(header ? header->window : q.region);
  q.vertices.insert(q.region.first);
  q.vertices.insert(q.region.last);
  q.vertices.insert({q.region.first.col, q.region.last.row});
  q.vertices.insert({q.region.last.col, q.region.first.row});
  q.vertices.seal();
  q.heights.resize(q.vertices.size());
  for (double& h : q.heights) h = 0;
  return q;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  RestrictedQuadtree base = base_of(bytes);
  look_at(bytes, &base);
  reseal(bytes, base);
  base = base_of(bytes);
  reseal(bytes, base);
  look_at(bytes, &base);
  return 0;
}
