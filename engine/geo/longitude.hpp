#pragma once
// Longitudes that differ by a full turn are the same place, and a question may use any of them.

#include <span>
#include <vector>

#include "talus/description.hpp"

namespace talus {

class Longitudes {
 public:
  /// turn  units of a full turn, 360 for degrees; 0: not geographic, and every function returns its argument
  Longitudes(double turn, const Description& description);
  explicit Longitudes(const Description& description);

  [[nodiscard]] double turn() const { return turn_; }

  /// The equivalent of p that lies in a rectangle of samples or within half a cell of it; p itself if none does.
  [[nodiscard]] Position among(Position p, GridRect rect) const;

  /// A line that goes the shorter way around the globe from each point to the next.
  [[nodiscard]] std::vector<Position> short_way(std::span<const Position> line) const;

  /// Multiples of the turn to add to the x of a line so that part of it lies in a rectangle of samples. More than one
  /// if the rectangle goes around the globe; 0 if there is none.
  [[nodiscard]] std::vector<double> shifts(double from, double to, GridRect rect) const;

  /// The equivalent of a box in the extent. xmin > xmax is a box across the antimeridian, at most half a turn wide.
  /// fails  invalid_argument: the box meets both ends of a raster around the globe; the sentence names both parts
  [[nodiscard]] Rectangle among(const Rectangle& box) const;

 private:
  [[nodiscard]] double x(double col) const { return mapping_.x0 + mapping_.dx * col; }

  double turn_;
  GridMapping mapping_;
  GridRect extent_;
};

}  // namespace talus
