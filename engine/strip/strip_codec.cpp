// The writer of coded strips.
//
// The data has one entry a triangle: height and type of the corner ahead. A run begins with two more entries, the
// heights of its first edge. All entries have the same width, so an entry is found by its number; at every sixteenth
// triangle a sub-strip header has everything else. The reader goes over the headers once to find the entries of each
// sub-strip, decodes sub-strips in any order, and finally checks that they agree.

#include "engine/strip/strip_codec.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/stream/stream_bytes.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

using namespace strip_layout;

class BitWriter {
 public:
  void put(std::uint64_t value, unsigned count) {
    if (bit_ / 8 + 8 > bytes_.size()) bytes_.resize(bytes_.size() * 2 + 64);
    std::uint64_t word;
    std::memcpy(&word, bytes_.data() + bit_ / 8, sizeof word);
    word = little(little(word) | value << (bit_ % 8));
    std::memcpy(bytes_.data() + bit_ / 8, &word, sizeof word);
    bit_ += count;
  }
  [[nodiscard]] std::span<const std::byte> bytes() {
    bytes_.resize((bit_ + 7) / 8);
    return bytes_;
  }

 private:
  std::vector<std::byte> bytes_;
  std::size_t bit_ = 0;
};

[[noreturn]] void refuse_strip(const std::string& what) { throw Failure(Cause::invalid_argument, "a strip " + what); }

/// Heights as whole steps above the lowest.
struct Quantised {
  std::vector<std::uint32_t> above;  ///< by vertex
  std::int64_t lowest = 0;
  int bits = 0;
};

Quantised quantise(std::span<const double> heights, double step) {
  if (!(step > 0) || !std::isfinite(step)) refuse_strip("needs a finite StripCoding::height_step above 0");
  Quantised out;
  double lowest = std::numeric_limits<double>::max(), highest = -lowest;
  for (const double h : heights) {
    const double q = std::nearbyint(h / step);
    if (!(std::abs(q) <= kMostSteps))
      refuse_strip("has a height that is not finite, or too large for StripCoding::height_step");
    lowest = std::min(lowest, q);
    highest = std::max(highest, q);
  }
  if (heights.empty()) return out;
  if (highest - lowest > static_cast<double>(std::numeric_limits<std::uint32_t>::max()))
    refuse_strip("has heights of more than 4294967295 steps: use a larger StripCoding::height_step");
  out.lowest = static_cast<std::int64_t>(lowest);
  out.bits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(highest - lowest)));
  out.above.reserve(heights.size());
  for (const double h : heights) out.above.push_back(static_cast<std::uint32_t>(std::nearbyint(h / step) - lowest));
  return out;
}

/// One end of the edge before the next triangle.
struct End {
  std::uint32_t vertex = 0;
  std::uint64_t entry = 0;
};

class Encoder {
 public:
  Encoder(const TriangleStrip& strip, double step) : strip_(strip), heights_(quantise(strip.heights, step)) {
    require_whole();
    head_.height_bits = heights_.bits;
    head_.lowest = heights_.lowest;
    head_.step = step;
    head_.region = strip.region;
  }

  std::vector<std::byte> encode() {
    for (std::size_t r = 0; r < strip_.runs.size(); ++r) {
      const std::uint64_t end = r + 1 < strip_.runs.size() ? strip_.runs[r + 1].first : strip_.triangles();
      left_ = {vertex(strip_.runs[r].left)};
      right_ = {vertex(strip_.runs[r].right)};
      begin_run();
      for (std::uint64_t t = strip_.runs[r].first; t < end; ++t) add(static_cast<std::size_t>(t));
    }
    if (!strip_.runs.empty()) end_run();
    return bytes();
  }

 private:
  void require_whole() const {
    bool whole = strip_.points.size() == strip_.heights.size() && strip_.steps.size() == strip_.triangles() &&
                 strip_.runs.empty() == (strip_.triangles() == 0);
    for (std::size_t r = 0; whole && r < strip_.runs.size(); ++r) {
      const std::uint64_t begin = strip_.runs[r].first;
      whole = begin < strip_.triangles() && (r == 0 ? begin == 0 : begin > strip_.runs[r - 1].first);
    }
    if (!whole) refuse_strip("has arrays or runs that do not match each other");
  }

  [[nodiscard]] std::uint32_t vertex(std::uint32_t v) const {
    if (v >= strip_.points.size()) refuse_strip("names a vertex that it does not have");
    return v;
  }
  [[nodiscard]] GridPoint point(const End& end) const { return strip_.points[end.vertex]; }

  void begin_run() {
    if (head_.runs > 0) end_run();
    in_run_ = 0;
    ++head_.runs;
    for (End* end : {&left_, &right_}) {
      end->entry = entry_;
      put(end->vertex, kNoType);
    }
  }
  void end_run() { tails_.push_back(static_cast<std::uint8_t>((in_run_ - 1) % kSubStrip)); }

  void put(std::uint32_t v, unsigned type) {
    data_.put(heights_.above[v] | std::uint64_t{type} << heights_.bits, head_.entry_bits());
    const GridPoint p = strip_.points[v];
    GridRect& w = head_.window;
    w = entry_ == 0 ? GridRect{p, p}
                    : GridRect{{std::min(w.first.col, p.col), std::min(w.first.row, p.row)},
                               {std::max(w.last.col, p.col), std::max(w.last.row, p.row)}};
    ++entry_;
  }

  void add(std::size_t t) {
    const StripStep step = strip_.steps[t];
    // This turn cannot follow in a strip of a restricted quadtree: begin a new run.
    if (in_run_ > 0 && turn_behind(before_, step.type()) != step.turns_right()) begin_run();
    if (in_run_ % kSubStrip == 0) begin_sub_strip(step);
    const std::uint32_t ahead = vertex(strip_.corners[t]);
    if (step.bits % 4 > 2 || step.bits > 6 || corner_ahead(point(left_), point(right_), step) != strip_.points[ahead])
      refuse_strip("has a triangle that bisection does not make: use strip_of()");
    (step.turns_right() ? left_ : right_) = {ahead, entry_};
    put(ahead, static_cast<unsigned>(step.type()));
    before_ = step;
    ++in_run_;
    ++head_.triangles;
  }

  void begin_sub_strip(StripStep step) {
    // At most eight triangles surround a vertex, so an end of the edge is at most nine entries back.
    if (entry_ - std::min(left_.entry, right_.entry) > 9) begin_run();
    SubStripHeader header;
    const GridPoint at = point(left_);
    if (!name_edge(at, point(right_), header)) refuse_strip("has an edge that bisection does not make: use strip_of()");
    const GridPoint corner{at.col & -kPatchSide, at.row & -kPatchSide};
    if (patches_.empty() || patches_.back().corner != corner)
      patches_.push_back({static_cast<std::uint32_t>(headers_.size()), corner});
    header.col = static_cast<std::uint32_t>(at.col - corner.col);
    header.row = static_cast<std::uint32_t>(at.row - corner.row);
    header.older_is_right = right_.entry < left_.entry;
    header.offset = static_cast<int>(entry_ - std::min(left_.entry, right_.entry));
    header.turns_right = step.turns_right();
    header.begins_run = in_run_ == 0;
    headers_.push_back(header.pack());
  }

  std::vector<std::byte> bytes() {
    if (headers_.size() > std::numeric_limits<std::uint32_t>::max())
      refuse_strip("has more than 2^36 triangles: ask for a larger tolerance");
    head_.sub_strips = headers_.size();
    head_.patches = patches_.size();
    StreamWriter out;
    out.bytes.reserve(static_cast<std::size_t>(head_.bytes()));
    for (const char c : kMagic) out.put(c);
    out.put(kVersion);
    out.put(static_cast<std::uint32_t>(head_.height_bits));
    out.put(head_.region);
    out.put(head_.window);
    out.put(head_.step);
    out.put(head_.lowest);
    for (const std::uint64_t n : {head_.triangles, head_.runs, head_.sub_strips, head_.patches}) out.put(n);
    out.seal(0);
    for (const Patch& patch : patches_) {
      out.put(patch.first);
      out.put(patch.corner.col);
      out.put(patch.corner.row);
    }
    for (const std::uint32_t header : headers_) out.put(header);
    for (std::size_t r = 0; r < tails_.size(); r += 2) {
      out.put(static_cast<std::uint8_t>(tails_[r] | (r + 1 < tails_.size() ? tails_[r + 1] << 4 : 0)));
    }
    out.put(data_.bytes());
    out.seal(kHeaderBytes);
    return std::move(out.bytes);
  }

  const TriangleStrip& strip_;
  Quantised heights_;
  Head head_;
  End left_, right_;
  StripStep before_;
  std::uint64_t in_run_ = 0, entry_ = 0;
  std::vector<Patch> patches_;
  std::vector<std::uint32_t> headers_;
  std::vector<std::uint8_t> tails_;
  BitWriter data_;
};

}  // namespace

std::vector<std::byte> encode_strip(const TriangleStrip& strip, const StripCoding& coding) {
  return Encoder(strip, coding.height_step).encode();
}

}  // namespace talus
