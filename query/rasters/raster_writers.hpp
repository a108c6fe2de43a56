#pragma once
// One function per raster format; write_raster chooses.

#include "query/export/output_file.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// A picture, north up, some 800 to 1600 pixels on the longer side and as wide as it would look on the
/// ground: the surface lit from the north-west and tinted by height, its triangles over it, void in
/// grey. Triangles of few pixels fade into the relief.
void write_png(const Mesh& mesh, const Description& description, OutputFile& out);

/// GeoTIFF: the surface at the samples of the mesh's region, in the vertical unit; NaN, which is its nodata, where no
/// triangle is. Float32 where that holds every one of these heights exactly, else Float64; tiled, DEFLATE.
///
/// fails  full, io: GDAL's own sentence; unsupported: a GDAL that writes none
/// cost   the triangles are laid over the samples twice; memory 4 bytes a triangle and a strip of samples
void write_tif(const Mesh& mesh, const Description& description, OutputFile& out);

}  // namespace talus
