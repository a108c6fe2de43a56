#include "app/options/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus::app {
namespace {

// The whole word is a number; the point is '.' in any locale.
std::optional<double> number(std::string_view word) {
  double value = 0;
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || std::isnan(value)) return std::nullopt;
  return value;
}

// Finite numbers with commas or blanks between them; empty if the word is anything else.
std::vector<double> numbers_in(std::string_view word) {
  constexpr std::string_view kBlank = " \t\r";
  std::vector<double> numbers;
  numbers.reserve(4);  // points are read by the million
  const auto skip_blank = [&] { word.remove_prefix(std::min(word.find_first_not_of(kBlank), word.size())); };
  skip_blank();
  for (;;) {
    const std::size_t end = std::min(word.find_first_of(" \t\r,"), word.size());
    const std::optional<double> value = number(word.substr(0, end));
    if (!value || !std::isfinite(*value)) return {};
    numbers.push_back(*value);
    word.remove_prefix(end);
    skip_blank();
    if (word.empty()) return numbers;
    if (!word.starts_with(',')) continue;
    word.remove_prefix(1);
    skip_blank();
  }
}

// Options that take numbers, and the most numbers that one value has.
struct NumberOption {
  std::string_view name;
  std::size_t most;
};
constexpr std::size_t kAny = 1 << 20;
constexpr NumberOption kNumberOptions[] = {
    {"--bbox", 4},   {"--point", 2},       {"--line", kAny}, {"--focus", 3},   {"--tolerances", kAny},
    {"--tr", 2},     {"--tolerance", 1},   {"--from", 1},    {"--surface", 1}, {"--map", 1},
    {"--nodata", 1}, {"--void-weight", 1}, {"--time", 1},    {"--quantum", 1}, {"--height-step", 1},
};

const NumberOption* number_option(std::string_view name) {
  const auto* found =
      std::find_if(std::begin(kNumberOptions), std::end(kNumberOptions), [&](const auto& o) { return o.name == name; });
  return found == std::end(kNumberOptions) ? nullptr : found;
}

// How many numbers a word holds; 0 if it holds anything else. Commas may stand at its ends.
std::size_t count_of_numbers(std::string_view word) {
  while (word.ends_with(',')) word.remove_suffix(1);
  while (word.starts_with(',')) word.remove_prefix(1);
  return numbers_in(word).size();
}

// "-o,--output" is --output in sentences.
std::string_view long_name(std::string_view names) { return names.substr(names.rfind(',') + 1); }

// The unit that a word ends in, which is cut off; 1 where it has none.
double take_unit(std::string_view& word, std::initializer_list<std::pair<std::string_view, double>> units) {
  for (const auto& [name, times] : units) {
    if (!word.ends_with(name)) continue;
    word.remove_suffix(name.size());
    return times;
  }
  return 1;
}

// How many letters to add, remove, replace or swap with the next one.
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> least(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        least[i][j] = i + j;
        continue;
      }
      least[i][j] =
          std::min({least[i - 1][j] + 1, least[i][j - 1] + 1, least[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        least[i][j] = std::min(least[i][j], least[i - 2][j - 2] + 1);
    }
  }
  return least.back().back();
}

std::optional<double> finite(std::string_view word) {
  const std::optional<double> value = number(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<Metres> tolerance(std::string_view word) {
  const std::optional<double> value = number(word);
  if (!value || *value < 0) return {};
  return Metres{std::abs(*value)};  // -0 is 0
}

std::optional<std::vector<Metres>> tolerances(std::string_view word) {
  std::vector<Metres> metres;
  for (const double value : numbers_in(word)) {
    if (value < 0) return {};
    metres.emplace_back(std::abs(value));
  }
  if (metres.empty()) return {};
  return metres;
}

std::optional<Metres> metres_above_zero(std::string_view word) {
  const std::optional<double> value = finite(word);
  if (!value || *value <= 0) return {};
  return Metres{*value};
}

std::optional<double> seconds(std::string_view word) {
  const double unit = take_unit(word, {{"ms", 1e-3}, {"s", 1}, {"", 0}});
  const std::optional<double> value = finite(word);
  if (!value || !(*value * unit > 0)) return {};
  return *value * unit;
}

std::optional<double> weight(std::string_view word) {
  const std::optional<double> value = finite(word);
  return value && *value >= 0 ? value : std::nullopt;
}

std::optional<double> nodata(std::string_view word) {
  return word == "nan" || word == "NaN" ? std::nan("") : number(word);
}

std::optional<std::uint64_t> bytes(std::string_view word) {
  const double unit = take_unit(word, {{"KiB", 1 << 10},
                                       {"MiB", 1 << 20},
                                       {"GiB", 1 << 30},
                                       {"kB", 1e3},
                                       {"MB", 1e6},
                                       {"GB", 1e9},
                                       {"K", 1 << 10},
                                       {"M", 1 << 20},
                                       {"G", 1 << 30}});
  const std::optional<double> value = number(word);
  if (!value || !(*value * unit >= 1) || *value * unit > 1e15) return {};
  return static_cast<std::uint64_t>(*value * unit);
}

std::optional<std::pair<double, double>> cell(std::string_view word) {
  const std::vector<double> size = numbers_in(word);
  if (size.empty() || size.size() > 2 || !(size.front() > 0) || !(size.back() > 0)) return {};
  return std::pair{size.front(), size.back()};
}

std::optional<Rectangle> box(std::string_view word) {
  const std::vector<double> sides = numbers_in(word);
  if (sides.size() != 4) return {};
  return Rectangle{sides[0], sides[1], sides[2], sides[3]};
}

std::optional<Position> point(std::string_view word) {
  const std::vector<double> xy = numbers_in(word);
  if (xy.size() != 2) return {};
  return Position{xy[0], xy[1]};
}

std::optional<std::vector<Position>> line(std::string_view word) {
  const std::vector<double> numbers = numbers_in(word);
  if (numbers.size() < 4 || numbers.size() % 2 != 0) return {};
  std::vector<Position> points;
  for (std::size_t i = 0; i < numbers.size(); i += 2) points.push_back({numbers[i], numbers[i + 1]});
  return points;
}

std::optional<Focus> focus(std::string_view word) {
  const std::vector<double> numbers = numbers_in(word);
  if (numbers.size() != 3 || numbers[2] < 0) return {};
  return Focus{numbers[0], numbers[1], numbers[2]};
}

}  // namespace

const Kind<Metres> kTolerance{"metres, 0 or more, or inf", tolerance};
const Kind<std::vector<Metres>> kTolerances{"metres, 0 or more, with commas between", tolerances};
const Kind<Metres> kMetresAboveZero{"metres above 0", metres_above_zero};
const Kind<double> kSeconds{"a time such as 10ms or 0.5s", seconds};
const Kind<double> kWeight{"a number, 0 or more", weight};
const Kind<double> kNodata{"a number or nan", nodata};
const Kind<std::uint64_t> kBytes{"bytes such as 512MiB or 2GB", bytes};
const Kind<std::pair<double, double>> kCell{"the size of a cell, DX,DY, both above 0", cell};
const Kind<Rectangle> kBox{"four numbers, XMIN,YMIN,XMAX,YMAX", box};
const Kind<Position> kPoint{"two numbers, X,Y", point};
const Kind<std::vector<Position>> kLine{"two points or more, X,Y,X,Y", line};
const Kind<Focus> kFocus{"X,Y,M, with M of 0 or more", focus};

void refuse(std::string_view names, std::string_view expected, std::string_view word) {
  throw Failure(Cause::invalid_argument, fmt::format("{} takes {}, not \"{}\"", long_name(names), expected, word));
}

std::int64_t read_whole(std::string_view names, std::string_view word, std::int64_t least, std::int64_t most) {
  std::string_view digits = word;
  const double unit = take_unit(digits, {{"k", 1e3}, {"K", 1e3}, {"M", 1e6}, {"G", 1e9}});
  const std::optional<double> value = number(digits);
  const double whole = value ? std::round(*value * unit) : 0;
  const bool is_whole = value && std::abs(whole - *value * unit) <= 1e-6 && std::abs(whole) <= 0x1p53;
  if (is_whole && whole >= static_cast<double>(least) && whole <= static_cast<double>(most))
    return static_cast<std::int64_t>(whole);
  refuse(names,
         most < 1'000'000 ? fmt::format("a whole number from {} to {}", least, most)
                          : fmt::format("a whole number of at least {}{}", least,
                                        most > 0x7fffffff ? ", such as 100000, 1e5 or 100k" : ""),
         word);
}

std::string listed(const std::vector<std::string>& words, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : fmt::format(" {} ", last)) + words[i];
  return text;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  const auto bare = [](std::string_view name) {
    return name.substr(std::min(name.find_first_not_of('-'), name.size()));
  };
  word = bare(word);
  // One letter in three may be wrong, or the end may be missing.
  std::size_t least = std::max<std::size_t>(word.size() / 3, 1) + 1;
  std::string nearest;
  for (const std::string& name : names) {
    const bool is_begun = word.size() >= 3 && bare(name).starts_with(word);
    const std::size_t distance = is_begun ? 1 : edits(word, bare(name));
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest);
}

std::string is_named(const std::string& word) { return word.empty() ? "expected a file name, not an empty word" : ""; }

std::vector<std::string> join_numbers(std::vector<std::string> arguments) {
  std::vector<std::string> joined;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string word = arguments[i];
    if (word == "--") {
      joined.insert(joined.end(), arguments.begin() + static_cast<std::ptrdiff_t>(i), arguments.end());
      break;
    }
    const std::size_t equals = word.find('=');
    const NumberOption* option = number_option(std::string_view(word).substr(0, equals));
    if (option == nullptr) {
      joined.push_back(word.starts_with("-.") ? "-0" + word.substr(1) : word);
      continue;
    }
    std::size_t count = equals == std::string::npos ? 0 : count_of_numbers(std::string_view(word).substr(equals + 1));
    bool is_begun = equals != std::string::npos;
    while (i + 1 < arguments.size() && (!is_begun || count > 0)) {
      const std::string& next = arguments[i + 1];
      const std::size_t more = count_of_numbers(next);
      // The first word belongs to the option if it looks like a negative number.
      const bool is_value =
          more > 0 ? count + more <= option->most : !is_begun && next.size() > 1 && next[0] == '-' && next[1] != '-';
      if (!is_value) break;
      word += (is_begun ? (word.ends_with(',') || next.starts_with(',') ? "" : ",") : "=") + next;
      is_begun = true;
      count += more;
      ++i;
      if (more == 0) break;
    }
    joined.push_back(word);
  }
  return joined;
}

}  // namespace talus::app
