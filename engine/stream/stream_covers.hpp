#pragma once
// Codes the covers of a stream's vertices: which of their triangles hold data. docs/format/rqt-v1.md, section 6.
//
// A vertex splits two triangles. Each has its right angle at a vertex that was coded earlier, whose covers say whether
// the triangle holds data. If it does, mostly both of its halves do; if not, neither does.

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/quadtree/grid.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Codes covers part by part. A writer and a reader remember the same vertices.
class CoverCoder {
 public:
  /// Adds the covers of the answer that an increment continues.
  void take(const RestrictedQuadtree& quadtree);
  /// Codes the covers of `points`. No bytes if all are 15.
  [[nodiscard]] std::vector<std::byte> encode(std::span<const GridPoint> points, std::span<const std::uint8_t> covers);
  /// fails  corrupt
  [[nodiscard]] std::vector<std::uint8_t> decode(std::span<const std::byte> bytes, std::span<const GridPoint> points);

 private:
  [[nodiscard]] std::uint8_t of(GridPoint p) const;
  void remember(GridPoint p, std::uint8_t covers);
  /// code(context, number) writes or reads the two bits for one split triangle
  template <class Code>
  std::uint8_t visit(GridPoint p, std::uint8_t covers, Code&& code) const;

  std::unordered_map<std::uint64_t, std::uint8_t> partial_;  ///< covers other than 15
};

}  // namespace talus
