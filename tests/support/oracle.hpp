#pragma once
// An independent judge of meshes: knows nothing of blocks, errors or quadtrees, only triangles and samples.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "talus/quadtree.hpp"
#include "talus/units.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {

struct OracleOptions {
  /// Of one cell, in metres, for the promise about outlines: a triangle that mixes data and void has no
  /// ground side longer than tolerance / void_weight. 0: not looked at.
  double cell_width_m = 0, cell_height_m = 0;
  double void_weight = 1;
  /// Vertices at valid samples have the source's height.
  bool heights_are_source = true;
};

/// What the judge found. Counts are of things that must not be, unless said otherwise.
struct OracleReport {
  // The surface.
  double largest_error = 0;  ///< metres, over covered samples
  GridPoint worst_sample{};
  std::uint64_t covered_samples = 0;    ///< corners of valid finest triangles of the region: how many there are
  std::uint64_t uncovered_samples = 0;  ///< of those, how many lie in no triangle of the mesh
  std::uint64_t triangles_over = 0;     ///< triangles with a covered sample beyond the tolerance
  std::uint64_t wrong_heights = 0;      ///< vertices at valid samples with another height than the sample
  bool exact = false;                   ///< all of it was computed in integers, and compared without slack

  // The plane below it, in finest triangles: halves of unit cells.
  std::uint64_t finest_triangles = 0;      ///< valid ones of the region: how many there are
  std::uint64_t uncovered_triangles = 0;   ///< of those, how many lie in no triangle of the mesh
  std::uint64_t overlapped_triangles = 0;  ///< valid or not, in more than one triangle of the mesh
  std::uint64_t idle_triangles = 0;        ///< triangles of the mesh that hold no valid finest triangle
  std::uint64_t mixed_triangles = 0;       ///< that hold both kinds: how many there are
  std::uint64_t coarse_outline = 0;        ///< mixed ones with too long a side
  std::uint64_t flipped = 0, degenerate = 0;
  bool area_wrong = false;  ///< only judged where there are no voids

  // The way they hang together.
  std::uint64_t overused_edges = 0;  ///< in more than two triangles, or twice in one direction
  std::uint64_t stray_edges = 0;     ///< in one triangle only, yet neither on the border nor on the outline
  std::uint64_t t_junctions = 0;     ///< vertices strictly inside an edge
  std::uint64_t duplicate_points = 0, orphan_points = 0, outside_points = 0, bad_indices = 0;

  std::vector<std::string> findings;  ///< the first few, spelled out

  /// Nothing was found that must not be.
  [[nodiscard]] bool sound() const;
  /// One line a finding, and the counts.
  [[nodiscard]] std::string summary() const;
};

/// Holds a mesh against the raster it claims to stand for.
///
/// mesh             over mesh.region, which must lie inside the raster; columns run east, rows south
/// raster           the whole source; its first sample is grid point (0, 0)
/// metres_per_unit  of heights
/// tolerance        metres; no slack where all heights are multiples of one binary fraction and a unit is a
///                  metre, for then every error is computed exactly; else a nanometre
/// cost             a few operations per sample, triangle and edge; about 50 bytes a sample
OracleReport check_mesh(const Mesh& mesh, const Terrain& raster, double metres_per_unit, double tolerance,
                        const OracleOptions& options = {});

/// Is the sample the corner of a valid finest triangle inside the region?
bool is_covered(const Terrain& raster, GridRect region, GridPoint sample);

/// Two meshes as one, points at one place made one. `region` is that of the result.
/// Meshes of adjoining regions meet without a crack iff their union is sound.
Mesh join(const Mesh& a, const Mesh& b, GridRect region);

}  // namespace talus::support
