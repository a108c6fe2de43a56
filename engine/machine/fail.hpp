#pragma once
// Throwing a Failure whose sentence is formatted.

#include <utility>

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus {

template <class... Args>
[[noreturn]] void fail(Cause cause, fmt::format_string<Args...> sentence, Args&&... args) {
  throw Failure(cause, fmt::format(sentence, std::forward<Args>(args)...));
}
/// The same with the file at fault, which the sentence should name, too.
template <class... Args>
[[noreturn]] void fail_in(const std::filesystem::path& file, Cause cause, fmt::format_string<Args...> sentence,
                          Args&&... args) {
  throw Failure(cause, fmt::format(sentence, std::forward<Args>(args)...), file);
}
/// An argument is wrong.
template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> sentence, Args&&... args) {
  fail(Cause::invalid_argument, sentence, std::forward<Args>(args)...);
}

}  // namespace talus
