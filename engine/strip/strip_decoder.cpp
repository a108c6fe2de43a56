// The reader of coded strips. It checks every number against the size of the bytes, and each sub-strip against the
// others.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/machine/parallel.hpp"
#include "engine/stream/stream_bytes.hpp"
#include "engine/strip/strip_codec.hpp"

namespace talus {
namespace {

using namespace strip_layout;

/// Reads at most 57 bits; eight bytes from there must be readable.
std::uint64_t bits_at(const std::byte* data, std::uint64_t bit, unsigned count) {
  std::uint64_t word;
  std::memcpy(&word, data + bit / 8, sizeof word);
  return little(word) >> (bit % 8) & ((std::uint64_t{1} << count) - 1);
}

bool is_inside(GridRect inner, GridRect outer) { return outer.contains(inner.first) && outer.contains(inner.last); }

/// fails  corrupt, unsupported
Head take_head(std::span<const std::byte> bytes) {
  StreamTaker from(bytes);
  for (const char c : kMagic) {
    if (from.take<char>() != c) StreamTaker::refuse(0, "this is not a strip of Talus");
  }
  if (const auto version = from.take<std::uint32_t>(); version != kVersion)
    fail(Cause::unsupported, "the strip has version {}, this program reads version {}", version, kVersion);
  Head head;
  const auto height_bits = from.take<std::uint32_t>();
  head.region = from.rect();
  head.window = from.rect();
  head.step = from.take<double>();
  head.lowest = from.take<std::int64_t>();
  for (std::uint64_t* n : {&head.triangles, &head.runs, &head.sub_strips, &head.patches})
    *n = from.take<std::uint64_t>();
  const std::uint64_t sum = stream_checksum(bytes.first(from.at()), 0);
  if (from.take<std::uint64_t>() != sum)
    StreamTaker::refuse(kHeaderBytes - kChecksumBytes, "the checksum of the header is wrong");

  if (height_bits > kMostHeightBits) StreamTaker::refuse(12, fmt::format("heights cannot have {} bits", height_bits));
  head.height_bits = static_cast<int>(height_bits);
  constexpr GridRect kGrid{{-kMaxExtent, -kMaxExtent}, {kMaxExtent, kMaxExtent}};
  const bool is_empty = head.triangles == 0;
  if (!is_empty && (!is_inside(head.window, kGrid) || head.window.cols() < 2 || head.window.rows() < 2))
    StreamTaker::refuse(32, "the window is empty or too large");
  if (!(head.step > 0) || !std::isfinite(head.step) || !std::isfinite(head.step * 2 * kMostSteps))
    StreamTaker::refuse(48, "the height step is not above 0, or too large");
  if (std::abs(static_cast<double>(head.lowest)) > kMostSteps)
    StreamTaker::refuse(56, "the lowest height is out of range");
  // None is larger than the bytes allow, so nothing overflows below.
  const std::uint64_t most = std::uint64_t{8} * bytes.size();
  const bool possible = head.triangles <= most && head.runs <= head.triangles && head.sub_strips <= head.triangles &&
                        head.patches <= head.sub_strips && head.runs <= head.sub_strips &&
                        (is_empty || (head.runs > 0 && head.patches > 0)) &&
                        head.sub_strips <= std::numeric_limits<std::uint32_t>::max();
  if (!possible)
    StreamTaker::refuse(64, "the numbers of triangles, runs, sub-strips and patches contradict each other or the size");
  if (head.bytes() != bytes.size())
    StreamTaker::refuse(std::min<std::uint64_t>(head.bytes(), bytes.size()),
                        fmt::format("the strip has {} bytes, its header says {}", bytes.size(), head.bytes()));
  return head;
}

class Decoder {
 public:
  Decoder(std::span<const std::byte> bytes, std::uint64_t limit) : head_(take_head(bytes)) {
    if (head_.triangles > limit)
      fail(Cause::unsupported, "the strip has {} triangles, the limit is {}", head_.triangles, limit);
    StreamTaker seal(bytes.last(kChecksumBytes));
    StreamTaker of_header(bytes.subspan(kHeaderBytes - kChecksumBytes));
    const auto seed = of_header.take<std::uint64_t>();
    const auto body = bytes.subspan(kHeaderBytes, bytes.size() - kHeaderBytes - kChecksumBytes);
    if (seal.take<std::uint64_t>() != stream_checksum(body, seed))
      StreamTaker::refuse(bytes.size() - kChecksumBytes, "the checksum of patches, headers and data is wrong");
    StreamTaker from(bytes.subspan(kHeaderBytes), kHeaderBytes);
    take_patches(from);
    headers_at_ = kHeaderBytes + from.at();
    headers_.resize(static_cast<std::size_t>(head_.sub_strips));
    for (std::uint32_t& header : headers_) header = from.take<std::uint32_t>();
    tails_at_ = kHeaderBytes + from.at();
    tails_ = from.take(head_.tail_bytes());
    data_at_ = kHeaderBytes + from.at();
    data_ = from.take(head_.data_bytes()).data();  // a checksum follows, so eight bytes are readable from each of them
    find_sub_strips();
    require_zero_behind_data();
  }

  Mesh decode(int threads) {
    Mesh mesh;
    mesh.region = head_.region;
    mesh.points.resize(static_cast<std::size_t>(head_.entries()));
    mesh.heights.resize(mesh.points.size());
    mesh.triangles.resize(static_cast<std::size_t>(head_.triangles));
    threads = threads_or_all(threads);
    for_each_task(threads, starts_.size(),
                  [&](int, std::size_t chunk) { each(chunk, mesh, &Decoder::decode_sub_strip); });
    for_each_task(threads, starts_.size(), [&](int, std::size_t chunk) { each(chunk, mesh, &Decoder::compare_edge); });
    return mesh;
  }

 private:
  /// Sub-strips in one task.
  static constexpr std::size_t kChunk = 1024;

  struct Start {
    std::uint64_t entry = 0, triangle = 0;
    std::size_t run = 0;  ///< runs that began before
    std::size_t patch = 0;
  };

  /// A sub-strip and the position of its output.
  struct SubStrip {
    SubStripHeader header;
    GridPoint left, right;
    std::uint64_t triangle = 0, entry = 0;  ///< number of its first triangle and entry
    std::uint64_t count = 0;
    std::size_t number = 0;
  };

  void take_patches(StreamTaker& from) {
    patches_.resize(static_cast<std::size_t>(head_.patches));
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      Patch& patch = patches_[i];
      patch.first = from.take<std::uint32_t>();
      patch.corner.col = from.take<std::int32_t>();
      patch.corner.row = from.take<std::int32_t>();
      const bool in_order = i == 0 ? patch.first == 0 : patch.first > patches_[i - 1].first;
      if (!in_order || patch.first >= head_.sub_strips || (patch.corner.col | patch.corner.row) % kPatchSide != 0)
        from.refuse(fmt::format("patch {} is out of order or outside the strip", i));
    }
  }

  [[nodiscard]] std::uint64_t tail(std::size_t run) const {
    return (std::to_integer<std::uint64_t>(tails_[run / 2]) >> (run % 2 * 4) & 15) + 1;
  }
  [[nodiscard]] bool begins_run(std::size_t i) const { return i == headers_.size() || headers_[i] >> 31 != 0; }
  [[nodiscard]] std::uint64_t count_of(std::size_t i, std::size_t run) const {
    return begins_run(i + 1) ? tail(run) : kSubStrip;
  }

  /// Finds the start of each chunk in one pass over the headers: entries have no gaps, and only the last sub-strip of a
  /// run is shorter.
  void find_sub_strips() {
    Start at;
    for (std::size_t i = 0; i < headers_.size(); ++i) {
      if (i == 0 && !begins_run(0)) StreamTaker::refuse(headers_at_, "the first sub-strip does not begin a run");
      while (at.patch + 1 < patches_.size() && patches_[at.patch + 1].first <= i) ++at.patch;
      if (i % kChunk == 0) starts_.push_back(at);
      if (begins_run(i)) {
        if (++at.run > head_.runs) StreamTaker::refuse(headers_at_ + 4 * i, "there are more runs than the header says");
        at.entry += 2;
      }
      const std::uint64_t count = count_of(i, at.run - 1);
      at.entry += count;
      at.triangle += count;
    }
    if (at.run != head_.runs || at.triangle != head_.triangles)
      StreamTaker::refuse(tails_at_, "the sub-strips have other numbers of runs or triangles than the header says");
  }

  /// Unused bits are 0, so each strip has one form.
  void require_zero_behind_data() const {
    const std::uint64_t used = head_.entries() * head_.entry_bits();
    if (used % 8 != 0 && bits_at(data_, used, static_cast<unsigned>(8 - used % 8)) != 0)
      StreamTaker::refuse(data_at_ + used / 8, "the bits after the last triangle are not 0");
    if (head_.runs % 2 != 0 && std::to_integer<unsigned>(tails_.back()) >> 4 != 0)
      StreamTaker::refuse(data_at_ - 1, "the bits after the last run are not 0");
  }

  template <class Visit>
  void each(std::size_t chunk, Mesh& mesh, Visit visit) const {
    Start at = starts_[chunk];
    const std::size_t end = std::min(headers_.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      while (at.patch + 1 < patches_.size() && patches_[at.patch + 1].first <= i) ++at.patch;
      SubStrip sub;
      sub.header = SubStripHeader::unpack(headers_[i]);
      if (sub.header.begins_run) {
        ++at.run;
        at.entry += 2;
      }
      sub.number = i;
      sub.count = count_of(i, at.run - 1);
      sub.triangle = at.triangle;
      sub.entry = at.entry;
      const Heading heading = kHeadings[sub.header.direction];
      const GridPoint corner = patches_[at.patch].corner;
      const std::int64_t length = std::int64_t{1} << sub.header.log;
      const std::int64_t col = std::int64_t{corner.col} + sub.header.col,
                         row = std::int64_t{corner.row} + sub.header.row;
      sub.left = within(col, row, i);
      sub.right = within(col + heading.col * length, row + heading.row * length, i);
      (this->*visit)(sub, mesh);
      at.entry += sub.count;
      at.triangle += sub.count;
    }
  }

  [[noreturn]] void refuse_sub_strip(std::size_t i, const char* what) const {
    StreamTaker::refuse(headers_at_ + 4 * i, fmt::format("sub-strip {}: {}", i, what));
  }

  [[nodiscard]] GridPoint within(std::int64_t col, std::int64_t row, std::size_t i) const {
    const GridRect& w = head_.window;
    if (col < w.first.col || col > w.last.col || row < w.first.row || row > w.last.row)
      refuse_sub_strip(i, "a vertex lies outside the window");
    return {static_cast<std::int32_t>(col), static_cast<std::int32_t>(row)};
  }

  void set(Mesh& mesh, std::uint64_t entry, GridPoint p, std::uint64_t above) const {
    mesh.points[static_cast<std::size_t>(entry)] = p;
    mesh.heights[static_cast<std::size_t>(entry)] =
        static_cast<double>(head_.lowest + static_cast<std::int64_t>(above)) * head_.step;
  }

  [[nodiscard]] std::uint64_t newer(const SubStrip& sub) const { return sub.entry - 1; }
  [[nodiscard]] std::uint64_t older(const SubStrip& sub) const {
    const auto offset = static_cast<std::uint64_t>(sub.header.offset);
    if (offset > sub.entry) refuse_sub_strip(sub.number, "its edge begins before the first entry");
    return sub.entry - offset;
  }

  /// Writes its own points, heights and triangles only.
  void decode_sub_strip(const SubStrip& sub, Mesh& mesh) const {
    const unsigned width = head_.entry_bits(), height_bits = width - 2;
    const std::uint64_t height_mask = (std::uint64_t{1} << height_bits) - 1;
    GridPoint left = sub.left, right = sub.right;
    if (sub.header.begins_run) {
      for (const std::uint64_t before : {std::uint64_t{2}, std::uint64_t{1}}) {
        const std::uint64_t raw = bits_at(data_, (sub.entry - before) * width, width);
        if (raw >> height_bits != kNoType)
          refuse_sub_strip(sub.number, "a triangle stands before the first one of its run");
        set(mesh, sub.entry - before, before == 2 ? left : right, raw & height_mask);
      }
      if (sub.header.offset != 2 || sub.header.older_is_right)
        refuse_sub_strip(sub.number, "its run begins inside another one");
    }
    auto left_entry = static_cast<std::uint32_t>(sub.header.older_is_right ? newer(sub) : older(sub));
    auto right_entry = static_cast<std::uint32_t>(sub.header.older_is_right ? older(sub) : newer(sub));
    StripStep before;
    for (std::uint64_t i = 0; i < sub.count; ++i) {
      const std::uint64_t entry = sub.entry + i, raw = bits_at(data_, entry * width, width);
      const auto code = static_cast<unsigned>(raw >> height_bits);
      if (code == kNoType) refuse_sub_strip(sub.number, "a triangle has no type");
      const auto type = static_cast<StripType>(code);
      before = StripStep(type, i == 0 ? sub.header.turns_right : turn_behind(before, type));
      const auto ahead = corner_ahead(left, right, before);
      if (!ahead || !head_.window.contains(*ahead))
        refuse_sub_strip(sub.number, "a vertex lies between samples or outside the window");
      set(mesh, entry, *ahead, raw & height_mask);
      mesh.triangles[static_cast<std::size_t>(sub.triangle + i)] = {left_entry, right_entry,
                                                                    static_cast<std::uint32_t>(entry)};
      (before.turns_right() ? left : right) = *ahead;
      (before.turns_right() ? left_entry : right_entry) = static_cast<std::uint32_t>(entry);
    }
  }

  /// Checks that the earlier sub-strips end at the edge of this one's header.
  void compare_edge(const SubStrip& sub, Mesh& mesh) const {
    const bool right_is_older = sub.header.older_is_right;
    const GridPoint a = mesh.points[static_cast<std::size_t>(older(sub))],
                    b = mesh.points[static_cast<std::size_t>(newer(sub))];
    if ((right_is_older ? b : a) != sub.left || (right_is_older ? a : b) != sub.right)
      refuse_sub_strip(sub.number, "its first edge differs from the data before it");
  }

  Head head_;
  std::vector<Patch> patches_;
  std::vector<std::uint32_t> headers_;
  std::span<const std::byte> tails_;
  const std::byte* data_ = nullptr;
  std::uint64_t headers_at_ = 0, tails_at_ = 0, data_at_ = 0;
  std::vector<Start> starts_;
};

}  // namespace

Mesh decode_strip(std::span<const std::byte> bytes, int threads, std::uint64_t limit) {
  // Vertex numbers have 32 bits: one vertex a triangle, and two a run, which has at least one triangle.
  return Decoder(bytes, std::min<std::uint64_t>(limit, std::numeric_limits<std::uint32_t>::max() / 3)).decode(threads);
}

StripSizes strip_sizes(std::span<const std::byte> bytes) {
  const Head head = take_head(bytes);
  return {head.triangles, head.runs, head.sub_strips, head.patches, head.height_bits, head.bytes()};
}

}  // namespace talus
