#pragma once
// The triangles of the whole raster's answer that meet a region.

#include <unordered_set>
#include <vector>

#include "query/found.hpp"
#include "query/page_walk.hpp"

namespace talus {

/// The vertices that the extent's own border needs, for looking up.
class ExtentBorder {
 public:
  explicit ExtentBorder(GridRect extent);
  [[nodiscard]] bool contains(GridPoint p) const { return members_.contains(key(p)); }
  [[nodiscard]] const std::vector<GridPoint>& vertices() const { return vertices_; }

 private:
  static std::uint64_t key(GridPoint p) {
    return std::uint64_t{static_cast<std::uint32_t>(p.col)} << 32 | static_cast<std::uint32_t>(p.row);
  }
  std::vector<GridPoint> vertices_;
  std::unordered_set<std::uint64_t> members_;
};

/// What an answer needs beyond a region so that all triangles that meet it are whole.
struct VerticesAround {
  std::vector<GridPoint> corners;  ///< of those triangles, outside the region; repeated
  /// Split vertices outside the region of triangles that are none of them: where all corners of such a triangle are
  /// vertices of the answer, this must be one, too, and tells that the triangle was split.
  std::vector<GridPoint> splits;
};

/// cost  in proportion to the triangles that the region's sides cut
[[nodiscard]] VerticesAround vertices_around(GridRect region, GridRect extent, int finest_height,
                                                     const Above& above, const ExtentBorder& border, PageWalk& pages);

}  // namespace talus
