#pragma once
// A list of scattered vertices, for walks from the finest level to the coarsest.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/quadtree/grid.hpp"

namespace talus {

/// Vertices by level, side midpoints and centres apart. The parents of a side midpoint are centres of the same level,
/// those of a centre are of coarser levels. So a walk in the order side midpoints, centres, next coarser level may
/// insert the parents of what it visits.
class ScatteredVertices {
 public:
  /// The same vertex may be inserted many times.
  void insert(GridPoint p) {
    std::vector<Key>& keys = list(height_in_tree(p), is_centre(p));
    const Key key = key_of(p);
    if (keys.empty() || keys.back() != key) keys.push_back(key);  // neighbours often share a parent
  }

  /// visit(vertex) row by row, each once. It may insert vertices of other kinds and levels.
  template <class Visit>
  void for_each_of_level(int shift, bool centres, Visit&& visit) {
    std::vector<Key>& keys = list(shift, centres);
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    for (const Key key : keys) visit(point_of(key));
  }

  template <class Visit>
  void for_each(Visit&& visit) {
    for (int shift = 0; shift < kLevels; ++shift) {
      for (const bool centres : {false, true}) for_each_of_level(shift, centres, visit);
    }
  }

 private:
  static constexpr int kLevels = std::countr_zero(static_cast<std::uint32_t>(kRootSpacing)) + 1;

  /// Row and column as one number that sorts by row, then by column.
  using Key = std::uint64_t;
  static constexpr std::uint32_t kSign = std::uint32_t{1} << 31;
  static Key key_of(GridPoint p) {
    return Key{static_cast<std::uint32_t>(p.row) ^ kSign} << 32 | (static_cast<std::uint32_t>(p.col) ^ kSign);
  }
  static GridPoint point_of(Key key) {
    return {static_cast<std::int32_t>(static_cast<std::uint32_t>(key) ^ kSign),
            static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32) ^ kSign)};
  }

  [[nodiscard]] std::vector<Key>& list(int shift, bool centres) {
    return lists_[2 * static_cast<std::size_t>(shift) + (centres ? 1 : 0)];
  }
  std::array<std::vector<Key>, 2 * kLevels> lists_;
};

}  // namespace talus
