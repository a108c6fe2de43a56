#include "talus/positions.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "engine/geo/globe.hpp"
#include "engine/machine/fail.hpp"

namespace talus {
namespace {

/// Calls out(i, x, y, z) for each corner.
template <class Out>
void for_each_position(const Mesh& mesh, const Description& d, Coordinates coordinates, const LocalOrigin& origin,
                       Out&& out) {
  const auto place = [&](std::size_t i) {
    const Place p = mesh.place(i);
    return Position{d.mapping.x(p.col), d.mapping.y(p.row)};
  };
  if (coordinates == Coordinates::crs) {
    for (std::size_t i = 0; i < mesh.size(); ++i) {
      const Position p = place(i);
      out(i, p.x, p.y, mesh.heights[i]);
    }
    return;
  }
  const bool is_local = coordinates == Coordinates::local;
  if (is_local &&
      !(std::isfinite(origin.position.x) && std::isfinite(origin.position.y) && std::isfinite(origin.height))) {
    refuse("origin {}, {}, {}: expected finite numbers", origin.position.x, origin.position.y, origin.height);
  }
  if (!d.crs.is_geographic) {
    if (!is_local) {
      fail(Cause::unsupported, "{} is not geographic: Talus places only longitudes and latitudes on the Earth",
           d.crs.name.empty() ? "a raster without a CRS" : d.crs.name);
    }
    for (std::size_t i = 0; i < mesh.size(); ++i) {
      const Position p = place(i);
      out(i, (p.x - origin.position.x) * d.crs.metres_per_unit, (p.y - origin.position.y) * d.crs.metres_per_unit,
          (mesh.heights[i] - origin.height) * d.metres_per_unit);
    }
    return;
  }
  const Globe globe = is_local ? Globe(d.crs, origin.position, origin.height * d.metres_per_unit) : Globe(d.crs);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const std::array<double, 3> p = globe.at(place(i), mesh.heights[i] * d.metres_per_unit);
    out(i, p[0], p[1], p[2]);
  }
}

template <class Number>
std::vector<Number> positions_as(const Mesh& mesh, const Description& d, Coordinates coordinates,
                                 const LocalOrigin& origin) {
  std::vector<Number> all(3 * mesh.size());
  for_each_position(mesh, d, coordinates, origin, [&](std::size_t i, double x, double y, double z) {
    all[3 * i] = static_cast<Number>(x);
    all[3 * i + 1] = static_cast<Number>(y);
    all[3 * i + 2] = static_cast<Number>(z);
  });
  return all;
}

}  // namespace

std::vector<double> positions(const Mesh& mesh, const Description& description, Coordinates coordinates,
                              const LocalOrigin& origin) {
  return positions_as<double>(mesh, description, coordinates, origin);
}

std::vector<float> float_positions(const Mesh& mesh, const Description& description, Coordinates coordinates,
                                   const LocalOrigin& origin) {
  return positions_as<float>(mesh, description, coordinates, origin);
}

std::vector<float> normals(const Mesh& mesh, std::span<const double> at) {
  if (at.size() != 3 * mesh.size())
    refuse("normals of {} corners need {} coordinates; there are {}", mesh.size(), 3 * mesh.size(), at.size());
  std::vector<double> sums(at.size());
  for (const auto& t : mesh.triangles) {
    const auto side = [&](std::size_t corner, std::size_t axis) {
      return at[3 * t[corner] + axis] - at[3 * t[0] + axis];
    };
    // Its length is twice the area. It points up, because triangles run counter-clockwise.
    const std::array<double, 3> cross{side(1, 1) * side(2, 2) - side(1, 2) * side(2, 1),
                                      side(1, 2) * side(2, 0) - side(1, 0) * side(2, 2),
                                      side(1, 0) * side(2, 1) - side(1, 1) * side(2, 0)};
    for (const std::uint32_t corner : t) {
      for (std::size_t axis = 0; axis < 3; ++axis) sums[3 * corner + axis] += cross[axis];
    }
  }
  std::vector<float> unit(sums.size());
  for (std::size_t i = 0; i < sums.size(); i += 3) {
    const double length = std::hypot(sums[i], sums[i + 1], sums[i + 2]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      unit[i + axis] = static_cast<float>(length > 0 ? sums[i + axis] / length : axis == 2 ? 1.0 : 0.0);
  }
  return unit;
}

}  // namespace talus
