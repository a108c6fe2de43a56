#include "engine/stream/stream_header.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "engine/geo/crs_text.hpp"
#include "engine/machine/fail.hpp"
#include "engine/quadtree/grid.hpp"
#include "engine/quadtree/rect.hpp"

namespace talus {
namespace {

constexpr std::array<char, 8> kMagic{'T', 'A', 'L', 'U', 'S', 'R', 'Q', 'T'};
constexpr std::size_t kChecksum = 8, kSmallestHeader = 32;
constexpr std::uint32_t kMostText = 1 << 20;  // bytes of a CRS or unit; real ones are shorter
constexpr std::uint32_t kCoding = 1;          // coding of parts; earlier versions also had 0 and 2
constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum Flags : std::uint32_t {
  kIncrement = 1,
  kPlain = 2,
  kCovers = 4,
  kLevelErrors = 8,
  kWholeCodes = 16,
  kLoose = 32,
  kWide = 64,
  kOtherErrors = 128 | 256,  ///< nested and midpoint errors of earlier versions
  kPerpendicular = 512,
  kAllFlags = 1023
};

/// Visits the doubles of a header in the order of the file.
template <class Header, class Visit>
void for_each_number(Header& h, Visit&& visit) {
  auto& d = h.description;
  for (auto* v : {&h.from.value, &h.quadtree.tolerance.value, &h.quadtree.bound.value, &d.mapping.x0, &d.mapping.y0,
                  &d.mapping.dx, &d.mapping.dy, &d.step.scale, &d.step.divisor, &d.step.offset, &d.metres_per_unit,
                  &d.minimum_height, &d.maximum_height, &d.void_weight, &d.lossy.value, &d.finest_tolerance.value,
                  &h.quadtree.origin.quantum.value})
    visit(*v);
}

/// The flags that are a yes or no of the header.
template <class Header, class Visit>
void for_each_flag(Header& h, Visit&& visit) {
  visit(kIncrement, h.is_increment);
  visit(kPlain, h.quadtree.origin.is_plain);
  visit(kCovers, h.has_covers);
  visit(kWholeCodes, h.description.step.integer);
  visit(kLoose, h.has_loose);
  visit(kWide, h.is_wide);
}

int log2_root(GridRect r) { return std::countr_zero(static_cast<std::uint32_t>(root_side(r))); }

bool is_within(GridRect inner, GridRect outer) { return outer.contains(inner.first) && outer.contains(inner.last); }

/// Checks the header, so that later arithmetic cannot overflow.
void require_plausible(const StreamTaker& in, const StreamHeader& h) {
  const Description& d = h.description;
  const RestrictedQuadtree& q = h.quadtree;
  const GridRect& e = d.extent;
  const auto in_range = [](std::int32_t v) { return v > -kMaxExtent && v < kMaxExtent; };
  if (!in_range(e.first.col) || !in_range(e.first.row) || !in_range(e.last.col) || !in_range(e.last.row) || is_empty(e))
    in.refuse("the extent is empty or too large");
  if (is_empty(h.window)) in.refuse("the window is empty");
  if (is_empty(q.region) || !is_within(q.region, h.window) || !is_within(h.window, e))
    in.refuse("the region leaves its window, or the window leaves the extent");
  if (q.origin.border == Border::constrain && !(h.window == q.region))
    in.refuse("the window exceeds a constrained border");
  for (const double v : {d.mapping.x0, d.mapping.y0, d.mapping.dx, d.mapping.dy, d.step.scale, d.step.divisor,
                         d.step.offset, d.metres_per_unit, d.minimum_height, d.maximum_height, d.void_weight,
                         d.lossy.value, d.finest_tolerance.value, q.origin.quantum.value}) {
    if (!std::isfinite(v)) in.refuse("expected a finite number");
  }
  for (const GridPoint corner : {e.first, e.last}) {
    if (!std::isfinite(d.mapping.x(corner.col)) || !std::isfinite(d.mapping.y(corner.row)))
      in.refuse("expected finite coordinates of all samples");
  }
  if (d.minimum_height > d.maximum_height) in.refuse("the lowest height is above the highest");
  if (!h.is_increment && h.base != 0) in.refuse("an answer cannot have a base");
  if (d.mapping.dx <= 0 || d.mapping.dy >= 0) in.refuse("expected columns eastward, rows southward");
  if (d.step.scale == 0 || d.step.divisor <= 0 || d.metres_per_unit <= 0 || d.void_weight < 0 || d.lossy.value < 0 ||
      d.finest_tolerance.value < 0 || q.origin.quantum.value < 0)
    in.refuse("a height step, unit, weight, loss or quantum is out of range");
  if ((h.kind == CodeKind::quanta) != (q.origin.quantum.value > 0))
    in.refuse("the quantum does not fit the code of heights");
  if (!(q.tolerance.value >= 0) || !(q.bound.value >= 0) || !(h.from.value >= 0))
    in.refuse("expected tolerances and a bound of 0 or more");
  if (h.is_increment ? !(q.tolerance < h.from) || !q.origin.is_plain : h.from.value != kInfinity)
    in.refuse("the coarser tolerance does not fit the stream");
  if (q.origin.is_plain && (q.origin.border != Border::constrain || q.level_errors.empty()))
    in.refuse("a plain answer needs a constrained border and level errors");
  for (const double v : q.level_errors) {
    if (!(v >= 0)) in.refuse("expected level errors of 0 or more");
  }
}

/// Refuses a mask or a number of vertices above the limits, before memory is allocated.
void require_room(const StreamHeader& h, const StreamLimits& limits) {
  const GridRect& window = h.window;
  const auto words = static_cast<std::uint64_t>((window.cols() + 63) / 64) * static_cast<std::uint64_t>(window.rows());
  const std::uint64_t bytes = words * 12;  // 8 for bits, 4 for ranks
  if (bytes > limits.mask_bytes) {
    fail(Cause::unsupported,
         "a region of {} x {} samples needs a mask of {} bytes, but StreamLimits allow {}: the stream is damaged or "
         "forged, or very coarse; ask for a smaller region",
         window.cols(), window.rows(), bytes, limits.mask_bytes);
  }
  if (h.vertices > limits.vertices)
    fail(Cause::unsupported, "the stream has {} vertices, but StreamLimits allow {}", h.vertices, limits.vertices);
}

}  // namespace

Metres StreamHeader::bound(std::size_t part) const {
  if (part + 1 == parts) return quadtree.bound;
  if (quadtree.level_errors.empty()) return Metres{kInfinity};
  double largest = quadtree.bound.value;
  for (std::size_t i = part + 1; i < parts; ++i) largest = std::max(largest, quadtree.level_errors[parts - 1 - i]);
  return Metres{largest};
}

void put_header(StreamWriter& out, const StreamHeader& h) {
  const Description& d = h.description;
  const RestrictedQuadtree& q = h.quadtree;
  if (d.crs_wkt.size() > kMostText || d.vertical_unit.size() > kMostText)
    throw Failure(Cause::invalid_argument, "cannot write a CRS or a vertical unit of more than 1 MiB");
  out.put(std::string(kMagic.data(), kMagic.size()));
  out.put(kStreamVersion);
  out.put(std::uint32_t{0});  // the header's length, overwritten below
  std::uint32_t flags = (q.level_errors.empty() ? 0u : kLevelErrors) |
                        (d.error_metric == ErrorMetric::perpendicular ? kPerpendicular : 0u);
  for_each_flag(h, [&](std::uint32_t flag, bool is_so) { flags |= is_so ? flag : 0u; });
  out.put(flags);
  out.put(static_cast<std::uint32_t>(h.parts));
  out.put(q.origin.identity.content);
  out.put(q.origin.identity.generation);
  out.put(static_cast<std::uint32_t>(q.origin.border));
  out.put(q.region);
  out.put(h.window);
  out.put(d.extent);
  for_each_number(h, [&](double v) { out.put(v); });
  out.put(h.vertices);
  out.put(kCoding);
  out.put(static_cast<std::uint32_t>(h.kind));
  out.put(h.base);
  out.put(static_cast<std::uint32_t>(d.crs_wkt.size()));
  out.put(static_cast<std::uint32_t>(d.vertical_unit.size()));
  for (const double error : q.level_errors) out.put(error);
  out.put(d.crs_wkt);
  out.put(d.vertical_unit);
  const auto length = static_cast<std::uint32_t>(out.bytes.size() + kChecksum);
  for (std::size_t i = 0; i < 4; ++i) out.bytes[12 + i] = static_cast<std::byte>(length >> (8 * i));
  out.seal(0);
}

bool begins_as_stream(std::span<const std::byte> bytes) {
  const std::size_t known = std::min(bytes.size(), kMagic.size());
  return std::equal(kMagic.begin(), kMagic.begin() + static_cast<std::ptrdiff_t>(known), bytes.begin(),
                    [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

namespace {

/// The part of a header that follows its version and length. Any version has these and a checksum, so damage is not
/// taken for a new version. Sets the header's length and seal. Nothing, if bytes are missing.
std::optional<StreamTaker> unsealed(std::span<const std::byte> bytes, StreamHeader& h) {
  StreamTaker in(bytes);
  if (!begins_as_stream(bytes)) StreamTaker::refuse(0, "not the stream of a restricted quadtree");
  if (bytes.size() < 16) return std::nullopt;
  (void)in.take(kMagic.size());
  const auto version = in.take<std::uint32_t>();
  const auto length = in.take<std::uint32_t>();
  if (length < kSmallestHeader || length > 4 * kMostText)
    StreamTaker::refuse(12, fmt::format("the header cannot have {} bytes", length));
  if (bytes.size() < length) return std::nullopt;
  h.bytes = length;
  h.seal = stream_checksum(bytes.first(length - kChecksum), 0);
  if (StreamTaker(bytes.subspan(length - kChecksum)).take<std::uint64_t>() != h.seal)
    StreamTaker::refuse(0, "wrong checksum of the header");
  if (version != kStreamVersion)
    fail(Cause::unsupported, "the stream has version {}, but this program reads version {}", version, kStreamVersion);
  in = StreamTaker(bytes.first(length - kChecksum));
  (void)in.take(kMagic.size() + 8);
  return in;
}

}  // namespace

std::optional<StreamHeader> take_header(std::span<const std::byte> bytes, const StreamLimits& limits) {
  StreamHeader h;
  std::optional<StreamTaker> rest = unsealed(bytes, h);
  if (!rest) return std::nullopt;
  StreamTaker& in = *rest;
  const auto flags = in.take<std::uint32_t>();
  if ((flags & ~std::uint32_t{kAllFlags}) != 0) in.refuse("the header has unknown flags");
  if ((flags & kOtherErrors) != 0)
    fail(Cause::unsupported,
         "the stream's vertices were chosen by nested or midpoint errors, but this program reads streams of exact "
         "errors only; ask its database again");
  for_each_flag(h, [&](std::uint32_t flag, bool& is_so) { is_so = (flags & flag) != 0; });
  RestrictedQuadtree& q = h.quadtree;
  Description& d = h.description;
  if ((flags & kPerpendicular) != 0) d.error_metric = ErrorMetric::perpendicular;
  h.parts = in.take<std::uint32_t>();
  q.origin.identity.content = in.take<std::uint64_t>();
  q.origin.identity.generation = in.take<std::uint32_t>();
  const auto border = in.take<std::uint32_t>();
  if (border > static_cast<std::uint32_t>(Border::clip)) in.refuse("the header has an unknown border");
  q.origin.border = static_cast<Border>(border);
  q.region = in.rect();
  h.window = in.rect();
  d.extent = in.rect();
  for_each_number(h, [&](double& v) { v = in.take<double>(); });
  h.vertices = in.take<std::uint64_t>();
  const auto coding = in.take<std::uint32_t>(), kind = in.take<std::uint32_t>();
  if (coding != kCoding) {
    fail(Cause::unsupported, "the stream has coding {}, but this program reads coding {} only; ask its database again",
         coding, kCoding);
  }
  if (kind > static_cast<std::uint32_t>(CodeKind::quanta)) in.refuse("the header has an unknown code of heights");
  h.kind = static_cast<CodeKind>(kind);
  h.base = in.take<std::uint64_t>();
  const auto crs = in.take<std::uint32_t>(), unit = in.take<std::uint32_t>();
  const std::size_t errors = (flags & kLevelErrors) != 0 ? h.parts : 0;
  if (crs > kMostText || unit > kMostText || errors > 64 || in.left() != crs + unit + 8 * errors)
    in.refuse("the texts or level errors do not fit the header's length");
  for (std::size_t i = 0; i < errors; ++i) q.level_errors.push_back(in.take<double>());
  d.crs_wkt = in.text(crs);
  d.crs = facts_of_wkt(d.crs_wkt);
  d.vertical_unit = in.text(unit);
  require_plausible(in, h);
  if (h.root() != (errors > 0 ? log2_root(d.extent) : log2_root(h.window)))
    in.refuse(fmt::format("{} parts do not fit the extent", h.parts));
  require_room(h, limits);
  return h;
}

std::uint64_t digest_of(const RestrictedQuadtree& q) {
  static_assert(std::endian::native == std::endian::little, "digests are computed from numbers in memory");
  std::uint64_t digest = 0;
  const GridRect& window = q.vertices.region();
  for (std::int64_t row = window.first.row; row <= window.last.row; ++row) {
    const auto words = q.vertices.row_words(static_cast<std::int32_t>(row));
    digest = stream_checksum(std::as_bytes(words), digest);
  }
  return stream_checksum(std::as_bytes(std::span(q.heights)), digest);
}

}  // namespace talus
