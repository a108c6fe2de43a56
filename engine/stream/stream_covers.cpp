#include "engine/stream/stream_covers.hpp"

#include <algorithm>
#include <string>

#include "engine/page/number_coder.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr int kFirstContext = 24;

std::uint64_t key(GridPoint p) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.col)) << 32 | static_cast<std::uint32_t>(p.row);
}

/// The bit of RestrictedQuadtree::covers for the triangle that `split` divides and that has its right angle at `apex`.
int bit_of(GridPoint apex, const Diamond& split) {
  const Diamond d = diamond(apex);
  for (int side = 0; side < 2; ++side) {
    for (int end = 0; end < 2; ++end) {
      const GridPoint a = d.apexes[static_cast<std::size_t>(side)], b = d.ends[static_cast<std::size_t>(end)];
      if ((a == split.ends[0] && b == split.ends[1]) || (a == split.ends[1] && b == split.ends[0]))
        return 2 * side + end;
    }
  }
  return -1;  // the apex is a root corner
}

}  // namespace

std::uint8_t CoverCoder::of(GridPoint p) const {
  const auto found = partial_.find(key(p));
  return found == partial_.end() ? std::uint8_t{15} : found->second;
}
void CoverCoder::remember(GridPoint p, std::uint8_t covers) {
  if (covers != 15) partial_[key(p)] = covers;
}

void CoverCoder::take(const RestrictedQuadtree& q) {
  if (q.covers.empty()) return;
  std::size_t i = 0;
  q.vertices.for_each([&](GridPoint p) { remember(p, q.covers[i++]); });
}

template <class Code>
std::uint8_t CoverCoder::visit(GridPoint p, std::uint8_t covers, Code&& code) const {
  if (spacing(p) >= kRootSpacing / 4) return code(kFirstContext + 16, covers);
  const Diamond d = diamond(p);
  unsigned told = 0;
  bool first_is_full = true;
  for (int side = 0; side < 2; ++side) {
    const GridPoint apex = d.apexes[static_cast<std::size_t>(side)];
    const std::uint8_t above = of(apex);
    const int bit = above == 15 || spacing(apex) >= kRootSpacing / 4 ? -1 : bit_of(apex, d);
    const bool has_data = bit < 0 || (above >> bit & 1) != 0;
    const int context =
        kFirstContext + (has_data ? 0 : 8) + (above == 15 ? 0 : 4) + (first_is_full ? 0 : 2) + (is_centre(p) ? 0 : 1);
    const unsigned here = covers >> (2 * side) & 3u;
    const unsigned number = code(context, static_cast<std::uint8_t>(has_data ? 3 - here : here));
    const unsigned decoded = has_data ? 3 - number : number;
    told |= (decoded & 3u) << (2 * side);
    first_is_full = decoded == 3;
  }
  return static_cast<std::uint8_t>(told);
}

std::vector<std::byte> CoverCoder::encode(std::span<const GridPoint> points, std::span<const std::uint8_t> covers) {
  if (std::all_of(covers.begin(), covers.end(), [](std::uint8_t c) { return c == 15; })) return {};
  NumberWriter out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    (void)visit(points[i], covers[i], [&](int context, std::uint8_t number) {
      out.put(number, context);
      return number;
    });
    remember(points[i], covers[i]);
  }
  std::vector<std::byte> bytes;
  out.finish(bytes);
  return bytes;
}

std::vector<std::uint8_t> CoverCoder::decode(std::span<const std::byte> bytes, std::span<const GridPoint> points) {
  std::vector<std::uint8_t> covers(points.size(), 15);
  if (bytes.empty()) return covers;
  NumberReader in;
  in.start(bytes);
  for (std::size_t i = 0; i < points.size(); ++i) {
    covers[i] = visit(points[i], 0, [&](int context, std::uint8_t) {
      const std::uint64_t number = in.get(context);
      if (number > (context == kFirstContext + 16 ? 15u : 3u))
        throw Failure(Cause::corrupt, "corrupt: covers are out of range");
      return static_cast<std::uint8_t>(number);
    });
    remember(points[i], covers[i]);
  }
  if (!in.is_intact()) throw Failure(Cause::corrupt, "corrupt: the covers are damaged");
  return covers;
}

}  // namespace talus
