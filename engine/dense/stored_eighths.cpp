#include "engine/dense/stored_eighths.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>

namespace talus {
namespace {

using detail::SortedSquare;

constexpr int kSide = detail::kDenseSide;
constexpr int kMostError = std::numeric_limits<std::int16_t>::max();
constexpr int kMostLowBits = 14;
constexpr std::byte kAllLeast{15};  ///< more than the most low bits: nothing follows

struct At {
  int col, row;
};

bool is_inside(At p) { return p.col >= 0 && p.row >= 0 && p.col < kSide && p.row < kSide; }

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

/// Bits, least significant first.
class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  void put(unsigned bits, int count) {
    for (int i = 0; i < count; ++i) {
      if (filled_ % 8 == 0) out_.push_back(std::byte{0});
      out_.back() |= static_cast<std::byte>((bits >> i & 1) << (filled_ % 8));
      ++filled_;
    }
  }

 private:
  std::vector<std::byte>& out_;
  std::size_t filled_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  /// At most 24 bits; beyond the end they are 0.
  unsigned get(int count) {
    const unsigned bits = window() & ((1u << count) - 1);
    at_ += static_cast<std::size_t>(count);
    return bits;
  }
  /// The number of zeros before the next one, which is read too; at most 24.
  unsigned zeros() {
    const unsigned bits = window() & 0xffffff;
    const int zeros = bits == 0 ? 24 : __builtin_ctz(bits);
    at_ += static_cast<std::size_t>(zeros) + (bits == 0 ? 0 : 1);
    return static_cast<unsigned>(zeros);
  }
  /// 0: more bits were read than there are, or the last byte has other bits set.
  [[nodiscard]] std::size_t end() const {
    const std::size_t bytes = (at_ + 7) / 8;
    if (bytes > bytes_.size()) return 0;
    if (at_ % 8 != 0 && std::to_integer<unsigned>(bytes_[bytes - 1]) >> (at_ % 8) != 0) return 0;
    return bytes;
  }

 private:
  [[nodiscard]] unsigned window() const {
    const std::size_t first = at_ / 8;
    const auto byte = [&](std::size_t i) { return std::to_integer<unsigned>(bytes_[first + i]) << (8 * i); };
    if (first + 4 <= bytes_.size()) [[likely]]
      return (byte(0) | byte(1) | byte(2) | byte(3)) >> (at_ % 8);
    unsigned word = 0;
    for (std::size_t i = 0; first + i < bytes_.size(); ++i) word |= byte(i);
    return word >> (at_ % 8);
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;  ///< in bits
};

/// Rice codes with an escape: 24 zeros, then 15 bits.
int bits_of(unsigned number, int low_bits) {
  const unsigned high = number >> low_bits;
  return high < 24 ? static_cast<int>(high) + 1 + low_bits : 24 + 15;
}

}  // namespace

StoredEighths::StoredEighths(const SquareBits& present, const SquareBits& data) {
  const SquareBits implied = implied_places(data);
  for (int level = 0; level < kLevels; ++level) {
    const int s = 1 << (level / 2);
    const bool centre = level % 2 != 0;
    for_each_bit(present, [&](int col, int row) {
      const int low = (col | row) & -(col | row);
      if (low != s || has(implied, col, row) || (((col & s) != 0 && (row & s) != 0) != centre)) return;
      Vertex v{};
      v.error = static_cast<std::int16_t>(SortedSquare::index_of(col, row));
      v.at = static_cast<std::int16_t>(row * kSide + col);
      v.level = static_cast<std::uint8_t>(level);
      const At step = to_end({col, row}, s, centre), a{col - step.col, row - step.row},
               b{col + step.col, row + step.row};
      const auto is_data = [&](At p) { return is_inside(p) && has(data, p.col, p.row); };
      // A side midpoint of spacing 1 is here because the page has no valid apex: perhaps no triangle with data.
      if (level > 0 && is_data({col, row}) && is_data(a) && is_data(b))
        v.to_end = static_cast<std::int16_t>(step.row * kSide + step.col);
      if (level > 0) {
        for (const At child : children_of({col, row}, s, centre)) {
          if (is_inside(child) && has(present, child.col, child.row))
            v.child[v.children++] = static_cast<std::int16_t>(SortedSquare::index_of(child.col, child.row));
        }
      }
      vertices_.push_back(v);
    });
  }
}

int StoredEighths::least(const Vertex& v, const std::int16_t* square, const std::int16_t* errors) {
  int least = 0;
  if (v.to_end != 0) {
    const int here = square[v.at];
    const auto rise = [&](int to) { return int{static_cast<std::int16_t>(square[v.at + to] - here)}; };
    least = std::min(kMostError, std::abs(4 * (rise(v.to_end) + rise(-v.to_end))));
  }
  for (int i = 0; i < v.children; ++i) least = std::max(least, int{errors[v.child[i]]});
  return least;
}

bool StoredEighths::put(std::span<const std::int16_t> square, SortedSquare& errors, std::vector<std::byte>& out) const {
  if (vertices_.empty()) {
    out.push_back(std::byte{0});
    return true;
  }
  std::vector<unsigned> above;
  above.reserve(vertices_.size());
  bool all_possible = true;
  for (const Vertex& v : vertices_) {
    const int from = least(v, square.data(), errors.numbers);
    std::int16_t& error = errors.numbers[v.error];
    all_possible = all_possible && error >= from;
    error = static_cast<std::int16_t>(std::max(from, int{error}));
    above.push_back(static_cast<unsigned>(error - from));
  }
  if (std::all_of(above.begin(), above.end(), [](unsigned number) { return number == 0; })) {
    out.push_back(kAllLeast);
    return all_possible;
  }
  std::array<int, kLevels> low_bits{};
  for (std::size_t level = 0; level < kLevels; ++level) {
    std::int64_t least_bits = std::numeric_limits<std::int64_t>::max();
    for (int k = 0; k <= kMostLowBits; ++k) {
      std::int64_t bits = 0;
      for (std::size_t i = 0; i < above.size(); ++i) {
        if (vertices_[i].level == level && above[i] > 0) bits += bits_of(above[i] - 1, k);
      }
      if (bits < least_bits) least_bits = bits, low_bits[level] = k;
    }
  }
  Writer writer(out);
  for (const int k : low_bits) writer.put(static_cast<unsigned>(k), 4);
  for (const unsigned number : above) writer.put(number > 0 ? 1 : 0, 1);
  for (std::size_t i = 0; i < above.size(); ++i) {
    if (above[i] == 0) continue;
    const unsigned number = above[i] - 1;
    const int k = low_bits[vertices_[i].level];
    if (number >> k < 24) {
      writer.put(0, static_cast<int>(number >> k));
      writer.put(1, 1);
      writer.put(number, k);
    } else {
      writer.put(0, 24);
      writer.put(number, 15);
    }
  }
  return all_possible;
}

std::size_t StoredEighths::get(std::span<const std::byte> bytes, std::span<const std::int16_t> square,
                               SortedSquare& errors) const {
  if (bytes.empty()) return 0;
  if (vertices_.empty()) return bytes[0] == std::byte{0} ? 1 : 0;
  if (bytes[0] == kAllLeast) {
    for (const Vertex& v : vertices_)
      errors.numbers[v.error] = static_cast<std::int16_t>(least(v, square.data(), errors.numbers));
    return 1;
  }
  Reader numbers(bytes);
  std::array<int, kLevels> low_bits{};
  for (int& k : low_bits) {
    k = static_cast<int>(numbers.get(4));
    if (k > kMostLowBits) return 0;
  }
  Reader flags = numbers;
  for (std::size_t i = 0; i < vertices_.size(); i += 24)
    static_cast<void>(numbers.get(static_cast<int>(std::min<std::size_t>(24, vertices_.size() - i))));
  unsigned flagged = 0;
  for (std::size_t i = 0; i < vertices_.size(); ++i, flagged >>= 1) {
    if (i % 24 == 0) flagged = flags.get(static_cast<int>(std::min<std::size_t>(24, vertices_.size() - i)));
    const Vertex& v = vertices_[i];
    int error = least(v, square.data(), errors.numbers);
    if ((flagged & 1) != 0) {
      const unsigned high = numbers.zeros();
      const int k = low_bits[v.level];
      const unsigned number = high < 24 ? high << k | numbers.get(k) : numbers.get(15);
      error += static_cast<int>(number) + 1;
      if (error > kMostError) return 0;
    }
    errors.numbers[v.error] = static_cast<std::int16_t>(error);
  }
  return numbers.end();
}

}  // namespace talus
