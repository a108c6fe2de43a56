#pragma once
// Longitudes that differ by a full turn name one place: a question may write either.

#include <span>
#include <vector>

#include "talus/description.hpp"

namespace talus {

class Longitudes {
 public:
  /// Any other CRS has no turn: all stays as it is written.
  /// turn  360 where the unit is degrees; 0: not geographic
  Longitudes(double turn, const Description& description);
  explicit Longitudes(const Description& description);

  [[nodiscard]] double turn() const { return turn_; }

  /// A point as the samples of a rectangle are written, where it lies among them or half a cell beside; else as it is.
  [[nodiscard]] Position among(Position p, GridRect rect) const;

  /// Each next point on the turn nearest to the one before, so that the line goes the short way.
  [[nodiscard]] std::vector<Position> short_way(std::span<const Position> line) const;

  /// What must be added to the x of a straight line from one x to another so that some of it lies among the samples of
  /// a rectangle: a multiple of the turn, 0 among them; more than one where the rectangle goes around the globe. Where
  /// there is none, 0.
  [[nodiscard]] std::vector<double> shifts(double from, double to, GridRect rect) const;

  /// A box as the samples of the extent are written. One whose xmin is above its xmax goes across the antimeridian, if
  /// that is at most half a turn. fails  invalid_argument: a box at both ends of a raster that goes around the globe;
  /// names the two to ask for
  [[nodiscard]] Rectangle among(const Rectangle& box) const;

 private:
  [[nodiscard]] double x(double col) const { return mapping_.x0 + mapping_.dx * col; }

  double turn_;
  GridMapping mapping_;
  GridRect extent_;
};

}  // namespace talus
