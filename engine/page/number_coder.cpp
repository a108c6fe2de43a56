#include "engine/page/number_coder.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>

namespace talus {
namespace {

constexpr int kStateBits = 10;
constexpr std::uint32_t kStates = 1u << kStateBits;

// ---- tokens ----------------------------------------------------------------------------------------
// A number below 16 is its own token. For larger ones the token is the highest bit and the one below it.

constexpr int kPlainTokens = 16;
constexpr int kTokens = kPlainTokens + 2 * 60 + 1;
constexpr int kEscape = kTokens - 1;  ///< for numbers too unlikely for a state: 6 bits of length, then the bits
constexpr std::uint8_t kEscapeBits = 0xff;
constexpr int kLongestFast = 16;  ///< most bits below a token in the fast path

struct Token {
  int token = 0, bits = 0;
  std::uint64_t first = 0;
};

constexpr Token token_of(std::uint64_t number) {
  if (number < kPlainTokens) return {static_cast<int>(number), 0, number};
  const int high = static_cast<int>(std::bit_width(number)) - 1;
  const std::uint64_t half = number >> (high - 1);  // 2 or 3
  return {kPlainTokens + 2 * (high - 4) + static_cast<int>(half & 1), high - 1, half << (high - 1)};
}

constexpr Token token_at(int token) {
  if (token < kPlainTokens) return {token, 0, static_cast<std::uint64_t>(token)};
  const int high = (token - kPlainTokens) / 2 + 4;
  return {token, high - 1, (2 + static_cast<std::uint64_t>(token & 1)) << (high - 1)};
}

// ---- distributions ---------------------------------------------------------------------------------
// Distribution t has a mean of about 2^(t/2) / 64. Nine tenths of it are half of a logistic distribution, which fits
// residuals better than a geometric one (0.01 bits a sample); the rest is a wide geometric one, which makes large
// numbers cheaper (0.03 bits). All arithmetic is whole numbers, so every machine has the same tables.

using Wide = unsigned __int128;
constexpr std::uint64_t kOne = std::uint64_t{1} << 62;

constexpr std::uint64_t times(std::uint64_t a, std::uint64_t b) {  // in units of 2^-62
  return static_cast<std::uint64_t>(static_cast<Wide>(a) * b >> 62);
}
constexpr std::uint64_t power(std::uint64_t base, std::uint64_t exponent) {
  std::uint64_t result = kOne;
  for (; exponent > 0; exponent >>= 1, base = times(base, base)) {
    if (exponent & 1) result = times(result, base);
  }
  return result;
}

/// The ratio of a geometric distribution with mean m / 2^20.
constexpr std::uint64_t ratio_of_mean(std::uint64_t m) {
  return static_cast<std::uint64_t>(static_cast<Wide>(m) * kOne / (m + (1u << 20)));
}

using Counts = std::array<std::uint16_t, kTokens>;

/// The number of states of each token. They sum up to kStates.
Counts counts_of(int t) {
  const std::uint64_t mean = ((t & 1) != 0 ? 23170u : 16384u) * (std::uint64_t{1} << (t / 2));  // · 2^-20
  const std::uint64_t narrow = ratio_of_mean(mean / 8 * 5), wide = ratio_of_mean(2 * mean);
  const auto at_least = [&](std::uint64_t number) {
    const std::uint64_t p = power(narrow, number);
    const auto logistic = static_cast<std::uint64_t>((static_cast<Wide>(p) << 62) / (kOne + p) * 2);
    return logistic / 10 * 9 + power(wide, number) / 10;
  };
  Counts counts{};
  std::uint32_t sum = 1;
  counts[kEscape] = 1;
  std::size_t largest = 0;
  for (int token = 0; token < kEscape; ++token) {
    const Token here = token_at(token);
    const std::uint64_t next = here.first + (std::uint64_t{1} << here.bits);
    const std::uint64_t chance = at_least(here.first) - std::min(at_least(here.first), at_least(next));
    auto count = static_cast<std::uint32_t>((chance >> (62 - kStateBits - 1)) + 1) / 2;
    if (count == 0 && chance > kOne >> (kStateBits + 4)) count = 1;
    const auto i = static_cast<std::size_t>(token);
    counts[i] = static_cast<std::uint16_t>(count);
    sum += count;
    if (counts[i] > counts[largest]) largest = i;
  }
  // Rounding changed the sum: correct the likeliest token, one state at a time.
  for (; sum < kStates; ++sum) ++counts[largest];
  for (; sum > kStates; --sum) --*std::max_element(counts.begin(), counts.end());
  return counts;
}

// ---- tables ----------------------------------------------------------------------------------------

/// Reading from a state: the number is `base` plus `low_bits` bits, the next state is `next` plus `bits` bits.
struct Step {
  std::uint32_t base;
  std::uint16_t next;
  std::uint8_t bits, low_bits;
};

struct Tables {
  std::array<std::array<Step, kStates>, kDistributions> steps;  ///< for reading, by state
  struct Writing {
    struct PerToken {
      std::uint16_t count = 0;  ///< number of its states
      std::int16_t first = 0;   ///< index of the first one in `states`, minus the count
      std::int16_t shed = 0;    ///< bits to write, or one more than needed
    };
    std::array<PerToken, kTokens> tokens;
    std::array<std::uint16_t, kStates> states;
    std::array<std::uint16_t, kTokens> cost;  ///< bits · 256
  };
  std::array<Writing, kDistributions> writing;

  Tables() {
    for (int t = 0; t < kDistributions; ++t) make(t);
  }

  void make(int t) {
    auto& w = writing[static_cast<std::size_t>(t)];
    auto& read = steps[static_cast<std::size_t>(t)];
    const Counts counts = counts_of(t);
    std::array<std::uint8_t, kStates> tokens{};
    std::uint32_t place = 0, first = 0;
    for (std::size_t token = 0; token < kTokens; ++token) {
      w.tokens[token] = {counts[token], static_cast<std::int16_t>(static_cast<int>(first) - counts[token]),
                         static_cast<std::int16_t>(kStateBits + 1 - std::bit_width(counts[token]))};
      first += counts[token];
      for (std::uint32_t i = 0; i < counts[token]; ++i) {
        tokens[place] = static_cast<std::uint8_t>(token);
        place = (place + (kStates >> 1) + (kStates >> 3) + 3) & (kStates - 1);
      }
      w.cost[token] = cost_of(counts[token], token);
    }
    std::array<std::uint32_t, kTokens> next{};
    for (std::size_t token = 0; token < kTokens; ++token) next[token] = counts[token];
    for (std::uint32_t state = 0; state < kStates; ++state) {
      Step& step = read[state];
      const std::size_t token = tokens[state];
      const std::uint32_t x = next[token]++;
      step.bits = static_cast<std::uint8_t>(kStateBits + 1 - std::bit_width(x));
      step.next = static_cast<std::uint16_t>((x << step.bits) - kStates);
      w.states[static_cast<std::size_t>(w.tokens[token].first) + x] = static_cast<std::uint16_t>(state);
      const Token t_at = token_at(static_cast<int>(token));
      step.low_bits = token == kEscape ? kEscapeBits : static_cast<std::uint8_t>(t_at.bits);
      // The base of a longer number follows from its low_bits and its half.
      step.base =
          step.low_bits > kLongestFast ? static_cast<std::uint32_t>(token & 1) : static_cast<std::uint32_t>(t_at.first);
    }
  }

  /// -256·log2(count / kStates), plus the bits below the token.
  static std::uint16_t cost_of(std::uint32_t count, std::size_t token) {
    if (count == 0) return 80 * 256;  // approximate cost of an escape
    std::uint64_t x = std::uint64_t{count} << (31 - (std::bit_width(count) - 1));
    int fraction = 0;
    for (int i = 0; i < 8; ++i) {  // the logarithm, bit by bit
      x = x * x >> 31;
      fraction *= 2;
      if (x >> 32) fraction += 1, x >>= 1;
    }
    const int log = (static_cast<int>(std::bit_width(count)) - 1) * 256 + fraction;
    return static_cast<std::uint16_t>(kStateBits * 256 - log + 256 * token_at(static_cast<int>(token)).bits);
  }
};

const Tables& tables() {
  static const auto made = std::make_unique<const Tables>();
  return *made;
}

/// Writes bits from the last to the first, so that they are read in order. The memory grows.
class BackwardBits {
 public:
  explicit BackwardBits(std::vector<std::byte>& buffer) : buffer_(buffer), at_(buffer.size()) {}
  void put(std::uint64_t bits, int count) {  // count <= 32
    held_ = held_ << count | bits;
    count_ += count;
    if (count_ >= 32) flush();
  }
  /// The bytes, and the number of unused low bits in the first one.
  std::pair<std::span<const std::byte>, int> finish() {
    const int idle = (8 - count_ % 8) % 8;
    held_ <<= idle;
    for (int left = count_ + idle; left > 0; left -= 8) store(static_cast<std::uint8_t>(held_ >> (left - 8)));
    return {std::span<const std::byte>(buffer_).subspan(at_), idle};
  }

 private:
  void flush() {
    const auto word = static_cast<std::uint32_t>(held_ >> (count_ - 32));
    if (at_ < 4) grow();
    at_ -= 4;
    for (std::size_t i = 0; i < 4; ++i) buffer_[at_ + i] = static_cast<std::byte>(word >> (8 * i) & 0xff);
    count_ -= 32;
    held_ &= (std::uint64_t{1} << count_) - 1;
  }
  void store(std::uint8_t byte) {
    if (at_ < 1) grow();
    buffer_[--at_] = std::byte{byte};
  }
  void grow() {
    const std::size_t more = std::max(buffer_.size(), std::size_t{4096});
    buffer_.insert(buffer_.begin(), more, std::byte{0});
    at_ += more;
  }

  std::vector<std::byte>& buffer_;
  std::size_t at_;
  std::uint64_t held_ = 0;
  int count_ = 0;
};

using Choice = std::array<std::uint8_t, kContexts>;  ///< distribution of each context
constexpr std::uint8_t kUnused = 0xff;

/// The cheapest distribution of each context, near the one with its mean.
Choice choose(std::span<const std::uint64_t> numbers, std::span<const std::uint8_t> contexts) {
  const auto counts = std::make_unique<std::array<std::array<std::uint32_t, kTokens>, kContexts>>();
  std::array<std::uint32_t, kContexts> highest{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto token = static_cast<std::uint32_t>(token_of(numbers[i]).token);
    ++(*counts)[contexts[i]][token];
    highest[contexts[i]] = std::max(highest[contexts[i]], token + 1);
  }
  Choice choice;
  choice.fill(kUnused);
  for (std::size_t c = 0; c < kContexts; ++c) {
    if (highest[c] == 0) continue;
    const std::span<const std::uint32_t> seen((*counts)[c].data(), highest[c]);
    double sum = 0, many = 0;  // for the mean, which is only the start of the search
    for (std::size_t token = 0; token < seen.size(); ++token) {
      const Token t = token_at(static_cast<int>(token));
      sum += static_cast<double>(seen[token]) *
             (static_cast<double>(t.first) + 0.5 * static_cast<double>((std::uint64_t{1} << t.bits) - 1));
      many += seen[token];
    }
    int middle = 0;
    while (middle < kDistributions - 1 && 0x1p-6 * static_cast<double>(std::uint64_t{1} << (middle / 2)) * many < sum)
      ++middle;
    std::uint64_t best = std::numeric_limits<std::uint64_t>::max();
    for (int t = std::max(middle - 6, 0); t <= std::min(middle + 1, kDistributions - 1); ++t) {
      const auto& cost = tables().writing[static_cast<std::size_t>(t)].cost;
      std::uint64_t bits = 0;
      for (std::size_t token = 0; token < seen.size(); ++token) bits += std::uint64_t{seen[token]} * cost[token];
      if (bits < best) best = bits, choice[c] = static_cast<std::uint8_t>(t);
    }
  }
  return choice;
}

}  // namespace

void NumberWriter::put(std::uint64_t number, int context) {
  numbers_.push_back(number);
  contexts_.push_back(static_cast<std::uint8_t>(context));
}

double NumberWriter::bits(int first, int end) const {
  const Choice choice = choose(numbers_, contexts_);
  double sum = 0;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (contexts_[i] < first || contexts_[i] >= end) continue;
    sum += tables().writing[choice[contexts_[i]]].cost[static_cast<std::size_t>(token_of(numbers_[i]).token)] / 256.0;
  }
  return sum;
}

void NumberWriter::finish(std::vector<std::byte>& out) {
  const Choice choice = choose(numbers_, contexts_);
  BackwardBits bits(backward_);
  std::array<std::uint32_t, 4> state{};
  for (std::size_t i = numbers_.size(); i-- > 0;) {
    const auto& w = tables().writing[choice[contexts_[i]]];
    const std::uint64_t number = numbers_[i];
    Token t = token_of(number);
    if (w.tokens[static_cast<std::size_t>(t.token)].count == 0) {
      t = {kEscape, std::max(static_cast<int>(std::bit_width(number)), 1), 0};
    }
    const Tables::Writing::PerToken to = w.tokens[static_cast<std::size_t>(t.token)];
    std::uint32_t& s = state[i % 4];
    const std::uint32_t x = s + kStates;
    const int shed = to.shed - (x >> to.shed < to.count ? 1 : 0);
    bits.put(x & ((1u << shed) - 1), shed);
    if (t.bits > 0) {
      const std::uint64_t low = number - t.first;
      if (t.bits > 32) bits.put(low >> 32, t.bits - 32);
      bits.put(low & 0xffffffffu, std::min(t.bits, 32));
      if (t.token == kEscape) bits.put(static_cast<std::uint64_t>(t.bits - 1), 6);
    }
    s = w.states[static_cast<std::size_t>(to.first + static_cast<int>(x >> shed))];
  }
  // Head: the contexts in use, a distribution for each, the states and the number of unused bits.
  const auto byte = [&](std::uint64_t v) { out.push_back(static_cast<std::byte>(v & 0xff)); };
  for (std::size_t c = 0; c < kContexts; c += 8) {
    unsigned used = 0;
    for (std::size_t k = 0; k < 8; ++k) used |= (choice[c + k] != kUnused ? 1u : 0u) << k;
    byte(used);
  }
  for (const std::uint8_t d : choice) {
    if (d != kUnused) byte(d);
  }
  const auto [written, idle] = bits.finish();
  std::uint64_t head = static_cast<std::uint64_t>(idle);
  for (std::size_t i = 0; i < 4; ++i) head |= std::uint64_t{state[i]} << (8 + kStateBits * i);
  for (int i = 0; i < 6; ++i) byte(head >> (8 * i));
  out.insert(out.end(), written.begin(), written.end());
}

// ---- reading ---------------------------------------------------------------------------------------

void NumberReader::start(std::span<const std::byte> bytes) {
  constexpr std::size_t kUsed = kContexts / 8, kHead = 6;
  started_well_ = false;
  position_ = 0;
  turn_ = 0;
  std::fill(std::begin(distribution_), std::end(distribution_), std::uint8_t{0});
  std::fill(std::begin(state_), std::end(state_), 0u);
  size_ = 0;
  bytes_.assign(16, std::byte{0});
  if (bytes.size() < kUsed) return;
  std::size_t at = kUsed;
  for (std::size_t c = 0; c < kContexts; ++c) {
    if ((std::to_integer<unsigned>(bytes[c / 8]) >> (c % 8) & 1) == 0) continue;
    if (at >= bytes.size()) return;
    distribution_[c] = std::to_integer<std::uint8_t>(bytes[at++]);
    if (distribution_[c] >= kDistributions) {
      distribution_[c] = 0;
      return;
    }
  }
  if (bytes.size() - at < kHead) return;
  std::uint64_t head = 0;
  for (std::size_t i = 0; i < kHead; ++i) head |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
  at += kHead;
  size_ = bytes.size() - at;
  bytes_.resize(size_ + 16);
  std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), bytes_.begin());
  std::fill(bytes_.end() - 16, bytes_.end(), std::byte{0});
  position_ = head & 0xff;
  for (std::size_t i = 0; i < 4; ++i)
    state_[i] = static_cast<std::uint32_t>(head >> (8 + kStateBits * i)) & (kStates - 1);
  started_well_ = position_ < 8 && (position_ == 0 || size_ > 0);
}

namespace {

/// The position of the next bits. Bits after the end are zeros.
struct TokenBits {
  const std::byte* bytes;
  std::size_t size;
  std::uint64_t position;
  std::uint64_t held = 0;

  [[gnu::always_inline]] void refill() {  // to at least 56 bits
    std::memcpy(&held, bytes + std::min<std::uint64_t>(position >> 3, size), 8);
    if constexpr (std::endian::native == std::endian::big) held = __builtin_bswap64(held);
    held >>= position & 7;
  }
  [[gnu::always_inline]] std::uint64_t take(unsigned count) {
    const std::uint64_t bits = held & ((std::uint64_t{1} << count) - 1);
    held >>= count;
    position += count;
    return bits;
  }
};

/// Reads a number with many bits below its token, or an escape. The step's own bits stay unread.
[[gnu::noinline]] std::uint64_t take_long(TokenBits& bits, const Step& step) {
  bits.refill();
  unsigned count = step.low_bits;
  std::uint64_t base = 0;
  if (count == kEscapeBits) {
    count = static_cast<unsigned>(bits.take(6)) + 1;
    bits.refill();
  } else {
    base = (std::uint64_t{2} + step.base) << count;
  }
  std::uint64_t low = bits.take(std::min(count, 32u));
  if (count > 32) {
    bits.refill();
    low |= bits.take(count - 32) << 32;
  }
  bits.refill();
  return base + low;
}

}  // namespace

std::uint64_t NumberReader::get(int context) {
  TokenBits bits{bytes_.data(), size_, position_};
  bits.refill();
  std::uint32_t& state = state_[turn_];
  const Step step = tables().steps[distribution_[context]][state];
  const std::uint64_t number =
      step.low_bits > kLongestFast ? take_long(bits, step) : step.base + bits.take(step.low_bits);
  state = step.next + static_cast<std::uint32_t>(bits.take(step.bits));
  turn_ = (turn_ + 1) % 4;
  position_ = bits.position;
  return number;
}

bool NumberReader::is_intact() const {
  return started_well_ && position_ == 8 * static_cast<std::uint64_t>(size_) &&
         std::all_of(std::begin(state_), std::end(state_), [](std::uint32_t s) { return s == 0; });
}

}  // namespace talus
