// A header, then one part a step of a Progression. Each ends with a checksum that is seeded with the one before it, so that no
// part can stand in another's place or another's stream. Whatever is read is held against what is left before anything
// is allocated, and memory grows with the bytes, but for the mask, which has a limit of its own.

#include "engine/stream_codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <xxhash.h>

#include "engine/grid.hpp"
#include "talus/failure.hpp"
#include "talus/progression.hpp"

namespace talus {
namespace {

constexpr std::array<char, 8> kMagic{'T', 'A', 'L', 'U', 'S', 'R', 'Q', 'T'};
constexpr std::size_t kChecksum = 8, kSmallestHeader = 24, kPartHeader = 32;
constexpr std::uint32_t kMostText = 1 << 20;  // a CRS of a megabyte is none
constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum Flags : std::uint32_t { kIncrement = 1, kPlain = 2, kCovers = 4, kLevelErrors = 8, kWholeCodes = 16, kAllFlags = 31 };

class Writer {
 public:
  template <class T>
  void put(T value) {
    auto raw = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  }
  void put(GridRect r) {
    for (const std::int32_t v : {r.first.col, r.first.row, r.last.col, r.last.row}) put(v);
  }
  void put(const std::string& text) {
    const auto raw = std::as_bytes(std::span(text));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  }
  /// Over what was put since `begin`.
  void seal(std::size_t begin) {
    seed_ = XXH3_64bits_withSeed(bytes.data() + begin, bytes.size() - begin, seed_);
    put(seed_);
  }
  std::vector<std::byte> bytes;

 private:
  std::uint64_t seed_ = 0;
};

/// Takes numbers one after the other; what is not there is corrupt.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[noreturn]] static void refuse(std::size_t at, const std::string& what) {
    throw Failure(Cause::corrupt, fmt::format("corrupt: byte {}: {}", at, what));
  }
  [[noreturn]] void refuse(const std::string& what) const { refuse(at_, what); }
  [[nodiscard]] std::size_t at() const { return at_; }
  void rewind() { at_ = 0; }
  /// Checksums go on from another's.
  void follow(const Reader& other) { seed_ = other.seed_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  void require(std::uint64_t count) const {
    if (count > left()) refuse(bytes_.size(), fmt::format("the stream is cut: {} more bytes are expected", count - left()));
  }
  template <class T>
  T take() {
    require(sizeof(T));
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }
  GridRect rect() {
    GridRect r;
    for (std::int32_t* v : {&r.first.col, &r.first.row, &r.last.col, &r.last.row}) *v = take<std::int32_t>();
    return r;
  }
  std::span<const std::byte> take(std::uint64_t count) {
    require(count);
    const auto taken = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += taken.size();
    return taken;
  }
  std::string text(std::uint64_t count) {
    const auto raw = take(count);
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  /// The checksum that stands `count` bytes on from here, over these bytes.
  void check(std::uint64_t count) {
    require(count);
    require(count + kChecksum);
    const std::uint64_t digest = XXH3_64bits_withSeed(bytes_.data() + at_, static_cast<std::size_t>(count), seed_);
    Reader end(bytes_.subspan(at_ + static_cast<std::size_t>(count)));
    if (end.take<std::uint64_t>() != digest) refuse("checksum");
    seed_ = digest;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint64_t seed_ = 0;
};

/// The grid points of a spacing's multiples in a window, row by row: what a part's mask has bits for.
struct Lattice {
  std::int32_t shift, first_col, first_row;
  std::int64_t cols, rows;
  Lattice(GridRect window, int log_spacing) : shift(log_spacing) {
    const std::int64_t ceil = (std::int64_t{1} << shift) - 1;
    first_col = static_cast<std::int32_t>((window.first.col + ceil) >> shift);
    first_row = static_cast<std::int32_t>((window.first.row + ceil) >> shift);
    cols = std::max<std::int64_t>(0, (window.last.col >> shift) - std::int64_t{first_col} + 1);
    rows = std::max<std::int64_t>(0, (window.last.row >> shift) - std::int64_t{first_row} + 1);
  }
  [[nodiscard]] std::uint64_t bits() const { return static_cast<std::uint64_t>(cols) * static_cast<std::uint64_t>(rows); }
  [[nodiscard]] std::uint64_t index(GridPoint p) const {
    return static_cast<std::uint64_t>((p.row >> shift) - first_row) * static_cast<std::uint64_t>(cols) +
           static_cast<std::uint64_t>((p.col >> shift) - first_col);
  }
  [[nodiscard]] GridPoint at(std::uint64_t index) const {
    const auto row = static_cast<std::int32_t>(index / static_cast<std::uint64_t>(cols)) + first_row;
    const auto col = static_cast<std::int32_t>(index % static_cast<std::uint64_t>(cols)) + first_col;
    return {col * (1 << shift), row * (1 << shift)};
  }
};

/// Positions of a part: points as they are in part 0, which is no lattice, else a mask.
std::uint64_t position_bytes(std::size_t part, const Lattice& lattice, std::uint64_t count) {
  if (part == 0) return 8 * count;
  return count == 0 ? 0 : (lattice.bits() + 7) / 8;
}

const RestrictedQuadtree& quadtree_of(const Stream& stream) {
  if (const auto* increment = std::get_if<Increment>(&stream.content)) return increment->added;
  return std::get<RestrictedQuadtree>(stream.content);
}

// ---- writing --------------------------------------------------------------------------------------------

void put_header(Writer& out, const Stream& stream, const RestrictedQuadtree& q, std::size_t parts) {
  const Description& d = stream.description;
  const auto* increment = std::get_if<Increment>(&stream.content);
  out.put(std::string(kMagic.data(), kMagic.size()));
  out.put(kStreamVersion);
  out.put(std::uint32_t{0});  // the header's length, put in below
  std::uint32_t flags = increment != nullptr ? kIncrement : 0u;
  if (q.origin.is_plain) flags |= kPlain;
  if (!q.covers.empty()) flags |= kCovers;
  if (!q.level_errors.empty()) flags |= kLevelErrors;
  if (d.step.integer) flags |= kWholeCodes;
  out.put(flags);
  out.put(static_cast<std::uint32_t>(parts));
  out.put(q.origin.identity.content);
  out.put(q.origin.identity.generation);
  out.put(static_cast<std::uint32_t>(q.origin.border));
  out.put(q.region);
  out.put(q.vertices.region());
  out.put(d.extent);
  out.put(increment != nullptr ? increment->from.value : kInfinity);
  for (const double v : {q.tolerance.value, q.bound.value, d.mapping.x0, d.mapping.y0, d.mapping.dx, d.mapping.dy, d.step.scale,
                         d.step.divisor, d.step.offset, d.metres_per_unit, d.minimum, d.maximum, d.void_weight, d.lossy_metres,
                         d.finest_tolerance})
    out.put(v);
  out.put(std::uint64_t{q.vertices.size()});
  out.put(static_cast<std::uint32_t>(d.crs_wkt.size()));
  out.put(static_cast<std::uint32_t>(d.vertical_unit.size()));
  out.put(d.crs_wkt);
  out.put(d.vertical_unit);
  const auto length = static_cast<std::uint32_t>(out.bytes.size() + kChecksum);
  for (std::size_t i = 0; i < 4; ++i) out.bytes[12 + i] = static_cast<std::byte>(length >> (8 * i));
  out.seal(0);
}

/// What a part is made of.
struct PartOf {
  std::size_t number = 0;
  int shift = 0;
  Metres bound;
  std::span<const GridPoint> points;
  std::span<const std::uint32_t> ranks;
};

void put_part(Writer& out, const RestrictedQuadtree& q, const PartOf& part) {
  const std::size_t begin = out.bytes.size();
  const auto& [number, shift, bound, points, ranks] = part;
  const Lattice lattice(q.vertices.region(), shift);
  out.put(static_cast<std::uint32_t>(number));
  out.put(static_cast<std::uint32_t>(shift));
  out.put(std::uint64_t{points.size()});
  out.put(bound.value);
  out.put(q.level_errors.empty() ? 0.0 : q.level_errors[static_cast<std::size_t>(shift)]);
  if (number == 0) {
    for (const GridPoint p : points) out.put(p.col), out.put(p.row);
  } else if (!points.empty()) {
    const std::size_t mask = out.bytes.size();
    out.bytes.resize(mask + static_cast<std::size_t>((lattice.bits() + 7) / 8));
    for (const GridPoint p : points) {
      const std::uint64_t i = lattice.index(p);
      out.bytes[mask + static_cast<std::size_t>(i / 8)] |= static_cast<std::byte>(1u << (i % 8));
    }
  }
  for (const std::uint32_t rank : ranks) out.put(q.heights[rank]);
  if (!q.covers.empty()) {
    for (std::size_t i = 0; i < ranks.size(); i += 2) {
      const unsigned low = q.covers[ranks[i]], high = i + 1 < ranks.size() ? q.covers[ranks[i + 1]] : 0u;
      out.put(static_cast<std::uint8_t>(low | high << 4));
    }
  }
  out.seal(begin);
}

// ---- reading --------------------------------------------------------------------------------------------

struct Header {
  Stream stream;
  RestrictedQuadtree quadtree;
  bool is_increment = false, has_covers = false, has_level_errors = false;
  Metres from;
  std::uint64_t vertices = 0;
  std::size_t parts = 0;
};

bool is_within(GridRect inner, GridRect outer) { return outer.contains(inner.first) && outer.contains(inner.last); }

/// What keeps later arithmetic inside its types.
void require_plausible(const Reader& in, const Header& h) {
  const Description& d = h.stream.description;
  const RestrictedQuadtree& q = h.quadtree;
  const GridRect &e = d.extent, &window = q.vertices.region();
  const auto in_range = [](std::int32_t v) { return v > -kMaxExtent && v < kMaxExtent; };
  if (!in_range(e.first.col) || !in_range(e.first.row) || !in_range(e.last.col) || !in_range(e.last.row) || e.cols() < 1 ||
      e.rows() < 1)
    in.refuse("impossible extent");
  if (q.region.cols() < 1 || q.region.rows() < 1 || !is_within(q.region, window) || !is_within(window, e))
    in.refuse("a region that is not in its window, or not in the extent");
  if (q.origin.border == Border::constrain && !(window == q.region)) in.refuse("a window beyond a constrained border");
  for (const double v : {d.mapping.x0, d.mapping.y0, d.mapping.dx, d.mapping.dy, d.step.scale, d.step.divisor, d.step.offset,
                         d.metres_per_unit, d.minimum, d.maximum, d.void_weight, d.lossy_metres, d.finest_tolerance}) {
    if (!std::isfinite(v)) in.refuse("a number that is none");
  }
  if (d.mapping.dx <= 0 || d.mapping.dy >= 0) in.refuse("impossible grid mapping");
  if (d.step.scale == 0 || d.step.divisor <= 0 || d.metres_per_unit <= 0 || d.void_weight < 0 || d.lossy_metres < 0 ||
      d.finest_tolerance < 0)
    in.refuse("impossible height step, unit, weight or loss");
  if (!(q.tolerance.value >= 0) || !(q.bound.value >= 0) || !(h.from.value >= 0)) in.refuse("a tolerance or bound that is none");
  if (h.is_increment ? !(q.tolerance < h.from) || !q.origin.is_plain : h.from.value != kInfinity)
    in.refuse("a tolerance to go on from that does not fit");
  if (q.origin.is_plain && (q.origin.border != Border::constrain || !h.has_level_errors))
    in.refuse("a plain answer with another border, or without level errors");
  const auto root = static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(root_side(e))));
  const auto root_of_window = static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(root_side(window))));
  if (h.parts != (q.origin.border != Border::constrain ? 1 : 1 + (h.has_level_errors ? root : root_of_window)))
    in.refuse(fmt::format("{} parts do not fit the extent", h.parts));
}

/// Where a mask would be too large, before there is one.
void require_mask(GridRect window, const StreamLimits& limits) {
  const auto words = static_cast<std::uint64_t>((window.cols() + 63) / 64) * static_cast<std::uint64_t>(window.rows());
  const std::uint64_t bytes = words * 12;  // bits and ranks
  if (bytes <= limits.mask_bytes) return;
  throw Failure(Cause::unsupported,
                fmt::format("a region of {} x {} samples needs a mask of {} bytes, {} are allowed", window.cols(), window.rows(),
                            bytes, limits.mask_bytes));
}

Header take_header(Reader& in, const StreamLimits& limits) {
  if (in.text(std::min(in.left(), kMagic.size())) != std::string(kMagic.data(), kMagic.size()))
    Reader::refuse(0, "not the stream of a restricted quadtree");
  Reader again = in;
  const auto version = in.take<std::uint32_t>();
  const auto length = in.take<std::uint32_t>();
  if (length < kSmallestHeader + kMagic.size()) Reader::refuse(12, fmt::format("a header of {} bytes", length));
  // Any version has these three and a checksum: what is damaged is not taken for what is new.
  again.rewind();
  again.check(length - kChecksum);
  if (version != kStreamVersion) {
    throw Failure(Cause::unsupported,
                  fmt::format("a stream of version {}, this program reads version {}", version, kStreamVersion));
  }
  in.follow(again);
  Header h;
  const auto flags = in.take<std::uint32_t>();
  if ((flags & ~std::uint32_t{kAllFlags}) != 0) in.refuse("unknown flags");
  h.is_increment = (flags & kIncrement) != 0;
  h.has_covers = (flags & kCovers) != 0;
  h.has_level_errors = (flags & kLevelErrors) != 0;
  RestrictedQuadtree& q = h.quadtree;
  Description& d = h.stream.description;
  q.origin.is_plain = (flags & kPlain) != 0;
  d.step.integer = (flags & kWholeCodes) != 0;
  h.parts = in.take<std::uint32_t>();
  q.origin.identity.content = in.take<std::uint64_t>();
  q.origin.identity.generation = in.take<std::uint32_t>();
  const auto border = in.take<std::uint32_t>();
  if (border > static_cast<std::uint32_t>(Border::clip)) in.refuse("unknown border");
  q.origin.border = static_cast<Border>(border);
  q.region = in.rect();
  const GridRect window = in.rect();
  d.extent = in.rect();
  h.from = Metres{in.take<double>()};
  q.tolerance = Metres{in.take<double>()};
  q.bound = Metres{in.take<double>()};
  for (double* v : {&d.mapping.x0, &d.mapping.y0, &d.mapping.dx, &d.mapping.dy, &d.step.scale, &d.step.divisor, &d.step.offset,
                    &d.metres_per_unit, &d.minimum, &d.maximum, &d.void_weight, &d.lossy_metres, &d.finest_tolerance})
    *v = in.take<double>();
  h.vertices = in.take<std::uint64_t>();
  const auto crs = in.take<std::uint32_t>(), unit = in.take<std::uint32_t>();
  if (crs > kMostText || unit > kMostText || in.at() + crs + unit + kChecksum != length)
    in.refuse("texts that do not fit the header");
  d.crs_wkt = in.text(crs);
  d.vertical_unit = in.text(unit);
  if (window.cols() < 1 || window.rows() < 1) in.refuse("an empty window");
  require_mask(window, limits);
  q.vertices = VertexMask(window);
  require_plausible(in, h);
  (void)in.take(kChecksum);
  return h;
}

struct Part {
  std::vector<GridPoint> points;
  std::vector<double> heights;
  std::vector<std::uint8_t> covers;
};

class Parts {
 public:
  Parts(Reader& in, Header& header) : in_(in), header_(header), q_(header.quadtree), bound_(kInfinity) {
    if (header.has_level_errors) q_.level_errors.assign(static_cast<std::size_t>(root()) + 1, 0);
  }

  /// Whether all bytes of the next part are there, if what it says of itself is true.
  [[nodiscard]] bool next_is_whole() const {
    if (in_.left() < kPartHeader + kChecksum) return false;
    Reader ahead = in_;
    (void)ahead.take<std::uint32_t>();
    (void)ahead.take<std::uint32_t>();
    const auto count = ahead.take<std::uint64_t>();
    if (count > in_.left()) return false;
    const Lattice lattice(q_.vertices.region(), static_cast<int>(header_.parts - 1 - taken_));
    return in_.left() >= kPartHeader + payload_bytes(lattice, count) + kChecksum;
  }

  void take() {
    const std::size_t begin = in_.at();
    Reader ahead = in_;
    const auto number = ahead.take<std::uint32_t>();
    const auto shift = ahead.take<std::uint32_t>();
    const auto count = ahead.take<std::uint64_t>();
    const auto bound = ahead.take<double>(), largest = ahead.take<double>();
    const std::size_t expected_shift = header_.parts - 1 - taken_;
    if (number != taken_ || shift != (is_one() ? 0 : expected_shift)) Reader::refuse(begin, "another part is expected");
    const Lattice lattice(q_.vertices.region(), static_cast<int>(shift));
    if (count > header_.vertices - found_) Reader::refuse(begin + 8, fmt::format("{} vertices are too many", count));
    ahead.require(count);  // at least a byte each: no product below overflows
    const std::uint64_t positions = position_bytes(taken_, lattice, count);
    in_.check(kPartHeader + payload_bytes(lattice, count));
    (void)in_.take(kPartHeader);
    if (!(bound >= q_.bound.value) || !(bound <= bound_)) Reader::refuse(begin + 16, "a bound that does not fit the others");
    if (!(largest >= 0) || (largest != 0 && !header_.has_level_errors)) Reader::refuse(begin + 24, "an error that is none");
    bound_ = bound;
    bounds_.push_back({bound, begin + 16});
    if (header_.has_level_errors) q_.level_errors[shift] = largest;

    parts_.emplace_back();
    Part& part = parts_.back();
    part.points.reserve(static_cast<std::size_t>(count));
    taken_ == 0 ? take_points(count) : take_mask(lattice, positions, count);
    part.heights.reserve(static_cast<std::size_t>(count));
    for (std::uint64_t i = 0; i < count; ++i) {
      part.heights.push_back(in_.take<double>());
      if (!std::isfinite(part.heights.back())) Reader::refuse(in_.at() - 8, "a height that is no number");
    }
    if (header_.has_covers) {
      part.covers.resize(static_cast<std::size_t>(count) + 1);
      for (std::size_t i = 0; i < count; i += 2) {
        const auto two = in_.take<std::uint8_t>();
        part.covers[i] = two & 15;
        part.covers[i + 1] = two >> 4;
      }
      if (part.covers[static_cast<std::size_t>(count)] != 0 && count % 2 != 0) Reader::refuse(in_.at() - 1, "bits left over");
    }
    (void)in_.take(kChecksum);
    found_ += count;
    ++taken_;
    require_parents(begin);
  }
  [[nodiscard]] std::size_t taken() const { return taken_; }

  /// Of what was taken.
  Stream stream() {
    const bool is_whole = taken_ == header_.parts;
    if (is_whole && found_ != header_.vertices)
      in_.refuse(fmt::format("{} vertices, the header says {}", found_, header_.vertices));
    if (is_whole) require_bounds();
    q_.vertices.seal();
    q_.heights.resize(q_.vertices.size());
    if (header_.has_covers) q_.covers.resize(q_.vertices.size());
    for (const Part& part : parts_) {
      for (std::size_t i = 0; i < part.points.size(); ++i) {
        const std::uint32_t rank = q_.vertices.rank(part.points[i]);
        q_.heights[rank] = part.heights[i];
        if (header_.has_covers) q_.covers[rank] = part.covers[i];
      }
    }
    if (!is_whole) {
      q_.bound = Metres{bound_};
      q_.origin.is_plain = false;
    }
    if (header_.is_increment) {
      header_.stream.content = Increment{std::move(q_), header_.from, {}};
    } else {
      header_.stream.content = std::move(q_);
    }
    return std::move(header_.stream);
  }

 private:
  [[nodiscard]] bool is_one() const { return q_.origin.border != Border::constrain; }
  [[nodiscard]] int root() const {
    return std::countr_zero(static_cast<std::uint32_t>(root_side(header_.stream.description.extent)));
  }

  [[nodiscard]] std::uint64_t payload_bytes(const Lattice& lattice, std::uint64_t count) const {
    return position_bytes(taken_, lattice, count) + 8 * count + (header_.has_covers ? (count + 1) / 2 : 0);
  }

  void add(GridPoint p, std::size_t at) {
    if (q_.vertices.contains(p)) Reader::refuse(at, "a vertex that is there already");
    q_.vertices.insert(p);
    parts_.back().points.push_back(p);
  }
  void take_points(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t at = in_.at();
      GridPoint p;
      p.col = in_.take<std::int32_t>();
      p.row = in_.take<std::int32_t>();
      if (!q_.vertices.region().contains(p)) Reader::refuse(at, "a vertex outside the region");
      if (i > 0) {
        const GridPoint before = parts_.back().points.back();
        if (p.row < before.row || (p.row == before.row && p.col <= before.col)) Reader::refuse(at, "vertices out of order");
      }
      add(p, at);
    }
  }
  void take_mask(const Lattice& lattice, std::uint64_t bytes, std::uint64_t count) {
    const std::size_t begin = in_.at();
    const auto mask = in_.take(bytes);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      for (unsigned rest = std::to_integer<unsigned>(mask[i]); rest != 0; rest &= rest - 1) {
        const std::uint64_t bit = 8 * std::uint64_t{i} + static_cast<unsigned>(std::countr_zero(rest));
        if (bit >= lattice.bits() || parts_.back().points.size() == count) Reader::refuse(begin + i, "bits left over");
        const GridPoint p = lattice.at(bit);
        if (height_in_tree(p) != lattice.shift) Reader::refuse(begin + i, "a vertex of another level");
        add(p, begin + i);
      }
    }
    if (parts_.back().points.size() != count) Reader::refuse(begin, "fewer vertices than said");
  }
  /// That each part states what the levels behind it leave out.
  void require_bounds() const {
    double expected = q_.bound.value;
    for (std::size_t i = bounds_.size(); i-- > 0;) {
      if (i + 1 < bounds_.size())
        expected = header_.has_level_errors ? std::max(expected, q_.level_errors[header_.parts - 2 - i]) : kInfinity;
      if (bounds_[i].first != expected) Reader::refuse(bounds_[i].second, "a bound that does not fit the errors behind it");
    }
  }

  /// Of an answer: that the parts so far are a restricted quadtree, as far as triangles with data need it. Amid voids
  /// parents may be missing.
  void require_parents(std::size_t begin) const {
    if (header_.is_increment || is_one()) return;
    const Part& part = parts_.back();
    for (std::size_t i = 0; i < part.points.size(); ++i) {
      const GridPoint p = part.points[i];
      if (spacing(p) >= std::int32_t{1} << root()) continue;
      const unsigned covers = header_.has_covers ? part.covers[i] : 15u;
      const Diamond d = diamond(p);
      for (std::size_t triangle = 0; triangle < 4; ++triangle) {
        const GridPoint apex = d.apexes[triangle / 2], end = d.ends[triangle % 2];
        if ((covers >> triangle & 1) == 0 || !q_.region.contains(apex) || !q_.region.contains(end)) continue;
        if (!q_.vertices.contains(apex) || !q_.vertices.contains(end))
          Reader::refuse(begin, fmt::format("the vertex at column {}, row {} lacks a corner of its triangles", p.col, p.row));
      }
    }
  }

  Reader& in_;
  Header& header_;
  RestrictedQuadtree& q_;
  double bound_;
  std::size_t taken_ = 0;
  std::uint64_t found_ = 0;
  std::vector<std::pair<double, std::size_t>> bounds_;  ///< by part, and where they stand
  std::vector<Part> parts_;
};

}  // namespace

std::vector<std::byte> encode(const Stream& stream) {
  const RestrictedQuadtree& q = quadtree_of(stream);
  const std::size_t n = q.vertices.size();
  const Description& d = stream.description;
  const auto root = static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(root_side(d.extent))));
  if (q.heights.size() != n || (!q.covers.empty() && q.covers.size() != n) ||
      (!q.level_errors.empty() && q.level_errors.size() != root + 1) || q.region.cols() < 1 || q.region.rows() < 1 ||
      d.crs_wkt.size() > kMostText || d.vertical_unit.size() > kMostText) {
    throw Failure(Cause::invalid_argument,
                  "a quadtree whose region, heights, covers, level errors or texts do not fit it cannot be written");
  }
  Writer out;
  if (q.origin.border == Border::constrain) {
    const Progression parts(q);
    put_header(out, stream, q, parts.steps());
    for (std::size_t i = 0; i < parts.steps(); ++i)
      put_part(out, q, {i, parts.shift(i), parts.bound(i), parts.points(i), parts.ranks(i)});
  } else {
    put_header(out, stream, q, 1);
    std::vector<GridPoint> points;
    std::vector<std::uint32_t> ranks(n);
    q.vertices.for_each([&](GridPoint p) { points.push_back(p); });
    std::iota(ranks.begin(), ranks.end(), 0u);
    put_part(out, q, {0, 0, q.bound, points, ranks});
  }
  return std::move(out.bytes);
}

StreamPrefix decode_stream_prefix(std::span<const std::byte> bytes, const StreamLimits& limits) {
  Reader in(bytes);
  Header header = take_header(in, limits);
  Parts parts(in, header);
  parts.take();
  while (parts.taken() < header.parts && parts.next_is_whole()) parts.take();
  StreamPrefix prefix;
  prefix.parts = parts.taken();
  prefix.parts_in_all = header.parts;
  prefix.bytes = in.at();
  prefix.stream = parts.stream();
  return prefix;
}

Stream decode_stream(std::span<const std::byte> bytes, const StreamLimits& limits) {
  Reader in(bytes);
  Header header = take_header(in, limits);
  Parts parts(in, header);
  while (parts.taken() < header.parts) parts.take();
  if (in.left() > 0) in.refuse(fmt::format("{} bytes left over", in.left()));
  return parts.stream();
}

}  // namespace talus
