#pragma once
// One function per mesh format; write_mesh chooses.

#include <filesystem>
#include <string>

#include "query/export/output_file.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// The ending in small letters: ".ply" for "part.PLY".
[[nodiscard]] std::string ending_of(const std::filesystem::path& file);
/// Whether write_mesh knows the ending.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);
/// Fails before the work if the file cannot be written.
/// fails  io: no such folder, or the file is a folder
void check_folder(const std::filesystem::path& file);
/// Checks a mesh from outside, because writers index by its numbers.
/// fails  invalid_argument: heights or triangles that do not match the points; names the file
void check_mesh(const Mesh& mesh, const std::filesystem::path& file);

/// Binary little endian: `double x y z` in CRS units and the vertical unit, `list uchar int vertex_indices`.
/// fails  unsupported: more than 2³¹ − 1 vertices
void write_ply(const Mesh& mesh, const Description& description, OutputFile& out);

/// Text: `v x y z`, the shortest decimals that give the doubles back, in the same units; `f` counts from 1.
void write_obj(const Mesh& mesh, const Description& description, OutputFile& out);

/// glTF 2.0 in one binary file: one node, one mesh, float positions, uint32 indices; y up, x east, z south, metres.
///
/// x and z count cells from the grid point in the middle of the region: whole numbers, exact in floats. y has the
/// source's own floats, or height steps from the middle height, if these restore every height; else the nearest floats
/// to the distances from the middle height. The node's scale converts to metres. Its translation places the mesh: in a
/// projected CRS at (x, height, -y) in metres, so that doubles give every position back; in a geographic CRS at the
/// middle, with cells of their size on the ground there. asset.extras has the CRS, its origin and the steps to restore
/// coordinates.
///
/// returns  how far the file's surface may lie from the mesh's, in metres: 0 if floats hold the heights, else at most
///          2⁻²⁵ of their range. At the cuts of a frame (clip_mesh) corners also move sideways, by at most 2⁻²⁴ of half
///          the region's side, and the slope turns that into height
/// fails    unsupported: more than 4 GiB, heights too large for floats, more than 2²⁴ cells from the middle
Metres write_glb(const Mesh& mesh, const Description& description, OutputFile& out);

}  // namespace talus
