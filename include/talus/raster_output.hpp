#pragma once
// Meshes as rasters and pictures. Needs GDAL: link talus::ingest.

#include <filesystem>

#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Writes a mesh as a raster. The name of `file` ends in .tif (a GeoTIFF: the surface at every sample, NaN
/// where there is no triangle) or .png (a picture: shaded relief and triangles). The file is written under another name
/// and then renamed, so it appears whole or not at all.
///
/// fails  invalid_argument: another ending, or a mesh whose parts do not match; unsupported: GDAL lacks the format;
///        io, full
/// cost   .tif: four bytes a triangle and a strip of samples
void write_raster(const Mesh& mesh, const Description& description, const std::filesystem::path& file);

/// Whether the name ends in .tif or .png.
[[nodiscard]] bool is_raster_file(const std::filesystem::path& file);

}  // namespace talus
