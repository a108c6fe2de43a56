#pragma once
// The one type Talus throws.

#include <stdexcept>
#include <string>
#include <string_view>

namespace talus {

/// Why something could not be done. The numbers are part of the interface and never change meaning.
enum class Cause : int {
  invalid_argument = 1,  ///< the caller asked for something that has no answer
  not_found = 2,         ///< no such file
  corrupt = 3,           ///< not a database, or a damaged one
  unsupported = 4,       ///< another version, or an input Talus does not take
  full = 5,              ///< the disk is full
  io = 6,                ///< reading or writing failed
};

[[nodiscard]] std::string_view to_string(Cause cause);

/// A failure and the sentence that explains it: which file, which value, what was expected.
class Failure : public std::runtime_error {
 public:
  Failure(Cause cause, const std::string& sentence) : std::runtime_error(sentence), cause_(cause) {}
  [[nodiscard]] Cause cause() const noexcept { return cause_; }

 private:
  Cause cause_;
};

}  // namespace talus
