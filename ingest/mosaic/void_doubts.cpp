#include "ingest/mosaic/void_doubts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include <fmt/format.h>

namespace talus {
namespace {

constexpr double kSteep = 50;          // metres above or below 0 in one cell: rare at coasts
constexpr std::uint64_t kFewest = 16;  // fewer edges prove nothing
constexpr std::array kLowest{-9999.0, -99999.0, -32768.0, -32767.0, -10000.0, -999.0};
constexpr std::array kHighest{32767.0, 65535.0, 9999.0, 99999.0};

template <std::size_t N>
bool is_one_of(double value, const std::array<double, N>& values) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

}  // namespace

void count_zero_edges(const Window& window, GridRect own, double metres_per_code, ZeroEdges& edges) {
  if (own.cols() < 1 || own.rows() < 1) return;
  const auto cols = static_cast<std::size_t>(window.region.cols());
  std::visit(
      [&](const auto& codes) {
        const auto count = [&](std::size_t zero, std::size_t other) {
          if (!window.valid.empty() && (window.valid[zero] == 0 || window.valid[other] == 0)) return;
          const auto height = static_cast<double>(codes[other]);
          if (height == 0) return;
          ++edges.all;
          if (std::abs(height) * metres_per_code >= kSteep) ++edges.steep;
        };
        for (std::int32_t row = own.first.row; row <= own.last.row; ++row) {
          const auto begin = static_cast<std::size_t>(row - window.region.first.row) * cols +
                             static_cast<std::size_t>(own.first.col - window.region.first.col);
          const auto end = begin + static_cast<std::size_t>(own.cols());
          if (std::find(codes.begin() + static_cast<std::ptrdiff_t>(begin),
                        codes.begin() + static_cast<std::ptrdiff_t>(end),
                        0) == codes.begin() + static_cast<std::ptrdiff_t>(end))
            continue;
          for (std::size_t i = begin; i < end; ++i) {
            if (codes[i] != 0) continue;
            if (i > begin) count(i, i - 1);
            if (i + 1 < end) count(i, i + 1);
            if (row > own.first.row) count(i, i - cols);
            if (row < own.last.row) count(i, i + cols);
          }
        }
      },
      window.codes);
}

std::vector<std::string> void_doubts(double minimum, double maximum, const ZeroEdges& edges, const std::string& unit,
                                     bool all_declare) {
  std::vector<std::string> doubts;
  const auto remedy = [&](double value) {
    return all_declare ? fmt::format(
                             "declare it in the files, which state another void value (gdal_translate -a_nodata {}), "
                             "and ingest again",
                             value)
                       : fmt::format("ingest again with InputOptions::nodata {}", value);
  };
  const auto doubt = [&](const char* which, double value) {
    doubts.push_back(fmt::format("the {} height is {} {}, which often means no data; if it does, {}", which, value,
                                 unit, remedy(value)));
  };
  if (is_one_of(minimum, kLowest)) doubt("lowest", minimum);
  if (is_one_of(maximum, kHighest)) doubt("highest", maximum);
  if (minimum == 0 && edges.all >= kFewest && 2 * edges.steep >= edges.all) {
    doubts.push_back(fmt::format(
        "the lowest height is 0, and most samples beside it are at least {} m higher; if 0 means no data, {}", kSteep,
        remedy(0)));
  }
  return doubts;
}

}  // namespace talus
