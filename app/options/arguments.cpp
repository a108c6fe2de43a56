#include "app/options/arguments.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus::app {
namespace {

// '.' in any locale, and the whole word or nothing.
std::optional<double> number(std::string_view word) {
  double value = 0;
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || std::isnan(value)) return std::nullopt;
  return value;
}

// Finite numbers with a comma or blanks between two of them; none if it is not that.
std::vector<double> numbers_in(std::string_view word) {
  constexpr std::string_view kBlank = " \t\r";
  std::vector<double> numbers;
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

// Options whose words are numbers, and how many at most make a value: "--bbox 1 2 3 4" is "--bbox=1,2,3,4".
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

// Of a word that holds nothing but numbers, commas at its ends allowed; else 0.
std::size_t count_of_numbers(std::string_view word) {
  while (word.ends_with(',')) word.remove_suffix(1);
  while (word.starts_with(',')) word.remove_prefix(1);
  return numbers_in(word).size();
}

}  // namespace

Metres parse_tolerance(const std::string& word, const char* option) {
  const std::optional<double> value = number(word);
  if (!value || *value < 0) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} takes metres, 0 or more, or inf; \"{}\" is not that", option, word));
  }
  return Metres{std::abs(*value)};  // -0 is 0
}

std::vector<Metres> parse_tolerances(const std::string& word, const char* option) {
  const std::vector<double> numbers = numbers_in(word);
  std::vector<Metres> tolerances;
  for (const double value : numbers) {
    if (value >= 0) tolerances.emplace_back(std::abs(value));  // -0 is 0
  }
  if (tolerances.empty() || tolerances.size() < numbers.size()) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} takes metres, 0 or more, with commas between; \"{}\" is not that", option, word));
  }
  return tolerances;
}

double parse_time(const std::string& word) {
  std::string_view digits = word;
  double unit = 0;
  if (digits.ends_with("ms")) {
    unit = 1e-3;
    digits.remove_suffix(2);
  } else if (digits.ends_with("s")) {
    unit = 1;
    digits.remove_suffix(1);
  }
  const std::optional<double> value = number(digits);
  if (unit == 0 || !value || !(*value * unit > 0) || !std::isfinite(*value)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--time takes a time, as 10ms or 0.5s; \"{}\" is not that", word));
  }
  return *value * unit;
}

Rectangle parse_bbox(const std::string& word) {
  const std::vector<double> numbers = numbers_in(word);
  if (numbers.size() != 4) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--bbox takes four numbers, XMIN,YMIN,XMAX,YMAX; \"{}\" is not that", word));
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

std::vector<Position> parse_line(const std::string& word) {
  const std::vector<double> numbers = numbers_in(word);
  if (numbers.size() < 4 || numbers.size() % 2 != 0) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--line takes two points or more, X,Y,X,Y; \"{}\" is not that", word));
  }
  std::vector<Position> line;
  for (std::size_t i = 0; i < numbers.size(); i += 2) line.push_back({numbers[i], numbers[i + 1]});
  return line;
}

std::optional<Position> parse_position(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  std::array<double, 2> xy{};
  const auto skip_blank = [&] { text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size())); };
  for (std::size_t i = 0; i < 2; ++i) {
    skip_blank();
    const std::size_t end = std::min(text.find_first_of(" \t\r,"), text.size());
    const std::optional<double> value = number(text.substr(0, end));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    xy[i] = *value;
    text.remove_prefix(end);
    skip_blank();
    if (i == 0 && text.starts_with(',')) text.remove_prefix(1);
  }
  if (!text.empty()) return std::nullopt;
  return Position{xy[0], xy[1]};
}

double parse_weight(const std::string& word) {
  const std::optional<double> value = number(word);
  if (!value || *value < 0 || !std::isfinite(*value)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--void-weight takes a number, 0 or more; \"{}\" is not that", word));
  }
  return *value;
}

std::uint64_t parse_bytes(const std::string& word) {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"KiB", 1 << 10}, {"MiB", 1 << 20}, {"GiB", 1 << 30},
                                                            {"kB", 1e3},      {"MB", 1e6},      {"GB", 1e9},
                                                            {"K", 1 << 10},   {"M", 1 << 20},   {"G", 1 << 30}};
  std::string_view digits = word;
  double unit = 1;
  for (const auto& [name, bytes] : kUnits) {
    if (!digits.ends_with(name)) continue;
    digits.remove_suffix(name.size());
    unit = bytes;
    break;
  }
  const std::optional<double> value = number(digits);
  if (!value || !(*value * unit >= 1) || *value * unit > 1e15) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--memory takes bytes, as 512MiB or 2GB; \"{}\" is not that", word));
  }
  return static_cast<std::uint64_t>(*value * unit);
}

std::pair<double, double> parse_cell(const std::string& word) {
  const std::string_view text = word;
  const std::size_t comma = text.find(',');
  const std::optional<double> dx = number(text.substr(0, comma));
  const std::optional<double> dy = comma == std::string_view::npos ? dx : number(text.substr(comma + 1));
  if (!dx || !dy || !(*dx > 0) || !(*dy > 0) || !std::isfinite(*dx) || !std::isfinite(*dy)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--tr takes the size of cells, DX,DY, both larger than 0; \"{}\" is not that", word));
  }
  return {*dx, *dy};
}

Metres parse_height_step(const std::string& word) {
  const std::optional<double> value = number(word);
  if (!value || !(*value > 0) || !std::isfinite(*value)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--height-step takes metres, more than 0; \"{}\" is not that", word));
  }
  return Metres{*value};
}

double parse_nodata(const std::string& word) {
  if (word == "nan" || word == "NaN") return std::nan("");
  if (const std::optional<double> value = number(word)) return *value;
  throw Failure(Cause::invalid_argument, fmt::format("--nodata takes a number or nan; \"{}\" is not that", word));
}

ColourCode parse_decode(const std::string& word) {
  if (word == "none") return ColourCode::none;
  if (word == "terrain-rgb") return ColourCode::terrain_rgb;
  if (word == "terrarium") return ColourCode::terrarium;
  throw Failure(Cause::invalid_argument,
                fmt::format("--decode takes terrain-rgb or terrarium; \"{}\" is neither", word));
}

bool parse_priority(const std::string& word) {
  if (word == "later") return false;
  if (word == "resolution") return true;
  throw Failure(Cause::invalid_argument, fmt::format("--priority takes later or resolution; \"{}\" is neither", word));
}

ErrorMetric parse_error_metric(const std::string& word) {
  if (const auto metric = error_metric_named(word)) return *metric;
  throw Failure(Cause::invalid_argument,
                fmt::format("--metric takes vertical or perpendicular; \"{}\" is neither", word));
}

Border parse_border(const std::string& word) {
  if (word == "constrain") return Border::constrain;
  if (word == "cover") return Border::cover;
  if (word == "clip") return Border::clip;
  throw Failure(Cause::invalid_argument, fmt::format("--border takes constrain, cover or clip; \"{}\" is none", word));
}

Focus parse_focus(const std::string& word) {
  const std::vector<double> numbers = numbers_in(word);
  if (numbers.size() != 3 || numbers[2] < 0) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--focus takes X,Y,METRES_PER_METRE, the last 0 or more; \"{}\" is not that", word));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

std::string is_named(const std::string& word) {
  return word.empty() ? "a file name is expected, not an empty word" : "";
}

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
      // The first word is the option's if it looks like a negative number, whatever comes of it.
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

std::string whole_number(std::string& word) {
  constexpr std::pair<char, double> kUnits[] = {{'k', 1e3}, {'K', 1e3}, {'M', 1e6}, {'G', 1e9}};
  std::string_view digits = word;
  double unit = 1;
  for (const auto& [letter, times] : kUnits) {
    if (!digits.ends_with(letter)) continue;
    digits.remove_suffix(1);
    unit = times;
    break;
  }
  const std::optional<double> value = number(digits);
  if (!value) return fmt::format("\"{}\" is not a whole number, such as 100000, 1e5 or 100k", word);
  const double whole = std::round(*value * unit);
  if (std::abs(whole - *value * unit) > 1e-6 || std::abs(whole) > 0x1p53)
    return fmt::format("\"{}\" is not a whole number up to 9e15", word);
  word = fmt::format("{:.0f}", whole + 0.0);
  return "";
}

}  // namespace talus::app
