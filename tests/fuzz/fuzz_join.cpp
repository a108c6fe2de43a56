// Two streams in arbitrary bytes, an answer and an increment, with checksums that fit: the increment is refused, or
// joined to an answer that a stream can hold. Then the same increment and an answer that it does not go on from.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "engine/stream/stream_codec.hpp"
#include "talus/failure.hpp"
#include "talus/increment.hpp"
#include "talus/quadtree.hpp"
#include "tests/fuzz/reseal.hpp"

namespace {

using namespace talus;

void require(bool holds) {
  if (!holds) std::abort();
}

/// Runs a step that may refuse its input and do nothing else wrong.
template <class Step>
bool holds_or_refuses(Step&& step) {
  try {
    step();
    return true;
  } catch (const Failure& failure) {
    require(failure.cause() == Cause::corrupt || failure.cause() == Cause::unsupported ||
            failure.cause() == Cause::invalid_argument);
    return false;
  }
}

const StreamLimits kLimits{std::uint64_t{1} << 20, std::uint64_t{1} << 20};

/// Everything of both, nothing else, and in numbers that fit.
void look_at_joined(const Description& description, const RestrictedQuadtree& base, const Increment& increment) {
  RestrictedQuadtree joined;
  if (!holds_or_refuses([&] { joined = merge(base, increment); })) return;
  require(joined.heights.size() == joined.vertices.size());
  require(joined.covers.empty() || joined.covers.size() == joined.vertices.size());
  std::size_t both = 0;
  base.vertices.for_each([&](GridPoint p) {
    if (joined.vertices.region().contains(p) && joined.vertices.contains(p)) ++both;
  });
  require(joined.vertices.size() >= both);
  holds_or_refuses([&] { static_cast<void>(triangulate(joined, 1)); });
  holds_or_refuses([&] {
    const auto bytes = encode(Stream{description, joined});
    require(encode(decode_stream(bytes)) == bytes);
  });
}

}  // namespace

/// The bytes: the length of the answer's stream in two, the answer's stream, the increment's.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t length = std::min<std::size_t>(data[0] + 256u * data[1], size - 2);
  const auto* bytes = reinterpret_cast<const std::byte*>(data) + 2;
  std::vector<std::byte> first(bytes, bytes + length), second(bytes + length, bytes + (size - 2));

  reseal(first, {});
  Stream answer, increment;
  if (!holds_or_refuses([&] { answer = decode_stream(first, kLimits); })) return 0;
  const auto* base = std::get_if<RestrictedQuadtree>(&answer.content);
  require(base != nullptr);  // an increment without its base is refused
  reseal(second, *base);
  if (!holds_or_refuses([&] { increment = decode_stream(second, kLimits, base); })) return 0;
  const auto* delta = std::get_if<Increment>(&increment.content);
  if (delta == nullptr) return 0;
  look_at_joined(answer.description, *base, *delta);

  RestrictedQuadtree other = *base;
  other.vertices = VertexMask(base->vertices.region());
  base->vertices.for_each([&](GridPoint p) {
    if (((p.col ^ p.row) & 4) == 0) other.vertices.insert(p);
  });
  other.vertices.seal();
  other.heights.resize(other.vertices.size());
  if (!other.covers.empty()) other.covers.resize(other.vertices.size());
  look_at_joined(answer.description, other, *delta);
  return 0;
}
