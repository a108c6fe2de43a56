#pragma once
// A mesh as arrays of coordinates, as graphics libraries and GPUs take them.

#include <cstdint>
#include <span>
#include <vector>

#include "talus/description.hpp"
#include "talus/quadtree.hpp"
#include "talus/units.hpp"

namespace talus {

/// In which coordinates the corners of a mesh are wanted.
enum class Coordinates : std::uint8_t {
  crs,    ///< x and y in units of the CRS, z in the vertical unit
  local,  ///< metres east, north and up from an origin
  ecef,   ///< metres from the centre of the Earth; the CRS must be geographic
};

/// Where `Coordinates::local` counts from.
struct LocalOrigin {
  Position position;  ///< in the CRS
  double height = 0;  ///< in the vertical unit
};

/// x, y and z of each corner, one after the other: positions[3·i] is x of corner i. mesh.triangles are indices into it.
///
/// In a geographic CRS `local` is the plane that touches the ellipsoid at the origin, and the Earth curves away beneath
/// it; heights count as heights above the ellipsoid, whatever they count from. In other systems `local` is the CRS moved
/// to the origin, in metres.
///
/// fails  invalid_argument: an origin that is no finite number, a latitude beyond a pole; unsupported: ecef where the CRS
///        is not geographic
/// cost   linear; 24 bytes a corner. Any number of threads may call it
[[nodiscard]] std::vector<double> positions(const Mesh& mesh, const Description& description,
                                            Coordinates coordinates = Coordinates::crs, const LocalOrigin& origin = {});

/// The same as floats, rounded once: choose `local` with an origin in or near the mesh, or digits are lost.
[[nodiscard]] std::vector<float> float_positions(const Mesh& mesh, const Description& description,
                                                 Coordinates coordinates, const LocalOrigin& origin = {});

/// A unit vector for each corner: the mean of the normals of its triangles, each weighted by its area.
///
/// positions  of the same mesh, in metres: local or ecef
/// fails      invalid_argument: another number of positions than three a corner
[[nodiscard]] std::vector<float> normals(const Mesh& mesh, std::span<const double> positions);

}  // namespace talus
