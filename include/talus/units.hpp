#pragma once
// Units, grid points and rectangles. Every other header uses them.

#if __cplusplus < 202002L
#error "Talus needs C++20"
#endif

#include <compare>
#include <cstdint>

namespace talus {

/// A number with a unit. The constructor is explicit, `.value` is the number; only equal units add or compare.
template <class Tag>
struct Quantity {
  double value{};
  constexpr Quantity() = default;
  constexpr explicit Quantity(double v) : value(v) {}
  friend constexpr auto operator<=>(Quantity, Quantity) = default;
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity{a.value + b.value}; }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity{a.value - b.value}; }
};
using Metres = Quantity<struct MetresTag>;
using Degrees = Quantity<struct DegreesTag>;

/// A point of the sample grid. Column 0, row 0 is the north-west sample of the first source.
/// Columns count east and rows count south; both may be negative.
struct GridPoint {
  std::int32_t col{}, row{};
  friend constexpr bool operator==(GridPoint, GridPoint) = default;
};

/// A rectangle of samples. `first` is the north-west corner, `last` the south-east one; both belong to it.
struct GridRect {
  GridPoint first, last;
  friend constexpr bool operator==(GridRect, GridRect) = default;

  [[nodiscard]] constexpr std::int64_t cols() const { return std::int64_t{last.col} - first.col + 1; }
  [[nodiscard]] constexpr std::int64_t rows() const { return std::int64_t{last.row} - first.row + 1; }
  [[nodiscard]] constexpr std::int64_t samples() const { return cols() * rows(); }
  [[nodiscard]] constexpr bool contains(GridPoint p) const {
    return p.col >= first.col && p.col <= last.col && p.row >= first.row && p.row <= last.row;
  }
};

/// A point in the coordinates of a database's CRS.
struct Position {
  double x{}, y{};
  friend constexpr bool operator==(Position, Position) = default;
};

/// A rectangle in the coordinates of a database's CRS: X before Y, xmin < xmax, ymin < ymax. Samples are pixel centres,
/// so the outer edge of a raster lies half a cell outside its outermost samples.
struct Rectangle {
  double xmin{}, ymin{}, xmax{}, ymax{};
};

/// The position of samples in the CRS: sample (col, row) is at (x0 + col·dx, y0 + row·dy). dx > 0 and dy < 0, so rows
/// count south, whatever the order of rows in the source.
struct GridMapping {
  double x0{}, y0{}, dx{1}, dy{-1};
  friend constexpr bool operator==(GridMapping, GridMapping) = default;
  [[nodiscard]] constexpr double x(double col) const { return x0 + col * dx; }
  [[nodiscard]] constexpr double y(double row) const { return y0 + row * dy; }
};

}  // namespace talus
