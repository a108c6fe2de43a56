#pragma once
// What can be asked of a snapshot.

#include <cstdint>
#include <memory>
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
/// fails  invalid_argument: numbers that are none, a tolerance or growth below 0, a point beyond where the CRS has a
///        ground (latitudes)
[[nodiscard]] std::shared_ptr<const ToleranceField> focus_tolerance(const Description& description, double x, double y,
                                                                    double metres_per_metre, Metres at_focus);

/// One tolerance a patch: `cols` × `rows` equal patches over a region, row by row from the north-west, the last of a row
/// or column perhaps smaller. A sample on the line between patches belongs to the next one; samples beyond the region have
/// infinity.
/// fails  invalid_argument: another number of metres than patches, negative or none; more patches than samples
[[nodiscard]] std::shared_ptr<const ToleranceField> patch_tolerance(GridRect region, std::int32_t cols, std::int32_t rows,
                                                                    std::vector<double> metres);

/// Everything but the region and tolerance has a default that asks for nothing.
struct Question {
  GridRect region{{0, 0}, {-1, -1}};
  Metres tolerance{0};
  Border border = Border::constrain;
  /// Instead of `tolerance`, where there is one.
  std::shared_ptr<const ToleranceField> field = {};
  /// No vertex of a finer level, save where the border needs it; the answer's bound says what that costs. Level 0 is the
  /// coarsest: one vertex amid the root square.
  int max_level = 31;
  /// Samples of the region that must be vertices, whatever their error.
  std::vector<GridPoint> points = {};
  /// Answers that this one is to meet, each where it shares a side or a part of one with the region: its vertices there
  /// become vertices here, with all they depend on. Whole answers of this state of the database with a constrained border;
  /// they need to live as long as the call.
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
