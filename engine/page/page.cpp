#include "engine/page/page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

float rounded_down(double v) {
  const auto f = static_cast<float>(v);
  return f > v ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float rounded_up(double v) { return -rounded_down(-v); }

}  // namespace

ChildEntry joined(const ChildEntry& a, const ChildEntry& b) {
  return {a.present || b.present, std::max(a.largest, b.largest), std::min(a.lowest, b.lowest),
          std::max(a.highest, b.highest), std::max(a.generation, b.generation)};
}

ChildEntry range_of(const Page& page, const HeightStep& step) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for_each_sample(page.grid, [&](std::size_t i, GridPoint) {
    if (!page.is_data(i) || page.is_dropped(i)) return;
    const double height = step.value(page.height(i));
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  });
  return {true, 0, rounded_down(lowest), rounded_up(highest)};
}

SquareBits present_samples(const PageGrid& grid) {
  SquareBits bits{};
  const int first_col = grid.first.col & (kPageSide - 1), first_row = grid.first.row & (kPageSide - 1);
  std::uint64_t row[2] = {0, 0};
  for (int col = first_col; col < first_col + grid.cols; ++col) row[col / 64] |= std::uint64_t{1} << (col % 64);
  for (int r = first_row; r < first_row + grid.rows; ++r) {
    auto& words = bits[static_cast<std::size_t>(r)];
    words[0] = row[0];
    words[1] = row[1];
  }
  return bits;
}

SquareBits data_samples(const Page& page) {
  return page.valid.empty() ? present_samples(page.grid) : marked_samples(page.grid, page.valid);
}

SquareBits marked_samples(const PageGrid& grid, std::span<const std::uint8_t> bytes) {
  SquareBits bits{};
  const int first_col = grid.first.col & (kPageSide - 1), first_row = grid.first.row & (kPageSide - 1);
  const auto cols = static_cast<std::size_t>(grid.cols);
  for (int row = 0; row < grid.rows; ++row)
    insert_row(bits, first_col, first_row + row, bytes.subspan(static_cast<std::size_t>(row) * cols, cols));
  return bits;
}

}  // namespace talus
