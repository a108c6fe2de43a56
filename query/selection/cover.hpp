#pragma once
// The triangles of the whole raster's answer that meet a region.

#include <vector>

#include "engine/quadtree/extent_border.hpp"
#include "query/pages/nearby_pages.hpp"
#include "query/selection/threshold.hpp"

namespace talus {

/// The vertices outside a region that complete the triangles that meet it.
struct VerticesAround {
  std::vector<GridPoint> corners;  ///< corners of these triangles outside the region; may repeat
  /// Split vertices outside the region, of larger triangles. If an answer has all corners of such a triangle, it must
  /// have the split vertex, too: otherwise the triangle would not be split.
  std::vector<GridPoint> splits;
  /// The largest error of the absent split vertices outside the region. Their triangles meet the region.
  LargestAbsent absent;
};

/// cost  in proportion to the triangles that the region's sides cut
[[nodiscard]] VerticesAround vertices_around(GridRect region, GridRect extent, int finest_height,
                                             const Threshold& above, const ExtentBorder& border, NearbyPages& pages);

}  // namespace talus
