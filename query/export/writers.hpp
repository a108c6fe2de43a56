#pragma once
// One function per format; write_mesh chooses.

#include "query/export/output_file.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Fails with invalid_argument for an ending write_mesh does not know, and where the folder is missing:
/// what write_mesh would find out only after the work.
void check_mesh_file(const std::filesystem::path& file);
/// Of these the folder, whatever the ending.
void check_folder(const std::filesystem::path& file);

/// Binary little endian; `double x y z` in CRS units and the vertical unit, `list uchar int
/// vertex_indices`. Fails with unsupported beyond 2³¹ − 1 vertices.
void write_ply(const Mesh& mesh, const Description& description, OutputFile& out);

/// Text; `v x y z` shortest round trip in the same units, `f` counted from 1.
void write_obj(const Mesh& mesh, const Description& description, OutputFile& out);

/// A picture, north up, some 800 to 1600 pixels on the longer side and as wide as it would look on the
/// ground: the surface lit from the north-west and tinted by height, its triangles over it, void in
/// grey. Triangles of few pixels fade into the relief.
void write_png(const Mesh& mesh, const Description& description, OutputFile& out);

}  // namespace talus
