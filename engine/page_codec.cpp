#include "engine/page_codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include <fmt/format.h>
#include <zstd.h>

#include "engine/vertex_error.hpp"
#include "talus/failure.hpp"

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
          std::max(a.highest, b.highest)};
}

ChildEntry range_of(const Page& page, const HeightStep& step) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < page.heights.size(); ++i) {
    if (!page.valid.empty() && !page.valid[i]) continue;
    const double height = step.value(page.heights[i]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  return {true, 0, rounded_down(lowest), rounded_up(highest)};
}

double Page::implied_error(GridPoint p, std::int32_t col, std::int32_t row, const CodeDistance& distance,
                           bool /*exact*/) const {
  const std::size_t here = index(col, row), step = (p.col & 1) != 0 ? 1 : static_cast<std::size_t>(grid.cols);
  return finest_error(heights[here], heights[here - step], heights[here + step], distance);
}

namespace {

constexpr int kZstdLevel = 3;
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kHeader = 8, kChildBytes = 11;
constexpr std::size_t kChildren = static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross;

enum Flag : std::uint8_t { kHasVoids = 1, kHasCovers = 2, kImpliesMidpoints = 4, kHasChildren = 8, kAllFlags = 15 };

/// How heights become whole numbers. A decimal k stands for k / 10^d, rounded to float where the source
/// was one; bits are the number's own, reordered so that they rise with it.
enum class Coding : std::uint8_t {
  whole = 0,
  decimal1 = 1,
  decimal2 = 2,
  decimal3 = 3,
  float_decimal1 = 4,
  float_decimal2 = 5,
  float_decimal3 = 6,
  float_bits = 7,
  double_bits = 8,
};
constexpr std::uint8_t kCodings = 9;
constexpr double kPowers[] = {1, 10, 100, 1000};

std::int64_t rising(std::int32_t bits) { return bits ^ ((bits >> 31) & 0x7fffffff); }
std::int64_t rising(std::int64_t bits) { return bits ^ ((bits >> 63) & 0x7fffffffffffffff); }

double height_of(std::int64_t k, Coding coding) {
  const int c = static_cast<int>(coding);
  switch (coding) {
    case Coding::whole: return static_cast<double>(k);
    case Coding::decimal1:
    case Coding::decimal2:
    case Coding::decimal3: return static_cast<double>(k) / kPowers[c];
    case Coding::float_decimal1:
    case Coding::float_decimal2:
    case Coding::float_decimal3:
      return static_cast<double>(static_cast<float>(static_cast<double>(k) / kPowers[c - 3]));
    case Coding::float_bits: {
      const auto narrow = static_cast<std::int32_t>(k);
      return static_cast<double>(std::bit_cast<float>(static_cast<std::int32_t>(rising(narrow))));
    }
    case Coding::double_bits: break;
  }
  return std::bit_cast<double>(rising(k));
}

std::int64_t number_of(double h, Coding coding) {
  const int c = static_cast<int>(coding);
  switch (coding) {
    case Coding::whole: return std::llround(h);
    case Coding::decimal1:
    case Coding::decimal2:
    case Coding::decimal3: return std::llround(h * kPowers[c]);
    case Coding::float_decimal1:
    case Coding::float_decimal2:
    case Coding::float_decimal3: return std::llround(h * kPowers[c - 3]);
    case Coding::float_bits: return rising(std::bit_cast<std::int32_t>(static_cast<float>(h)));
    case Coding::double_bits: break;
  }
  return rising(std::bit_cast<std::int64_t>(h));
}

bool restores(std::span<const double> heights, Coding coding) {
  for (const double h : heights) {
    if (std::abs(h) > 4e9 && coding < Coding::float_bits) return false;
    const double back = height_of(number_of(h, coding), coding);
    if (std::bit_cast<std::uint64_t>(back) != std::bit_cast<std::uint64_t>(h)) return false;
  }
  return true;
}

/// The first of a fixed ladder that restores every height bit for bit.
Coding choose(std::span<const double> heights) {
  for (const Coding c : {Coding::whole, Coding::float_decimal1, Coding::decimal1, Coding::float_decimal2,
                         Coding::decimal2, Coding::float_decimal3, Coding::decimal3, Coding::float_bits}) {
    if (restores(heights, c)) return c;
  }
  return Coding::double_bits;
}

std::int64_t mean(std::int64_t a, std::int64_t b) { return (a & b) + ((a ^ b) >> 1); }  // floor, no overflow

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

/// The samples of a page coarse to fine, each with what its neighbours predict. Every sample but the
/// page's corner is the middle of a side or a square of coarser ones; ends weigh three, apexes one where
/// the point is the middle of a side, all alike in the middle of a square. What lies outside the page is
/// left out.
class Prediction {
 public:
  Prediction(const PageGrid& grid, std::vector<std::int64_t>& numbers)
      : grid_(grid),
        numbers_(numbers),
        offset_col_(grid.first.col & (kPageSide - 1)),
        offset_row_(grid.first.row & (kPageSide - 1)) {}

  /// visit(number, predicted) in an order that depends on the grid only.
  template <class Visit>
  void run(Visit&& visit) {
    if (offset_col_ == 0 && offset_row_ == 0) visit(at(0, 0), std::int64_t{0});
    for (std::int32_t s = kPageSide / 2; s >= 1; s /= 2) {
      for (std::int32_t row = first(offset_row_, s, 2 * s); row < grid_.rows; row += 2 * s) centres(row, s, visit);
      for (std::int32_t row = first(offset_row_, 0, s); row < grid_.rows; row += s) sides(row, s, visit);
    }
  }

 private:
  /// Smallest page-relative index that is `phase` modulo `period` in the page's square.
  static std::int32_t first(std::int32_t offset, std::int32_t phase, std::int32_t period) {
    return (phase - offset) & (period - 1);
  }
  /// Most points have all four neighbours in the page; those need no look at its sides.
  template <class Visit>
  void centres(std::int32_t row, std::int32_t s, Visit& visit) {
    const bool inner_row = row >= s && row + s < grid_.rows;
    const std::ptrdiff_t down = std::ptrdiff_t{s} * grid_.cols;
    for (std::int32_t col = first(offset_col_, s, 2 * s); col < grid_.cols; col += 2 * s) {
      std::int64_t* p = &at(col, row);
      const bool inner = inner_row && col >= s && col + s < grid_.cols;
      visit(*p, inner ? mean(mean(p[-down - s], p[down + s]), mean(p[s - down], p[down - s])) : centre(col, row, s));
    }
  }
  template <class Visit>
  void sides(std::int32_t row, std::int32_t s, Visit& visit) {
    const bool upright = ((row + offset_row_) & s) != 0;  // the side runs down, not along the row
    const bool inner_row = row >= s && row + s < grid_.rows;
    const std::ptrdiff_t down = std::ptrdiff_t{s} * grid_.cols, ends = upright ? down : s, apexes = upright ? s : down;
    for (std::int32_t col = first(offset_col_, upright ? 0 : s, 2 * s); col < grid_.cols; col += 2 * s) {
      std::int64_t* p = &at(col, row);
      if (inner_row && col >= s && col + s < grid_.cols) {
        const std::int64_t along = mean(p[-ends], p[ends]), across = mean(p[-apexes], p[apexes]);
        visit(*p, plus(along, minus(across, along) >> 2));
      } else {
        visit(*p, upright ? side(col, row, 0, s) : side(col, row, s, 0));
      }
    }
  }
  std::int64_t& at(std::int32_t col, std::int32_t row) {
    return numbers_[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.cols) +
                    static_cast<std::size_t>(col)];
  }
  [[nodiscard]] bool has(std::int32_t col, std::int32_t row) const {
    return static_cast<std::uint32_t>(col) < static_cast<std::uint32_t>(grid_.cols) &&
           static_cast<std::uint32_t>(row) < static_cast<std::uint32_t>(grid_.rows);
  }
  std::int64_t centre(std::int32_t col, std::int32_t row, std::int32_t s) {
    return pair(pair_of(col - s, row - s, col + s, row + s), pair_of(col + s, row - s, col - s, row + s));
  }
  /// Ends at ±(dc, dr), apexes across.
  std::int64_t side(std::int32_t col, std::int32_t row, std::int32_t dc, std::int32_t dr) {
    if (has(col - dc, row - dr) && has(col + dc, row + dr) && has(col - dr, row - dc) && has(col + dr, row + dc)) {
      const std::int64_t along = mean(at(col - dc, row - dr), at(col + dc, row + dr));
      const std::int64_t across = mean(at(col - dr, row - dc), at(col + dr, row + dc));
      return plus(along, minus(across, along) >> 2);
    }
    const Guess ends = pair_of(col - dc, row - dr, col + dc, row + dr);
    const Guess apexes = pair_of(col - dr, row - dc, col + dr, row + dc);
    return ends.count > 0 && ends.count >= apexes.count ? ends.value : apexes.count > 0 ? apexes.value : 0;
  }
  struct Guess {
    std::int64_t value;
    int count;
  };
  Guess pair_of(std::int32_t c1, std::int32_t r1, std::int32_t c2, std::int32_t r2) {
    const bool one = has(c1, r1), two = has(c2, r2);
    if (one && two) return {mean(at(c1, r1), at(c2, r2)), 2};
    if (one) return {at(c1, r1), 1};
    return two ? Guess{at(c2, r2), 1} : Guess{0, 0};
  }
  static std::int64_t pair(Guess a, Guess b) {
    return a.count == b.count && a.count > 0 ? mean(a.value, b.value) : a.count > b.count ? a.value : b.value;
  }

  const PageGrid& grid_;
  std::vector<std::int64_t>& numbers_;
  std::int32_t offset_col_, offset_row_;
};

/// The samples whose errors the page stores, row by row: its own vertices but for implied midpoints.
void list_stored_errors(const Page& page, std::vector<std::uint32_t>& stored) {
  stored.clear();
  const bool coarsest = page.id.band == page.bands - 1;
  const std::int32_t coarser = kChildrenAcross - 1;  // units with these bits clear belong to the band above
  for (std::int32_t row = 0; row < page.grid.rows; ++row) {
    const bool row_coarser = ((row + page.grid.first.row) & coarser) == 0 && !coarsest;
    const bool row_odd = ((row + page.grid.first.row) & 1) != 0, inner_row = row > 0 && row + 1 < page.grid.rows;
    for (std::int32_t col = 0; col < page.grid.cols; ++col) {
      const std::int32_t unit = col + page.grid.first.col;
      const bool own = !row_coarser || (unit & coarser) != 0;
      const bool side = ((unit & 1) != 0) != row_odd;  // the midpoint of a finest side
      const bool implied =
          page.implied_midpoints && side && (row_odd ? inner_row : col > 0 && col + 1 < page.grid.cols);
      if (own && !implied) stored.push_back(static_cast<std::uint32_t>(page.index(col, row)));
    }
  }
}

// ---- bytes ---------------------------------------------------------------------------------------

template <class Int>
void put(std::vector<std::byte>& out, Int value) {
  for (std::size_t i = 0; i < sizeof(Int); ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}

/// A section: how many bytes follow (u32), its top bit set where they stand as they are, else a zstd frame.
constexpr std::uint32_t kPlain = 0x80000000u;

void put_section(std::vector<std::byte>& out, std::span<const std::byte> raw) {
  std::vector<std::byte> packed(ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), kZstdLevel);
  if (ZSTD_isError(size) || size >= raw.size()) {
    put(out, static_cast<std::uint32_t>(raw.size()) | kPlain);
    out.insert(out.end(), raw.begin(), raw.end());
  } else {
    put(out, static_cast<std::uint32_t>(size));
    out.insert(out.end(), packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
  }
}

struct FreeContext {
  void operator()(ZSTD_DCtx* c) const { ZSTD_freeDCtx(c); }
};

class Reader {
 public:
  Reader(PageId id, std::span<const std::byte> bytes) : id_(id), rest_(bytes) {}

  [[noreturn]] void corrupt(const char* what) const {
    throw Failure(Cause::corrupt, fmt::format("corrupt: page {}/{} of band {}: {}", id_.x, id_.y, id_.band, what));
  }
  template <class Int>
  Int get() {
    if (rest_.size() < sizeof(Int)) corrupt("ends early");
    Int value = 0;
    for (std::size_t i = 0; i < sizeof(Int); ++i)
      value = static_cast<Int>(value | static_cast<Int>(std::to_integer<Int>(rest_[i]) << (8 * i)));
    rest_ = rest_.subspan(sizeof(Int));
    return value;
  }
  /// A section of exactly `size` bytes once unpacked, into `buffer`.
  std::span<const std::byte> section(std::size_t size, std::vector<std::byte>& buffer, ZSTD_DCtx* context) {
    const auto length = get<std::uint32_t>();
    const std::size_t stored = length & ~kPlain;
    if (stored > rest_.size()) corrupt("section longer than the page");
    const auto bytes = rest_.first(stored);
    rest_ = rest_.subspan(stored);
    buffer.resize(size);
    if ((length & kPlain) != 0) {
      if (stored != size) corrupt("section of the wrong length");
      if (size > 0) std::memcpy(buffer.data(), bytes.data(), size);
    } else {
      const std::size_t got = ZSTD_decompressDCtx(context, buffer.data(), size, bytes.data(), stored);
      if (ZSTD_isError(got) || got != size) corrupt("section does not unpack");
    }
    return buffer;
  }
  void finish() const {
    if (!rest_.empty()) corrupt("bytes after the last section");
  }

 private:
  PageId id_;
  std::span<const std::byte> rest_;
};

}  // namespace

std::vector<std::byte> encode(const Page& page) {
  const std::size_t n = page.grid.size();
  const Coding coding = choose(page.heights);
  std::vector<std::int64_t> numbers(n);
  for (std::size_t i = 0; i < n; ++i) numbers[i] = number_of(page.heights[i], coding);
  std::vector<std::uint64_t> residuals;
  residuals.reserve(n);
  std::uint64_t all = 0;
  Prediction(page.grid, numbers).run([&](std::int64_t& number, std::int64_t predicted) {
    const auto i = static_cast<std::size_t>(&number - numbers.data());
    if (!page.valid.empty() && !page.valid[i] && page.covers[i] == 0 && std::isfinite(height_of(predicted, coding))) {
      number = predicted;  // nobody asks for it; between bits of both signs it may overflow into no number
    }
    residuals.push_back(zigzag(minus(number, predicted)));
    all |= residuals.back();
  });
  const std::size_t width = all < 1ull << 8 ? 1 : all < 1ull << 16 ? 2 : all < 1ull << 32 ? 4 : 8;

  std::vector<std::byte> out;
  const int flags = (page.valid.empty() ? 0 : kHasVoids) | (page.covers.empty() ? 0 : kHasCovers) |
                    (page.implied_midpoints ? kImpliesMidpoints : 0) | (page.children.empty() ? 0 : kHasChildren);
  put(out, kVersion);
  put(out, static_cast<std::uint8_t>(coding));
  put(out, static_cast<std::uint8_t>(flags));
  put(out, static_cast<std::uint8_t>(width));
  put(out, static_cast<std::uint16_t>(page.grid.cols));
  put(out, static_cast<std::uint16_t>(page.grid.rows));
  static_assert(kHeader == 8);

  std::vector<std::byte> section;
  if (!page.valid.empty()) {
    section.assign((n + 7) / 8, std::byte{0});
    for (std::size_t i = 0; i < n; ++i) {
      if (page.valid[i]) section[i / 8] |= std::byte{1} << (i % 8);
    }
    put_section(out, section);
  }
  if (!page.covers.empty()) {
    section.resize(n);
    for (std::size_t i = 0; i < n; ++i) section[i] = std::byte{page.covers[i]};
    put_section(out, section);
  }
  for (std::size_t plane = 0; plane < width; ++plane) {
    section.resize(n);
    for (std::size_t i = 0; i < n; ++i) section[i] = static_cast<std::byte>(residuals[i] >> (8 * plane) & 0xff);
    put_section(out, section);
  }
  std::vector<std::uint32_t> stored;
  list_stored_errors(page, stored);
  for (const unsigned shift : {0u, 8u}) {
    section.clear();
    for (const std::uint32_t i : stored) section.push_back(static_cast<std::byte>(page.errors[i] >> shift & 0xff));
    put_section(out, section);
  }
  if (!page.children.empty()) {
    section.clear();
    for (const ChildEntry& child : page.children) {
      put(section, static_cast<std::uint8_t>(child.present ? 1 : 0));
      put(section, child.largest);
      put(section, std::bit_cast<std::uint32_t>(child.lowest));
      put(section, std::bit_cast<std::uint32_t>(child.highest));
    }
    put_section(out, section);
  }
  return out;
}

struct PageDecoder::Scratch {
  Page page;
  std::vector<std::int64_t> numbers;
  std::array<std::vector<std::byte>, 8> planes;
  std::vector<std::uint32_t> stored;
  std::unique_ptr<ZSTD_DCtx, FreeContext> context{ZSTD_createDCtx()};

  /// What `stored` depends on: most pages of a query are alike.
  using Shape = std::array<std::int32_t, 6>;
  [[nodiscard]] static Shape shape_of(const Page& page) {
    const std::int32_t coarser = kChildrenAcross - 1;
    return {page.grid.cols,
            page.grid.rows,
            page.grid.first.col & coarser,
            page.grid.first.row & coarser,
            page.id.band == page.bands - 1 ? 1 : 0,
            page.implied_midpoints ? 1 : 0};
  }
  Shape shape{};
};

PageDecoder::PageDecoder() : scratch_(std::make_unique<Scratch>()) {}
PageDecoder::~PageDecoder() = default;
PageDecoder::PageDecoder(PageDecoder&&) noexcept = default;
PageDecoder& PageDecoder::operator=(PageDecoder&&) noexcept = default;

const Page& PageDecoder::decode(PageId id, GridRect extent, int bands, std::span<const std::byte> bytes) {
  Reader in(id, bytes);
  Page& page = scratch_->page;  // by name: clang 14 captures no structured binding
  auto& numbers = scratch_->numbers;
  auto& planes = scratch_->planes;
  auto& stored = scratch_->stored;
  const auto section = [&](std::size_t size, std::size_t plane = 0) {
    return in.section(size, planes[plane], scratch_->context.get());
  };
  page.id = id;
  page.bands = bands;
  page.grid = page_grid(id, extent);
  const std::size_t n = page.grid.size();
  if (in.get<std::uint8_t>() != kVersion) in.corrupt("unknown version");
  const auto coding = in.get<std::uint8_t>(), flags = in.get<std::uint8_t>(), width = in.get<std::uint8_t>();
  if (coding >= kCodings) in.corrupt("unknown coding of heights");
  if ((flags & ~kAllFlags) != 0 || ((flags & kHasVoids) != 0 && (flags & kHasCovers) == 0))
    in.corrupt("impossible flags");
  if (((flags & kHasChildren) != 0) != (id.band > 0))
    in.corrupt("table of pages below where none belongs, or none where one does");
  if ((flags & kImpliesMidpoints) != 0 && (id.band != 0 || (flags & (kHasVoids | kHasCovers)) != 0))
    in.corrupt("impossible flags");
  if (width != 1 && width != 2 && width != 4 && width != 8) in.corrupt("impossible width of residuals");
  if (in.get<std::uint16_t>() != page.grid.cols || in.get<std::uint16_t>() != page.grid.rows) in.corrupt("wrong size");
  page.implied_midpoints = (flags & kImpliesMidpoints) != 0;

  page.valid.clear();
  page.covers.clear();
  page.children.clear();
  if ((flags & kHasVoids) != 0) {
    const auto bits = section((n + 7) / 8);
    page.valid.resize(n);
    for (std::size_t i = 0; i < n; ++i) page.valid[i] = std::to_integer<std::uint8_t>(bits[i / 8] >> (i % 8)) & 1;
  }
  if ((flags & kHasCovers) != 0) {
    const auto raw = section(n);
    page.covers.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      page.covers[i] = std::to_integer<std::uint8_t>(raw[i]);
      if (page.covers[i] > 15) in.corrupt("impossible triangles around a vertex");
    }
  }

  for (std::size_t plane = 0; plane < width; ++plane) (void)section(n, plane);
  numbers.resize(n);
  std::size_t next = 0;
  const auto rebuild = [&](auto&& residual) {
    Prediction(page.grid, numbers).run([&](std::int64_t& number, std::int64_t predicted) {
      number = plus(predicted, unzigzag(residual(next++)));
    });
  };
  const auto byte = [](const std::vector<std::byte>& plane, std::size_t i) {
    return std::to_integer<std::uint64_t>(plane[i]);
  };
  if (width == 1) {
    rebuild([&, &low = planes[0]](std::size_t i) { return byte(low, i); });
  } else if (width == 2) {
    rebuild([&, &low = planes[0], &high = planes[1]](std::size_t i) { return byte(low, i) | byte(high, i) << 8; });
  } else {
    rebuild([&, &all = planes](std::size_t i) {
      std::uint64_t value = 0;
      for (std::size_t plane = 0; plane < width; ++plane) value |= byte(all[plane], i) << (8 * plane);
      return value;
    });
  }
  page.heights.resize(n);
  if (static_cast<Coding>(coding) == Coding::whole) {
    std::transform(numbers.begin(), numbers.end(), page.heights.begin(),
                   [](std::int64_t k) { return static_cast<double>(k); });
  } else {
    for (std::size_t i = 0; i < n; ++i) page.heights[i] = height_of(numbers[i], static_cast<Coding>(coding));
    if (!std::all_of(page.heights.begin(), page.heights.end(), [](double h) { return std::isfinite(h); })) {
      in.corrupt("a height that is no number");
    }
  }

  page.errors.assign(n, 0);
  if (const auto shape = scratch_->shape_of(page); shape != scratch_->shape) {
    list_stored_errors(page, stored);
    scratch_->shape = shape;
  }
  for (const unsigned shift : {0u, 8u}) {
    const auto raw = section(stored.size());
    for (std::size_t i = 0; i < stored.size(); ++i) {
      ErrorCode& error = page.errors[stored[i]];
      error = static_cast<ErrorCode>(error | std::to_integer<unsigned>(raw[i]) << shift);
    }
  }
  if (std::any_of(page.errors.begin(), page.errors.end(), [](ErrorCode e) { return e > kAlwaysSelected; })) {
    in.corrupt("an error beyond the ladder");
  }

  if ((flags & kHasChildren) != 0) {
    Reader table(id, section(kChildren * kChildBytes));
    page.children.resize(kChildren);
    for (ChildEntry& child : page.children) {
      const auto present = table.get<std::uint8_t>();
      child.present = present != 0;
      child.largest = table.get<std::uint16_t>();
      child.lowest = std::bit_cast<float>(table.get<std::uint32_t>());
      child.highest = std::bit_cast<float>(table.get<std::uint32_t>());
      if (present > 1 || child.largest > kAlwaysSelected) in.corrupt("impossible table of pages below");
    }
  }
  in.finish();
  return page;
}

}  // namespace talus
