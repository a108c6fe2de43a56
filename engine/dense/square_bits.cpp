#include "engine/dense/square_bits.hpp"

#include <cstring>

#include "engine/machine/cpu.hpp"

namespace talus {
namespace {

constexpr int kSide = detail::kDenseSide;

/// 128 bits of a row; column 0 is the lowest bit.
using Row = unsigned __int128;

class Rows {
 public:
  Rows() = default;
  explicit Rows(const SquareBits& bits) {
    for (std::size_t row = 0; row < kSide; ++row) rows_[row] = Row{bits[row][1]} << 64 | bits[row][0];
  }
  /// Rows outside the square have no bits.
  [[nodiscard]] Row operator[](int row) const {
    return row < 0 || row >= kSide ? Row{0} : rows_[static_cast<std::size_t>(row)];
  }
  Row& at(int row) { return rows_[static_cast<std::size_t>(row)]; }

  /// The samples around which one within one column and row is set.
  [[nodiscard]] Rows grown() const {
    Rows along, result;
    for (int row = 0; row < kSide; ++row) along.at(row) = (*this)[row] | (*this)[row] << 1 | (*this)[row] >> 1;
    for (int row = 0; row < kSide; ++row) result.at(row) = along[row - 1] | along[row] | along[row + 1];
    return result;
  }
  /// The samples around which all within one column and row are set.
  [[nodiscard]] Rows eroded() const {
    Rows along, result;
    for (int row = 0; row < kSide; ++row) along.at(row) = (*this)[row] & (*this)[row] << 1 & (*this)[row] >> 1;
    for (int row = 0; row < kSide; ++row) result.at(row) = along[row - 1] & along[row] & along[row + 1];
    return result;
  }

 private:
  std::array<Row, kSide> rows_{};
};

/// The columns first, first + step …
constexpr Row columns(int first, int step) {
  Row bits = 0;
  for (int col = first; col < kSide; col += step) bits |= Row{1} << col;
  return bits;
}

/// Finest side midpoints: they, both ends and one apex are data.
Row finest_sides(const Rows& data, int row) {
  const Row here = data[row], north = data[row - 1], south = data[row + 1], west = here << 1, east = here >> 1;
  if (row % 2 == 0) return here & west & east & (north | south) & columns(1, 2);
  return here & north & south & (west | east) & columns(0, 2);
}

TALUS_CLONES int count_of(const std::uint64_t (*rows)[2]) {
  int count = 0;
  for (int row = 0; row < kSide; ++row)
    count += __builtin_popcountll(rows[row][0]) + __builtin_popcountll(rows[row][1]);
  return count;
}

}  // namespace

std::size_t count(const SquareBits& bits) { return static_cast<std::size_t>(count_of(bits.data())); }

void insert_row(SquareBits& bits, int col, int row, std::span<const std::uint8_t> bytes) {
  std::size_t i = 0;
  if constexpr (std::endian::native == std::endian::little) {
    // Eight bytes at once: the product moves byte k's bit to bit 56 + k, and no two others to one place.
    auto& words = bits[static_cast<std::size_t>(row)];
    for (; i + 8 <= bytes.size(); i += 8) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, bytes.data() + i, 8);
      const std::uint64_t found = (eight * 0x0102040810204080) >> 56;
      const std::size_t at = static_cast<std::size_t>(col) + i;
      words[at / 64] |= found << at % 64;
      if (at % 64 > 56 && at < 64) words[1] |= found >> (64 - at);
    }
  }
  for (; i < bytes.size(); ++i) {
    if (bytes[i] != 0) insert(bits, col + static_cast<int>(i), row);
  }
}

SquareBits grown(const SquareBits& bits) {
  const Rows rows = Rows(bits).grown();
  SquareBits result;
  for (int row = 0; row < kSide; ++row) {
    result[static_cast<std::size_t>(row)][0] = static_cast<std::uint64_t>(rows[row]);
    result[static_cast<std::size_t>(row)][1] = static_cast<std::uint64_t>(rows[row] >> 64);
  }
  return result;
}

SquareBits implied_places(const SquareBits& data) {
  const Rows samples(data);
  SquareBits implied{};
  const auto add = [&](int row, Row bits) {
    implied[static_cast<std::size_t>(row)][0] |= static_cast<std::uint64_t>(bits);
    implied[static_cast<std::size_t>(row)][1] |= static_cast<std::uint64_t>(bits >> 64);
  };
  for (int row = 0; row < kSide; ++row) add(row, finest_sides(samples, row));
  Rows eroded = samples;
  const auto add_level = [&](int s, bool centres) {
    for (int row = 0; row < kSide; row += s) {
      const bool row_odd = (row & s) != 0;
      if (centres && !row_odd) continue;
      add(row, eroded[row] & columns(centres || !row_odd ? s : 0, 2 * s));
    }
  };
  for (int reach = 1; reach <= 10; ++reach) {
    eroded = eroded.eroded();
    if (reach == 1) add_level(1, true);
    if (reach == 2) add_level(2, false);
    if (reach == 4) add_level(2, true);
    if (reach == 6) add_level(4, false);
    if (reach == 10) add_level(4, true);
  }
  return implied;
}

}  // namespace talus
