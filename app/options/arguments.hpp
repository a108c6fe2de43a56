#pragma once
// Words of the command line, and the values they stand for.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/question.hpp"
#include "talus/units.hpp"

namespace talus::app {

/// A kind of value: what a person types, and how it is read.
template <class T>
struct Kind {
  const char* expected;
  std::optional<T> (*read)(std::string_view word);
};

/// --focus: a point, and how much the tolerance grows with each metre from it.
struct Focus {
  double x, y, metres_per_metre;
};

extern const Kind<Metres> kTolerance, kMetresAboveZero;  // inf is a tolerance
extern const Kind<std::vector<Metres>> kTolerances;      // "1,5,20", all finite
extern const Kind<double> kSeconds;                      // "10ms", "0.5s"
extern const Kind<double> kWeight, kNodata;              // a weight is 0 or more; no data may be nan
extern const Kind<std::uint64_t> kBytes;                 // "512MiB", "2GB", "1e9"
extern const Kind<std::pair<double, double>> kCell;      // "DX,DY", or one number for both
extern const Kind<Rectangle> kBox;                       // "XMIN,YMIN,XMAX,YMAX"
extern const Kind<Position> kPoint;                      // "X,Y" or "X Y"
extern const Kind<std::vector<Position>> kLine;          // "X,Y,X,Y": two points or more
extern const Kind<Focus> kFocus;                         // "X,Y,M"

/// Longest line of a file of points, in bytes.
inline constexpr std::size_t kLongestPointLine = 4096;
/// Most points of a file.
inline constexpr std::size_t kMostPoints = 10'000'000;

/// "--tolerance takes metres, 0 or more, or inf, not \"west\"".
[[noreturn]] void refuse(std::string_view names, std::string_view expected, std::string_view word);

/// names  of the option, the longest last: "-o,--output"
/// fails  invalid_argument
template <class T>
T read(const Kind<T>& kind, std::string_view names, std::string_view word) {
  if (auto value = kind.read(word)) return *std::move(value);
  refuse(names, kind.expected, word);
}

/// 1e5, 100k and 2.5M (a k is a thousand) are whole numbers, too.
/// fails  invalid_argument
[[nodiscard]] std::int64_t read_whole(std::string_view names, std::string_view word, std::int64_t least,
                                      std::int64_t most);

/// Names of the values of an enum.
template <class T>
using Names = std::vector<std::pair<const char*, T>>;

/// The name that a mistyped word was meant to be: "; did you mean clip?". Empty where none is close.
[[nodiscard]] std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);
/// "a, b and c", or with another last word.
[[nodiscard]] std::string listed(const std::vector<std::string>& words, const char* last = "and");

/// fails  invalid_argument: lists the names
template <class T>
T named(const Names<T>& choices, std::string_view option, std::string_view word) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (name == word) return value;
    names.emplace_back(name);
  }
  throw Failure(Cause::invalid_argument,
                fmt::format("{} takes {}, not \"{}\"{}", option, listed(names, "or"), word, did_you_mean(word, names)));
}
template <class T>
const char* name_in(const Names<T>& choices, T value) {
  for (const auto& [name, chosen] : choices) {
    if (chosen == value) return name;
  }
  return "";
}

/// What is wrong with the name of a file; empty: nothing. CLI11 wants a check like this.
[[nodiscard]] std::string is_named(const std::string& word);

/// Joins "--bbox -1 2 3 4" to "--bbox=-1,2,3,4" and makes -.5 -0.5, because a negative number looks like an option.
[[nodiscard]] std::vector<std::string> join_numbers(std::vector<std::string> arguments);

}  // namespace talus::app
