#include "engine/stream/symbol_coder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace talus {
namespace {

constexpr std::uint32_t kAll = 1u << kChanceBits;
constexpr std::uint32_t kLowest = 1u << 16;  ///< smallest state between symbols

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  return at + 2 <= bytes.size()
             ? std::to_integer<std::uint32_t>(bytes[at]) | std::to_integer<std::uint32_t>(bytes[at + 1]) << 8
             : 0;
}

}  // namespace

void BitWriter::put_gamma(std::uint32_t v) {
  const int high = static_cast<int>(std::bit_width(v)) - 1;
  put(0, high);
  for (int i = high; i >= 0; --i) put(v >> i & 1u, 1);
}

std::uint32_t BitReader::take_gamma() {
  int high = 0;
  while (high < 32 && take(1) == 0) ++high;
  if (high == 32) return 0;  // writers do not make such bits
  std::uint32_t v = 1;
  for (int i = 0; i < high; ++i) v = v << 1 | static_cast<std::uint32_t>(take(1));
  return v;
}

bool BitReader::is_intact() const {
  if (at_ > 8 * std::uint64_t{bytes_.size()} || 8 * std::uint64_t{bytes_.size()} - at_ >= 8) return false;
  return at_ % 8 == 0 || std::to_integer<unsigned>(bytes_.back()) >> (at_ % 8) == 0;
}

SymbolTables SymbolTables::of(std::span<const Counts> counts) {
  SymbolTables tables;
  tables.chances_.resize(counts.size());
  for (std::size_t c = 0; c < counts.size(); ++c) {
    std::uint64_t sum = 0;
    for (const std::uint32_t n : counts[c]) sum += n;
    if (sum == 0) continue;
    // Each symbol that occurs has a chance. The likeliest symbols make up for rounding.
    auto& chances = tables.chances_[c];
    std::uint32_t given = 0;
    for (std::size_t s = 0; s < kMostSymbols; ++s) {
      if (counts[c][s] == 0) continue;
      chances[s].size =
          static_cast<std::uint16_t>(std::max<std::uint64_t>(1, (counts[c][s] * std::uint64_t{kAll} + sum / 2) / sum));
      given += chances[s].size;
    }
    const auto likeliest = [&] {
      return std::max_element(chances.begin(), chances.end(),
                              [](const Chance& a, const Chance& b) { return a.size < b.size; });
    };
    for (; given < kAll; given = kAll)
      likeliest()->size = static_cast<std::uint16_t>(likeliest()->size + (kAll - given));
    for (; given > kAll; --given) --likeliest()->size;
  }
  tables.place();
  return tables;
}

void SymbolTables::place() {
  places_.assign(chances_.size() * kAll, kAll - 1);
  for (std::size_t c = 0; c < chances_.size(); ++c) {
    std::uint32_t first = 0;
    for (std::size_t s = 0; s < kMostSymbols; ++s) {
      Chance& chance = chances_[c][s];
      chance.first = static_cast<std::uint16_t>(first);
      for (std::uint32_t i = 0; i < chance.size; ++i) {
        places_[c * kAll + first + i] = static_cast<std::uint32_t>(s) << 20 | (chance.size - 1u) << 10 | i;
      }
      first += chance.size;
    }
    // A context without symbols reads as symbol 0, which is an absent vertex.
    for (std::uint32_t i = first; i < kAll; ++i) places_[c * kAll + i] = (kAll - 1) << 10 | i;
  }
}

double SymbolTables::cost(std::span<const Counts> counts) const {
  double bits = 0;
  for (std::size_t c = 0; c < counts.size(); ++c) {
    for (std::size_t s = 0; s < kMostSymbols; ++s) {
      if (counts[c][s] == 0) continue;
      if (chances_.size() != counts.size() || chances_[c][s].size == 0) return std::numeric_limits<double>::infinity();
      bits += counts[c][s] * (kChanceBits - std::log2(chances_[c][s].size));
    }
  }
  return bits;
}

void SymbolTables::write(BitWriter& out) const {
  for (const auto& chances : chances_) {
    std::size_t used = kMostSymbols;
    while (used > 0 && chances[used - 1].size == 0) --used;
    out.put_gamma(static_cast<std::uint32_t>(used) + 1);
    for (std::size_t s = 0; s + 1 < used; ++s) out.put_gamma(chances[s].size + 1u);
  }
}

bool SymbolTables::read(BitReader& in, std::size_t contexts) {
  chances_.assign(contexts, {});
  for (auto& chances : chances_) {
    const std::uint32_t used = in.take_gamma() - 1;
    if (used > kMostSymbols) return false;
    std::uint32_t left = kAll;
    for (std::size_t s = 0; s < used; ++s) {
      const std::uint32_t size = s + 1 < used ? in.take_gamma() - 1 : left;
      if (size > left || (s + 1 == used && size == 0)) return false;
      chances[s].size = static_cast<std::uint16_t>(size);
      left -= size;
    }
  }
  place();
  return true;
}

std::vector<std::byte> encode_symbols(const SymbolTables& tables, std::span<const SymbolRow> rows) {
  std::size_t count = 0;
  for (const SymbolRow& row : rows) count += row.symbols.size();
  std::vector<std::uint16_t> words;  // in reverse order of reading
  words.reserve(count / 2 + 8);
  std::array<std::uint32_t, 4> states;
  states.fill(kLowest);
  for (std::size_t r = rows.size(); r-- > 0;) {
    const SymbolRow& row = rows[r];
    for (std::size_t i = row.symbols.size(); i-- > 0;) {
      const SymbolTables::Chance chance = tables.chance(row.contexts[i], row.symbols[i]);
      std::uint32_t& x = states[i % 4];
      if (std::uint64_t{x} >= std::uint64_t{chance.size} << (32 - kChanceBits)) {
        words.push_back(static_cast<std::uint16_t>(x & 0xffff));
        x >>= 16;
      }
      x = (x / chance.size) << kChanceBits | (x % chance.size + chance.first);
    }
  }
  std::vector<std::byte> bytes;
  bytes.reserve(16 + 2 * words.size());
  for (const std::uint32_t x : states) {
    for (int i = 0; i < 32; i += 8) bytes.push_back(static_cast<std::byte>(x >> i & 0xff));
  }
  for (std::size_t i = words.size(); i-- > 0;) {
    bytes.push_back(static_cast<std::byte>(words[i] & 0xff));
    bytes.push_back(static_cast<std::byte>(words[i] >> 8));
  }
  return bytes;
}

SymbolReader::SymbolReader(const SymbolTables& tables, std::span<const std::byte> bytes)
    : places_(tables.places()), bytes_(bytes) {
  for (std::uint32_t& x : states_) {
    x = word_at(bytes_, at_) | word_at(bytes_, at_ + 2) << 16;
    at_ += 4;
  }
}

void SymbolReader::take(const std::uint8_t* contexts, std::uint8_t* symbols, std::size_t count) {
  std::array<std::uint32_t, 4> states = states_;
  std::size_t at = at_, i = 0;
  const auto one = [&](std::uint32_t & x, std::size_t k) __attribute__((always_inline)) {
    const std::uint32_t place = places_[std::size_t{contexts[k]} << kChanceBits | (x & (kAll - 1))];
    symbols[k] = static_cast<std::uint8_t>(place >> 20);
    return ((place >> 10 & (kAll - 1)) + 1) * (x >> kChanceBits) + (place & (kAll - 1));
  };
  // While eight bytes are left, four reads need no check.
  for (; i + 4 <= count && at + 8 <= bytes_.size(); i += 4) {
    for (std::size_t s = 0; s < 4; ++s) {
      std::uint32_t x = one(states[s], i + s);
      std::uint16_t word = 0;
      std::memcpy(&word, bytes_.data() + at, 2);
      if constexpr (std::endian::native == std::endian::big) word = static_cast<std::uint16_t>(word << 8 | word >> 8);
      const bool low = x < kLowest;
      x = low ? x << 16 | word : x;
      at += low ? 2 : 0;
      states[s] = x;
    }
  }
  for (; i < count; ++i) {
    std::uint32_t x = one(states[i % 4], i);
    if (x < kLowest) {
      x = x << 16 | word_at(bytes_, at);
      at += 2;
    }
    states[i % 4] = x;
  }
  states_ = states;
  at_ = at;
}

bool SymbolReader::is_intact() const {
  return at_ == bytes_.size() &&
         std::all_of(states_.begin(), states_.end(), [](std::uint32_t x) { return x == kLowest; });
}

}  // namespace talus
