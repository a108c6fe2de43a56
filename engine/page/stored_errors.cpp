#include "engine/page/stored_errors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <tuple>

namespace talus {
namespace {

using detail::SortedSquare;

constexpr unsigned kCodes = kAlwaysSelected + 1;
constexpr unsigned kEighths = 1 << 15;  ///< one more than the most
constexpr int kMostLowBits = 14;
constexpr unsigned kMostZeros = 24;  ///< then the number follows in 15 bits
constexpr int kBitsOfNumber = 15;

/// How the numbers of a class are written: 0 to 14 low bits; all are 0; or the same with a flag for each number.
constexpr unsigned kAllZero = 15, kFlags = 16, kBitsOfMode = 5;

/// Side midpoints and centres of each spacing, and the corner that is coarser than all levels of a page.
constexpr std::size_t kMostClasses = 2 * kPageShift + 1;

struct Vertex {
  std::uint16_t at, error;     ///< indices of its height and of its error
  std::int16_t to_end;         ///< from its height to that of one end, and backward to the other; 0: they do not count
  std::uint16_t children = 0;  ///< in the page
  std::uint16_t child[4] = {};
};

struct List {
  std::vector<Vertex> vertices;
  std::array<std::uint32_t, kMostClasses + 1> begin{};  ///< of each class; children come before their parents
  std::size_t classes = 0;
};

// ---- bits --------------------------------------------------------------------------------------------

/// Bits, least significant first.
class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  void put(std::uint64_t bits, unsigned count) {
    waiting_ |= bits << filled_;
    for (filled_ += count; filled_ >= 8; filled_ -= 8, waiting_ >>= 8) out_.push_back(static_cast<std::byte>(waiting_));
  }
  void put_number(unsigned number, unsigned low_bits) {
    const unsigned high = number >> low_bits;
    if (high >= kMostZeros) return put(std::uint64_t{number} << kMostZeros, kMostZeros + kBitsOfNumber);
    put(std::uint64_t{1} << high | std::uint64_t{number & ((1u << low_bits) - 1)} << (high + 1), high + 1 + low_bits);
  }
  void end() {
    if (filled_ > 0) put(0, 8 - filled_);
  }

 private:
  std::vector<std::byte>& out_;
  std::uint64_t waiting_ = 0;
  unsigned filled_ = 0;
};

/// Beyond the end all bits are 0.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  /// At most 56 bits.
  std::uint64_t get(unsigned count) {
    const std::uint64_t bits = window() & ((std::uint64_t{1} << count) - 1);
    at_ += count;
    return bits;
  }
  unsigned get_number(unsigned low_bits) {
    const std::uint64_t bits = window();
    const auto zeros = static_cast<unsigned>(std::countr_zero(bits | std::uint64_t{1} << kMostZeros));
    if (zeros == kMostZeros) {
      at_ += kMostZeros + kBitsOfNumber;
      return static_cast<unsigned>(bits >> kMostZeros & (kEighths - 1));
    }
    at_ += zeros + 1 + low_bits;
    return zeros << low_bits | static_cast<unsigned>(bits >> (zeros + 1) & ((1u << low_bits) - 1));
  }
  void skip(std::size_t count) { at_ += count; }
  /// Whether all bytes were read, and no other bit of the last one is set.
  [[nodiscard]] bool is_at_end() const {
    return (at_ + 7) / 8 == bytes_.size() &&
           (at_ % 8 == 0 || std::to_integer<unsigned>(bytes_.back()) >> (at_ % 8) == 0);
  }

 private:
  [[nodiscard]] std::uint64_t window() const {
    const std::size_t first = at_ / 8;
    std::uint64_t word = 0;
    if (first + 8 <= bytes_.size()) [[likely]] {
      std::memcpy(&word, bytes_.data() + first, 8);
    } else if (first < bytes_.size()) {
      std::memcpy(&word, bytes_.data() + first, bytes_.size() - first);
    }
    return word >> (at_ % 8);
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;  ///< in bits
};

unsigned mode_for(std::span<const std::uint16_t> numbers) {
  std::size_t above = 0, bits = 0;
  for (const unsigned number : numbers) {
    above += number > 0 ? 1 : 0;
    bits += static_cast<std::size_t>(std::bit_width(number));
  }
  if (above == 0) return kAllZero;
  const auto bits_with = [&](unsigned low_bits, unsigned less) {
    std::size_t sum = 0;
    for (const unsigned number : numbers) {
      const unsigned high = (number - less) >> low_bits;
      const unsigned length = high < kMostZeros ? high + 1 + low_bits : kMostZeros + kBitsOfNumber;
      sum += number >= less ? length : 0;
    }
    return sum + less * numbers.size();
  };
  // Around the mean length of the numbers.
  unsigned best = 0;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const unsigned less : {0u, 1u}) {
    const int mean = static_cast<int>(bits / (less == 0 ? numbers.size() : above));
    for (int low = std::max(mean - 2, 0); low <= std::min(mean + 1, kMostLowBits); ++low) {
      const std::size_t sum = bits_with(static_cast<unsigned>(low), less);
      if (sum < least) least = sum, best = static_cast<unsigned>(low) + less * kFlags;
    }
  }
  return best;
}

// ---- what errors follow from -------------------------------------------------------------------------

/// Errors and heights of a dense page.
struct OfSquares {
  const std::int16_t* heights;
  std::int16_t* errors;
  CodesOfEighths codes;

  [[nodiscard]] unsigned values() const { return codes == nullptr ? kEighths : kCodes; }
  [[nodiscard]] unsigned least(const Vertex& v) const {
    int least = 0, code = 0;
    if (v.to_end != 0) {
      const int here = heights[v.at];
      const auto rise = [&](int to) { return int{static_cast<std::int16_t>(heights[v.at + to] - here)}; };
      least = std::min(static_cast<int>(kEighths) - 1, std::abs(4 * (rise(v.to_end) + rise(-v.to_end))));
    }
    for (int i = 0; i < v.children; ++i) {
      const int error = errors[v.child[i]];
      least = std::max(least, error);
      code = std::max(code, -1 - error);
    }
    return static_cast<unsigned>(codes == nullptr ? least
                                                  : std::max(code, int{(*codes)[static_cast<std::size_t>(least)]}));
  }
  [[nodiscard]] unsigned get(const Vertex& v) const {
    return static_cast<unsigned>(codes == nullptr ? errors[v.error] : -1 - errors[v.error]);
  }
  void set(const Vertex& v, unsigned error) const {
    errors[v.error] = codes == nullptr ? static_cast<std::int16_t>(error) : coded(static_cast<int>(error));
  }
};

/// Those of another page.
struct OfPage {
  Page& page;
  const CodeDistance& distance;

  [[nodiscard]] static unsigned values() { return kCodes; }
  [[nodiscard]] unsigned least(const Vertex& v) const {
    double codes = 0;
    if (v.to_end != 0) {
      const double* here = page.heights.data() + v.at;
      codes = std::abs(*here - (here[v.to_end] / 2 + here[-v.to_end] / 2));
    }
    ErrorCode error = 0;
    for (int i = 0; i < v.children; ++i) {
      error = std::max(error, page.errors[v.child[i]]);
      if (page.has_distance(v.child[i])) codes = std::max(codes, page.distance_of(v.child[i]));
    }
    return codes == 0 ? error : std::max(error, error_code(distance.metres(codes)));
  }
  [[nodiscard]] unsigned get(const Vertex& v) const { return page.errors[v.error]; }
  void set(const Vertex& v, unsigned error) const { page.errors[v.error] = static_cast<ErrorCode>(error); }
};

template <class Of>
void put_errors(const List& list, const Of& of, std::vector<std::byte>& out) {
  std::vector<std::uint16_t> numbers;
  numbers.reserve(list.vertices.size());
  for (const Vertex& v : list.vertices)
    numbers.push_back(static_cast<std::uint16_t>((of.get(v) + of.values() - of.least(v)) % of.values()));
  const auto of_class = [&](std::size_t k) {
    return std::span(numbers).subspan(list.begin[k], list.begin[k + 1] - list.begin[k]);
  };
  std::array<unsigned, kMostClasses> modes{};
  bool all_zero = true;
  for (std::size_t k = 0; k < list.classes; ++k) {
    modes[k] = mode_for(of_class(k));
    all_zero = all_zero && modes[k] == kAllZero;
  }
  Writer writer(out);
  writer.put(all_zero ? 0 : 1, 1);
  for (std::size_t k = 0; !all_zero && k < list.classes; ++k) writer.put(modes[k], kBitsOfMode);
  for (std::size_t k = 0; k < list.classes; ++k) {
    if (modes[k] == kAllZero) continue;
    const unsigned flags = modes[k] / kFlags, low_bits = modes[k] % kFlags;
    for (const unsigned number : of_class(k)) writer.put(number >= 1 ? flags : 0, flags);
    for (const unsigned number : of_class(k)) {
      if (number >= flags) writer.put_number(number - flags, low_bits);
    }
  }
  writer.end();
}

template <class Of>
bool get_errors(const List& list, std::span<const std::byte> bytes, const Of& of) {
  Reader numbers(bytes);
  const bool all_zero = numbers.get(1) == 0;
  std::array<unsigned, kMostClasses> modes{};
  modes.fill(kAllZero);
  for (std::size_t k = 0; !all_zero && k < list.classes; ++k)
    modes[k] = static_cast<unsigned>(numbers.get(kBitsOfMode));
  bool possible = true;
  const auto set = [&](const Vertex& v, unsigned number) {
    const unsigned sum = of.least(v) + number, values = of.values();
    possible = possible && number < values;
    of.set(v, sum < values ? sum : (sum - values) % values);
  };
  for (std::size_t k = 0; k < list.classes; ++k) {
    const Vertex* v = list.vertices.data() + list.begin[k];
    const Vertex* const end = list.vertices.data() + list.begin[k + 1];
    const unsigned low_bits = modes[k] % kFlags;
    if (modes[k] == kAllZero) {
      for (; v != end; ++v) set(*v, 0);
    } else if (low_bits > kMostLowBits) {
      return false;
    } else if (modes[k] < kFlags) {
      for (; v != end; ++v) set(*v, numbers.get_number(low_bits));
    } else {
      Reader flags = numbers;
      numbers.skip(static_cast<std::size_t>(end - v));
      while (v != end) {
        const auto count = static_cast<unsigned>(std::min<std::ptrdiff_t>(56, end - v));
        std::uint64_t bits = flags.get(count);
        for (const Vertex* const last = v + count; v != last; ++v, bits >>= 1)
          set(*v, (bits & 1) != 0 ? numbers.get_number(low_bits) + 1 : 0);
      }
    }
  }
  return possible && numbers.is_at_end();
}

// ---- lists -------------------------------------------------------------------------------------------

struct At {
  int col, row;
};

/// Half the way between the ends of a vertex's diamond. A side midpoint's ends lie along its side; a centre's on the
/// falling diagonal, or on the rising one, by turns.
At to_end(At p, int s, bool centre) {
  if (!centre) return (p.col & s) != 0 ? At{s, 0} : At{0, s};
  return (((p.col - s) ^ (p.row - s)) & (2 * s)) == 0 ? At{s, s} : At{s, -s};
}

/// The children of a centre are the side midpoints around it; those of a side midpoint the centres of half its spacing.
std::array<At, 4> children_of(At p, int s, bool centre) {
  if (centre) return {{{p.col, p.row - s}, {p.col - s, p.row}, {p.col + s, p.row}, {p.col, p.row + s}}};
  const int h = s / 2;
  return {{{p.col - h, p.row - h}, {p.col + h, p.row - h}, {p.col - h, p.row + h}, {p.col + h, p.row + h}}};
}

/// Those of a row's vertices that belong to a class.
std::array<std::uint64_t, 2> of_class(const std::uint64_t (&bits)[2], int row, int s, bool centre) {
  if ((row & (s - 1)) != 0 || (centre && (row & s) == 0)) return {0, 0};
  std::uint64_t cols = 0;  // odd multiples of s, or in a row of odd ones the even ones
  for (int col = centre || (row & s) == 0 ? s : 0; col < 64; col += 2 * s) cols |= std::uint64_t{1} << col;
  if (s == 64) return {bits[0] & cols, (row & s) == 0 || centre ? bits[1] & 1 : 0};
  return {bits[0] & cols, bits[1] & cols};
}

List list_of(const Page& page, ErrorForm form, const SquareBits& implied, const SquareBits& data) {
  const bool dense = form >= ErrorForm::dense, coarsest = page.id.band == page.bands - 1;
  const SquareBits present = present_samples(page.grid), stored = without(present, implied);
  const int first_col = page.grid.first.col & (kPageSide - 1), first_row = page.grid.first.row & (kPageSide - 1);
  const int stride = dense ? kPageSide : page.grid.cols;
  const auto index = [&](At p) {
    return static_cast<std::uint16_t>(dense ? p.row * kPageSide + p.col
                                            : (p.row - first_row) * page.grid.cols + p.col - first_col);
  };
  const auto error_index = [&](At p) {
    return dense ? static_cast<std::uint16_t>(SortedSquare::index_of(p.col, p.row)) : index(p);
  };
  const auto has_at = [](const SquareBits& bits, At p) {
    return p.col >= 0 && p.row >= 0 && p.col < kPageSide && p.row < kPageSide && has(bits, p.col, p.row);
  };
  List list;
  list.classes = coarsest ? kMostClasses : 2 * kBandLevels;
  for (std::size_t k = 0; k < list.classes; ++k) {
    const int s = 1 << (k / 2);
    const bool centre = k % 2 != 0;
    const auto add = [&](At p) {
      Vertex v{index(p), error_index(p), 0};
      const At step = to_end(p, s, centre), a{p.col - step.col, p.row - step.row},
               b{p.col + step.col, p.row + step.row};
      // A stored side midpoint of spacing 1 beside implied ones has no valid apex: perhaps no triangle with data.
      const bool ends_count = form == ErrorForm::none || k > 0;
      if (ends_count && has_at(data, p) && has_at(data, a) && has_at(data, b))
        v.to_end = static_cast<std::int16_t>(step.row * stride + step.col);
      if (k > 0) {
        for (const At child : children_of(p, s, centre)) {
          if (has_at(present, child)) v.child[v.children++] = error_index(child);
        }
      }
      list.vertices.push_back(v);
    };
    if (k == 2 * kPageShift) {
      if (has(present, 0, 0)) list.vertices.push_back({index({0, 0}), error_index({0, 0}), 0});
    } else {
      for (int row = 0; row < kPageSide; row += s) {
        const auto words = of_class(stored[static_cast<std::size_t>(row)], row, s, centre);
        for (int word = 0; word < 2; ++word) {
          for (std::uint64_t rest = words[static_cast<std::size_t>(word)]; rest != 0; rest &= rest - 1)
            add({64 * word + std::countr_zero(rest), row});
        }
      }
    }
    list.begin[k + 1] = static_cast<std::uint32_t>(list.vertices.size());
  }
  return list;
}

/// The errors that follow from heights in this form.
SquareBits implied_in(ErrorForm form, const SquareBits& data) {
  if (form == ErrorForm::none) return {};
  SquareBits implied = implied_places(data);
  if (form != ErrorForm::finest) return implied;
  for (std::size_t row = 0; row < implied.size(); row += 2) {  // of spacing 1: those with an odd coordinate
    for (std::uint64_t& word : implied[row]) word &= 0xaaaaaaaaaaaaaaaa;
  }
  return implied;
}

}  // namespace

/// Pages of one shape without voids share a list.
struct StoredErrors::Lists {
  using Shape = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t, ErrorForm, bool>;
  std::map<Shape, List> of_shapes;
  List other;
  const List* here = &other;
};

StoredErrors::StoredErrors() : lists_(std::make_unique<Lists>()) {}
StoredErrors::~StoredErrors() = default;
StoredErrors::StoredErrors(StoredErrors&&) noexcept = default;
StoredErrors& StoredErrors::operator=(StoredErrors&&) noexcept = default;

void StoredErrors::list(const Page& page, ErrorForm form) {
  const SquareBits data = data_samples(page);
  const auto made = [&] { return list_of(page, form, implied_in(form, data), data); };
  if (!page.valid.empty()) {
    lists_->other = made();
    lists_->here = &lists_->other;
    return;
  }
  constexpr std::size_t kMostShapes = 8;
  const Lists::Shape shape{page.grid.first.col & (kPageSide - 1),
                           page.grid.first.row & (kPageSide - 1),
                           page.grid.cols,
                           page.grid.rows,
                           form,
                           page.id.band == page.bands - 1};
  auto found = lists_->of_shapes.find(shape);
  if (found == lists_->of_shapes.end()) {
    if (lists_->of_shapes.size() >= kMostShapes) lists_->of_shapes.clear();
    found = lists_->of_shapes.emplace(shape, made()).first;
  }
  lists_->here = &found->second;
}

void StoredErrors::places(std::vector<std::uint16_t>& found) const {
  found.clear();
  for (const Vertex& v : lists_->here->vertices) found.push_back(v.at);
}

void StoredErrors::put(const std::vector<ErrorCode>& all, Page& page, const CodeDistance& distance,
                       std::vector<std::byte>& out) {
  for (const Vertex& v : lists_->here->vertices) page.errors[v.error] = all[v.error];
  put_errors(*lists_->here, OfPage{page, distance}, out);
}

void StoredErrors::put(DenseSquares& squares, CodesOfEighths codes, std::vector<std::byte>& out) {
  put_errors(*lists_->here, OfSquares{squares.numbers, squares.errors.numbers, codes}, out);
}

bool StoredErrors::get(std::span<const std::byte> bytes, Page& page, const CodeDistance& distance) const {
  return get_errors(*lists_->here, bytes, OfPage{page, distance});
}

bool StoredErrors::get(std::span<const std::byte> bytes, DenseSquares& squares, CodesOfEighths codes) const {
  return get_errors(*lists_->here, bytes, OfSquares{squares.numbers, squares.errors.numbers, codes});
}

}  // namespace talus
