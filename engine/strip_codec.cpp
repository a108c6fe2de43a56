// Strips as bits.
//
// The strip data is one entry a triangle: the height ahead and the type. A run has two entries before it, the heights of its
// first edge. Entries stand at multiples of one width, so whoever knows the number of an entry can read it, and a sub-strip
// header says everything else there is to know at every sixteenth triangle. The reader walks over the headers once, to find
// where each sub-strip's entries are, and then decodes sub-strips in any order; that what they say of each other agrees is
// looked at in the end.

#include "engine/strip_codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/parallel.hpp"
#include "engine/stream_bytes.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::array<char, 8> kMagic{'T', 'A', 'L', 'S', 'T', 'R', 'I', 'P'};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint64_t kHeaderBytes = 104, kPatchBytes = 12, kChecksumBytes = 8;
constexpr double kMostSteps = 0x1p51;  ///< whole numbers that a double holds, with room for the range
constexpr unsigned kNoType = 3;        ///< of entries that are no triangle

struct Patch {
  std::uint32_t first = 0;  ///< sub-strip
  GridPoint corner;         ///< north-west
};

/// Everything the header says.
struct Head {
  int height_bits = 0;
  GridRect region{{0, 0}, {-1, -1}}, window{{0, 0}, {-1, -1}};
  double step = 1;
  std::int64_t lowest = 0;
  std::uint64_t triangles = 0, runs = 0, sub_strips = 0, patches = 0;

  [[nodiscard]] std::uint64_t entries() const { return triangles + 2 * runs; }
  [[nodiscard]] unsigned entry_bits() const { return static_cast<unsigned>(height_bits) + 2; }
  [[nodiscard]] std::uint64_t data_bytes() const { return (entries() * entry_bits() + 7) / 8; }
  [[nodiscard]] std::uint64_t tail_bytes() const { return (runs + 1) / 2; }
  [[nodiscard]] std::uint64_t bytes() const {
    return kHeaderBytes + patches * kPatchBytes + sub_strips * 4 + tail_bytes() + data_bytes() + kChecksumBytes;
  }
};

// ---- bits ------------------------------------------------------------------------------------------------------------------

std::uint64_t little(std::uint64_t v) {
  if constexpr (std::endian::native == std::endian::big) v = __builtin_bswap64(v);
  return v;
}

/// At most 57 bits from anywhere; eight bytes from there on must be readable.
std::uint64_t bits_at(const std::byte* data, std::uint64_t bit, unsigned count) {
  std::uint64_t word;
  std::memcpy(&word, data + bit / 8, sizeof word);
  return little(word) >> (bit % 8) & ((std::uint64_t{1} << count) - 1);
}

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

// ---- writing ---------------------------------------------------------------------------------------------------------------

[[noreturn]] void refuse_strip(const std::string& what) { throw Failure(Cause::invalid_argument, "a strip " + what); }

/// Heights as whole steps above the lowest.
struct Quantised {
  std::vector<std::uint32_t> above;  ///< by vertex
  std::int64_t lowest = 0;
  int bits = 0;
};

Quantised quantise(std::span<const double> heights, double step) {
  if (!(step > 0) || !std::isfinite(step)) refuse_strip("needs a height step larger than 0");
  Quantised out;
  double lowest = std::numeric_limits<double>::max(), highest = -lowest;
  for (const double h : heights) {
    const double q = std::nearbyint(h / step);
    if (!(std::abs(q) <= kMostSteps)) refuse_strip("has a height that is no number, or too large for its step");
    lowest = std::min(lowest, q);
    highest = std::max(highest, q);
  }
  if (heights.empty()) return out;
  if (highest - lowest > static_cast<double>(std::numeric_limits<std::uint32_t>::max()))
    refuse_strip("has heights of more than 4294967295 steps: take a larger one");
  out.lowest = static_cast<std::int64_t>(lowest);
  out.bits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(highest - lowest)));
  out.above.reserve(heights.size());
  for (const double h : heights) out.above.push_back(static_cast<std::uint32_t>(std::nearbyint(h / step) - lowest));
  return out;
}

/// An end of the edge before the next triangle.
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
    if (!whole) refuse_strip("whose parts do not fit each other");
  }

  [[nodiscard]] std::uint32_t vertex(std::uint32_t v) const {
    if (v >= strip_.points.size()) refuse_strip("with a vertex that is not there");
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
    // Such a strip is none of a restricted quadtree; the path is begun anew.
    if (in_run_ > 0 && turn_behind(before_, step.type()) != step.turns_right()) begin_run();
    if (in_run_ % kSubStrip == 0) begin_sub_strip(step);
    const std::uint32_t ahead = vertex(strip_.corners[t]);
    if (step.bits % 4 > 2 || step.bits > 6 || corner_ahead(point(left_), point(right_), step) != strip_.points[ahead])
      refuse_strip("with a triangle that is none of the hierarchy");
    (step.turns_right() ? left_ : right_) = {ahead, entry_};
    put(ahead, static_cast<unsigned>(step.type()));
    before_ = step;
    ++in_run_;
    ++head_.triangles;
  }

  void begin_sub_strip(StripStep step) {
    // Around one vertex there are at most eight triangles, so no end of the edge is farther back than nine entries.
    if (entry_ - std::min(left_.entry, right_.entry) > 9) begin_run();
    SubStripHeader header;
    const GridPoint at = point(left_);
    if (!name_edge(at, point(right_), header)) refuse_strip("with an edge that is none of the hierarchy");
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
    if (headers_.size() > std::numeric_limits<std::uint32_t>::max()) refuse_strip("of more than 2^36 triangles");
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

// ---- reading ---------------------------------------------------------------------------------------------------------------

bool is_inside(GridRect inner, GridRect outer) { return outer.contains(inner.first) && outer.contains(inner.last); }

/// fails  corrupt, unsupported
Head take_head(std::span<const std::byte> bytes) {
  StreamTaker from(bytes);
  for (const char c : kMagic) {
    if (from.take<char>() != c) StreamTaker::refuse(0, "not a strip of Talus");
  }
  if (const auto version = from.take<std::uint32_t>(); version != kVersion)
    throw Failure(Cause::unsupported, fmt::format("a strip of version {}; this is a reader of version {}", version, kVersion));
  Head head;
  const auto height_bits = from.take<std::uint32_t>();
  head.region = from.rect();
  head.window = from.rect();
  head.step = from.take<double>();
  head.lowest = from.take<std::int64_t>();
  for (std::uint64_t* n : {&head.triangles, &head.runs, &head.sub_strips, &head.patches}) *n = from.take<std::uint64_t>();
  const std::uint64_t sum = stream_checksum(bytes.first(from.at()), 0);
  if (from.take<std::uint64_t>() != sum) StreamTaker::refuse(kHeaderBytes - kChecksumBytes, "the header's checksum");

  if (height_bits > kMostHeightBits) StreamTaker::refuse(12, fmt::format("heights of {} bits", height_bits));
  head.height_bits = static_cast<int>(height_bits);
  constexpr GridRect kGrid{{-kMaxExtent, -kMaxExtent}, {kMaxExtent, kMaxExtent}};
  const bool is_empty = head.triangles == 0;
  if (!is_empty && (!is_inside(head.window, kGrid) || head.window.cols() < 2 || head.window.rows() < 2))
    StreamTaker::refuse(32, "a window that is none");
  if (!(head.step > 0) || !std::isfinite(head.step) || !std::isfinite(head.step * 2 * kMostSteps))
    StreamTaker::refuse(48, "a height step that is none");
  if (std::abs(static_cast<double>(head.lowest)) > kMostSteps) StreamTaker::refuse(56, "a lowest height that is too low or high");
  // Each is no more than bytes can hold, so nothing overflows below.
  const std::uint64_t most = std::uint64_t{8} * bytes.size();
  const bool possible = head.triangles <= most && head.runs <= head.triangles && head.sub_strips <= head.triangles &&
                        head.patches <= head.sub_strips && head.runs <= head.sub_strips &&
                        (is_empty || (head.runs > 0 && head.patches > 0)) &&
                        head.sub_strips <= std::numeric_limits<std::uint32_t>::max();
  if (!possible) StreamTaker::refuse(64, "numbers of triangles, runs, sub-strips and patches that do not fit each other or the bytes");
  if (head.bytes() != bytes.size())
    StreamTaker::refuse(std::min<std::uint64_t>(head.bytes(), bytes.size()),
                        fmt::format("{} bytes in all, where the header says {}", bytes.size(), head.bytes()));
  return head;
}

class Decoder {
 public:
  Decoder(std::span<const std::byte> bytes, std::uint64_t limit) : head_(take_head(bytes)) {
    if (head_.triangles > limit)
      throw Failure(Cause::unsupported, fmt::format("a strip of {} triangles, {} at most are wanted", head_.triangles, limit));
    StreamTaker seal(bytes.last(kChecksumBytes));
    StreamTaker of_header(bytes.subspan(kHeaderBytes - kChecksumBytes));
    const auto seed = of_header.take<std::uint64_t>();
    const auto body = bytes.subspan(kHeaderBytes, bytes.size() - kHeaderBytes - kChecksumBytes);
    if (seal.take<std::uint64_t>() != stream_checksum(body, seed))
      StreamTaker::refuse(bytes.size() - kChecksumBytes, "the checksum of patches, headers and data");
    StreamTaker from(bytes.subspan(kHeaderBytes), kHeaderBytes);
    take_patches(from);
    headers_at_ = kHeaderBytes + from.at();
    headers_.resize(static_cast<std::size_t>(head_.sub_strips));
    for (std::uint32_t& header : headers_) header = from.take<std::uint32_t>();
    tails_at_ = kHeaderBytes + from.at();
    tails_ = from.take(head_.tail_bytes());
    data_at_ = kHeaderBytes + from.at();
    data_ = from.take(head_.data_bytes()).data();  // a checksum follows, so eight bytes can be read from any of them
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
    for_each_task(threads, starts_.size(), [&](int, std::size_t chunk) { each(chunk, mesh, &Decoder::decode_sub_strip); });
    for_each_task(threads, starts_.size(), [&](int, std::size_t chunk) { each(chunk, mesh, &Decoder::compare_edge); });
    return mesh;
  }

 private:
  /// So many sub-strips are one piece of work.
  static constexpr std::size_t kChunk = 1024;

  struct Start {
    std::uint64_t entry = 0, triangle = 0;
    std::size_t run = 0;  ///< how many have begun before
    std::size_t patch = 0;
  };

  /// A sub-strip, and where what it says goes.
  struct SubStrip {
    SubStripHeader header;
    GridPoint left, right;
    std::uint64_t triangle = 0, entry = 0;  ///< of its first triangle
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
        from.refuse(fmt::format("patch {}", i));
    }
  }

  [[nodiscard]] std::uint64_t tail(std::size_t run) const {
    return (std::to_integer<std::uint64_t>(tails_[run / 2]) >> (run % 2 * 4) & 15) + 1;
  }
  [[nodiscard]] bool begins_run(std::size_t i) const { return i == headers_.size() || headers_[i] >> 31 != 0; }
  [[nodiscard]] std::uint64_t count_of(std::size_t i, std::size_t run) const { return begins_run(i + 1) ? tail(run) : kSubStrip; }

  /// Entries follow each other without gaps, and only the last sub-strip of a run is shorter: one walk over the headers finds
  /// where each chunk begins.
  void find_sub_strips() {
    Start at;
    for (std::size_t i = 0; i < headers_.size(); ++i) {
      if (i == 0 && !begins_run(0)) StreamTaker::refuse(headers_at_, "the first sub-strip begins no run");
      while (at.patch + 1 < patches_.size() && patches_[at.patch + 1].first <= i) ++at.patch;
      if (i % kChunk == 0) starts_.push_back(at);
      if (begins_run(i)) {
        if (++at.run > head_.runs) StreamTaker::refuse(headers_at_ + 4 * i, "more runs than the header says");
        at.entry += 2;
      }
      const std::uint64_t count = count_of(i, at.run - 1);
      at.entry += count;
      at.triangle += count;
    }
    if (at.run != head_.runs || at.triangle != head_.triangles)
      StreamTaker::refuse(tails_at_, "sub-strips that are not as many runs and triangles as the header says");
  }

  /// One strip has one form.
  void require_zero_behind_data() const {
    const std::uint64_t used = head_.entries() * head_.entry_bits();
    if (used % 8 != 0 && bits_at(data_, used, static_cast<unsigned>(8 - used % 8)) != 0)
      StreamTaker::refuse(data_at_ + used / 8, "bits behind the last triangle");
    if (head_.runs % 2 != 0 && std::to_integer<unsigned>(tails_.back()) >> 4 != 0)
      StreamTaker::refuse(data_at_ - 1, "bits behind the last run");
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
      const std::int64_t col = std::int64_t{corner.col} + sub.header.col, row = std::int64_t{corner.row} + sub.header.row;
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
      refuse_sub_strip(i, "a vertex outside the window");
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
    if (offset > sub.entry) refuse_sub_strip(sub.number, "an entry before the first one");
    return sub.entry - offset;
  }

  /// Its points, heights and triangles, which nobody else writes.
  void decode_sub_strip(const SubStrip& sub, Mesh& mesh) const {
    const unsigned width = head_.entry_bits(), height_bits = width - 2;
    const std::uint64_t height_mask = (std::uint64_t{1} << height_bits) - 1;
    GridPoint left = sub.left, right = sub.right;
    if (sub.header.begins_run) {
      for (const std::uint64_t before : {2, 1}) {
        const std::uint64_t raw = bits_at(data_, (sub.entry - before) * width, width);
        if (raw >> height_bits != kNoType) refuse_sub_strip(sub.number, "a triangle before the first one of its run");
        set(mesh, sub.entry - before, before == 2 ? left : right, raw & height_mask);
      }
      if (sub.header.offset != 2 || sub.header.older_is_right) refuse_sub_strip(sub.number, "a run that begins in another one");
    }
    auto left_entry = static_cast<std::uint32_t>(sub.header.older_is_right ? newer(sub) : older(sub));
    auto right_entry = static_cast<std::uint32_t>(sub.header.older_is_right ? older(sub) : newer(sub));
    StripStep before;
    for (std::uint64_t i = 0; i < sub.count; ++i) {
      const std::uint64_t entry = sub.entry + i, raw = bits_at(data_, entry * width, width);
      const auto code = static_cast<unsigned>(raw >> height_bits);
      if (code == kNoType) refuse_sub_strip(sub.number, "a triangle without a type");
      const auto type = static_cast<StripType>(code);
      before = StripStep(type, i == 0 ? sub.header.turns_right : turn_behind(before, type));
      const auto ahead = corner_ahead(left, right, before);
      if (!ahead || !head_.window.contains(*ahead)) refuse_sub_strip(sub.number, "a vertex between samples or outside the window");
      set(mesh, entry, *ahead, raw & height_mask);
      mesh.triangles[static_cast<std::size_t>(sub.triangle + i)] = {left_entry, right_entry, static_cast<std::uint32_t>(entry)};
      (before.turns_right() ? left : right) = *ahead;
      (before.turns_right() ? left_entry : right_entry) = static_cast<std::uint32_t>(entry);
    }
  }

  /// Whether the sub-strips before it have the edge where its header says.
  void compare_edge(const SubStrip& sub, Mesh& mesh) const {
    const bool right_is_older = sub.header.older_is_right;
    const GridPoint a = mesh.points[static_cast<std::size_t>(older(sub))], b = mesh.points[static_cast<std::size_t>(newer(sub))];
    if ((right_is_older ? b : a) != sub.left || (right_is_older ? a : b) != sub.right)
      refuse_sub_strip(sub.number, "another edge than the one before it ends at");
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

std::vector<std::byte> encode_strip(const TriangleStrip& strip, const StripCoding& coding) {
  return Encoder(strip, coding.height_step).encode();
}

Mesh decode_strip(std::span<const std::byte> bytes, int threads, std::uint64_t limit) {
  // Vertices are numbered with 32 bits: one a triangle, and two a run, which has a triangle.
  return Decoder(bytes, std::min<std::uint64_t>(limit, std::numeric_limits<std::uint32_t>::max() / 3)).decode(threads);
}

StripSizes strip_sizes(std::span<const std::byte> bytes) {
  const Head head = take_head(bytes);
  return {head.triangles, head.runs, head.sub_strips, head.patches, head.height_bits, head.bytes()};
}

}  // namespace talus
