#pragma once
// The judge: a mesh held against every sample.

#include <array>
#include <cstdint>
#include <functional>

#include "query/accuracy/error_distribution.hpp"
#include "talus/database.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

struct TrueError {
  double largest_perpendicular_m = 0;  ///< the same at right angles to each triangle, if cell sizes were given
  double largest_m = 0;                ///< metres between surface and sample, over the valid samples a triangle touches
  std::uint64_t covered = 0;           ///< corners of valid finest triangles inside the mesh's region
  std::uint64_t uncovered = 0;         ///< of those, the ones no triangle of the mesh touches
  std::uint64_t stray = 0;             ///< valid samples that are not covered and that no triangle touches
  /// Of the valid samples that a triangle touches, each once: on an edge it counts with the triangle that is farther.
  ErrorDistribution errors;
};

/// Told of a judged sample: metres of the surface above it, below 0 where the surface runs under it.
using ErrorVisitor = std::function<void(GridPoint sample, double metres)>;

/// Metres of a cell's width and height on a row.
using CellsOfRow = std::function<std::array<double, 2>(std::int32_t row)>;

/// Brute force, and nothing of it shared with the code that made the mesh: each triangle is laid over
/// each sample in it. A finest triangle is half a cell, cut from the corner with an even sum of column
/// and row to the other one, and valid iff its three corners are.
///
/// truth   called with strips of whole rows of `mesh.region`, from north to south, overlapping by two rows
/// visit   if given, told of each sample of `errors`, row by row
/// cells   if given, distances at right angles are measured, too, with cells as on the row in the middle of a
///         triangle's longest side
/// fails   as `truth` does
/// cost    time linear in samples + triangles; memory 4 bytes a triangle and a strip of samples
TrueError true_error(const Mesh& mesh, const Description& description, const SampleReader& truth,
                     const ErrorVisitor& visit = {}, const CellsOfRow& cells = {});

}  // namespace talus
