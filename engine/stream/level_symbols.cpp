#include "engine/stream/level_symbols.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include <fmt/format.h>

#include "engine/stream/mixing_coder.hpp"
#include "engine/stream/stream_bytes.hpp"
#include "engine/stream/symbol_coder.hpp"
#include "talus/failure.hpp"

namespace talus {

// ---- balanced: symbols ----------------------------------------------------------------------------------
// Symbol 0 is absent. Others tell the sign and the size of the residual: with v the residual, or its complement where
// it is negative, b = v >> shift is told up to 12 by the symbol alone; above, the symbol tells the highest bit of b -
// 12. The bits below follow as they are.

namespace {

constexpr int kPlainSizes = 13;
constexpr std::size_t kFirstLong = 1 + 2 * kPlainSizes;

struct Token {
  std::uint8_t symbol;
  std::uint8_t bits;
  std::uint64_t rest;
};

template <class Code>
Token token_of(Code residual, int shift) {
  const bool negative = residual < 0;
  const auto v = static_cast<std::uint64_t>(negative ? ~residual : residual);
  const std::uint64_t b = v >> shift, low = v & ((std::uint64_t{1} << shift) - 1);
  if (b < kPlainSizes)
    return {static_cast<std::uint8_t>(1 + 2 * b + (negative ? 1 : 0)), static_cast<std::uint8_t>(shift), low};
  const std::uint64_t e = b - (kPlainSizes - 1);
  const int high = static_cast<int>(std::bit_width(e)) - 1;
  return {static_cast<std::uint8_t>(kFirstLong + 2 * static_cast<std::size_t>(high) + (negative ? 1 : 0)),
          static_cast<std::uint8_t>(high + shift), (e - (std::uint64_t{1} << high)) << shift | low};
}

/// What a symbol stands for, given the shift.
template <class Code>
struct Meanings {
  std::array<Code, 256> base{}, flip{};
  std::array<std::uint8_t, 256> bits{};
  explicit Meanings(int shift) {
    for (std::size_t s = 1; s < kMostSymbols; ++s) {
      const std::size_t pair = (s - 1) / 2;
      flip[s] = static_cast<Code>(s % 2 == 0 ? -1 : 0);
      std::uint64_t first = pair;
      int more = shift;
      if (s >= kFirstLong) {
        const auto high = std::min(static_cast<int>(pair) - kPlainSizes, 63);  // the last symbols no writer makes
        first = (kPlainSizes - 1) + (std::uint64_t{1} << high);
        more += high;
      }
      base[s] = static_cast<Code>(first << shift);
      // no writer makes such
      bits[s] = static_cast<std::uint8_t>(more < static_cast<int>(8 * sizeof(Code)) ? more : 0);
    }
  }
};

/// Contexts, fewer where a level is small.
enum class Resolution : std::uint8_t { same_tables = 0, kinds = 1, all = 2 };
constexpr std::size_t kKinds = 4;  // centres, sides, and the loose ones of either
constexpr std::size_t contexts_of(Resolution r) { return r == Resolution::kinds ? kKinds : kCandidateContexts; }
std::uint8_t context_at(Resolution r, std::uint8_t context) {
  if (r == Resolution::all) return context;
  return context >= kStrictContexts ? static_cast<std::uint8_t>(2 + context - kStrictContexts)
                                    : static_cast<std::uint8_t>(context / (kEnergies * kDistances));
}

[[noreturn]] void refuse(const std::string& what) { throw Failure(Cause::corrupt, "corrupt: " + what); }

}  // namespace

struct SymbolState {
  SymbolTables tables;
  Resolution resolution = Resolution::same_tables;  ///< of the tables; same_tables: there are none
  std::vector<MixedModelPointer> mixed;             ///< by stripe
  MixedModel& mixed_model(std::size_t stripe) {
    while (mixed.size() <= stripe) mixed.push_back(make_mixed_model());
    return *mixed[stripe];
  }
};

template <class Code>
void StripeRecord<Code>::take(const CandidateRow<Code>& row, bool with_surroundings) {
  lattice = row.lattice;
  rows.push_back({row.row, row.count});
  contexts.insert(contexts.end(), row.contexts, row.contexts + row.count);
  if (with_surroundings) {
    columns.insert(columns.end(), row.columns, row.columns + row.count);
    energies.insert(energies.end(), row.energies, row.energies + row.count);
    distances.insert(distances.end(), row.distances, row.distances + row.count);
  }
  present.insert(present.end(), row.present, row.present + row.count);
  residuals.insert(residuals.end(), row.residuals, row.residuals + row.count);
}

namespace {

template <class Code>
using Halves = std::array<std::vector<StripeRecord<Code>>, 2>;
using Bytes = std::vector<std::byte>;

/// So that most residuals are told by a symbol alone, and the bits below are about even.
template <class Code>
int shift_of(const Halves<Code>& halves) {
  double sum = 0, count = 0;
  for (const auto& stripes : halves) {
    for (const auto& stripe : stripes) {
      std::uint64_t there = 0, sizes = 0;  // absent ones have residual 0
      for (const std::uint8_t p : stripe.present) there += p;
      for (const Code r : stripe.residuals)
        sizes += std::min<std::uint64_t>(static_cast<std::uint64_t>(r < 0 ? ~r : r), 1u << 30);
      count += static_cast<double>(there);
      sum += static_cast<double>(sizes);
    }
  }
  int shift = 0;
  while (sum > 8 * count && shift < static_cast<int>(8 * sizeof(Code)) - 8) sum /= 2, ++shift;
  return shift;
}

void append(Bytes& to, const Bytes& from) { to.insert(to.end(), from.begin(), from.end()); }

/// Lengths of all pieces, then the pieces.
Bytes packed(const std::vector<Bytes>& pieces) {
  Bytes out;
  for (const Bytes& piece : pieces) put_variable(out, piece.size());
  for (const Bytes& piece : pieces) append(out, piece);
  return out;
}
std::vector<std::span<const std::byte>> unpacked(std::span<const std::byte> bytes, std::size_t count) {
  VariableReader in(bytes);
  std::vector<std::size_t> sizes;
  if (count > bytes.size()) refuse("more stripes than bytes");
  for (std::size_t i = 0; i < count; ++i) sizes.push_back(in.size());
  std::vector<std::span<const std::byte>> pieces;
  for (const std::size_t size : sizes) pieces.push_back(in.take(size));
  if (in.left() > 0) refuse("bytes left over in a level");
  return pieces;
}

template <class Code>
Bytes encode_balanced(const Halves<Code>& halves, SymbolState& state) {
  const int shift = shift_of(halves);
  struct Tokens {
    std::vector<std::uint8_t> symbols;
    Bytes raw;
  };
  std::vector<Tokens> tokens;
  std::vector<SymbolTables::Counts> counts(kCandidateContexts, SymbolTables::Counts{}),
      merged(kKinds, SymbolTables::Counts{});
  for (const auto& stripes : halves) {
    for (const auto& stripe : stripes) {
      Tokens made;
      made.symbols.resize(stripe.present.size());
      BitWriter raw;
      for (std::size_t i = 0; i < stripe.present.size(); ++i) {
        if (stripe.present[i] != 0) {
          const Token token = token_of(stripe.residuals[i], shift);
          made.symbols[i] = token.symbol;
          if (token.bits > 0) raw.put(token.rest, token.bits);
        }
        ++counts[stripe.contexts[i]][made.symbols[i]];
      }
      raw.finish();
      made.raw = std::move(raw.bytes);
      tokens.push_back(std::move(made));
    }
  }
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const std::size_t to = context_at(Resolution::kinds, static_cast<std::uint8_t>(c));
    for (std::size_t s = 0; s < kMostSymbols; ++s) merged[to][s] += counts[c][s];
  }
  // The cheapest of new tables and the last ones.
  struct Choice {
    Resolution resolution;
    SymbolTables tables;
    Bytes written;
    double bits;
  };
  std::vector<Choice> choices;
  for (const Resolution r : {Resolution::kinds, Resolution::all}) {
    const auto& counted = r == Resolution::kinds ? merged : counts;
    Choice choice{r, SymbolTables::of(counted), {}, 0};
    BitWriter out;
    choice.tables.write(out);
    out.finish();
    choice.written = std::move(out.bytes);
    choice.bits = choice.tables.cost(counted) + 8.0 * static_cast<double>(choice.written.size());
    choices.push_back(std::move(choice));
  }
  Choice& best = choices[0].bits <= choices[1].bits ? choices[0] : choices[1];
  const bool reuses = state.resolution != Resolution::same_tables &&
                      state.tables.cost(state.resolution == Resolution::kinds ? merged : counts) <= best.bits;
  if (!reuses) {
    state.tables = std::move(best.tables);
    state.resolution = best.resolution;
  }
  Bytes out;
  out.push_back(static_cast<std::byte>(shift));
  out.push_back(static_cast<std::byte>(reuses ? Resolution::same_tables : state.resolution));
  if (!reuses) {
    put_variable(out, best.written.size());
    append(out, best.written);
  }
  std::vector<Bytes> pieces;
  std::size_t next = 0;
  for (const auto& stripes : halves) {
    for (const auto& stripe : stripes) {
      const Tokens& made = tokens[next++];
      std::vector<std::uint8_t> kinds;
      if (state.resolution == Resolution::kinds) {
        for (const std::uint8_t c : stripe.contexts) kinds.push_back(context_at(state.resolution, c));
      }
      const std::vector<std::uint8_t>& contexts = state.resolution == Resolution::kinds ? kinds : stripe.contexts;
      std::vector<SymbolRow> rows;
      std::size_t at = 0;
      for (const auto& row : stripe.rows) {
        rows.push_back({std::span(contexts).subspan(at, row.count), std::span(made.symbols).subspan(at, row.count)});
        at += row.count;
      }
      pieces.push_back(encode_symbols(state.tables, rows));
      pieces.push_back(made.raw);
    }
  }
  append(out, packed(pieces));
  return out;
}

// ---- fast: a bit a candidate, and residuals in groups of 32 with a width -----------------------------------

constexpr std::size_t kGroup = 32;

template <class Code>
Bytes encode_fast(const Halves<Code>& halves) {
  std::vector<Bytes> pieces;
  for (const auto& stripes : halves) {
    for (const auto& stripe : stripes) {
      BitWriter present, packed_values;
      Bytes widths;
      std::vector<std::uint64_t> values;
      for (std::size_t i = 0; i < stripe.present.size(); ++i) {
        present.put(stripe.present[i], 1);
        const Code r = stripe.residuals[i];
        if (stripe.present[i] != 0) {
          values.push_back(static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<Code>>(r < 0 ? ~r : r)) << 1 |
                           (r < 0 ? 1u : 0u));
        }
      }
      values.resize((values.size() + kGroup - 1) / kGroup * kGroup);
      for (std::size_t g = 0; g < values.size(); g += kGroup) {
        std::uint64_t all = 0;
        for (std::size_t i = 0; i < kGroup; ++i) all |= values[g + i];
        const auto width = static_cast<int>(std::bit_width(all));
        widths.push_back(static_cast<std::byte>(width));
        for (std::size_t i = 0; i < kGroup; ++i) packed_values.put(values[g + i], width);
      }
      present.finish();
      packed_values.finish();
      pieces.push_back(std::move(present.bytes));
      pieces.push_back(std::move(widths));
      pieces.push_back(std::move(packed_values.bytes));
    }
  }
  return packed(pieces);
}

/// All groups at once: each takes a whole number of bytes.
template <class Code>
std::vector<Code> values_of(std::span<const std::byte> widths, std::span<const std::byte> bits) {
  std::size_t needed = 0;
  for (const std::byte w : widths) {
    if (std::to_integer<std::size_t>(w) > 8 * sizeof(Code)) refuse("residuals wider than heights");
    needed += kGroup / 8 * std::to_integer<std::size_t>(w);
  }
  if (needed != bits.size()) refuse("groups of residuals that do not fit their widths");
  std::vector<Code> values(kGroup * widths.size());
  std::size_t at = 0;
  Code* to = values.data();
  for (const std::byte w : widths) {
    const auto width = std::to_integer<std::size_t>(w);
    if (width <= 32 && at + 8 * width / 2 + 8 <= bits.size()) {
      const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
      for (std::size_t i = 0; i < kGroup; ++i) {
        std::uint64_t word = 0;
        std::memcpy(&word, bits.data() + at + i * width / 8, 8);
        if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
        const auto v = static_cast<std::make_unsigned_t<Code>>(word >> (i * width % 8) & mask);
        to[i] = static_cast<Code>((v >> 1) ^ (~(v & 1) + 1));
      }
    } else {
      BitReader in(bits.subspan(at));
      for (std::size_t i = 0; i < kGroup; ++i) {
        const auto v = static_cast<std::make_unsigned_t<Code>>(in.take_long(static_cast<int>(width)));
        to[i] = static_cast<Code>((v >> 1) ^ (~(v & 1) + 1));
      }
    }
    at += kGroup / 8 * width;
    to += kGroup;
  }
  return values;
}

}  // namespace

// ---- writing --------------------------------------------------------------------------------------------

template <class Code>
LevelEncoder<Code>::LevelEncoder(StreamProfile profile) : profile_(profile), state_(std::make_unique<SymbolState>()) {}
template <class Code>
LevelEncoder<Code>::~LevelEncoder() = default;

template <class Code>
std::vector<std::byte> LevelEncoder<Code>::encode(const Halves<Code>& halves) {
  bool is_empty = true;
  for (const auto& stripes : halves) {
    for (const auto& stripe : stripes)
      is_empty =
          is_empty && std::all_of(stripe.present.begin(), stripe.present.end(), [](std::uint8_t p) { return p == 0; });
  }
  if (is_empty) return {};
  Bytes out;
  put_variable(out, halves[0].size());
  if (profile_ == StreamProfile::fast) {
    append(out, encode_fast(halves));
  } else if (profile_ == StreamProfile::balanced) {
    append(out, encode_balanced(halves, *state_));
  } else {
    std::vector<Bytes> pieces;
    const int shift = shift_of(halves);
    for (std::size_t half = 0; half < 2; ++half) {
      for (std::size_t b = 0; b < halves[half].size(); ++b)
        pieces.push_back(encode_mixed(state_->mixed_model(b), halves[half][b], half, shift));
    }
    out.push_back(static_cast<std::byte>(shift));
    append(out, packed(pieces));
  }
  return out;
}

// ---- reading --------------------------------------------------------------------------------------------

template <class Code>
struct LevelDecoder<Code>::Stripe {
  // balanced
  SymbolReader symbols;
  BitReader raw;
  std::shared_ptr<const Meanings<Code>> meanings;
  Resolution resolution = Resolution::all;
  std::vector<std::uint8_t> room, contexts;
  // fast
  std::span<const std::byte> present;
  std::size_t at = 0;  ///< of present, in bits
  std::vector<Code> values;
  std::size_t next = 0;  ///< of values
  // small
  std::unique_ptr<MixedReader<Code>> mixed;
};

template <class Code>
LevelDecoder<Code>::LevelDecoder(StreamProfile profile) : profile_(profile), state_(std::make_unique<SymbolState>()) {}
template <class Code>
LevelDecoder<Code>::~LevelDecoder() = default;

template <class Code>
std::size_t LevelDecoder<Code>::start(std::span<const std::byte> bytes) {
  stripes_[0].clear(), stripes_[1].clear();
  if (bytes.empty()) return 1;  // all are absent
  VariableReader in(bytes);
  const std::size_t count = in.size();
  if (count < 1 || count > bytes.size()) refuse("an impossible number of stripes");
  std::shared_ptr<const Meanings<Code>> meanings;
  int shift = 0;
  if (profile_ != StreamProfile::fast) {
    shift = std::to_integer<int>(in.take(1)[0]);
    if (shift >= static_cast<int>(8 * sizeof(Code))) refuse("an impossible shift of residuals");
  }
  if (profile_ == StreamProfile::balanced) {
    const auto resolution = std::to_integer<unsigned>(in.take(1)[0]);
    if (resolution > 2 || (resolution == 0 && state_->resolution == Resolution::same_tables))
      refuse("no tables of symbols");
    if (resolution != 0) {
      state_->resolution = static_cast<Resolution>(resolution);
      const std::size_t size = in.size();
      BitReader table(in.take(size));
      if (!state_->tables.read(table, contexts_of(state_->resolution)) || !table.is_intact())
        refuse("damaged tables of symbols");
    }
    meanings = std::make_shared<const Meanings<Code>>(shift);
  }
  const std::size_t per_stripe = profile_ == StreamProfile::fast ? 3 : profile_ == StreamProfile::balanced ? 2 : 1;
  const auto pieces = unpacked(in.take(in.left()), 2 * count * per_stripe);
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t b = 0; b < count; ++b) {
      const auto* piece = &pieces[(half * count + b) * per_stripe];
      auto stripe = std::make_unique<Stripe>();
      if (profile_ == StreamProfile::fast) {
        stripe->present = piece[0];
        stripe->values = values_of<Code>(piece[1], piece[2]);
      } else if (profile_ == StreamProfile::balanced) {
        stripe->symbols = SymbolReader(state_->tables, piece[0]);
        stripe->raw = BitReader(piece[1]);
        stripe->meanings = meanings;
        stripe->resolution = state_->resolution;
      } else {
        stripe->mixed = std::make_unique<MixedReader<Code>>(state_->mixed_model(b), piece[0], half, shift);
      }
      stripes_[half].push_back(std::move(stripe));
    }
  }
  return count;
}

template <class Code>
void LevelDecoder<Code>::take(std::size_t half, std::size_t b, CandidateRow<Code>& row) {
  const std::size_t n = row.count;
  if (stripes_[half].empty()) {
    std::fill_n(row.present, n, std::uint8_t{0});
    std::fill_n(row.residuals, n, Code{0});
    return;
  }
  Stripe& stripe = *stripes_[half][b];
  if (profile_ == StreamProfile::balanced) {
    if (stripe.room.size() < n) stripe.room.resize(n), stripe.contexts.resize(n);
    const std::uint8_t* contexts = row.contexts;
    if (stripe.resolution == Resolution::kinds) {
      for (std::size_t i = 0; i < n; ++i) stripe.contexts[i] = context_at(Resolution::kinds, row.contexts[i]);
      contexts = stripe.contexts.data();
    }
    std::uint8_t* symbols = stripe.room.data();
    stripe.symbols.take(contexts, symbols, n);
    const Meanings<Code>& m = *stripe.meanings;
    BitReader raw = stripe.raw;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t s = symbols[i];
      const std::uint64_t rest = sizeof(Code) <= 4 ? raw.take(m.bits[s]) : raw.take_long(m.bits[s]);
      const auto v = static_cast<Code>(static_cast<std::uint64_t>(m.base[s]) + rest);
      row.present[i] = s != 0 ? 1 : 0;
      row.residuals[i] = static_cast<Code>(v ^ m.flip[s]);
    }
    stripe.raw = raw;
  } else if (profile_ == StreamProfile::fast) {
    if (stripe.at + n > 8 * stripe.present.size() ||
        stripe.next + n > stripe.values.size() + kGroup + n)  // values are looked at below
      refuse("fewer bits than candidates");
    // At most as many values as candidates: room for them, so that no look is needed at each.
    if (stripe.values.size() < stripe.next + n) stripe.values.resize(stripe.next + n);
    const Code* values = stripe.values.data();
    std::size_t next = stripe.next, at = stripe.at;
    for (std::size_t i = 0; i < n; ++i, ++at) {
      const auto p = static_cast<std::uint8_t>(std::to_integer<unsigned>(stripe.present[at / 8]) >> (at % 8) & 1u);
      row.present[i] = p;
      row.residuals[i] = values[next];
      next += p;
    }
    stripe.at = at, stripe.next = next;
  } else {
    stripe.mixed->take(row);
  }
}

template <class Code>
bool LevelDecoder<Code>::is_intact() const {
  for (const auto& stripes : stripes_) {
    for (const auto& stripe : stripes) {
      if (profile_ == StreamProfile::balanced && !(stripe->symbols.is_intact() && stripe->raw.is_intact()))
        return false;
      if (profile_ == StreamProfile::fast && (stripe->at + 7) / 8 != stripe->present.size()) return false;
      if (profile_ == StreamProfile::small && !stripe->mixed->is_intact()) return false;
    }
  }
  return true;
}

template struct StripeRecord<std::int32_t>;
template struct StripeRecord<std::int64_t>;
template class LevelEncoder<std::int32_t>;
template class LevelEncoder<std::int64_t>;
template class LevelDecoder<std::int32_t>;
template class LevelDecoder<std::int64_t>;

}  // namespace talus
