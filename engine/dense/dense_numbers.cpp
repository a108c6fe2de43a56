#include "engine/dense/dense_numbers.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/dense/kernels.hpp"
#include "engine/machine/cpu.hpp"

namespace talus {
namespace {

using namespace detail;

constexpr int kChoices = 16;            ///< numbers of low bits that a class may have, the least one included
constexpr unsigned kLongestUnary = 24;  ///< larger numbers are patched
constexpr std::size_t kHead = 12 + kBendClasses / 2;
constexpr std::size_t kBehind = 1024;          ///< readable bytes behind the streams
constexpr std::uint16_t kAllFlagged = 0xffff;  ///< as the number of bytes of flags: none, and all flags are 1

template <class T>
constexpr int kBits = 8 * static_cast<int>(sizeof(T));
template <class T>
constexpr std::size_t kPatchBytes = 2 + sizeof(T);

/// The class of each entry of DenseStreams::low_bits_of.
constexpr std::array<std::uint8_t, kBendPlaces> classes_of_places() {
  std::array<std::uint8_t, kBendPlaces> classes{};
  for (unsigned sum = 0; sum < kBendSums; ++sum) classes[bend_place(sum)] = static_cast<std::uint8_t>(bend_class(sum));
  return classes;
}
constexpr std::array<std::uint8_t, kBendPlaces> kClassesOfPlaces = classes_of_places();
constexpr bool places_tell_classes() {
  for (unsigned sum = 0; sum < kBendSums; ++sum) {
    if (kClassesOfPlaces[bend_place(sum)] != bend_class(sum)) return false;
  }
  return true;
}
static_assert(places_tell_classes());

template <class Int>
void append(std::vector<std::byte>& out, Int value) {
  for (std::size_t i = 0; i < sizeof(Int); ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}
template <class Int>
Int read(const std::byte* from) {
  Int value = 0;
  for (std::size_t i = 0; i < sizeof(Int); ++i)
    value = static_cast<Int>(value | static_cast<Int>(std::to_integer<Int>(from[i]) << (8 * i)));
  return value;
}

/// Collects bits in memory that was made large enough.
class BitWriter {
 public:
  void begin(std::size_t most_bytes) {
    bytes_.resize(std::max(bytes_.size(), most_bytes + 8));
    next_ = bytes_.data();
    word_ = 0;
    filled_ = 0;
  }
  void put(std::uint64_t bits, int count) {  // at most 32
    word_ |= bits << filled_;
    filled_ += count;
    if (filled_ < 32) return;
    const auto whole = static_cast<std::uint32_t>(word_);
    for (int i = 0; i < 4; ++i) next_[i] = static_cast<std::byte>(whole >> (8 * i));
    next_ += 4;
    word_ >>= 32;
    filled_ -= 32;
  }
  /// Fills the last byte with zeros.
  void end_byte() {
    for (; filled_ > 0; filled_ -= 8, word_ >>= 8) *next_++ = static_cast<std::byte>(word_ & 0xff);
    word_ = 0;
    filled_ = 0;
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return {bytes_.data(), next_}; }

 private:
  std::vector<std::byte> bytes_;
  std::byte* next_ = nullptr;
  std::uint64_t word_ = 0;
  int filled_ = 0;  ///< below 32 between calls
};

/// How the groups of each class are coded.
struct Choice {
  int least_bits = 0;
  std::array<std::uint8_t, kBendClasses> low_bits{};
  std::array<bool, kBendClasses> is_flagged{};
};

/// The unary parts of a group with `low_bits` low bits, in bits, without their ones; a patched number counts as much as
/// its patch.
template <class T>
TALUS_INLINE std::uint32_t unary_bits(const T* zigzag, int low_bits) {
  constexpr auto kPatched = static_cast<T>(8 * kPatchBytes<T>);
  std::uint32_t bits = 0;
  for (int i = 0; i < kGroup; ++i) {  // numbers that are not stored are 0
    const T high = static_cast<T>(zigzag[i] >> low_bits);
    bits += static_cast<std::uint32_t>(high > kLongestUnary ? kPatched : high);
  }
  return bits;
}

/// What the groups of a class would cost with `first_low_bits` low bits and the next five numbers.
struct ClassCosts {
  static constexpr std::size_t kTried = 6;
  std::uint32_t groups = 0, zero_groups = 0;
  std::uint32_t numbers = 0, zero_numbers = 0;  ///< stored; those in groups of zeros only
  std::uint32_t sizes = 0;                      ///< the sum of the bit widths of the groups' sums
  int first_low_bits = 0;
  std::array<std::uint64_t, kTried> unary{};

  [[nodiscard]] int low_bits(std::size_t tried) const { return first_low_bits + static_cast<int>(tried); }
  [[nodiscard]] std::uint64_t bits(std::size_t tried) const {
    return unary[tried] + std::uint64_t{numbers} * static_cast<std::uint64_t>(low_bits(tried) + 1);
  }
  /// Bits if each group has a flag that says whether all of its numbers are 0.
  [[nodiscard]] std::uint64_t flagged_bits(std::size_t tried) const {
    return groups + bits(tried) - std::uint64_t{zero_numbers} * static_cast<std::uint64_t>(low_bits(tried) + 1);
  }
  [[nodiscard]] std::uint64_t least_bits(std::size_t tried) const { return std::min(bits(tried), flagged_bits(tried)); }
  [[nodiscard]] std::size_t best() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < kTried; ++i) best = least_bits(i) < least_bits(best) ? i : best;
    return best;
  }
};

template <class T>
TALUS_CLONES void sum_groups(const Residuals<T>& numbers, std::uint64_t* sums) {
  for (int g = 0; g < kDenseGroups; ++g) {
    std::uint64_t sum = 0;
    for (int i = 0; i < kGroup; ++i) sum += numbers.zigzag[g * kGroup + i];
    sums[g] = sum;
  }
}
template <class T>
TALUS_CLONES void add_costs(const Residuals<T>& numbers, std::array<ClassCosts, kBendClasses>& costs) {
  for (int g = 0; g < kDenseGroups; ++g) {
    ClassCosts& of = costs[static_cast<std::size_t>(bend_class(numbers.bend_sums[g]))];
    for (std::size_t i = 0; i < ClassCosts::kTried; ++i)
      of.unary[i] += unary_bits(numbers.zigzag + g * kGroup, of.first_low_bits + static_cast<int>(i));
  }
}

template <class T>
Choice choose(const Residuals<T>& numbers) {
  std::array<ClassCosts, kBendClasses> costs{};
  std::array<std::uint64_t, kDenseGroups> sums;
  sum_groups(numbers, sums.data());
  for (std::size_t g = 0; g < kDenseGroups; ++g) {
    if (numbers.stored[g] == 0) continue;
    ClassCosts& of = costs[static_cast<std::size_t>(bend_class(numbers.bend_sums[g]))];
    const auto stored = static_cast<std::uint32_t>(std::popcount(numbers.stored[g]));
    ++of.groups;
    of.numbers += stored;
    of.sizes += static_cast<std::uint32_t>(std::bit_width(sums[g]));
    if (sums[g] != 0) continue;
    ++of.zero_groups;
    of.zero_numbers += stored;
  }
  constexpr int kMost = kBits<T> - static_cast<int>(ClassCosts::kTried);
  for (ClassCosts& of : costs) {
    // The mean of the logarithms is a guess that a few large numbers do not spoil.
    const std::uint32_t others = of.groups - of.zero_groups;
    if (others > 0) of.first_low_bits = std::clamp(static_cast<int>(of.sizes / others) - 8, 0, kMost);
  }
  add_costs(numbers, costs);

  Choice choice;
  int most = 0;
  for (const ClassCosts& of : costs) most = std::max(most, of.groups > 0 ? of.low_bits(of.best()) : 0);
  choice.least_bits = std::max(0, most - (kChoices - 1));
  for (std::size_t i = 0; i < kBendClasses; ++i) {
    const ClassCosts& of = costs[i];
    const std::size_t best = of.best();
    choice.low_bits[i] = static_cast<std::uint8_t>(std::max(of.groups > 0 ? of.low_bits(best) : 0, choice.least_bits));
    choice.is_flagged[i] = of.groups > 0 && of.flagged_bits(best) < of.bits(best);
  }
  return choice;
}

}  // namespace

template <class T>
struct DenseNumbers<T>::Memory {
  DenseFunctions<T> functions;
  DenseMemory<T> work{};
  Residuals<T> residuals;
  BitWriter unary, flags, low;
  std::vector<std::byte> patches;
  DenseStreams in;
  std::vector<std::uint8_t> streams;  ///< unary parts and low bits, and at the end flags
  std::vector<std::uint16_t> patched;
  std::vector<std::uint64_t> patch_values;

  void write_group(std::size_t g, const Choice& choice, std::span<const T> square,
                   std::span<const std::uint16_t> places);
};

namespace {

/// The places of all numbers in the square, in coding order.
std::array<std::uint16_t, kDenseNumbers> places_in_order() {
  std::array<std::uint16_t, kDenseNumbers> places{};
  std::size_t next = 0;
  const auto row = [&](int x, int y, int step) {
    for (; x < kDenseSide; x += step) places[next++] = static_cast<std::uint16_t>(y * kDenseSide + x);
  };
  for (int s = 4; s >= 1; s /= 2) {
    for (int y = s; y < kDenseSide; y += 2 * s) row(s, y, 2 * s);
    for (int y = 0; y < kDenseSide; y += 2 * s) {
      row(s, y, 2 * s);
      row(0, y + s, 2 * s);
    }
  }
  return places;
}

}  // namespace

template <class T>
DenseNumbers<T>::DenseNumbers() : DenseNumbers(dense_functions<T>(instruction_set())) {}
template <class T>
DenseNumbers<T>::DenseNumbers(const DenseFunctions<T>& functions) : memory_(std::make_unique<Memory>()) {
  memory_->functions = functions;
}
template <class T>
DenseNumbers<T>::~DenseNumbers() = default;
template <class T>
DenseNumbers<T>::DenseNumbers(DenseNumbers&&) noexcept = default;
template <class T>
DenseNumbers<T>& DenseNumbers<T>::operator=(DenseNumbers&&) noexcept = default;

template <class T>
void DenseNumbers<T>::Memory::write_group(std::size_t g, const Choice& choice, std::span<const T> square,
                                          std::span<const std::uint16_t> places) {
  const std::uint16_t stored = residuals.stored[g];
  if (stored == 0) return;
  const T* zigzag = residuals.zigzag + g * kGroup;
  const auto of = static_cast<std::size_t>(bend_class(residuals.bend_sums[g]));
  const int low_bits = choice.low_bits[of];
  if (choice.is_flagged[of]) {
    const bool zero = std::all_of(zigzag, zigzag + kGroup, [](T z) { return z == 0; });
    flags.put(zero ? 1 : 0, 1);
    if (zero) return;
  }
  for (std::size_t i = 0; i < kGroup; ++i) {
    if ((stored >> i & 1) == 0) continue;
    T number = zigzag[i];
    if (static_cast<T>(number >> low_bits) > kLongestUnary) {
      const std::uint16_t place = places[g * kGroup + i];
      append(patches, place);
      append(patches, square[place]);
      number = 0;
    }
    const auto high = static_cast<int>(number >> low_bits);
    unary.put(std::uint64_t{1} << high, high + 1);
    const std::uint64_t below = number & ((std::uint64_t{1} << low_bits) - 1);
    low.put(below & 0xffffffff, std::min(low_bits, 32));
    if (low_bits > 32) low.put(below >> 32, low_bits - 32);
  }
  low.end_byte();
}

template <class T>
void DenseNumbers<T>::put(std::span<T> square, const SquareBits* stored, std::vector<std::byte>& out) {
  static const std::array<std::uint16_t, kDenseNumbers> places = places_in_order();
  Memory& m = *memory_;
  // In units of `bend_shift`, the bends of a group must not all be too large to tell apart.
  int bend_shift = 2;
  const auto predict = [&] {
    m.functions.predict(square.data(), stored != nullptr ? stored->data() : nullptr, bend_shift, m.work, m.residuals);
    const auto large = std::count_if(m.residuals.bend_sums, m.residuals.bend_sums + kDenseGroups,
                                     [](std::uint16_t sum) { return sum > (kBendSums - 1) / 2; });
    return large > kDenseGroups / 8;
  };
  while (predict() && bend_shift + 4 < kBits<T>) bend_shift += 4;
  const Choice choice = choose(m.residuals);
  m.unary.begin(std::size_t{kDenseNumbers} * (kLongestUnary + 1) / 8);
  m.flags.begin(kDenseGroups / 8);
  m.low.begin(std::size_t{kDenseNumbers} * sizeof(T) + kDenseGroups);
  m.patches.clear();
  for (std::size_t g = 0; g < kDenseGroups; ++g) m.write_group(g, choice, square, places);
  m.unary.end_byte();
  m.flags.end_byte();
  append(out, static_cast<std::uint8_t>(bend_shift));
  append(out, static_cast<std::uint8_t>(choice.least_bits));
  append(out, static_cast<std::uint16_t>(m.patches.size() / kPatchBytes<T>));
  append(out, static_cast<std::uint16_t>(m.unary.bytes().size()));
  const std::span<const std::byte> flags = m.flags.bytes();
  const bool all_flagged = !flags.empty() && m.unary.bytes().empty();  // a flag of 0 would be followed by numbers
  append(out, all_flagged ? kAllFlagged : static_cast<std::uint16_t>(flags.size()));
  std::uint32_t flagged = 0;
  for (std::size_t of = 0; of < kBendClasses; ++of) flagged |= (choice.is_flagged[of] ? 1u : 0u) << of;
  append(out, flagged);
  const auto nibble = [&](std::size_t of) { return static_cast<unsigned>(choice.low_bits[of] - choice.least_bits); };
  for (std::size_t of = 0; of < kBendClasses; of += 2)
    append(out, static_cast<std::uint8_t>(nibble(of) | nibble(of + 1) << 4));
  for (const std::span<const std::byte> part :
       {std::span<const std::byte>(m.patches), all_flagged ? flags.first(0) : flags, m.unary.bytes(), m.low.bytes()})
    out.insert(out.end(), part.begin(), part.end());
}

template <class T>
bool DenseNumbers<T>::get(std::span<const std::byte> bytes, const SquareBits* stored, std::span<T> square) {
  if (bytes.size() < kHead) return false;
  Memory& m = *memory_;
  DenseStreams& in = m.in;
  in.bend_shift = std::to_integer<int>(bytes[0]);
  const int least_bits = std::to_integer<int>(bytes[1]);
  in.patches = read<std::uint16_t>(&bytes[2]);
  in.unary_bytes = read<std::uint16_t>(&bytes[4]);
  in.flag_bytes = read<std::uint16_t>(&bytes[6]);
  in.all_flagged = in.flag_bytes == kAllFlagged;
  if (in.all_flagged) in.flag_bytes = 0;
  const std::size_t in_front = kHead + in.patches * kPatchBytes<T> + in.flag_bytes + in.unary_bytes;
  if (in.bend_shift >= kBits<T> || least_bits + kChoices > kBits<T> || in.flag_bytes > kDenseGroups / 8 ||
      in.patches > kDenseNumbers || in_front > bytes.size())
    return false;
  in.low_bytes = bytes.size() - in_front;
  if (in.low_bytes > kDenseNumbers * sizeof(T)) return false;

  std::array<std::uint8_t, kBendClasses> low_bits_of{};
  const auto flagged = read<std::uint32_t>(&bytes[8]);
  if (flagged >> kBendClasses != 0) return false;
  for (std::size_t of = 0; of < kBendClasses; ++of) {
    const auto nibble = std::to_integer<unsigned>(bytes[12 + of / 2]) >> (4 * (of & 1)) & 15;
    low_bits_of[of] = static_cast<std::uint8_t>(static_cast<unsigned>(least_bits) + nibble +
                                                ((flagged >> of & 1) != 0 ? unsigned{kFlagged} : 0));
  }
  for (std::size_t i = 0; i < kBendPlaces; ++i) in.low_bits_of[i] = low_bits_of[kClassesOfPlaces[i]];
  const std::byte* from = bytes.data() + kHead;
  m.patched.resize(in.patches);
  m.patch_values.resize(in.patches);
  for (std::size_t i = 0; i < in.patches; ++i, from += kPatchBytes<T>) {
    m.patched[i] = read<std::uint16_t>(from);
    if (m.patched[i] >= kDenseSide * kDenseSide) return false;
    m.patch_values[i] = read<T>(from + 2);
  }
  in.patched = m.patched.data();
  in.patch_values = m.patch_values.data();
  // Flags come last in memory, because kernels may read far behind low bits and a little behind flags.
  const std::size_t size = in.unary_bytes + in.low_bytes + kBehind;
  m.streams.resize(std::max(m.streams.size(), size + kDenseGroups / 8 + 8));
  std::uint8_t* to = m.streams.data();
  std::memcpy(to, from + in.flag_bytes, in.unary_bytes + in.low_bytes);
  std::memcpy(to + size, from, in.flag_bytes);
  if (in.all_flagged) std::memset(to + size, 0xff, kDenseGroups / 8 + 8);
  in.unary = to;
  in.low = to + in.unary_bytes;
  in.flags = to + size;
  in.stored = stored != nullptr ? stored->data() : nullptr;
  return m.functions.read(in, square.data(), m.work);
}

template class DenseNumbers<std::uint16_t>;
template class DenseNumbers<std::uint32_t>;
template class DenseNumbers<std::uint64_t>;

}  // namespace talus
