#include "engine/page/page_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/machine/fail.hpp"
#include "engine/page/page_errors.hpp"
#include "engine/page/page_heights.hpp"
#include "engine/page/page_numbers.hpp"
#include "engine/page/page_voids.hpp"
#include "engine/page/stored_errors.hpp"

namespace talus {

namespace {

float rounded_down(double v) {
  const auto f = static_cast<float>(v);
  return f > v ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float rounded_up(double v) { return -rounded_down(-v); }

}  // namespace

ChildEntry joined(const ChildEntry& a, const ChildEntry& b) {
  return {a.present || b.present, std::max(a.largest, b.largest), std::min(a.lowest, b.lowest),
          std::max(a.highest, b.highest), std::max(a.generation, b.generation)};
}

ChildEntry range_of(const Page& page, const HeightStep& step) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
    if (!page.is_data(i) || page.is_dropped(i, p)) return;
    const double height = step.value(page.heights[i]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  });
  return {true, 0, rounded_down(lowest), rounded_up(highest)};
}

namespace {

constexpr std::uint8_t kVersion = 2;
constexpr std::size_t kHeader = 16;
constexpr std::size_t kChildren = static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross;

enum Flag : std::uint8_t {
  kHasVoids = 1,
  kHasCovers = 2,
  kIsNarrow = 4,
  kHasChildren = 8,
  kInnerCoversFollow = 16,
  kDropsHeights = 32,
  kAllFlags = 63
};

/// Which errors are implied, and in which arithmetic.
enum class Implied : std::uint8_t { none = 0, finest = 1, whole = 2, exact = 3 };

// Contexts of the parts of a page.
constexpr int kVoidsFrom = kHeightContexts, kCoversFrom = kVoidsFrom + kVoidContexts,
              kErrorsFrom = kCoversFrom + kCoverContexts, kChildrenFrom = kErrorsFrom + kErrorContexts;
static_assert(kChildrenFrom + 5 <= kContexts);

/// Numbers closer to the base than this are narrow: predictions and errors fit in 32 bits.
constexpr std::int64_t kNarrow = 1 << 24;

std::int64_t minus(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}
std::int64_t plus(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::uint64_t zigzag(std::int64_t v) {
  return static_cast<std::uint64_t>(v) << 1 ^ static_cast<std::uint64_t>(v >> 63);
}
std::int64_t unzigzag(std::uint64_t v) { return static_cast<std::int64_t>(v >> 1 ^ (0 - (v & 1))); }

template <class Int>
void put(std::vector<std::byte>& out, Int value) {
  for (std::size_t i = 0; i < sizeof(Int); ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}

/// The position of a page's samples in its square.
struct Placement {
  explicit Placement(const PageGrid& grid)
      : cols(grid.cols),
        rows(grid.rows),
        col(grid.first.col & (kPageSide - 1)),
        row(grid.first.row & (kPageSide - 1)) {}
  std::int32_t cols, rows, col, row;
  [[nodiscard]] bool is_whole() const { return cols == kPageSide && rows == kPageSide; }
  [[nodiscard]] PresentRect present() const { return {col, col + cols, row, row + rows}; }

  template <class From, class To>
  void into_square(const std::vector<From>& grid, std::vector<To>& square) const {
    for (std::int32_t r = 0; r < rows; ++r) {
      const auto* from = grid.data() + std::ptrdiff_t{r} * cols;
      std::transform(from, from + cols, square.data() + std::ptrdiff_t{row + r} * kPageSide + col,
                     [](From v) { return static_cast<To>(v); });
    }
  }
  template <class From, class To>
  void from_square(const std::vector<From>& square, std::vector<To>& grid) const {
    grid.resize(static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows));
    for (std::int32_t r = 0; r < rows; ++r) {
      const auto* from = square.data() + std::ptrdiff_t{row + r} * kPageSide + col;
      std::copy(from, from + cols, grid.data() + std::ptrdiff_t{r} * cols);
    }
  }
};

/// Errors that follow from heights, for writing and reading.
struct ErrorsOfHeights {
  ImpliedErrors<std::int32_t> whole;
  ImpliedErrors<double> exact;
  std::vector<double> square, distances;
  std::vector<std::int32_t> eighths;
  std::vector<std::uint8_t> valid;

  /// Fills page.eighths or page.distances. `narrow`: the numbers of the square minus the base, if there are any.
  void imply(Implied kind, const std::vector<std::int32_t>& narrow, Page& page) {
    const Placement place(page.grid);
    page.eighths.clear();
    page.distances.clear();
    if (kind == Implied::none) return;
    std::span<const std::uint8_t> data;
    if (!page.valid.empty()) {
      valid.assign(kSquare, 0);
      place.into_square(page.valid, valid);
      data = valid;
    }
    if (kind == Implied::whole) {
      eighths.resize(kSquare);
      whole.compute(narrow, place.present(), data, eighths);
      place.from_square(eighths, page.eighths);
      return;
    }
    square.assign(kSquare, 0);
    place.into_square(page.heights, square);
    distances.resize(kSquare);
    if (kind == Implied::exact) {
      exact.compute(square, place.present(), data, distances);
    } else {
      implied_errors_rounded_up(square, place.present(), data, distances);
    }
    place.from_square(distances, page.distances);
  }
};

/// 1 where the height is stored: a valid sample, or a corner of a triangle with data, that is not dropped. Empty: all.
void mark_needed(const Page& page, std::vector<std::uint8_t>& needed) {
  needed.clear();
  if (page.valid.empty() && !page.drops_heights) return;
  needed.assign(page.grid.size(), 1);
  for (std::size_t i = 0; i < page.valid.size(); ++i) {
    needed[i] = page.valid[i] != 0 || (!page.covers.empty() && page.covers[i] != 0) ? 1 : 0;
  }
  if (!page.drops_heights) return;
  for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
    if (page.is_dropped(i, p)) needed[i] = 0;
  });
}

void put_children(const std::vector<ChildEntry>& children, NumberWriter& out) {
  const auto bits = [](float f) { return std::int64_t{std::bit_cast<std::int32_t>(f)}; };
  ChildEntry last;
  for (const ChildEntry& child : children) {
    out.put(child.present ? 1 : 0, kChildrenFrom);
    if (!child.present) continue;
    out.put(zigzag(std::int64_t{child.largest} - last.largest), kChildrenFrom + 1);
    out.put(zigzag(bits(child.lowest) - bits(last.lowest)), kChildrenFrom + 2);
    out.put(zigzag(bits(child.highest) - bits(last.highest)), kChildrenFrom + 3);
    out.put(zigzag(std::int64_t{child.generation} - last.generation), kChildrenFrom + 4);
    last = child;
  }
}

bool get_children(std::vector<ChildEntry>& children, NumberReader& in) {
  const auto added = [&](float to, int context) {
    const std::int64_t bits = plus(std::bit_cast<std::int32_t>(to), unzigzag(in.get(context)));
    return std::bit_cast<float>(static_cast<std::int32_t>(bits));
  };
  children.assign(kChildren, {});
  ChildEntry last;
  bool possible = true;
  for (ChildEntry& child : children) {
    const std::uint64_t present = in.get(kChildrenFrom);
    possible = possible && present <= 1;
    if (present != 1) continue;
    const std::int64_t largest = plus(last.largest, unzigzag(in.get(kChildrenFrom + 1)));
    possible = possible && largest >= 0 && largest <= kAlwaysSelected;
    child = {true, static_cast<ErrorCode>(possible ? largest : 0), added(last.lowest, kChildrenFrom + 2),
             added(last.highest, kChildrenFrom + 3),
             static_cast<std::uint32_t>(plus(last.generation, unzigzag(in.get(kChildrenFrom + 4))))};
    last = child;
  }
  return possible;
}

/// What writing and reading both work in.
struct Workspace {
  Page page;  ///< for writing: as the reader will have it
  std::vector<std::int64_t> wide_square;
  std::vector<std::int32_t> narrow_square;
  std::vector<std::uint8_t> needed, coded;
  HeightLevels<std::int32_t> narrow_levels;
  std::optional<HeightLevels<std::int64_t>> wide_levels;
  ErrorsOfHeights errors_of;
  StoredErrors stored;

  /// 1 for the samples of the square whose heights are stored. Empty: all.
  std::span<const std::uint8_t> coded_in(const Placement& place) {
    if (needed.empty() && place.is_whole()) return {};
    coded.assign(kSquare, 0);
    if (needed.empty()) needed.assign(page.grid.size(), 1);
    place.into_square(needed, coded);
    return coded;
  }
};

}  // namespace

// ---- writing ---------------------------------------------------------------------------------------

struct PageEncoder::Scratch : Workspace {
  std::vector<std::int64_t> numbers;
  NumberWriter out;

  /// Copies the page without the heights that the reader does not have yet when it reads errors.
  void begin(const Page& given) {
    page.id = given.id;
    page.bands = given.bands;
    page.grid = given.grid;
    page.drops_heights = given.drops_heights;
    page.extent = given.extent;
    page.valid = given.valid;
    page.heights.clear();
    if (!page.drops_heights) page.heights = given.heights;
    page.eighths.clear();
    page.distances.clear();
    page.errors.assign(given.grid.size(), 0);
  }

  /// The first kind that gives every error exactly as ingest computed it.
  Implied find_implied(const Page& given, Coding coding, bool is_narrow, const CodeDistance& distance) {
    const auto fits = [&](Implied kind) {
      errors_of.imply(kind, narrow_square, page);
      for (std::size_t i = 0; i < given.errors.size(); ++i) {
        if (!page.is_implied(i)) continue;
        // The same as error_code(metres) == code, without the search.
        const double metres = distance.metres(page.implied_distance(i));
        const ErrorCode code = given.errors[i];
        if (!(metres <= error_of(code)) || (code > 0 && metres <= error_of(static_cast<ErrorCode>(code - 1))))
          return false;
      }
      return true;
    };
    if (given.id.band != 0 || given.heights.empty() || given.drops_heights) {
      errors_of.imply(Implied::none, narrow_square, page);
      return Implied::none;
    }
    if (coding == Coding::whole && is_narrow) {
      if (fits(Implied::whole)) return Implied::whole;
    } else if (is_exact(given) && fits(Implied::exact)) {
      return Implied::exact;
    }
    if (fits(Implied::finest)) return Implied::finest;
    errors_of.imply(Implied::none, narrow_square, page);
    return Implied::none;
  }

  /// Whether interpolation over a block of 8² never rounds.
  [[nodiscard]] bool is_exact(const Page& given) const {
    BitRange bits;
    for (std::size_t i = 0; i < given.heights.size(); ++i) {
      if (needed.empty() || needed[i] != 0) bits.take(given.heights[i]);
    }
    return bits.interpolates_exactly(kChildrenAcross);
  }
};

PageEncoder::PageEncoder() : scratch_(std::make_unique<Scratch>()) {}
PageEncoder::~PageEncoder() = default;
PageEncoder::PageEncoder(PageEncoder&&) noexcept = default;
PageEncoder& PageEncoder::operator=(PageEncoder&&) noexcept = default;

std::vector<std::byte> encode(const Page& page, const CodeDistance& distance) {
  return PageEncoder().encode(page, distance);
}

std::vector<std::byte> PageEncoder::encode(const Page& page, const CodeDistance& distance) {
  Scratch& s = *scratch_;
  const Placement place(page.grid);
  const std::size_t n = page.grid.size();
  mark_needed(page, s.needed);
  const Coding coding = choose_coding(page.heights, s.needed);
  s.numbers.resize(n);
  numbers_of(page.heights, s.needed, coding, s.numbers);

  std::int64_t base = 0, lowest = 0, highest = 0;
  std::size_t first = 0;
  while (first < n && !s.needed.empty() && s.needed[first] == 0) ++first;
  if (first < n) base = s.numbers[first];
  for (std::size_t i = 0; i < n; ++i) {
    std::int64_t& number = s.numbers[i];
    number = s.needed.empty() || s.needed[i] != 0 ? minus(number, base) : 0;
    lowest = std::min(lowest, number);
    highest = std::max(highest, number);
  }
  const bool is_narrow = lowest > -kNarrow && highest < kNarrow;

  s.out.clear();
  s.begin(page);
  const std::span<const std::uint8_t> coded = s.coded_in(place);
  if (!page.valid.empty()) put_voids(page.grid, page.valid, kVoidsFrom, s.out);
  const bool inner_follow =
      !page.covers.empty() && put_covers(page.id, page.bands, page.grid, page.valid, page.covers, kCoversFrom, s.out);
  if (page.drops_heights) s.stored.put(page.errors, s.page, distance, kErrorsFrom, s.out);
  if (is_narrow) {
    s.narrow_square.assign(kSquare, 0);
    place.into_square(s.numbers, s.narrow_square);
    s.narrow_levels.put(s.narrow_square, coded, place.present(), s.out);
  } else {
    s.wide_square.assign(kSquare, 0);
    place.into_square(s.numbers, s.wide_square);
    if (!s.wide_levels) s.wide_levels.emplace();
    s.wide_levels->put(s.wide_square, coded, place.present(), s.out);
  }
  if (!page.children.empty()) put_children(page.children, s.out);

  const Implied implied = page.drops_heights ? Implied::none : s.find_implied(page, coding, is_narrow, distance);
  if (!page.drops_heights) s.stored.put(page.errors, s.page, distance, kErrorsFrom, s.out);

  std::vector<std::byte> bytes;
  bytes.reserve(n);
  const int flags = (page.valid.empty() ? 0 : kHasVoids) | (page.covers.empty() ? 0 : kHasCovers) |
                    (is_narrow ? kIsNarrow : 0) | (page.children.empty() ? 0 : kHasChildren) |
                    (inner_follow ? kInnerCoversFollow : 0) | (page.drops_heights ? kDropsHeights : 0);
  talus::put(bytes, kVersion);
  talus::put(bytes, static_cast<std::uint8_t>(coding));
  talus::put(bytes, static_cast<std::uint8_t>(flags));
  talus::put(bytes, static_cast<std::uint8_t>(implied));
  talus::put(bytes, static_cast<std::uint16_t>(page.grid.cols));
  talus::put(bytes, static_cast<std::uint16_t>(page.grid.rows));
  talus::put(bytes, static_cast<std::uint64_t>(base));
  static_assert(kHeader == 16);
  s.out.finish(bytes);
  return bytes;
}

PageEncoder::Parts PageEncoder::parts() const {
  const NumberWriter& out = scratch_->out;
  return {out.bits(0, kVoidsFrom), out.bits(kErrorsFrom, kChildrenFrom), out.bits(kVoidsFrom, kErrorsFrom),
          out.bits(kChildrenFrom, kContexts)};
}

// ---- reading ---------------------------------------------------------------------------------------

struct PageDecoder::Scratch : Workspace {
  NumberReader in;
  Implied implied = Implied::none;

  [[noreturn]] void corrupt(const char* what) const {
    fail(Cause::corrupt, "corrupt: page {}/{} of band {}: {}", page.id.x, page.id.y, page.id.band, what);
  }

  template <class Number>
  void heights_of(const std::vector<Number>& square, std::int64_t base, Coding coding) {
    const Placement place(page.grid);
    page.heights.resize(page.grid.size());
    double* to = page.heights.data();
    for (std::int32_t row = 0; row < place.rows; ++row, to += place.cols) {
      const Number* from = square.data() + std::ptrdiff_t{place.row + row} * kPageSide + place.col;
      talus::heights_of(base, std::span(from, static_cast<std::size_t>(place.cols)), coding, to);
    }
    if (coding < Coding::float_bits) return;
    for (std::size_t i = 0; i < page.heights.size(); ++i) {
      if (std::isfinite(page.heights[i])) continue;
      if (needed.empty() || needed[i] != 0) corrupt("a height is not a finite number");
      page.heights[i] = 0;  // a void that nothing needs, predicted from bits of both signs
    }
  }
};

PageDecoder::PageDecoder() : scratch_(std::make_unique<Scratch>()) {}
PageDecoder::~PageDecoder() = default;
PageDecoder::PageDecoder(PageDecoder&&) noexcept = default;
PageDecoder& PageDecoder::operator=(PageDecoder&&) noexcept = default;

void PageDecoder::decode_most(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                              std::span<const std::byte> bytes) {
  Scratch& s = *scratch_;
  Page& page = s.page;
  page.id = id;
  page.bands = bands;
  page.grid = page_grid(id, extent);
  page.extent = extent;
  const Placement place(page.grid);
  const std::size_t n = page.grid.size();
  if (bytes.size() < kHeader) s.corrupt("it ends too early");
  const auto byte = [&](std::size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  if (byte(0) != kVersion) s.corrupt("its version is unknown");
  const unsigned coding_byte = byte(1), flags = byte(2), implied = byte(3);
  if (coding_byte >= kCodings) s.corrupt("its coding of heights is unknown");
  const auto coding = static_cast<Coding>(coding_byte);
  if ((flags & ~unsigned{kAllFlags}) != 0 ||
      ((flags & (kHasVoids | kInnerCoversFollow)) != 0 && (flags & kHasCovers) == 0))
    s.corrupt("its flags contradict each other");
  if (((flags & kHasChildren) != 0) != (id.band > 0))
    s.corrupt("child entries are missing, or a page of band 0 has some");
  s.implied = static_cast<Implied>(implied);
  page.drops_heights = (flags & kDropsHeights) != 0;
  if (implied > 3 || (implied != 0 && (id.band > 0 || n == 0 || page.drops_heights)) ||
      (s.implied == Implied::whole && (coding != Coding::whole || (flags & kIsNarrow) == 0)))
    s.corrupt("its kind of implied errors is impossible");
  if ((byte(4) | byte(5) << 8) != static_cast<unsigned>(page.grid.cols) ||
      (byte(6) | byte(7) << 8) != static_cast<unsigned>(page.grid.rows))
    s.corrupt("its size does not match the extent");
  std::uint64_t base = 0;
  for (std::size_t i = 0; i < 8; ++i) base |= std::uint64_t{byte(8 + i)} << (8 * i);
  s.in.start(bytes.subspan(kHeader));

  page.valid.clear();
  page.covers.clear();
  page.children.clear();
  page.errors.clear();
  page.eighths.clear();
  page.distances.clear();
  if ((flags & kHasVoids) != 0) {
    page.valid.resize(n);
    get_voids(page.grid, page.valid, kVoidsFrom, s.in);
  }
  if ((flags & kHasCovers) != 0) {
    page.covers.resize(n);
    if (!get_covers(id, bands, page.grid, page.valid, (flags & kInnerCoversFollow) != 0, page.covers, kCoversFrom,
                    s.in))
      s.corrupt("the triangles around a vertex are impossible");
  }
  if (page.drops_heights) {
    page.heights.clear();
    page.errors.assign(n, 0);
    if (!s.stored.get(page, distance, kErrorsFrom, s.in)) s.corrupt("an error is larger than any possible one");
  }
  mark_needed(page, s.needed);
  const std::span<const std::uint8_t> coded = s.coded_in(place);
  if ((flags & kIsNarrow) != 0) {
    s.narrow_square.resize(kSquare);
    s.narrow_levels.get(s.narrow_square, coded, place.present(), s.in);
    s.heights_of(s.narrow_square, static_cast<std::int64_t>(base), coding);
  } else {
    s.wide_square.resize(kSquare);
    if (!s.wide_levels) s.wide_levels.emplace();
    s.wide_levels->get(s.wide_square, coded, place.present(), s.in);
    s.heights_of(s.wide_square, static_cast<std::int64_t>(base), coding);
  }
  if ((flags & kHasChildren) != 0 && !get_children(page.children, s.in)) s.corrupt("its child entries are wrong");
}

const Page& PageDecoder::decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                        std::span<const std::byte> bytes) {
  decode_most(id, extent, bands, distance, bytes);
  return scratch_->page;
}

const Page& PageDecoder::decode(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                std::span<const std::byte> bytes) {
  decode_most(id, extent, bands, distance, bytes);
  Scratch& s = *scratch_;
  s.errors_of.imply(s.implied, s.narrow_square, s.page);
  if (!s.page.drops_heights) {
    s.page.errors.assign(s.page.grid.size(), 0);
    if (!s.stored.get(s.page, distance, kErrorsFrom, s.in)) s.corrupt("an error is larger than any possible one");
  }
  if (!s.in.is_intact()) s.corrupt("it has too few or too many bits");
  return s.page;
}

}  // namespace talus
