#pragma once
// Random numbers that are the same on every machine: the distributions of <random> are not.

#include <cmath>
#include <cstdint>

namespace talus::support {

/// SplitMix64. Good enough for terrains, and a seed is one number that a failing test can print.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  /// From first to last, both included.
  int between(int first, int last) {
    const auto choices = static_cast<std::uint64_t>(std::int64_t{last} - first) + 1;
    return static_cast<int>(first + static_cast<std::int64_t>(next() % choices));
  }
  /// From 0 up to, not including, 1.
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double within(double low, double high) { return low + (high - low) * unit(); }
  /// Small and large values are equally likely per power of ten; low > 0.
  double log_between(double low, double high) { return low * std::pow(high / low, unit()); }
  bool chance(double probability) { return unit() < probability; }

 private:
  std::uint64_t state_;
};

}  // namespace talus::support
