#pragma once
// The triangles of the whole raster's answer that meet a region.

#include <vector>

#include "query/pages/extent_border.hpp"
#include "query/pages/nearby_pages.hpp"
#include "query/selection/threshold.hpp"

namespace talus {

/// What an answer needs beyond a region so that all triangles that meet it are whole.
struct VerticesAround {
  std::vector<GridPoint> corners;  ///< of those triangles, outside the region; repeated
  /// Split vertices outside the region of triangles that are none of them: where all corners of such a triangle are
  /// vertices of the answer, this must be one, too, and tells that the triangle was split.
  std::vector<GridPoint> splits;
  /// Of the split vertices that are absent outside the region: what their triangles leave out, inside it and beyond.
  LargestAbsent absent;
};

/// cost  in proportion to the triangles that the region's sides cut
[[nodiscard]] VerticesAround vertices_around(GridRect region, GridRect extent, int finest_height,
                                             const Threshold& above, const ExtentBorder& border, NearbyPages& pages);

}  // namespace talus
