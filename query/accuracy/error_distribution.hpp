#pragma once
// How far many samples lie from a surface.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace talus {

/// Distances counted by size, in memory that does not grow with them: 256 classes from each power of two to the next,
/// from 10⁻¹² m to 1.6·10⁷ m, and of each class the largest distance.
class ErrorDistribution {
 public:
  /// metres  at least 0, infinity allowed
  void add(double metres);
  ErrorDistribution& operator+=(const ErrorDistribution& other);

  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] double largest() const { return largest_; }  ///< 0 of no samples
  [[nodiscard]] double rms() const;                          ///< 0 of no samples
  /// The least distance within which this share of the samples lies, as a distance that was added: never too small, and
  /// at most one part in 256 too large. Exact where its class holds one distance only, as with heights in whole steps.
  /// share  above 0, at most 1
  [[nodiscard]] double within(double share) const;

 private:
  struct Class {
    std::uint64_t count = 0;
    double largest = 0;
  };
  std::vector<Class> classes_;  ///< empty: nothing was added
  std::uint64_t samples_ = 0;
  long double squares_ = 0;
  double largest_ = 0;
};

}  // namespace talus
