#include "engine/page/stored_errors.hpp"

#include <algorithm>
#include <cmath>

#include "engine/quadtree/apex_halves.hpp"

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

StoredErrors::Around StoredErrors::around(const Page& page, const Vertex& v) {
  const PageGrid& g = page.grid;
  const std::int32_t s = v.spacing, h = s / 2;
  const GridPoint unit{g.first.col + v.col, g.first.row + v.row};
  Around near;
  const auto below = [&](std::size_t i) { near.below[near.count++] = i; };
  if (v.col >= s && v.row >= s && v.col + s < g.cols && v.row + s < g.rows) {  // all are at known distances
    const auto row = static_cast<std::size_t>(g.cols), side = static_cast<std::size_t>(s),
               half = static_cast<std::size_t>(h);
    const VertexKind kind = kind_of(unit, s);
    const std::size_t to_end = side * (kind == VertexKind::level_side       ? 1
                                       : kind == VertexKind::upright_side   ? row
                                       : kind == VertexKind::falling_centre ? row + 1
                                                                            : row - 1);
    if (is_centre(kind)) {
      for (const std::size_t by : {side, side * row}) below(v.index - by), below(v.index + by);
    } else if (h > 0) {
      for (const std::size_t by : {half * (row - 1), half * (row + 1)}) below(v.index - by), below(v.index + by);
    }
    near.has_ends = true;
    near.ends = {v.index - to_end, v.index + to_end};
    return near;
  }
  const auto local = [&](GridPoint p) { return GridPoint{p.col - g.first.col, p.row - g.first.row}; };
  const auto has = [&](GridPoint p) { return p.col >= 0 && p.row >= 0 && p.col < g.cols && p.row < g.rows; };
  const Diamond d = diamond(unit);
  const GridPoint a = local(d.ends[0]), b = local(d.ends[1]);
  near.has_ends = has(a) && has(b);
  if (near.has_ends) near.ends = {page.index(a.col, a.row), page.index(b.col, b.row)};
  const Children all = children(unit);
  for (int k = 0; k < all.count; ++k) {
    const GridPoint p = local(all.at[static_cast<std::size_t>(k)]);
    if (has(p)) below(page.index(p.col, p.row));
  }
  return near;
}

ErrorCode StoredErrors::at_least(const Page& page, const Vertex& v, const CodeDistance& distance) const {
  if (v.spacing == 0) return 0;
  const Around near = around(page, v);
  const auto is_data = [&](std::size_t i) { return page.valid.empty() || page.valid[i] != 0; };
  double codes = 0;
  if (!page.heights.empty() && near.has_ends) {
    const auto [one, other] = near.ends;
    if (is_data(v.index) && is_data(one) && is_data(other)) {
      const double middle = page.heights[one] / 2 + page.heights[other] / 2;
      codes = std::abs(page.heights[v.index] - middle);
    }
  }
  ErrorCode error = 0;
  for (std::size_t k = 0; k < near.count; ++k) {
    const std::size_t i = near.below[k];
    if (page.is_implied(i)) {
      codes = std::max(codes, page.implied_distance(i));
    } else {
      error = std::max(error, page.errors[i]);
    }
  }
  return std::max(error, error_code(distance.metres(codes)));
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
