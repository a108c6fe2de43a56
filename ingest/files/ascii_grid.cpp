#include "ingest/files/ascii_grid.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <vector>

#include "engine/machine/fail.hpp"

namespace talus {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

std::string lower(std::string_view word) {
  std::string all(word);
  for (char& c : all) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return all;
}

bool is_keyword(std::string_view word) {
  constexpr std::array<std::string_view, 11> kWords{"ncols",     "nrows",        "xllcorner", "yllcorner",
                                                    "xllcenter", "yllcenter",    "cellsize",  "dx",
                                                    "dy",        "nodata_value", "nodata"};
  return std::find(kWords.begin(), kWords.end(), lower(word)) != kWords.end();
}

bool is_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return end == word.data() + word.size() && error != std::errc::invalid_argument && !std::isinf(value);
}

}  // namespace

void require_whole_ascii_grid(const std::filesystem::path& file, const std::string& name, int cols, int rows) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> buffer(std::size_t{1} << 16);
  std::string word;
  const std::uint64_t wanted = static_cast<std::uint64_t>(cols) * static_cast<std::uint64_t>(rows);
  std::uint64_t numbers = 0;
  bool in_header = true, is_value = false;
  const auto take = [&] {
    if (word.empty()) return;
    if (in_header && is_value) {
      is_value = false;
    } else if (in_header && is_keyword(word)) {
      is_value = true;
    } else {
      in_header = false;
      if (!is_number(word)) {
        fail_in(name, Cause::unsupported, "{}: column {}, row {} holds \"{}\", not a number. Correct the file", name,
                numbers % static_cast<std::uint64_t>(cols), numbers / static_cast<std::uint64_t>(cols),
                word.substr(0, 40));
      }
      ++numbers;
    }
    word.clear();
  };
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), in.gcount() > 0) {
    for (const char c : std::string_view(buffer.data(), static_cast<std::size_t>(in.gcount()))) {
      if (is_blank(c)) {
        take();
      } else if (word.size() < 400) {
        word += c;
      }
    }
  }
  if (!in.eof()) fail_in(name, Cause::io, "cannot read {}", name);
  take();
  if (numbers == wanted) return;
  fail_in(name, Cause::unsupported,
          "{} has {} numbers, but {} rows of {} need {}: it is cut short, or has a number too few or too many", name,
          numbers, rows, cols, wanted);
}

}  // namespace talus
