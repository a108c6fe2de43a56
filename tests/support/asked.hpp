#pragma once
// A random raster, ingested, and questions to it.

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/random.hpp"
#include "tests/support/random_raster.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {

struct Asked {
  explicit Asked(std::uint64_t number, SizeLimits limits = {}) : random(number), raster(random_raster(number, limits)) {
    write_raster(raster.terrain, folder / "a.tif", raster.file);
    IngestOptions options;
    options.void_weight = raster.void_weight;
    static_cast<void>(ingest(folder / "a.tif", folder / "a.talus", options));
    now.emplace(Database::open(folder / "a.talus").snapshot());
  }
  [[nodiscard]] Question question() {
    Question q;
    q.region = random_region(random, raster.terrain);
    q.tolerance = Metres{random_tolerance(random)};
    return q;
  }
  [[nodiscard]] std::string name(const Question& q) const {
    return raster.description + ", columns " + std::to_string(q.region.first.col) + " to " +
           std::to_string(q.region.last.col) + ", rows " + std::to_string(q.region.first.row) + " to " +
           std::to_string(q.region.last.row) + " at " + std::to_string(q.tolerance.value);
  }
  void expect_sound(const Question& q, const Answer& answer) const {
    const OracleReport report =
        check_mesh(triangulate(answer.quadtree), raster.terrain, now->description().metres_per_unit,
                   answer.quadtree.bound.value, raster.judging);
    EXPECT_TRUE(report.sound()) << name(q) << ": " << report.summary();
  }

  Random random;
  RandomRaster raster;
  TempFolder folder;
  std::optional<Snapshot> now;
};

/// Runs a property on random rasters.
template <class Property>
void for_rasters(int cases, Property&& property, SizeLimits limits = {}) {
  const auto only = property_seed();
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(property_cases(cases)); ++seed) {
    if (only && seed != *only) continue;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Asked asked(7000 + seed, limits);
    property(asked);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace talus::support
