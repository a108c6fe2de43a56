#pragma once
// The distribution of the distances of samples from a surface.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace talus {

/// Distances counted in classes, in constant memory: 256 classes from each power of two to the next, from 10⁻¹² m to
/// 1.6·10⁷ m, each with its largest distance.
class ErrorDistribution {
 public:
  /// metres  at least 0, infinity allowed
  void add(double metres);
  ErrorDistribution& operator+=(const ErrorDistribution& other);

  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] double largest() const { return largest_; }  ///< 0 without samples
  [[nodiscard]] double rms() const;                          ///< 0 without samples
  /// The smallest added distance that this share of the samples lies within: never too small, and at most one part in
  /// 256 too large. Exact if its class has a single distance, as with heights in whole steps.
  /// share  above 0, at most 1
  [[nodiscard]] double within(double share) const;

 private:
  struct Class {
    std::uint64_t count = 0;
    double largest = 0;
  };
  std::vector<Class> classes_;  ///< empty before the first add
  std::uint64_t samples_ = 0;
  long double squares_ = 0;
  double largest_ = 0;
};

}  // namespace talus
