#pragma once
// Meshes as rasters and pictures. Needs GDAL: link talus::ingest.

#include <filesystem>

#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// Writes a mesh as a raster. The ending of `file` says how: .tif is a GeoTIFF with the surface's height at every sample,
/// NaN where no triangle is; .png is a picture, shaded relief with the triangles over it. The file is written under
/// another name and then renamed: it appears whole or not at all.
///
/// fails  invalid_argument: another ending, or a mesh whose numbers do not fit; unsupported: a GDAL without the format;
///        io, full
/// cost   .tif: four bytes a triangle and a strip of samples
void write_raster(const Mesh& mesh, const Description& description, const std::filesystem::path& file);

/// Whether write_raster knows the ending.
[[nodiscard]] bool is_raster_file(const std::filesystem::path& file);

}  // namespace talus
