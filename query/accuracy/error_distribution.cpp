#include "query/accuracy/error_distribution.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace talus {
namespace {

// A class is a double's exponent and the first eight bits of its fraction.
constexpr int kDropped = 52 - 8;
constexpr std::uint64_t key(double metres) { return std::bit_cast<std::uint64_t>(metres) >> kDropped; }
constexpr std::uint64_t kLeast = key(0x1p-40), kMost = key(0x1p24) - 1;

}  // namespace

void ErrorDistribution::add(double metres) {
  if (classes_.empty()) classes_.resize(kMost - kLeast + 1);
  Class& of = classes_[std::clamp(key(metres), kLeast, kMost) - kLeast];
  ++of.count;
  of.largest = std::max(of.largest, metres);
  ++samples_;
  squares_ += static_cast<long double>(metres) * metres;
  largest_ = std::max(largest_, metres);
}

ErrorDistribution& ErrorDistribution::operator+=(const ErrorDistribution& other) {
  if (classes_.empty()) classes_.resize(other.classes_.size());
  for (std::size_t i = 0; i < other.classes_.size(); ++i) {
    classes_[i].count += other.classes_[i].count;
    classes_[i].largest = std::max(classes_[i].largest, other.classes_[i].largest);
  }
  samples_ += other.samples_;
  squares_ += other.squares_;
  largest_ = std::max(largest_, other.largest_);
  return *this;
}

double ErrorDistribution::rms() const {
  return samples_ == 0 ? 0 : static_cast<double>(std::sqrt(squares_ / static_cast<long double>(samples_)));
}

double ErrorDistribution::within(double share) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(samples_)));
  std::uint64_t so_far = 0;
  for (const Class& of : classes_) {
    so_far += of.count;
    if (of.count > 0 && so_far >= wanted) return of.largest;
  }
  return largest_;
}

}  // namespace talus
