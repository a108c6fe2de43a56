#pragma once
// The vertices that the border of the whole extent needs.

#include <vector>

#include "talus/units.hpp"

namespace talus {

/// These vertices, sorted. A snapshot makes them once.
class ExtentBorder {
 public:
  /// cost  time in proportion to the extent's sides
  explicit ExtentBorder(GridRect extent);
  [[nodiscard]] bool contains(GridPoint p) const;
  /// Whether one with a spacing below 64 may lie in a rectangle.
  [[nodiscard]] bool is_near(GridRect rect) const;
  [[nodiscard]] const std::vector<GridPoint>& vertices() const { return vertices_; }

 private:
  GridRect extent_;
  std::vector<GridPoint> vertices_;  ///< row by row
};

}  // namespace talus
