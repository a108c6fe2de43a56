#pragma once
// What verify has found so far, and where.

#include <map>
#include <string>
#include <tuple>

#include "engine/page/page_layout.hpp"
#include "talus/database.hpp"

namespace talus {

class Findings {
 public:
  Findings(VerifyReport& report, const Description& description) : report_(report), description_(description) {}

  /// About a page: answers that need its square may be refused, or wrong.
  void in(PageId page, const std::string& sentence);
  /// About a rectangle; without a sample of the extent it is about everything.
  void in(GridRect samples, const std::string& sentence);
  /// About something that all answers depend on.
  void everywhere(const std::string& sentence);
  /// About the file, beside what is found in its pages.
  void of_file(const std::string& sentence) { add(sentence); }
  /// The database is sound in itself, and is not what it was held against.
  void difference(const std::string& sentence);

  [[nodiscard]] std::uint64_t count() const { return report_.finding_count; }

 private:
  void add(const std::string& sentence);

  VerifyReport& report_;
  const Description& description_;
  std::map<std::tuple<int, int, int, int>, std::size_t> places_;  ///< of rectangles in the report
};

[[nodiscard]] std::string name_of(PageId id);

}  // namespace talus
