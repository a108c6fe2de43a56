#pragma once
// Meshes as users receive them: files, read back without any code of the exporters.

#include <filesystem>

#include "talus/quadtree.hpp"
#include "talus/units.hpp"

namespace talus::support {

/// Reads .ply (as `talus query` writes it: binary little endian, double x y z, triangles) or .obj, and puts
/// every position back on the grid. Throws std::runtime_error where the file is not so, or a position is
/// no sample's.
///
/// A .glb, too, in a CRS of metres: heights come out in metres, by the node's transform in double. It is held to what
/// glTF 2.0 asks of chunks, accessors and buffer views.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& file, const GridMapping& mapping);

}  // namespace talus::support
