#pragma once
// A mesh as arrays of coordinates for graphics libraries and GPUs.

#include <cstdint>
#include <span>
#include <vector>

#include "talus/description.hpp"
#include "talus/quadtree.hpp"
#include "talus/units.hpp"

namespace talus {

/// The coordinate system of the result.
enum class Coordinates : std::uint8_t {
  crs,    ///< x and y in units of the CRS, z in the vertical unit
  local,  ///< metres east, north and up from an origin
  ecef,   ///< metres from the centre of the Earth (geographic CRS only)
};

/// The origin of `Coordinates::local`.
struct LocalOrigin {
  Position position;  ///< in the CRS
  double height = 0;  ///< in the vertical unit
};

/// Coordinates of all corners. positions[3·i], [3·i + 1], [3·i + 2] are x, y, z of corner i. mesh.triangles, three numbers
/// a triangle in one piece, is the index buffer.
///
/// In a geographic CRS, `local` is the plane that touches the ellipsoid at the origin; the Earth curves away below it.
/// Heights count as heights above the ellipsoid. In other systems `local` is the CRS in metres, moved to the origin:
/// metres of the map, which differ from metres on the ground by the projection's scale.
///
/// fails  invalid_argument: an origin that is not finite or has a latitude beyond a pole; unsupported: ecef in a CRS
///        that is not geographic
/// cost   linear; 24 bytes a corner. Any number of threads may call it at once
[[nodiscard]] std::vector<double> positions(const Mesh& mesh, const Description& description,
                                            Coordinates coordinates = Coordinates::crs, const LocalOrigin& origin = {});

/// The same as float. Use `local` with an origin in or near the mesh: large coordinates lose digits in float.
[[nodiscard]] std::vector<float> float_positions(const Mesh& mesh, const Description& description,
                                                 Coordinates coordinates, const LocalOrigin& origin = {});

/// One unit normal a corner: the mean of the normals of its triangles, weighted by their areas.
///
/// positions  positions(mesh, …) in metres: local or ecef
/// fails      invalid_argument: `positions` does not hold three numbers a corner
[[nodiscard]] std::vector<float> normals(const Mesh& mesh, std::span<const double> positions);

}  // namespace talus
