#pragma once
// What can be asked of a snapshot.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "talus/description.hpp"
#include "talus/units.hpp"

namespace talus {

struct RestrictedQuadtree;

/// Where an answer ends.
enum class Border {
  constrain,  ///< at the region's sides, which are mesh edges: answers at one tolerance meet there
  cover,      ///< behind it: all triangles of the whole raster's answer that meet the region, as they are
  clip        ///< those triangles, cut at the rectangle as it was asked for (see clip_mesh)
};

/// A tolerance that varies from sample to sample.
class ToleranceField {
 public:
  virtual ~ToleranceField() = default;
  /// At a sample. Metres, >= 0, infinity allowed.
  [[nodiscard]] virtual double at(GridPoint p) const = 0;
  /// No more than the smallest of all samples of a rectangle, which may leave the extent. The closer, the fewer
  /// vertices. Called from several threads.
  [[nodiscard]] virtual double least(GridRect rect) const = 0;
};

/// Grows in proportion to the distance on the ground from a point in CRS coordinates, as ground looks from there. The
/// cell's size is taken where the point is.
/// fails  invalid_argument: numbers that are none, a tolerance or growth below 0, a point outside the raster or beyond
///        where the CRS has a ground (latitudes)
[[nodiscard]] std::shared_ptr<const ToleranceField> focus_tolerance(const Description& description, double x, double y,
                                                                    double metres_per_metre, Metres at_focus);

/// One tolerance a patch: `cols` × `rows` patches over a region, as equal as whole samples allow, row by row from the
/// north-west. Samples beyond the region have infinity.
/// fails  invalid_argument: another number of metres than patches, negative or none; more patches than samples
[[nodiscard]] std::shared_ptr<const ToleranceField> patch_tolerance(GridRect region, std::int32_t cols,
                                                                    std::int32_t rows, std::vector<double> metres);

/// One tolerance a cell of a raster: each sample of a region has that of the cell it lies in, on the line between two
/// that of the next one. The outermost cells reach one sample further, so that a raster over the very rectangle that
/// was asked for will do. Samples beyond the region have infinity.
///
/// cells   where the cells' centres are in the database's CRS, by column and row of `metres`
/// metres  cells in which no sample lies are not looked at
/// fails   invalid_argument: a sample in no cell; a cell that is void, negative or no number; names it
[[nodiscard]] std::shared_ptr<const ToleranceField> raster_tolerance(const Description& description, GridRect region,
                                                                     const GridMapping& cells,
                                                                     const SampleWindow& metres);

/// The samples nearest to points, for Question::points; of two that are as near, the one to the east or south.
/// returns  as many, in their order
/// fails    invalid_argument: a coordinate that is no finite number; a point whose sample is not in the region
[[nodiscard]] std::vector<GridPoint> samples_nearest(const Description& description, GridRect region,
                                                     std::span<const Position> points);

/// The samples nearest to a line that is straight between its points: one a step along the longer axis of each part,
/// and those nearest to its ends. Each is a neighbour of the one before, on the grid or across a cell. As vertices they
/// hold the surface to the samples along the line; edges need not follow it. A sample that the line comes back to
/// stands where it came first.
/// fails  invalid_argument: fewer than two points; as samples_nearest
/// cost   time in proportion to the line's steps; memory to the samples returned, at most 8 bytes and a bit for each of
///        the region's
[[nodiscard]] std::vector<GridPoint> samples_along(const Description& description, GridRect region,
                                                   std::span<const Position> line);
/// Of several lines, each sample once.
[[nodiscard]] std::vector<GridPoint> samples_along(const Description& description, GridRect region,
                                                   std::span<const std::vector<Position>> lines);

/// Everything but the region and tolerance has a default that asks for nothing.
struct Question {
  GridRect region{{0, 0}, {-1, -1}};
  Metres tolerance{0};
  Border border = Border::constrain;
  /// Instead of `tolerance`, where there is one.
  std::shared_ptr<const ToleranceField> field = {};
  /// No vertex of a finer level, save where the border needs it; the answer's bound says what that costs. Level 0 is
  /// the coarsest: one vertex amid the root square.
  int max_level = 31;
  /// Samples of the region that must be vertices, whatever their error. A void one is none for that: it is counted in
  /// Answer::void_points and otherwise as if nobody had asked for it.
  std::vector<GridPoint> points = {};
  /// Answers that this one is to meet, each where it shares a side or a part of one with the region: its vertices there
  /// become vertices here, with all they depend on. Whole answers of this state of the database with a constrained
  /// border; they need to live as long as the call.
  std::vector<const RestrictedQuadtree*> neighbours = {};
};

/// A region that grows outward to multiples of `samples` from grid point (0, 0), and ends with the extent: borders on
/// multiples of 16 need few vertices of their own.
/// fails  invalid_argument: fewer than 1
[[nodiscard]] GridRect snapped(GridRect region, std::int32_t samples, GridRect extent);

/// The finest level that a raster has: vertices of spacing 1.
[[nodiscard]] int finest_level(GridRect extent);

/// What a budget allows.
struct Budget {
  std::uint64_t vertices = 0, triangles = 0;  ///< at most so many; 0: any number
};

}  // namespace talus
