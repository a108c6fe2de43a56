#pragma once
// One function per format; write_mesh chooses.

#include <filesystem>
#include <string>

#include "query/export/output_file.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// ".ply" of "part.PLY": in small letters.
[[nodiscard]] std::string ending_of(const std::filesystem::path& file);
/// Whether write_mesh knows the ending.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);
/// What a writer would find out only after the work.
/// fails  io: no such folder, or the file is a folder
void check_folder(const std::filesystem::path& file);
/// A mesh may come from anywhere, and writers index by it.
/// fails  invalid_argument: heights or triangles that do not fit the points; names the file
void check_mesh(const Mesh& mesh, const std::filesystem::path& file);

/// Binary little endian; `double x y z` in CRS units and the vertical unit, `list uchar int
/// vertex_indices`. Fails with unsupported beyond 2³¹ − 1 vertices.
void write_ply(const Mesh& mesh, const Description& description, OutputFile& out);

/// Text; `v x y z` shortest round trip in the same units, `f` counted from 1.
void write_obj(const Mesh& mesh, const Description& description, OutputFile& out);

/// glTF 2.0 in one binary file: one node, one mesh, float positions, uint32 indices; y up, x east, z south, metres.
///
/// Positions count from the grid point amid the region, in cells across and down: whole numbers, which floats hold
/// exactly. Up they are the source's own floats, or height steps from the middle height, where these restore every
/// height; else the nearest float to the distance from the middle height. The node's scale makes metres of them, its
/// translation the place: of a projected CRS its coordinates in metres (x, height, -y), so that double arithmetic gives
/// every position back; of a geographic one the middle, cells having the size they have on the ground there.
/// asset.extras holds the CRS, the origin in it and what restores coordinates in it.
///
/// returns  how far the file's surface may lie from the mesh's, in metres: 0 for heights that floats hold, at most 2⁻²⁵
///          of the range of others. Where a frame cut (clip_mesh) corners move sideways, by 2⁻²⁴ of the region's half
///          side at most, and slope turns that into height
/// fails    unsupported: more than 4 GiB, heights beyond floats, more than 2²⁴ cells from the middle
Metres write_glb(const Mesh& mesh, const Description& description, OutputFile& out);

}  // namespace talus
