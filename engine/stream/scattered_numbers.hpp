#pragma once
// Codes a few vertices of a stream that may lie anywhere on its grid, as numbers. docs/format/rqt-v1.md, section 6.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/page/number_coder.hpp"
#include "engine/stream/bit_lattice.hpp"
#include "engine/stream/level_walk.hpp"
#include "talus/failure.hpp"

namespace talus {

[[noreturn]] inline void refuse_stream(const std::string& what) { throw Failure(Cause::corrupt, "corrupt: " + what); }

/// Contexts of a NumberWriter.
enum NumberContext : int {
  kCount = 0,
  kIsThere = 1,
  kRows = 2,
  kColumns = 3,
  kHeight = 8 /* to 16 */,
  kCover = 24 /* to 39 */
};

inline std::uint64_t folded(std::int64_t v) {
  return static_cast<std::uint64_t>(v) << 1 ^ static_cast<std::uint64_t>(v >> 63);
}
inline std::int64_t unfolded(std::uint64_t v) { return static_cast<std::int64_t>(v >> 1 ^ (~(v & 1) + 1)); }

/// Predicts heights of scattered vertices, row by row: the height of the nearest earlier vertex in its row or column.
class Neighbourhood {
 public:
  struct Guess {
    std::int64_t height;
    int context;
  };
  [[nodiscard]] Guess guess(GridPoint p) const {
    if (!has_last_) return {0, kHeight + 8};
    std::int64_t distance = std::int64_t{1} << 40, height = last_;
    if (at_.row == p.row) distance = std::int64_t{p.col} - at_.col;
    const auto above = columns_.find(p.col);
    if (above != columns_.end() && std::int64_t{p.row} - above->second.first < distance) {
      distance = std::int64_t{p.row} - above->second.first;
      height = above->second.second;
    }
    return {height, kHeight + std::min(7, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(distance))))};
  }
  void take(GridPoint p, std::int64_t height) {
    has_last_ = true;
    at_ = p;
    last_ = height;
    columns_[p.col] = {p.row, height};
  }

 private:
  bool has_last_ = false;
  GridPoint at_;
  std::int64_t last_ = 0;
  std::unordered_map<std::int32_t, std::pair<std::int32_t, std::int64_t>> columns_;
};

template <class Code>
struct Scattered {
  std::vector<GridPoint> points;
  std::vector<Code> heights;
};

template <class Code>
void put_heights(NumberWriter& out, const Scattered<Code>& vertices) {
  Neighbourhood near;
  for (std::size_t i = 0; i < vertices.points.size(); ++i) {
    const auto guess = near.guess(vertices.points[i]);
    const std::int64_t height = vertices.heights[i];
    out.put(folded(wrapped_difference(height, guess.height)), guess.context);
    near.take(vertices.points[i], height);
  }
}
template <class Code>
void take_heights(NumberReader& in, Scattered<Code>& vertices) {
  Neighbourhood near;
  vertices.heights.resize(vertices.points.size());
  for (std::size_t i = 0; i < vertices.points.size(); ++i) {
    const auto guess = near.guess(vertices.points[i]);
    const std::int64_t height = wrapped_sum(guess.height, unfolded(in.get(guess.context)));
    vertices.heights[i] = static_cast<Code>(height);
    near.take(vertices.points[i], vertices.heights[i]);
  }
}

/// Writes points row by row. Each is a point of the lattice.
inline void put_points(NumberWriter& out, const BitLattice& lattice, std::span<const GridPoint> points) {
  out.put(points.size(), kCount);
  std::int32_t row = 0, col = 0;
  for (const GridPoint p : points) {
    const std::int32_t i = (p.col >> lattice.shift) - lattice.first_col,
                       j = (p.row >> lattice.shift) - lattice.first_row;
    out.put(static_cast<std::uint64_t>(j - row), kRows);
    if (j != row) col = 0;
    out.put(static_cast<std::uint64_t>(i - col), kColumns);
    row = j, col = i + 1;
  }
}
/// Reads points. accept(p) says whether a vertex may be at p.
template <class Accept>
std::vector<GridPoint> take_points(NumberReader& in, const BitLattice& lattice, std::uint64_t most, Accept&& accept) {
  const std::uint64_t count = in.get(kCount);
  if (count > most) refuse_stream(fmt::format("{} scattered vertices are too many", count));
  std::vector<GridPoint> points;
  std::uint64_t row = 0, col = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::uint64_t down = in.get(kRows);
    if (down > 0) col = 0;
    const std::uint64_t right = in.get(kColumns);
    if (down >= static_cast<std::uint64_t>(lattice.rows) || right >= static_cast<std::uint64_t>(lattice.cols) ||
        row + down >= static_cast<std::uint64_t>(lattice.rows) ||
        col + right >= static_cast<std::uint64_t>(lattice.cols))
      refuse_stream("a scattered vertex lies outside the window");
    row += down, col += right;
    points.push_back(lattice.at(static_cast<std::int32_t>(col), static_cast<std::int32_t>(row)));
    if (!accept(points.back())) refuse_stream("a scattered vertex is of another level, or a duplicate");
    ++col;
  }
  return points;
}

}  // namespace talus
