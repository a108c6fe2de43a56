#pragma once
// Failure: the only exception type that Talus throws.

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace talus {

/// Why something failed. The numbers are part of the interface and keep their meaning.
enum class Cause : int {
  invalid_argument = 1,  ///< an argument is wrong
  not_found = 2,         ///< the file does not exist
  corrupt = 3,           ///< the file is damaged, or is not a database
  unsupported = 4,       ///< the file has another version, or Talus cannot read this input
  full = 5,              ///< the disk is full
  io = 6,                ///< reading or writing failed
  cancelled = 7,         ///< the caller's std::stop_token asked to stop
  too_large = 8,         ///< the answer needs more than the caller's Limits allow
  out_of_memory = 9,     ///< the system has no free memory
};

[[nodiscard]] std::string_view to_string(Cause cause);

/// A cause and a sentence: which file or value, what is wrong, what to do. Sentences about damage begin with "corrupt: ".
///
/// Where an option would help, the sentence has its full name, for instance `InputOptions::allow_outside`. A program
/// that has another name for the option can replace it.
class Failure : public std::runtime_error {
 public:
  /// file  the file at fault, as the caller named it; empty: no file is at fault
  Failure(Cause cause, const std::string& sentence, std::filesystem::path file = {})
      : std::runtime_error(sentence), cause_(cause), file_(std::move(file)) {}
  [[nodiscard]] Cause cause() const noexcept { return cause_; }
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

 private:
  Cause cause_;
  std::filesystem::path file_;
};

/// Runs work(). A failure that names no file gets `file`.
template <class Work>
decltype(auto) blaming(const std::filesystem::path& file, Work&& work) {
  try {
    return work();
  } catch (const Failure& failure) {
    if (!failure.file().empty()) throw;
    throw Failure(failure.cause(), failure.what(), file);
  }
}

/// Runs work(). When memory runs out, throws a Failure with Cause::out_of_memory.
template <class Work>
decltype(auto) within_memory(Work&& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw Failure(Cause::out_of_memory, "out of memory");
  } catch (const std::length_error&) {  // the array would be longer than any container allows
    throw Failure(Cause::out_of_memory, "out of memory");
  }
}

}  // namespace talus
