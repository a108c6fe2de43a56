#include "engine/stream/mixing_coder.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "engine/stream/level_symbols.hpp"

namespace talus {
namespace {

// ---- chances -------------------------------------------------------------------------------------------
// A chance is in units of 2^-12, its stretched form the logarithm of its odds in units of 2^-8.

int squashed(int t) {
  // 4096 / (1 + exp(-x)) for x from -8 to 8 in halves, rounded.
  static constexpr std::array<int, 33> kAt{1,    2,    4,    6,    10,   17,   27,   45,   74,   120,  194,
                                           311,  488,  747,  1102, 1546, 2048, 2550, 2994, 3349, 3608, 3785,
                                           3902, 3976, 4022, 4051, 4069, 4079, 4086, 4090, 4092, 4094, 4095};
  if (t > 2047) return 4095;
  if (t < -2047) return 0;
  const int rest = t & 127, i = (t >> 7) + 16;
  return (kAt[static_cast<std::size_t>(i)] * (128 - rest) + kAt[static_cast<std::size_t>(i) + 1] * rest + 64) >> 7;
}

struct Stretched {
  std::array<std::int16_t, 4096> of{};
  Stretched() {
    int p = 0;
    for (int t = -2047; t <= 2047; ++t) {
      const int next = squashed(t);
      for (; p <= next; ++p) of[static_cast<std::size_t>(p)] = static_cast<std::int16_t>(t);
    }
    for (; p < 4096; ++p) of[static_cast<std::size_t>(p)] = 2047;
  }
};
const Stretched& stretched() {
  static const Stretched made;
  return made;
}

/// A chance that learns, fast at first.
struct Adaptive {
  std::uint16_t chance = 1 << 15;
  std::uint16_t seen = 0;
  void learn(int bit, int slowest) {
    const int gap = (bit != 0 ? 65535 : 0) - int{chance};
    chance = static_cast<std::uint16_t>(chance + gap * 2 / (2 * int{seen} + 3));
    if (seen < slowest) ++seen;
  }
};

/// What neighbours that were told before say.
enum Neighbour : unsigned { kNone = 0, kAbsent = 1, kSmall = 2, kLarge = 3 };

constexpr std::size_t kInputs = 7;
constexpr int kUnary = 24;

/// Fine classes of a size in eighths of the tolerance.
unsigned fine_class(unsigned size) {
  if (size < 8) return size;
  if (size < 16) return 8 + (size - 8) / 2;
  if (size < 32) return 12 + (size - 16) / 8;
  return size < 64 ? 14 : 15;
}

}  // namespace

class MixedModel {
 public:
  MixedModel() : weights_(kSets * kInputs, 1 << 14) {
    static constexpr std::array<std::size_t, kInputs> sizes{1 << 13, 1 << 16, 1 << 14, 1 << 16,
                                                            1 << 13, 1 << 14, 1 << 14};
    for (std::size_t i = 0; i < kInputs; ++i) tables_[i].resize(sizes[i]);
    plain_.resize(1 << 9);
    refined_.resize(kSets * 33);
    for (std::size_t i = 0; i < refined_.size(); ++i)
      refined_[i].chance = static_cast<std::uint16_t>(squashed((static_cast<int>(i % 33) - 16) * 128) * 16);
  }

  /// Of one decision: a context for each input, and a set of weights.
  struct Decision {
    std::array<std::uint32_t, kInputs> contexts{};
    std::size_t set = 0;
  };
  static constexpr std::size_t kSets = 64;

  [[nodiscard]] int chance(const Decision& d) {
    std::int64_t dot = 0;
    for (std::size_t i = 0; i < kInputs; ++i) {
      slots_[i] = &tables_[i][d.contexts[i] & (tables_[i].size() - 1)];
      inputs_[i] = stretched().of[slots_[i]->chance >> 4];
      dot += std::int64_t{inputs_[i]} * weights_[d.set * kInputs + i];
    }
    const int t = static_cast<int>(std::clamp<std::int64_t>(dot >> 16, -2047, 2047));
    mixed_ = squashed(t);
    const int place = (t + 2048) * 32 / 4096;
    const auto at = d.set * 33 + static_cast<std::size_t>(place);
    refined_slot_ = &refined_[at];
    const int refined = (refined_[at].chance >> 4);
    return std::clamp((3 * mixed_ + refined) / 4, 1, 4095);
  }
  void learn(const Decision& d, int bit) {
    const int error = ((bit << 12) - mixed_) * 6;
    for (std::size_t i = 0; i < kInputs; ++i) {
      auto& w = weights_[d.set * kInputs + i];
      w += static_cast<std::int32_t>((std::int64_t{inputs_[i]} * error + 0x2000) >> 14);
      w = std::clamp(w, -(1 << 20), 1 << 20);
      slots_[i]->learn(bit, 250);
    }
    refined_slot_->learn(bit, 250);
  }
  [[nodiscard]] Adaptive& plain(std::size_t context) { return plain_[context]; }

 private:
  std::array<std::vector<Adaptive>, kInputs> tables_;
  std::vector<Adaptive> plain_, refined_;
  std::vector<std::int32_t> weights_;
  std::array<Adaptive*, kInputs> slots_{};
  std::array<int, kInputs> inputs_{};
  Adaptive* refined_slot_ = nullptr;
  int mixed_ = 2048;
};

void MixedModelDelete::operator()(MixedModel* model) const { delete model; }
MixedModelPointer make_mixed_model() { return MixedModelPointer(new MixedModel); }

namespace {

// ---- decisions as bytes ----------------------------------------------------------------------------------

class DecisionWriter {
 public:
  explicit DecisionWriter(std::vector<std::byte>& out) : out_(out) {}
  int code(int bit, int chance) {
    const std::uint32_t middle = low_ + ((high_ - low_) >> 12) * static_cast<std::uint32_t>(chance);
    bit != 0 ? high_ = middle : low_ = middle + 1;
    for (; ((low_ ^ high_) & 0xff000000u) == 0; low_ <<= 8, high_ = high_ << 8 | 255)
      out_.push_back(static_cast<std::byte>(high_ >> 24));
    return bit;
  }
  void finish() {
    for (int i = 0; i < 4; ++i, low_ <<= 8) out_.push_back(static_cast<std::byte>(low_ >> 24));
  }

 private:
  std::vector<std::byte>& out_;
  std::uint32_t low_ = 0, high_ = 0xffffffffu;
};

class DecisionReader {
 public:
  explicit DecisionReader(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) at_value_ = at_value_ << 8 | next();
  }
  int code(int, int chance) {
    const std::uint32_t middle = low_ + ((high_ - low_) >> 12) * static_cast<std::uint32_t>(chance);
    const int bit = at_value_ <= middle ? 1 : 0;
    bit != 0 ? high_ = middle : low_ = middle + 1;
    for (; ((low_ ^ high_) & 0xff000000u) == 0; low_ <<= 8, high_ = high_ << 8 | 255)
      at_value_ = at_value_ << 8 | next();
    return bit;
  }
  /// A writer's last four bytes are what its reader has looked at when all was told.
  [[nodiscard]] bool is_intact() const { return at_ == bytes_.size() && !beyond_; }

 private:
  std::uint32_t next() {
    if (at_ == bytes_.size()) return beyond_ = true, 0;
    return std::to_integer<std::uint32_t>(bytes_[at_++]);
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool beyond_ = false;
  std::uint32_t low_ = 0, high_ = 0xffffffffu, at_value_ = 0;
};

// ---- candidates as decisions -----------------------------------------------------------------------------

/// What was told in the last three rows, by column, with room on both sides.
class Told {
 public:
  struct Cell {
    std::uint8_t state = kNone, size = 0, negative = 0;
  };
  void start_row(std::int32_t row, std::size_t columns) {
    if (cells_[0].size() != columns + 8) {
      for (auto& cells : cells_) cells.assign(columns + 8, Cell{});
      rows_ = {-9, -9, -9};
    }
    const auto k = static_cast<std::size_t>(row % 3);
    std::fill(cells_[k].begin(), cells_[k].end(), Cell{});
    rows_[k] = row;
  }
  [[nodiscard]] Cell at(std::int32_t row, std::int64_t column) const {
    if (row < 0) return {};
    const auto k = static_cast<std::size_t>(row % 3);
    return rows_[k] == row ? cells_[k][static_cast<std::size_t>(column + 4)] : Cell{};
  }
  void set(std::int32_t row, std::int64_t column, Cell cell) {
    cells_[static_cast<std::size_t>(row % 3)][static_cast<std::size_t>(column + 4)] = cell;
  }

 private:
  std::array<std::vector<Cell>, 3> cells_;
  std::array<std::int32_t, 3> rows_{-9, -9, -9};
};

/// The one description of what is decided: a writer knows each bit and is told it back, a reader is told.
template <class Code, class Coder>
class Teller {
 public:
  Teller(MixedModel& model, Coder& coder, std::size_t half, int shift)
      : model_(model), coder_(coder), half_(half), shift_(shift) {}

  void start_row(std::int32_t row, std::size_t columns) {
    row_ = row;
    told_.start_row(row, columns);
  }

  void tell(std::uint32_t column, unsigned context, unsigned energy, unsigned distance, std::uint8_t& present,
            Code& residual) {
    const auto i = static_cast<std::int64_t>(column);
    const std::array<Told::Cell, 5> around =
        half_ == 0 ? std::array{told_.at(row_, i - 2), told_.at(row_ - 2, i), told_.at(row_ - 2, i + 2),
                                told_.at(row_ - 2, i - 2), Told::Cell{}}
                   : std::array{told_.at(row_ - 1, i - 1), told_.at(row_ - 1, i + 1), told_.at(row_, i - 2),
                                told_.at(row_ - 2, i), told_.at(row_, i - 1)};
    unsigned states = 0, here = 0, gone = 0, sizes = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      states = states * 4 + around[k].state;
      here += around[k].state >= kSmall ? 1 : 0;
      gone += around[k].state == kAbsent ? 1 : 0;
      sizes += around[k].size;
    }
    const unsigned kind = context >= kStrictContexts ? 2 + static_cast<unsigned>(half_) : static_cast<unsigned>(half_);
    const unsigned e = fine_class(energy), d = fine_class(distance);
    const unsigned average = here > 0 ? std::min(15u, fine_class(std::min(255u, 4 * sizes / here))) : 0;

    MixedModel::Decision is_there;
    is_there.contexts = {(kind * 16 + e) * 16 + d,
                         ((kind * 256 + states) * 4 + d / 4) * 4 + e / 4,
                         ((kind * 16 + e) * 5 + here) * 5 + gone,
                         ((kind * 16 + d) * 16 + states / 16) * 8 + e / 2,
                         kind * 16 + average,
                         (kind * 256 + states) * 2,
                         ((kind * 16 + average) * 16 + d)};
    is_there.set = kind * 5 + here;
    present = static_cast<std::uint8_t>(decide(is_there, present));
    if (present == 0) {
      residual = 0;
      told_.set(row_, i, {kAbsent, 0, 0});
      return;
    }
    const auto negative = static_cast<unsigned>(decide(sign_of(kind, d, e, around), residual < 0 ? 1 : 0));
    const auto magnitude = static_cast<std::uint64_t>(residual < 0 ? ~residual : residual);
    std::uint64_t v = 0;
    const std::uint64_t b = tell_size(magnitude >> shift_, kind, e, d, average, negative, around[0].size);
    v = b << shift_;
    for (int bit = shift_ - 1; bit >= 0; --bit)
      v |= static_cast<std::uint64_t>(coder_.code(static_cast<int>(magnitude >> bit & 1), 2048)) << bit;
    residual = static_cast<Code>(negative != 0 ? ~v : v);
    told_.set(row_, i,
              {static_cast<std::uint8_t>(b < 3 ? kSmall : kLarge),
               static_cast<std::uint8_t>(std::min<std::uint64_t>(b, 60)), static_cast<std::uint8_t>(1 + negative)});
  }

 private:
  static constexpr std::uint32_t kSign = 1 << 12, kSize = 1 << 13;

  MixedModel::Decision sign_of(unsigned kind, unsigned d, unsigned e, const std::array<Told::Cell, 5>& around) const {
    const unsigned signs = (around[0].negative * 3u + around[1].negative) * 3 + around[2].negative;
    MixedModel::Decision sign;
    sign.contexts = {kSign + (kind * 16 + d) * 16 + e,
                     (1u << 15) + kind * 16 + d,
                     (1u << 13) + kind * 27 + signs,
                     (1u << 15) + (kind * 27 + signs) * 16 + d,
                     (1u << 12) + kind,
                     (1u << 13) + kind * 16 + e,
                     (1u << 13) + (kind * 3 + around[3].negative) * 16 + d};
    sign.set = 20 + kind;
    return sign;
  }

  std::uint64_t tell_size(std::uint64_t b, unsigned kind, unsigned e, unsigned d, unsigned average, unsigned negative,
                          unsigned before) {
    unsigned t = 0;
    for (; t < kUnary; ++t) {
      MixedModel::Decision more;
      more.contexts = {kSize / 2 + 2048 + t * 16 + e + 512 * (kind & 1),
                       (1u << 15) + (1u << 14) + ((t * 16 + d) * 2 + negative) * 4 + kind,
                       (1u << 13) + 4096 + (t * 16 + average) * 2 + negative,
                       (1u << 15) + (1u << 14) + (((t * 8 + e / 2) * 8 + d / 2) * 2 + negative) * 2 + (kind & 1),
                       (1u << 12) + 1024 + t * 4 + kind,
                       (1u << 13) + 4096 + (t * 16 + std::min(before, 15u)) * 2 + (kind & 1),
                       (1u << 13) + 4096 + (t * 16 + std::min(average, 15u)) * 8 + e / 2};
      more.set = 24 + std::min(t, 15u) * 2 + (kind & 1);
      if (decide(more, b > t ? 1 : 0) == 0) return t;
    }
    // Larger ones: how many bits, in ones and a zero, then the bits.
    const std::uint64_t rest = b - kUnary + 1;
    int high = 0;
    const int bits = static_cast<int>(std::bit_width(rest)) - 1;
    while (high < 63 - shift_ && decide_plain(static_cast<std::size_t>(high), bits > high ? 1 : 0) != 0) ++high;
    std::uint64_t v = 1;
    for (int bit = high - 1; bit >= 0; --bit)
      v = v << 1 | static_cast<std::uint64_t>(coder_.code(static_cast<int>(rest >> bit & 1), 2048));
    return v + kUnary - 1;
  }

  int decide(const MixedModel::Decision& d, int bit) {
    const int told = coder_.code(bit, model_.chance(d));
    model_.learn(d, told);
    return told;
  }
  int decide_plain(std::size_t context, int bit) {
    Adaptive& slot = model_.plain(context);
    const int told = coder_.code(bit, std::clamp(slot.chance >> 4, 1, 4095));
    slot.learn(told, 60);
    return told;
  }

  MixedModel& model_;
  Coder& coder_;
  std::size_t half_;
  int shift_;
  std::int32_t row_ = 0;
  Told told_;
};

}  // namespace

template <class Code>
std::vector<std::byte> encode_mixed(MixedModel& model, const StripeRecord<Code>& stripe, std::size_t half, int shift) {
  std::vector<std::byte> out;
  DecisionWriter writer(out);
  Teller<Code, DecisionWriter> teller(model, writer, half, shift);
  std::size_t at = 0;
  for (const auto& row : stripe.rows) {
    teller.start_row(row.row, static_cast<std::size_t>(stripe.lattice->cols));
    for (std::size_t end = at + row.count; at < end; ++at) {
      std::uint8_t present = stripe.present[at];
      Code residual = stripe.residuals[at];
      teller.tell(stripe.columns[at], stripe.contexts[at], stripe.energies[at], stripe.distances[at], present,
                  residual);
    }
  }
  writer.finish();
  return out;
}

template <class Code>
struct MixedReader<Code>::State {
  DecisionReader reader;
  Teller<Code, DecisionReader> teller;
  State(MixedModel& model, std::span<const std::byte> bytes, std::size_t half, int shift)
      : reader(bytes), teller(model, reader, half, shift) {}
};

template <class Code>
MixedReader<Code>::MixedReader(MixedModel& model, std::span<const std::byte> bytes, std::size_t half, int shift)
    : state_(std::make_unique<State>(model, bytes, half, shift)) {}
template <class Code>
MixedReader<Code>::~MixedReader() = default;

template <class Code>
void MixedReader<Code>::take(CandidateRow<Code>& row) {
  state_->teller.start_row(row.row, static_cast<std::size_t>(row.lattice->cols));
  for (std::size_t i = 0; i < row.count; ++i) {
    row.present[i] = 0;
    row.residuals[i] = 0;
    state_->teller.tell(row.columns[i], row.contexts[i], row.energies[i], row.distances[i], row.present[i],
                        row.residuals[i]);
  }
}

template <class Code>
bool MixedReader<Code>::is_intact() const {
  return state_->reader.is_intact();
}

template std::vector<std::byte> encode_mixed(MixedModel&, const StripeRecord<std::int32_t>&, std::size_t, int);
template std::vector<std::byte> encode_mixed(MixedModel&, const StripeRecord<std::int64_t>&, std::size_t, int);
template class MixedReader<std::int32_t>;
template class MixedReader<std::int64_t>;

}  // namespace talus
