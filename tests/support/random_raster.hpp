#pragma once
// Rasters of every kind the ingest takes, each made from one number.

#include <cstdint>
#include <string>

#include "talus/units.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {

struct RandomRaster {
  Terrain terrain;  ///< fits the file's type; has at least one valid sample
  RasterOptions file;
  OracleOptions judging;  ///< ground sizes where they are plain
  double void_weight = 1;
  std::string description;  ///< for the message of a test that fails
};

struct SizeLimits {
  int least_cols = 1, least_rows = 1, most_cols = 300, most_rows = 200;
};

[[nodiscard]] RandomRaster random_raster(std::uint64_t seed, SizeLimits limits = {});

/// A rectangle of samples inside the terrain: often all of it, sometimes a line or a single sample.
[[nodiscard]] GridRect random_region(Random& random, const Terrain& terrain);

/// A tolerance in metres, 0 and infinity among them, and many that are exactly some sample's error.
[[nodiscard]] double random_tolerance(Random& random);

/// How many cases a property is tried with: `usual`, or in proportion if TALUS_PROPERTY_CASES (usually 1000)
/// says so.
[[nodiscard]] int property_cases(int usual);

/// The one seed to try, if TALUS_PROPERTY_SEED names it: what a failing test printed.
[[nodiscard]] std::optional<std::uint64_t> property_seed();

}  // namespace talus::support
