#pragma once
// What every hard case is held to: the promise, at the tolerances and rectangles where it breaks most easily, by the
// independent oracle; and the same answers from every kernel and any number of threads.

#include <optional>
#include <vector>

#include "talus/talus.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {

struct HardCase {
  Terrain terrain;                   ///< what the file holds, row 0 north; fits file.type
  RasterOptions file{};              ///< a geotransform with rows to the north or columns to the west is written so
  bool voids_are_nan = false;        ///< in the file, whatever number file.nodata names, if any
  OracleOptions judging{};           ///< ground sizes, where there are voids and cells are of one size
  double void_weight = 1;            ///< of ingest and of the judge
  double metres_per_unit = 1;        ///< of file.unit
  std::vector<double> tolerances{};  ///< in metres, besides those every case is asked at
  std::vector<GridRect> regions{};   ///< besides the whole, a part, and two that meet
};

/// A hard case, ingested.
class HardDatabase {
 public:
  explicit HardDatabase(HardCase hard);

  /// Everything below, and: samples bit for bit, verify() without a finding, an error reached is a tolerance
  /// itself and so is one ulp to either side, tighter tolerances have all vertices of looser ones, parts that share a
  /// side meet, streams and increments give answers back bit for bit, every kernel this CPU has and
  /// one or two threads give the same answers, all without a float exception. Failures are those of the running test.
  void hold_to_the_promise() const;

  /// The answer's mesh, held against every sample of the region, and its bound against the truth.
  [[nodiscard]] Mesh judged(GridRect region, double tolerance) const;
  [[nodiscard]] Mesh judged(double tolerance) const { return judged(extent(), tolerance); }

  /// An answer of the whole raster as a client gets it: the same bit for bit from a stream. Its mesh,
  /// held against every sample; rounded heights may differ from the source's.
  [[nodiscard]] Mesh streamed(const RestrictedQuadtree& answer) const;

  [[nodiscard]] GridRect extent() const { return {{0, 0}, {truth_.cols - 1, truth_.rows - 1}}; }
  [[nodiscard]] const Snapshot& now() const { return *now_; }
  [[nodiscard]] const Terrain& truth() const { return truth_; }  ///< in the vertical unit, scale and offset applied

 private:
  [[nodiscard]] double judge(const Mesh& mesh, double tolerance) const;
  [[nodiscard]] Mesh judged(GridRect region, double tolerance, double& true_error) const;
  [[nodiscard]] int watched_of_ingest() const;
  void check_samples() const;
  void check_verify(double tolerance) const;
  /// Returns the error it reached at a medium tolerance.
  double check_region(GridRect region, bool all) const;
  void check_neighbours(double tolerance) const;
  void check_streams(double tolerance) const;
  void check_kernels_and_threads(double tolerance) const;

  HardCase hard_;
  Terrain truth_;
  double range_m_ = 0;
  TempFolder folder_;
  std::optional<Snapshot> now_;
};

/// Is the point one of the mesh's?
[[nodiscard]] bool has_point(const Mesh& mesh, GridPoint p);

/// Ground sizes of the narrowest and flattest cell of a raster in degrees, on the WGS 84 ellipsoid: no triangle's sides
/// are shorter than with these.
[[nodiscard]] OracleOptions judging_in_degrees(const RasterOptions& file, int rows);

/// Samples of real ground: rolling hills in whole units, with edges nowhere in particular.
[[nodiscard]] Terrain hills(int cols, int rows, double amplitude = 100);

}  // namespace talus::support
