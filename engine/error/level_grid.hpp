#pragma once
// One value for each vertex of the finest levels, and of a rim around the extent.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/machine/large_memory.hpp"
#include "engine/quadtree/grid.hpp"

namespace talus {

/// One array a level, over its vertices within four spacings of the extent. The rim holds all ancestors of inner
/// vertices, because descendants of a vertex of spacing s lie within 3s of it. Memory: 1⅓ values a sample plus the rim.
template <class Value>
class LevelGrid {
 public:
  /// The extent may lie anywhere, and may be empty.
  LevelGrid(GridRect extent, int levels, Value initial) { reset(extent, levels, initial); }

  /// The same as a new grid, reusing the memory.
  void reset(GridRect extent, int levels, Value initial) {
    levels_.resize(static_cast<std::size_t>(levels));
    for (int shift = 0; shift < levels; ++shift) {
      Level& level = levels_[static_cast<std::size_t>(shift)];
      level.first_col = (extent.first.col >> shift) - kRim;
      level.first_row = (extent.first.row >> shift) - kRim;
      const bool empty = extent.cols() <= 0 || extent.rows() <= 0;
      level.cols = empty ? 0 : (extent.last.col >> shift) + kRim - level.first_col + 1;
      level.rows = empty ? 0 : (extent.last.row >> shift) + kRim - level.first_row + 1;
      const std::size_t count = static_cast<std::size_t>(level.cols) * static_cast<std::size_t>(level.rows);
      make_room(level.values, count);
      level.values.assign(count, initial);
    }
  }

  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }
  /// Whether p belongs to one of the levels and lies within the rim.
  [[nodiscard]] bool holds(GridPoint p) const {
    const int shift = height_in_tree(p);
    return shift < levels() && levels_[static_cast<std::size_t>(shift)].holds(p, shift);
  }
  [[nodiscard]] Value& operator[](GridPoint p) {
    const int shift = height_in_tree(p);
    Level& level = levels_[static_cast<std::size_t>(shift)];
    return level.values[level.index(p, shift)];
  }
  [[nodiscard]] const Value& operator[](GridPoint p) const { return const_cast<LevelGrid&>(*this)[p]; }

  /// The vertices of one level in its own units: (col, row) is the grid point (col << shift, row << shift).
  template <class V>
  struct UnitsOf {
    V* values = nullptr;  ///< from (first_col, first_row), row by row
    std::ptrdiff_t stride = 0;
    std::int32_t first_col = 0, last_col = -1, first_row = 0, last_row = -1;  ///< rim included
    [[nodiscard]] V& at(std::int32_t col, std::int32_t row) const {
      return values[(row - first_row) * stride + (col - first_col)];
    }
    [[nodiscard]] bool holds(std::int32_t col, std::int32_t row) const {
      return col >= first_col && col <= last_col && row >= first_row && row <= last_row;
    }
  };
  using Units = UnitsOf<Value>;
  [[nodiscard]] Units units(int shift) { return units_of<Value>(levels_[static_cast<std::size_t>(shift)]); }
  [[nodiscard]] UnitsOf<const Value> units(int shift) const {
    return units_of<const Value>(levels_[static_cast<std::size_t>(shift)]);
  }

  /// visit(GridPoint) for each vertex of one level, centres or side midpoints, rim included.
  template <class Visit>
  void for_each(int shift, bool centres, Visit&& visit) const {
    const Level& level = levels_[static_cast<std::size_t>(shift)];
    for (std::int32_t row = level.first_row; row < level.first_row + level.rows; ++row) {
      const bool row_odd = (row & 1) != 0;
      if (centres && !row_odd) continue;
      const std::int32_t wanted = centres || !row_odd ? 1 : 0;  // parity of the column
      const std::int32_t start = level.first_col + ((level.first_col & 1) == wanted ? 0 : 1);
      for (std::int32_t col = start; col < level.first_col + level.cols; col += 2) {
        visit(GridPoint{col * (std::int32_t{1} << shift), row * (std::int32_t{1} << shift)});
      }
    }
  }

 private:
  static constexpr std::int32_t kRim = 4;
  struct Level {
    std::int32_t first_col = 0, first_row = 0, cols = 0, rows = 0;
    std::vector<Value, LargeAllocator<Value>> values;
    [[nodiscard]] bool holds(GridPoint p, int shift) const {
      const std::int32_t col = (p.col >> shift) - first_col, row = (p.row >> shift) - first_row;
      return col >= 0 && row >= 0 && col < cols && row < rows;
    }
    [[nodiscard]] std::size_t index(GridPoint p, int shift) const {
      return static_cast<std::size_t>((p.row >> shift) - first_row) * static_cast<std::size_t>(cols) +
             static_cast<std::size_t>((p.col >> shift) - first_col);
    }
  };
  template <class V, class LevelOf>
  static UnitsOf<V> units_of(LevelOf& l) {
    return {l.values.data(), l.cols, l.first_col, l.first_col + l.cols - 1, l.first_row, l.first_row + l.rows - 1};
  }
  std::vector<Level> levels_;
};

}  // namespace talus
