#pragma once
// Tiles of one grid, for tests of several inputs.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "ingest/mosaic/source.hpp"
#include "talus/ingest.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {

/// Tiles of cells of 10 m whose north-west corner is given in cells east and south of 500000, 5200000.
class TilesTest : public ::testing::Test {
 protected:
  static RasterOptions at(int col, int row, SampleType type = SampleType::int16) {
    RasterOptions options;
    options.type = type;
    options.crs = "EPSG:25832";
    options.geotransform = {500000.0 + 10 * col, 10, 0, 5200000.0 - 10 * row, 0, -10};
    return options;
  }
  std::filesystem::path write(const std::string& name, const Terrain& terrain, const RasterOptions& options) {
    write_raster(terrain, folder_ / name, options);
    return folder_ / name;
  }
  std::filesystem::path constant(const std::string& name, int cols, int rows, double height,
                                 const RasterOptions& options) {
    return write(name, surface(cols, rows, [&](int, int) { return height; }), options);
  }
  std::filesystem::path write_text(const std::string& name, const std::string& text) {
    std::ofstream{folder_ / name} << text;
    return folder_ / name;
  }
  static Failure failure_with(const std::vector<std::filesystem::path>& files, const InputOptions& options = {}) {
    return failure_of([&] { Source{files, options}; });
  }

  TempFolder folder_;
};

}  // namespace talus::support
