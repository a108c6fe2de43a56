#pragma once
// Whole numbers, mostly small ones, as bits: a static tANS coder with fixed distributions.
//
// Every number is put under a context, a small integer that says what kind of number it is and how large it
// may be; both sides know it. For each context the writer names the one of kDistributions that fits best, so
// a page carries one byte a context and no tables. A number becomes a token (its leading bits), coded with
// as many bits as the token is unlikely, and the bits below them as they are. Four states take turns, so that
// a processor works on four numbers at once. docs/format has the bits.
//
// source  asymmetric numeral systems, J. Duda, arXiv:1311.2540; the table's spread is that of Zstandard's FSE

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace talus {

inline constexpr int kContexts = 96;
inline constexpr int kDistributions = 96;

/// Collects numbers, then writes them all.
class NumberWriter {
 public:
  void put(std::uint64_t number, int context);
  template <class Number>
  void put(const Number* numbers, std::span<const std::uint8_t> contexts) {
    numbers_.insert(numbers_.end(), numbers, numbers + contexts.size());
    contexts_.insert(contexts_.end(), contexts.begin(), contexts.end());
  }
  /// Appends what was put to `out`. Nothing may follow it there.
  void finish(std::vector<std::byte>& out);
  /// About how many bits the numbers of contexts from `first` up to `end` take. For measurements.
  [[nodiscard]] double bits(int first, int end) const;
  /// Forgets what was put, keeps the memory.
  void clear() { numbers_.clear(), contexts_.clear(); }

 private:
  std::vector<std::uint64_t> numbers_;
  std::vector<std::uint8_t> contexts_;
  std::vector<std::byte> backward_;  ///< memory of finish
};

/// Gives them back one by one, or many at once. Whatever the bytes are, every call returns some number and reads
/// nothing out of bounds; is_intact() tells at the end.
class NumberReader {
 public:
  /// `bytes` all that finish() wrote. Copied.
  void start(std::span<const std::byte> bytes);
  [[nodiscard]] std::uint64_t get(int context);
  /// The same for one number a context; numbers beyond 32 bits are cut off.
  void get(std::span<const std::uint8_t> contexts, std::uint32_t* numbers);
  void get(std::span<const std::uint8_t> contexts, std::uint64_t* numbers);
  /// All bits were read, and no others.
  [[nodiscard]] bool is_intact() const;

 private:
  template <class Number, class Take>
  void get_many(std::span<const std::uint8_t> contexts, Number* numbers, Take&& take);

  std::vector<std::byte> bytes_;
  std::size_t size_ = 0;        // of the bits, in bytes; zeros follow
  std::uint64_t position_ = 0;  // in bits
  std::uint32_t state_[4]{};
  unsigned turn_ = 0;
  bool started_well_ = false;
  std::uint8_t distribution_[kContexts]{};
};

}  // namespace talus
