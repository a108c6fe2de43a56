#pragma once
// Compares a mesh with every sample.

#include <array>
#include <cstdint>
#include <functional>

#include "query/accuracy/error_distribution.hpp"
#include "talus/database.hpp"
#include "talus/description.hpp"
#include "talus/quadtree.hpp"

namespace talus {

struct TrueError {
  double largest_perpendicular_m = 0;  ///< the same, perpendicular to each triangle, if cell sizes were given
  double largest_m = 0;                ///< metres between surface and sample, over the valid samples in triangles
  std::uint64_t covered = 0;           ///< corners of valid finest triangles inside the mesh's region
  std::uint64_t uncovered = 0;         ///< covered samples in no triangle
  std::uint64_t stray = 0;             ///< valid samples that are neither covered nor in a triangle
  /// Errors of the valid samples in triangles, each once. On an edge, the triangle that is farther away counts.
  ErrorDistribution errors;
};

/// Receives a sample and how many metres the surface lies above it; negative if below.
using ErrorVisitor = std::function<void(GridPoint sample, double metres)>;

/// Width and height in metres of the cells on a row.
using CellsOfRow = std::function<std::array<double, 2>(std::int32_t row)>;

/// Measures by brute force, independently of the code that made the mesh: compares each triangle with each sample in
/// it. A finest triangle is half a cell, cut from the corner with an even sum of column and row to the opposite one. It
/// is valid if its three corners are.
///
/// truth   called with strips of whole rows of `mesh.region`, from north to south, overlapping by two rows
/// visit   if given, receives each sample of `errors`, row by row
/// cells   if given, perpendicular distances are measured, too; a triangle has the cells of the row in the middle of
///         its longest side
/// fails   as `truth` does
/// cost    time linear in samples + triangles; memory 4 bytes a triangle and a strip of samples
TrueError true_error(const Mesh& mesh, const Description& description, const SampleReader& truth,
                     const ErrorVisitor& visit = {}, const CellsOfRow& cells = {});

}  // namespace talus
