#include "app/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus::app {
namespace {

// '.' in any locale, and the whole word or nothing.
std::optional<double> number(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || std::isnan(value)) return std::nullopt;
  return value;
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

Rectangle parse_bbox(const std::string& word) {
  std::vector<double> numbers;
  for (std::string_view rest = word;;) {
    const std::size_t comma = rest.find(',');
    const std::optional<double> value = number(rest.substr(0, comma));
    if (!value || !std::isfinite(*value)) {
      numbers.clear();
      break;
    }
    numbers.push_back(*value);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (numbers.size() != 4) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--bbox takes four numbers, XMIN,YMIN,XMAX,YMAX; \"{}\" is not that", word));
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
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

double parse_height_step(const std::string& word) {
  const std::optional<double> value = number(word);
  if (!value || !(*value > 0) || !std::isfinite(*value)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--height-step takes metres, more than 0; \"{}\" is not that", word));
  }
  return *value;
}

bool parse_priority(const std::string& word) {
  if (word == "later") return false;
  if (word == "resolution") return true;
  throw Failure(Cause::invalid_argument,
                fmt::format("--priority takes later or resolution; \"{}\" is neither", word));
}

std::string is_named(const std::string& word) {
  return word.empty() ? "a file name is expected, not an empty word" : "";
}

std::vector<std::string> join_numbers(std::vector<std::string> arguments) {
  std::vector<std::string> joined;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const bool takes_number = word == "--bbox" || word == "--tolerance" || word == "--from" || word == "--void-weight";
    if (takes_number && i + 1 < arguments.size() && arguments[i + 1].size() > 1 && arguments[i + 1][0] == '-' &&
        arguments[i + 1][1] != '-') {
      joined.push_back(word + "=" + arguments[++i]);
    } else {
      joined.push_back(word);
    }
  }
  return joined;
}

}  // namespace talus::app
