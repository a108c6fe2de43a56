#include "engine/stored_errors.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

constexpr std::uint32_t kCodes = kAlwaysSelected + 1;

}  // namespace

void StoredErrors::list(const Page& page) {
  const PageGrid& g = page.grid;
  const bool coarsest = page.id.band == page.bands - 1;
  const int kind = page.eighths.empty() ? (page.distances.empty() ? 0 : 1) : 2;
  const std::array<std::int32_t, 6> shape{
      g.cols, g.rows, g.first.col & (kPageSide - 1), g.first.row & (kPageSide - 1), coarsest ? 1 : 0, kind};
  const bool by_shape = page.valid.empty() && kind != 1;
  if (by_shape && shape == listed_for_) return;
  listed_for_ = by_shape ? shape : std::array<std::int32_t, 6>{-1};
  vertices_.clear();
  const auto add = [&](int col, int row, int s, int context) {
    const std::size_t i = page.index(col, row);
    if (page.is_implied(i)) return;
    vertices_.push_back({static_cast<std::uint32_t>(i), static_cast<std::int16_t>(col), static_cast<std::int16_t>(row),
                         static_cast<std::int16_t>(s), static_cast<std::uint8_t>(context)});
  };
  const int levels = coarsest ? kPageShift : kBandLevels;
  for (int level = 0; level < levels; ++level) {
    const int s = 1 << level;
    for (const bool centres : {false, true}) {
      const int context = 4 * std::min(level, 3) + (centres ? 2 : 0);
      for (int row = -g.first.row & (s - 1); row < g.rows; row += s) {
        const bool row_odd = ((g.first.row + row) & s) != 0;
        if (centres && !row_odd) continue;
        const int phase = centres || !row_odd ? s : 0;
        for (int col = (phase - g.first.col) & (2 * s - 1); col < g.cols; col += 2 * s) add(col, row, s, context);
      }
    }
  }
  if (!coarsest) return;
  for (int row = -g.first.row & (kPageSide - 1); row < g.rows; row += kPageSide) {
    for (int col = -g.first.col & (kPageSide - 1); col < g.cols; col += kPageSide) add(col, row, 0, 12);
  }
}

ErrorCode StoredErrors::at_least(const Page& page, const Vertex& v, const CodeDistance& distance) const {
  if (v.spacing == 0) return 0;
  const PageGrid& g = page.grid;
  const auto has = [&](GridPoint p) { return p.col >= 0 && p.row >= 0 && p.col < g.cols && p.row < g.rows; };
  const auto is_data = [&](std::size_t i) { return page.valid.empty() || page.valid[i] != 0; };
  const GridPoint unit{g.first.col + v.col, g.first.row + v.row};
  const auto local = [&](GridPoint p) { return GridPoint{p.col - g.first.col, p.row - g.first.row}; };

  double metres = 0;
  const Diamond d = diamond(unit);
  const GridPoint a = local(d.ends[0]), b = local(d.ends[1]);
  if (!page.heights.empty() && has(a) && has(b)) {
    const std::size_t one = page.index(a.col, a.row), other = page.index(b.col, b.row);
    if (is_data(v.index) && is_data(one) && is_data(other)) {
      const double middle = page.heights[one] / 2 + page.heights[other] / 2;
      metres = distance.metres(std::abs(page.heights[v.index] - middle));
    }
  }
  ErrorCode code = 0;
  const Children below = children(unit);
  for (int k = 0; k < below.count; ++k) {
    const GridPoint p = local(below.at[static_cast<std::size_t>(k)]);
    if (!has(p)) continue;
    const std::size_t i = page.index(p.col, p.row);
    if (page.is_implied(i)) {
      metres = std::max(metres, distance.metres(page.implied_distance(i)));
    } else {
      code = std::max(code, page.errors[i]);
    }
  }
  return std::max(code, error_code(metres));
}

void StoredErrors::put(const std::vector<ErrorCode>& all, Page& page, const CodeDistance& distance, int context,
                       NumberWriter& out) {
  list(page);
  for (const Vertex& v : vertices_) {
    const ErrorCode from = at_least(page, v, distance);
    page.errors[v.index] = all[v.index];
    out.put((all[v.index] + kCodes - from) % kCodes, context + v.kind + (from > 0 ? 1 : 0));
  }
}

bool StoredErrors::get(Page& page, const CodeDistance& distance, int context, NumberReader& in) {
  list(page);
  for (const Vertex& v : vertices_) {
    const ErrorCode from = at_least(page, v, distance);
    const std::uint64_t above = in.get(context + v.kind + (from > 0 ? 1 : 0));
    if (above >= kCodes) return false;
    page.errors[v.index] = static_cast<ErrorCode>((from + above) % kCodes);
  }
  return true;
}

}  // namespace talus
