#pragma once
// The one type Talus throws.

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace talus {

/// Why something could not be done. The numbers are part of the interface and never change meaning.
enum class Cause : int {
  invalid_argument = 1,  ///< the caller asked for something that has no answer
  not_found = 2,         ///< no such file
  corrupt = 3,           ///< not a database, or a damaged one
  unsupported = 4,       ///< another version, or an input Talus does not take
  full = 5,              ///< the disk is full
  io = 6,                ///< reading or writing failed
  cancelled = 7,         ///< the caller's std::stop_token asked for the end
  too_large = 8,         ///< the answer needs more than the caller's limits allow, see Limits
  out_of_memory = 9,     ///< the system has no memory left to give
};

[[nodiscard]] std::string_view to_string(Cause cause);

/// A failure and the sentence that explains it: which file, which value, what was expected, what to do.
///
/// Where a field of an options struct would help, the sentence names it in full, for instance
/// `InputOptions::allow_outside`; a program that offers it under another name can replace the word.
class Failure : public std::runtime_error {
 public:
  /// file  the file that is at fault, as the caller named it; empty: no file is
  Failure(Cause cause, const std::string& sentence, std::filesystem::path file = {})
      : std::runtime_error(sentence), cause_(cause), file_(std::move(file)) {}
  [[nodiscard]] Cause cause() const noexcept { return cause_; }
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

 private:
  Cause cause_;
  std::filesystem::path file_;
};

/// work(); a failure of it that names no file names this one.
template <class Work>
decltype(auto) blaming(const std::filesystem::path& file, Work&& work) {
  try {
    return work();
  } catch (const Failure& failure) {
    if (!failure.file().empty()) throw;
    throw Failure(failure.cause(), failure.what(), file);
  }
}

/// work() at a public door: where the system has no memory left, the caller gets a Failure with Cause::out_of_memory.
template <class Work>
decltype(auto) within_memory(Work&& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw Failure(Cause::out_of_memory, "out of memory");
  } catch (const std::length_error&) {  // more than a container can ever hold
    throw Failure(Cause::out_of_memory, "out of memory");
  }
}

}  // namespace talus
