#include "engine/stream/level_symbols.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "engine/stream/stream_bytes.hpp"
#include "engine/stream/symbol_coder.hpp"
#include "talus/failure.hpp"

namespace talus {

// Symbol 0 means that a candidate is not a vertex. Other symbols are the sign and size of a residual. Let v be the
// residual, or its complement if it is negative, and b = v >> shift. Up to 12, b has a symbol of its own. Above, the
// symbol is the highest bit of b - 12. Lower bits follow without coding.

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

/// The residuals that each symbol stands for, at one shift.
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
        const auto high = std::min(static_cast<int>(pair) - kPlainSizes, 63);  // writers do not use the last symbols
        first = (kPlainSizes - 1) + (std::uint64_t{1} << high);
        more += high;
      }
      base[s] = static_cast<Code>(first << shift);
      // writers do not use larger ones
      bits[s] = static_cast<std::uint8_t>(more < static_cast<int>(8 * sizeof(Code)) ? more : 0);
    }
  }
};

/// The contexts of a level's tables. Small levels have fewer.
enum class Resolution : std::uint8_t { same_tables = 0, kinds = 1, all = 2 };
constexpr std::size_t kKinds = 4;  // strict and loose centres, strict and loose side midpoints
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
  Resolution resolution = Resolution::same_tables;  ///< of the tables; same_tables: there are no tables yet
};

template <class Code>
void StripeRecord<Code>::take(const CandidateRow<Code>& row) {
  rows.push_back(row.count);
  contexts.insert(contexts.end(), row.contexts, row.contexts + row.count);
  present.insert(present.end(), row.present, row.present + row.count);
  residuals.insert(residuals.end(), row.residuals, row.residuals + row.count);
}

namespace {

template <class Code>
using Halves = std::array<std::vector<StripeRecord<Code>>, 2>;
using Bytes = std::vector<std::byte>;

/// The shift at which most residuals have symbols of their own, and at which the lower bits are about random.
template <class Code>
int shift_of(const Halves<Code>& halves) {
  double sum = 0, count = 0;
  for (const auto& stripes : halves) {
    for (const auto& stripe : stripes) {
      std::uint64_t there = 0, sizes = 0;  // absent candidates have residual 0
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

/// Joins pieces: first the lengths of all, then their bytes.
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
  if (in.left() > 0) refuse("a level has bytes after its last stripe");
  return pieces;
}

template <class Code>
Bytes encode_halves(const Halves<Code>& halves, SymbolState& state) {
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
  // Chooses new tables of either resolution, or the last tables, whichever need the fewest bits.
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
      for (const std::size_t count : stripe.rows) {
        rows.push_back({std::span(contexts).subspan(at, count), std::span(made.symbols).subspan(at, count)});
        at += count;
      }
      pieces.push_back(encode_symbols(state.tables, rows));
      pieces.push_back(made.raw);
    }
  }
  append(out, packed(pieces));
  return out;
}

}  // namespace

// ---- writing --------------------------------------------------------------------------------------------

template <class Code>
LevelEncoder<Code>::LevelEncoder() : state_(std::make_unique<SymbolState>()) {}
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
  append(out, encode_halves(halves, *state_));
  return out;
}

// ---- reading --------------------------------------------------------------------------------------------

template <class Code>
struct LevelDecoder<Code>::Stripe {
  SymbolReader symbols;
  BitReader raw;
  std::shared_ptr<const Meanings<Code>> meanings;
  Resolution resolution = Resolution::all;
  std::vector<std::uint8_t> room, contexts;
};

template <class Code>
LevelDecoder<Code>::LevelDecoder() : state_(std::make_unique<SymbolState>()) {}
template <class Code>
LevelDecoder<Code>::~LevelDecoder() = default;

template <class Code>
std::size_t LevelDecoder<Code>::start(std::span<const std::byte> bytes) {
  stripes_[0].clear(), stripes_[1].clear();
  if (bytes.empty()) return 1;  // no candidate is a vertex
  VariableReader in(bytes);
  const std::size_t count = in.size();
  if (count < 1 || count > bytes.size()) refuse(fmt::format("a level has {} stripes", count));
  const int shift = std::to_integer<int>(in.take(1)[0]);
  if (shift >= static_cast<int>(8 * sizeof(Code))) refuse(fmt::format("residuals have a shift of {} bits", shift));
  const auto resolution = std::to_integer<unsigned>(in.take(1)[0]);
  if (resolution > 2 || (resolution == 0 && state_->resolution == Resolution::same_tables))
    refuse("a level has no tables of symbols");
  if (resolution != 0) {
    state_->resolution = static_cast<Resolution>(resolution);
    const std::size_t size = in.size();
    BitReader table(in.take(size));
    if (!state_->tables.read(table, contexts_of(state_->resolution)) || !table.is_intact())
      refuse("the tables of symbols are damaged");
  }
  const auto meanings = std::make_shared<const Meanings<Code>>(shift);
  const auto pieces = unpacked(in.take(in.left()), 2 * count * 2);  // symbols and raw bits of each stripe
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t b = 0; b < count; ++b) {
      const auto* piece = &pieces[(half * count + b) * 2];
      auto stripe = std::make_unique<Stripe>();
      stripe->symbols = SymbolReader(state_->tables, piece[0]);
      stripe->raw = BitReader(piece[1]);
      stripe->meanings = meanings;
      stripe->resolution = state_->resolution;
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
}

template <class Code>
bool LevelDecoder<Code>::is_intact() const {
  for (const auto& stripes : stripes_) {
    for (const auto& stripe : stripes) {
      if (!stripe->symbols.is_intact() || !stripe->raw.is_intact()) return false;
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
