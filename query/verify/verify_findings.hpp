#pragma once
// Collects the findings of verify and their places.

#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "engine/page/page_layout.hpp"
#include "talus/database.hpp"

namespace talus {

class Findings {
 public:
  Findings(VerifyReport& report, const Description& description) : report_(report), description_(description) {}

  /// A finding in a page. Answers that need its square may fail or be wrong.
  void in(PageId page, const std::string& sentence);
  /// A finding in a rectangle; if that has no sample of the extent, a finding about everything.
  void in(GridRect samples, const std::string& sentence);
  /// A finding that concerns all answers.
  void everywhere(const std::string& sentence);
  /// A finding about the file that concerns no answer.
  void of_file(const std::string& sentence) { add(sentence); }
  /// A difference between a sound database and the truth it was compared with.
  void difference(const std::string& sentence);

  [[nodiscard]] std::uint64_t count() const { return report_.finding_count; }

 private:
  void add(const std::string& sentence);

  VerifyReport& report_;
  const Description& description_;
  std::map<std::tuple<int, int, int, int>, std::size_t> places_;  ///< indices of rectangles in the report
};

[[nodiscard]] std::string name_of(PageId id);
/// Bit for bit.
[[nodiscard]] inline bool is_same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

}  // namespace talus
