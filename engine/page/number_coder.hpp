#pragma once
// A coder for mostly small whole numbers: static tANS with fixed distributions. docs/format has the bits.
//
// Each number has a context, a small integer that both sides know: the kind of the number and its likely size. The
// writer chooses the best of kDistributions for each context, so a page has one byte a context and no tables. A number
// becomes a token (its leading bits), which costs as many bits as it is unlikely, and the bits below. Four states take
// turns, so that a processor works on four numbers at once.
//
// source  asymmetric numeral systems, J. Duda, arXiv:1311.2540; the spread of the table is that of Zstandard's FSE

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace talus {

inline constexpr int kContexts = 96;
inline constexpr int kDistributions = 96;

/// Collects numbers, then writes all of them.
class NumberWriter {
 public:
  void put(std::uint64_t number, int context);
  /// Appends all numbers to `out`. Nothing may follow them there.
  void finish(std::vector<std::byte>& out);
  /// Approximate size in bits of the numbers with contexts `first` to `end` - 1. For measurements.
  [[nodiscard]] double bits(int first, int end) const;
  /// Removes all numbers, but keeps the memory.
  void clear() { numbers_.clear(), contexts_.clear(); }

 private:
  std::vector<std::uint64_t> numbers_;
  std::vector<std::uint8_t> contexts_;
  std::vector<std::byte> backward_;  ///< reused by finish
};

/// Reads the numbers. With damaged bytes every call still returns a number and reads nothing out of bounds; is_intact()
/// says at the end whether they were damaged.
class NumberReader {
 public:
  /// bytes  everything that finish() wrote; copied
  void start(std::span<const std::byte> bytes);
  [[nodiscard]] std::uint64_t get(int context);
  /// Whether exactly all bits were read.
  [[nodiscard]] bool is_intact() const;

 private:
  std::vector<std::byte> bytes_;
  std::size_t size_ = 0;        // in bytes; zeros follow
  std::uint64_t position_ = 0;  // in bits
  std::uint32_t state_[4]{};
  unsigned turn_ = 0;
  bool started_well_ = false;
  std::uint8_t distribution_[kContexts]{};
};

}  // namespace talus
