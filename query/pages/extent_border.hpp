#pragma once
// The vertices that the border of the whole extent needs.

#include <vector>

#include "talus/units.hpp"

namespace talus {

/// Made once for a snapshot.
class ExtentBorder {
 public:
  /// cost  in proportion to the extent's sides
  explicit ExtentBorder(GridRect extent);
  [[nodiscard]] bool contains(GridPoint p) const;
  [[nodiscard]] const std::vector<GridPoint>& vertices() const { return vertices_; }

 private:
  GridRect extent_;
  std::vector<GridPoint> vertices_;  ///< row by row
};

}  // namespace talus
