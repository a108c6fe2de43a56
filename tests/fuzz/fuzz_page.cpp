// Arbitrary bytes as a page: refused as corrupt, or a page that encodes to the same page again.
//
// The first byte chooses which page of which database the rest claims to be. With bit 64 it may be in a slice: two bytes say
// how long the page is, the rest is the slice, and the page is told its digest.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "engine/page/digest.hpp"
#include "engine/page/page_codec.hpp"
#include "talus/failure.hpp"
#include "tests/support/given_page.hpp"

namespace {

using namespace talus;

struct Place {
  PageId id;
  GridRect extent;
};
constexpr Place kPlaces[] = {
    {{0, 0, 0}, {{0, 0}, {127, 127}}},  {{0, 0, 0}, {{0, 0}, {0, 0}}},         {{0, 1, 2}, {{0, 0}, {140, 299}}},
    {{1, 0, 0}, {{0, 0}, {999, 700}}},  {{0, -1, -1}, {{-40, -3}, {50, 60}}},  {{1, -1, 0}, {{-900, 16}, {80, 90}}},
    {{2, 0, 0}, {{0, 0}, {20000, 10}}}, {{1, 0, 0}, {{200, 200}, {203, 203}}},  // no sample at all
};

void require(bool holds) {
  if (!holds) std::abort();
}

/// Whether `b` is what came of `a`.
bool is_same(const Page& a, const Page& b, const CodeDistance& distance) {
  if (a.valid != b.valid || a.covers != b.covers || a.children.size() != b.children.size()) return false;
  bool same = true;
  for_each_sample(a.grid, [&](std::size_t i, GridPoint p) {
    const ErrorCode error = b.is_own(p) ? b.error(i, distance) : ErrorCode{0};
    same = same && (b.is_dense ? error >= a.errors[i] : error == a.errors[i]);
  });
  if (!same) return false;
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };  // a table may hold NaN
  for (std::size_t i = 0; i < a.children.size(); ++i) {
    const ChildEntry &x = a.children[i], &y = b.children[i];
    if (x.present != y.present || x.largest != y.largest || bits(x.lowest) != bits(y.lowest) ||
        bits(x.highest) != bits(y.highest) || x.generation != y.generation) {
      return false;
    }
  }
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    const bool needed = a.valid.empty() || a.valid[i] != 0 || a.covers[i] != 0;
    if (needed && std::bit_cast<std::uint64_t>(a.heights[i]) != std::bit_cast<std::uint64_t>(b.height(i))) return false;
  }
  return true;
}

/// A page in a slice has the heights of that and nothing of its own.
void look_at_page_in_slice(PageId id, GridRect extent, const CodeDistance& distance, std::span<const std::byte> input) {
  if (input.size() < 2) return;
  const std::size_t length = std::to_integer<std::size_t>(input[0]) + 256 * std::to_integer<std::size_t>(input[1]);
  input = input.subspan(2);
  std::vector<std::byte> bytes(input.begin(),
                               input.begin() + static_cast<std::ptrdiff_t>(std::min(length, input.size())));
  const auto slice = input.subspan(bytes.size());
  const std::uint64_t digest = digest_of(slice);
  for (std::size_t i = 0; i < 8 && bytes.size() >= 16; ++i) bytes[8 + i] = static_cast<std::byte>(digest >> (8 * i));
  const auto other = [&](PageId, PageDecoder::Content what) {
    return what == PageDecoder::Content::slice ? slice : std::span<const std::byte>();
  };
  const int bands = band_count(extent);
  PageDecoder decoder, again;
  const Page page = decoder.decode(id, extent, bands, distance, bytes, other);
  if (!page.is_sliced()) return;
  const auto written = PageEncoder().encode_in_slice(page, digest);
  const Page& same = again.decode(id, extent, bands, distance, written, other);
  require(same.valid == page.valid && same.covers == page.covers && same.errors == page.errors);
  require(std::memcmp(same.in_slice.data(), page.in_slice.data(), sizeof(SquareBits)) == 0 &&
          same.heights == page.heights);
  for (std::size_t i = 0; i < page.heights.size(); ++i) require(std::isfinite(page.heights[i]));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto& [id, extent] = kPlaces[data[0] % std::size(kPlaces)];
  // Only where height codes are whole may a page be dense.
  const CodeDistance distance({1, 1, 0, (data[0] & 128) != 0}, 1);
  const int bands = band_count(extent);
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  PageDecoder decoder, again;
  try {
    if ((data[0] & 64) != 0) look_at_page_in_slice(id, extent, distance, bytes);
    const Page page = support::given_page(decoder.decode(id, extent, bands, distance, bytes), distance);
    for (const double h : page.heights) require(std::isfinite(h));
    for (const ErrorCode e : page.errors) require(e <= kAlwaysSelected);
    require(is_same(page, again.decode(id, extent, bands, distance, encode(page, distance)), distance));
  } catch (const Failure& failure) {
    require(failure.cause() == Cause::corrupt);
    static_cast<void>(again);
  }
  return 0;
}
