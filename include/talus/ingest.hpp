#pragma once
// Rasters to databases.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/units.hpp"

namespace talus {

/// The grid of an existing database, for inputs that are to fit it.
struct Grid {
  GridMapping mapping;
  GridRect extent{{0, 0}, {-1, -1}};  ///< what it holds today; says on which side of the antimeridian new data belongs
  std::string crs_wkt;
  std::string vertical_unit = "metre";
  double metres_per_unit = 1;
  std::optional<HeightStep> step;  ///< codes must be in this one, as where a database is updated; empty: any will do
};
[[nodiscard]] Grid grid_of(const Description& description);

/// How inputs are read.
struct InputOptions {
  std::vector<std::string> allow_drivers;  ///< GDAL drivers that may open files, beyond those Talus trusts
  std::string srs;            ///< the CRS of inputs, said from outside: EPSG:…, WKT or PROJ; empty: what they state
  std::string vertical_unit;  ///< of inputs, said from outside: metre, foot, us-survey-foot, km, dm, cm, mm
  /// Resample inputs that are not on it to this grid: any of CRS, cell size in its units (both or none), and
  /// method (near, bilinear, cubic, average). What is left out is the first input's, and bilinear.
  std::string target_srs;
  double target_dx = 0, target_dy = 0;
  std::string resampling;
  std::optional<Grid> grid;          ///< or to this one
  bool priority_resolution = false;  ///< where inputs overlap the one with smaller cells wins, not the later one
  double height_step = 0;            ///< round heights to multiples of so many metres; 0: keep them
};

struct IngestOptions {
  bool overwrite = false;    ///< replace an existing database; without it one that exists is a failure
  double void_weight = 1.0;  ///< metres of error per metre of ground side where a triangle mixes data and void
  /// Told now and then how much of the work is done, 0 to 1, and in what.
  std::function<void(double fraction, const char* stage)> progress = {};
};

struct IngestReport {
  Description description;
  std::uint64_t pages = 0;  ///< pages written
  std::uint64_t bytes = 0;  ///< size of the database file
  double seconds = 0;
};

/// Makes a database from one raster.
///
/// input     a local raster file GDAL reads: Byte, Int16, UInt16, Int32, UInt32, Float32 or Float64, one band
///           (the first is taken), nodata and NaN are voids; heights within ±10⁶ metres
/// database  the file to make; work happens in `database`.part and is renamed at the end
/// fails     not_found, unsupported (driver, type, rotation, more samples than memory), invalid_argument (no band, all
/// void, a value
///           that is no height, database exists), full, io; nothing is left behind
/// cost      memory about 20 bytes a sample, checked beforehand; time about linear
/// source    exact errors [P98 §5], saturation, pages docs/format/v1.md
IngestReport ingest(const std::filesystem::path& input, const std::filesystem::path& database,
                    const IngestOptions& options = {});

/// Inputs opened for comparison: the same samples `ingest` would take.
///
/// inputs  raster files, folders of them, and "@list.txt", which names one a line
/// fails   as ingest does for its inputs
class Raster {
 public:
  explicit Raster(const std::filesystem::path& input);
  Raster(const std::vector<std::filesystem::path>& inputs, const InputOptions& options);
  ~Raster();
  Raster(Raster&&) noexcept;
  Raster& operator=(Raster&&) noexcept;

  [[nodiscard]] const Description& description() const;
  /// The samples of a rectangle, row 0 north, memory in proportion to it. Fails with io or invalid_argument.
  [[nodiscard]] SampleWindow read(GridRect part) const;

 private:
  struct Opened;
  std::unique_ptr<Opened> opened_;
};

}  // namespace talus
