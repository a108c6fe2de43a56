#pragma once
// Which triangles of vertices hold data, in streams: docs/format/rqt-v1.md, section 6.
//
// A vertex splits two triangles, and each of them has its right angle at a vertex that came before: where that one says
// that a triangle holds data, mostly both of its halves do, and where it does not, neither does.

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Writer and reader remember the same.
class CoverCoder {
 public:
  /// What an increment goes on from.
  void take(const RestrictedQuadtree& quadtree);
  /// covers  of `points`; none at all where all are 15
  [[nodiscard]] std::vector<std::byte> encode(std::span<const GridPoint> points, std::span<const std::uint8_t> covers);
  /// fails  corrupt
  [[nodiscard]] std::vector<std::uint8_t> decode(std::span<const std::byte> bytes, std::span<const GridPoint> points);

 private:
  [[nodiscard]] std::uint8_t of(GridPoint p) const;
  void remember(GridPoint p, std::uint8_t covers);
  /// code(context, number): one side of a vertex
  template <class Code>
  std::uint8_t visit(GridPoint p, std::uint8_t covers, Code&& code) const;

  std::unordered_map<std::uint64_t, std::uint8_t> partial_;  ///< those that are not 15
};

}  // namespace talus
