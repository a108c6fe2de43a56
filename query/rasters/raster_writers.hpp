#pragma once
// One function per raster format; write_raster chooses.

#include "query/export/output_file.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// A picture, north up, 800 to 1600 pixels on the longer side, with the proportions of the ground. The surface is lit
/// from the north-west and tinted by height, with its triangles on top; void is grey. Small triangles fade.
void write_png(const Mesh& mesh, const Description& description, OutputFile& out);

/// A GeoTIFF of the surface at the samples of the mesh's region, in the vertical unit. NaN is its nodata, where no
/// triangle is. Float32 if it holds all heights exactly, else Float64; tiled, DEFLATE.
///
/// fails  full, io: in GDAL's words; unsupported: this GDAL writes no GeoTIFF
/// cost   rasterizes the triangles twice; memory: 4 bytes a triangle and a strip of samples
void write_tif(const Mesh& mesh, const Description& description, OutputFile& out);

}  // namespace talus
