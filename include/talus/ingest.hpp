#pragma once
// Rasters to databases.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/units.hpp"

namespace talus {

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

/// A raster opened for comparison: the same samples `ingest` would take.
///
/// fails  as ingest does for its input
class Raster {
 public:
  explicit Raster(const std::filesystem::path& input);
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
