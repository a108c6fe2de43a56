#pragma once
// Codes symbols of a small alphabet as bits: static range asymmetric numeral systems with four states in turn. Each
// context has a distribution, which is measured and stored with the symbols. docs/format/rqt-v1.md, section 7.
//
// source  asymmetric numeral systems, J. Duda, arXiv:1311.2540; four interleaved states: F. Giesen, arXiv:1402.3392

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace talus {

inline constexpr int kMostSymbols = 156;
inline constexpr int kChanceBits = 10;  ///< chances are multiples of 2^-10

/// Writes bits in order, the first in the lowest bit of a byte.
class BitWriter {
 public:
  void put(std::uint64_t bits, int count) {  // count <= 64, higher bits zero
    if (count > 32) put(bits & 0xffffffffu, 32), bits >>= 32, count -= 32;
    held_ |= bits << held_count_;
    held_count_ += count;
    while (held_count_ >= 8) {
      bytes.push_back(static_cast<std::byte>(held_ & 0xff));
      held_ >>= 8;
      held_count_ -= 8;
    }
  }
  /// Writes v >= 1 as Elias gamma: a zero for each bit after the highest, then its bits, the highest first.
  void put_gamma(std::uint32_t v);
  void finish() {
    if (held_count_ > 0) bytes.push_back(static_cast<std::byte>(held_ & 0xff));
    held_ = 0, held_count_ = 0;
  }
  std::vector<std::byte> bytes;

 private:
  std::uint64_t held_ = 0;
  int held_count_ = 0;
};

/// Reads bits. Any bytes are safe: no call reads out of bounds, and is_intact() says at the end whether all was sound.
class BitReader {
 public:
  BitReader() = default;
  explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard, gnu::always_inline]] std::uint64_t take(int count) {  // count <= 56
    const std::uint64_t bits = window() & ((std::uint64_t{1} << count) - 1);
    at_ += static_cast<unsigned>(count);
    return bits;
  }
  [[nodiscard]] std::uint64_t take_long(int count) {  // count <= 64
    if (count <= 32) return take(count);
    const std::uint64_t low = take(32);
    return low | take(count - 32) << 32;
  }
  /// Reads an Elias gamma number; 0 for bits that put_gamma does not write.
  [[nodiscard]] std::uint32_t take_gamma();
  /// Whether exactly all bytes were used, and the last unused bits are 0.
  [[nodiscard]] bool is_intact() const;

 private:
  /// The next 57 bits or more.
  [[nodiscard, gnu::always_inline]] std::uint64_t window() const {
    const std::uint64_t byte = at_ / 8;
    if (byte + 8 <= bytes_.size()) [[likely]] {
      std::uint64_t word = 0;
      __builtin_memcpy(&word, bytes_.data() + byte, 8);
      if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
      return word >> (at_ % 8);
    }
    std::uint64_t word = 0;
    for (std::uint64_t i = byte; i < bytes_.size() && i < byte + 8; ++i)
      word |= std::to_integer<std::uint64_t>(bytes_[static_cast<std::size_t>(i)]) << (8 * (i - byte));
    return word >> (at_ % 8);
  }
  std::span<const std::byte> bytes_;
  std::uint64_t at_ = 0;  // in bits
};

/// The distributions of symbols, one for each context.
class SymbolTables {
 public:
  using Counts = std::array<std::uint32_t, kMostSymbols>;

  /// counts  how often each symbol occurs in each context
  [[nodiscard]] static SymbolTables of(std::span<const Counts> counts);
  /// The bits for symbols with these counts; infinity if one of them has no chance.
  [[nodiscard]] double cost(std::span<const Counts> counts) const;
  void write(BitWriter& out) const;
  /// returns  false if a distribution is damaged
  [[nodiscard]] bool read(BitReader& in, std::size_t contexts);
  [[nodiscard]] std::size_t contexts() const { return chances_.size(); }

  struct Chance {
    std::uint16_t size = 0, first = 0;  ///< in units of 2^-kChanceBits
  };
  [[nodiscard]] const Chance& chance(std::size_t context, std::size_t symbol) const {
    return chances_[context][symbol];
  }
  /// For reading, by context and place: the symbol (8 bits), its size − 1 (10 bits), the place − its first (10 bits).
  [[nodiscard]] const std::uint32_t* places() const { return places_.data(); }

 private:
  void place();
  std::vector<std::array<Chance, kMostSymbols>> chances_;
  std::vector<std::uint32_t> places_;
};

/// The symbols of a row and their contexts. The first symbol of each row belongs to the first state.
struct SymbolRow {
  std::span<const std::uint8_t> contexts, symbols;
};
[[nodiscard]] std::vector<std::byte> encode_symbols(const SymbolTables& tables, std::span<const SymbolRow> rows);

/// Decodes these symbols, row by row. Any bytes are safe: every call returns some symbols.
class SymbolReader {
 public:
  SymbolReader() = default;
  /// Tables and bytes must stay as long as it reads.
  SymbolReader(const SymbolTables& tables, std::span<const std::byte> bytes);
  void take(const std::uint8_t* contexts, std::uint8_t* symbols, std::size_t count);
  [[nodiscard]] bool is_intact() const;

 private:
  const std::uint32_t* places_ = nullptr;
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::array<std::uint32_t, 4> states_{};
};

}  // namespace talus
