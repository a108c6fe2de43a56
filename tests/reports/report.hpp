#pragma once
// What the tests of public reports share: a folder, the program, and GDAL's own reading of a raster.

#include <functional>

#include "talus/ingest.hpp"
#include "tests/cli/command.hpp"
#include "tests/support/gdal_cells.hpp"

namespace talus::support {

class Report : public Command {
 protected:
  static constexpr int kSide = 40;

  /// A slope of whole numbers from 100 to 217, or whatever `height` says.
  static Band slope(const std::function<double(int col, int row)>& height = [](int col, int row) {
    return 100.0 + 2 * col + row;
  }) {
    Band band;
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) band.samples.push_back(height(col, row));
    }
    return band;
  }
  static Band constant(double value, GDALColorInterp meaning = GCI_Undefined) {
    return {std::vector<double>(kSide * kSide, value), meaning};
  }
  static Band with_meaning(Band band, GDALColorInterp meaning) {
    band.meaning = meaning;
    return band;
  }
  /// A square of ten cells a side, within the band.
  static void burn(Band& band, int col, int row, double value) {
    for (int r = row; r < row + 10; ++r) {
      for (int c = col; c < col + 10; ++c) band.samples[static_cast<std::size_t>(r * kSide + c)] = value;
    }
  }
  void write(const std::string& name, const std::vector<Band>& bands, const BandsOptions& options = {}) const {
    write_bands(folder / name, kSide, kSide, bands, options);
  }
  [[nodiscard]] Outcome ingest(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"ingest", "--overwrite"});
    return talus(arguments);
  }
  /// Ingests one raster and holds the database against GDAL's reading of it.
  void expect_as_gdal_reads(const std::string& name, int voids) const {
    const Outcome outcome = ingest({name, "d.talus"});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    const Cells expected = cells_of(folder / name);
    EXPECT_EQ(expected.voids(), voids) << "the raster is not what this test means";
    EXPECT_EQ(different(cells_of_database(folder / "d.talus"), expected), 0);
  }
};

}  // namespace talus::support
