// Reports of files that hold several rasters, and of libraries that talk.

#include <memory>

#include <gdal_priv.h>

#include "talus/ingest.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Containers : public Report {
 protected:
  void SetUp() override {
    GDALAllRegister();
    if (GetGDALDriverManager()->GetDriverByName("netCDF") == nullptr) GTEST_SKIP() << "this GDAL has no netCDF driver";
  }
  /// A netCDF file with a variable a band.
  void write_nc(const std::string& name, const std::vector<std::pair<std::string, Band>>& variables,
                const char* format) const {
    std::vector<Band> bands;
    for (const auto& [variable, band] : variables) bands.push_back(band);
    write("source.tif", bands, {.crs = "EPSG:4326", .geotransform = {{8, 0.01, 0, 47, 0, -0.01}}});
    const std::unique_ptr<GDALDataset> source(
        GDALDataset::Open((folder / "source.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
    for (std::size_t i = 0; i < variables.size(); ++i)
      source->GetRasterBand(static_cast<int>(i) + 1)->SetMetadataItem("NETCDF_VARNAME", variables[i].first.c_str());
    const std::string word = std::string("FORMAT=") + format;
    char* words[] = {const_cast<char*>(word.c_str()), nullptr};
    GDALClose(GetGDALDriverManager()->GetDriverByName("netCDF")->CreateCopy((folder / name).c_str(), source.get(), 0,
                                                                            words, nullptr, nullptr));
  }
};

// A changed byte crashes the library or makes it take gigabytes: only files that somebody trusts are opened.
TEST_F(Containers, NetcdfIsOpenedOnlyIfTrusted) {
  write_nc("one.nc", {{"elevation", slope()}}, "NC");
  expect_refusal(ingest({"one.nc", "n.talus"}), {failed}, {"one.nc", "netCDF", "--allow-driver netCDF"});
  const Outcome trusted = ingest({"one.nc", "n.talus", "--allow-driver", "netCDF"});
  ASSERT_EQ(trusted.exit_code, done) << trusted.err;
  EXPECT_EQ(cells_of_database(folder / "n.talus").at(3, 4), 110);
}

// Deltares/hydromt#663, clawpack/geoclaw#286: which variable it is, and which there are.
TEST_F(Containers, AVariableIsChosenByName) {
  for (const char* format : {"NC", "NC4"}) {
    SCOPED_TRACE(format);
    write_nc("two.nc", {{"bed", slope()}, {"ice", constant(3000)}}, format);
    const Outcome several = ingest({"two.nc", "n.talus", "--allow-driver", "netCDF"});
    expect_refusal(several, {failed}, {"two.nc", "bed", "ice", "--variable"});
    const std::string ice = several.err.find("ice2") == std::string::npos ? "ice" : "ice2";  // GDAL may number them
    const Outcome chosen = ingest({"two.nc", "n.talus", "--allow-driver", "netCDF", "--variable", ice});
    ASSERT_EQ(chosen.exit_code, done) << chosen.err;
    EXPECT_EQ(cells_of_database(folder / "n.talus").at(3, 4), 3000);
    expect_refusal(ingest({"two.nc", "n.talus", "--allow-driver", "netCDF", "--variable", "elevtn"}), {usage},
                   {"two.nc", "elevtn", "bed"});
  }
}

// CyprienBosserelle/xbeach_gpu#14: pages of HDF5-DIAG beside a right result.
TEST_F(Containers, HdfIsQuiet) {
  write_nc("four.nc", {{"elevation", slope()}}, "NC4");
  const Outcome outcome = ingest({"four.nc", "n.talus", "--allow-driver", "netCDF"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_THAT(outcome.err + outcome.out, Not(HasSubstr("HDF5-DIAG")));
  EXPECT_THAT(talus({"info", "four.nc"}).err, Not(HasSubstr("HDF5-DIAG")));
}

}  // namespace
}  // namespace talus::support
