#include "ingest/mosaic/source.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <gdal.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "talus/ingest.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"

namespace talus {
namespace {

using support::all_codes;
using support::failure_of;
using support::open;
using support::RasterOptions;
using support::SampleType;
using support::spelled;
using support::TempFolder;
using support::Terrain;
using support::write_raster;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// 3 x 2, all different: 0 1 2 / 3 4 5
Terrain counting() {
  return support::surface(3, 2, [](int col, int row) { return 3 * row + col; });
}

class SourceTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const Terrain& terrain, const RasterOptions& options = {}) {
    write_raster(terrain, folder_ / "dem.tif", options);
    return folder_ / "dem.tif";
  }
  std::filesystem::path write_text(const std::string& name, std::string_view text) {
    std::ofstream{folder_ / name} << text;
    return folder_ / name;
  }
  // A virtual raster of 3 x 2 samples whose band holds `inside`.
  std::filesystem::path write_vrt(const std::string& name, const std::string& inside,
                                  const std::string& band = R"(dataType="Int16" band="1")") {
    return write_text(name, R"(<VRTDataset rasterXSize="3" rasterYSize="2"><VRTRasterBand )" + band + ">" + inside +
                                "</VRTRasterBand></VRTDataset>");
  }
  static std::string source(const std::string& file) {
    return R"(<SimpleSource><SourceFilename relativeToVRT="1">)" + file + "</SourceFilename></SimpleSource>";
  }

  TempFolder folder_;
};

TEST_F(SourceTest, SamplesArePixelCentres) {
  RasterOptions options;
  options.geotransform = {100, 10, 0, 200, 0, -20};
  options.crs = "EPSG:32632";
  const Source dem = open(write(counting(), options));
  const Description& d = dem.description();
  EXPECT_EQ(d.extent, (GridRect{{0, 0}, {2, 1}}));
  EXPECT_EQ(d.mapping, (GridMapping{105, 190, 10, -20}));
  EXPECT_EQ(d.source_name, "dem.tif");
  EXPECT_EQ(d.source_type, "Int16");
  EXPECT_EQ(d.vertical_unit, "metre");
  EXPECT_THAT(d.crs_wkt, HasSubstr("UTM zone 32N"));
  EXPECT_THAT(all_codes(dem).codes, ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST_F(SourceTest, SouthUpAndMirroredRastersAreTurned) {
  RasterOptions options;
  options.geotransform = {100, 10, 0, 200, 0, 20};  // rows run north
  {
    const Source dem = open(write(counting(), options));
    EXPECT_EQ(dem.description().mapping, (GridMapping{105, 230, 10, -20}));
    EXPECT_THAT(all_codes(dem).codes, ElementsAre(3, 4, 5, 0, 1, 2));
    EXPECT_THAT(spelled(dem.read({{1, 1}, {2, 1}})).codes, ElementsAre(1, 2));
  }
  options.geotransform = {100, -10, 0, 200, 0, 20};  // and columns west
  const Source dem = open(write(counting(), options));
  EXPECT_EQ(dem.description().mapping, (GridMapping{75, 230, 10, -20}));
  EXPECT_THAT(all_codes(dem).codes, ElementsAre(5, 4, 3, 2, 1, 0));
  EXPECT_THAT(spelled(dem.read({{0, 0}, {0, 1}})).codes, ElementsAre(5, 2));
}

TEST_F(SourceTest, ARasterWithoutPlaceCountsPixels) {
  RasterOptions options;
  options.geotransform = {0, 1, 0, 0, 0, 1};  // GDAL's word for none
  EXPECT_EQ(open(write(counting(), options)).description().mapping, (GridMapping{0.5, -0.5, 1, -1}));
}

TEST_F(SourceTest, NodataIsComparedInTheSamplesOwnType) {
  Terrain terrain = counting();
  terrain.make_void(1, 1);
  RasterOptions options;
  options.type = SampleType::float32;
  options.nodata = -3.4028234663852886e38;
  EXPECT_THAT(all_codes(open(write(terrain, options))).valid, ElementsAre(1, 1, 1, 1, 0, 1));
  options.nodata = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(all_codes(open(write(terrain, options))).valid, ElementsAre(1, 1, 1, 1, 0, 1));
}

TEST_F(SourceTest, NodataThatNoSampleCanHoldMeansNothing) {
  write(counting());
  const Source dem = open(write_vrt("v.vrt", "<NoDataValue>0.5</NoDataValue>" + source("dem.tif")));
  EXPECT_THAT(all_codes(dem).valid, ElementsAre(1, 1, 1, 1, 1, 1));
}

TEST_F(SourceTest, AMaskIsHonoured) {
  const std::filesystem::path file = write(counting());
  {
    GDALDatasetH dataset = GDALOpen(file.c_str(), GA_Update);
    ASSERT_NE(dataset, nullptr);
    ASSERT_EQ(GDALCreateDatasetMaskBand(dataset, GMF_PER_DATASET), CE_None);
    std::array<std::uint8_t, 6> mask{255, 255, 0, 255, 255, 255};
    GDALRasterBandH band = GDALGetMaskBand(GDALGetRasterBand(dataset, 1));
    ASSERT_EQ(GDALRasterIO(band, GF_Write, 0, 0, 3, 2, mask.data(), 3, 2, GDT_Byte, 0, 0), CE_None);
    GDALClose(dataset);
  }
  EXPECT_THAT(all_codes(open(file)).valid, ElementsAre(1, 1, 0, 1, 1, 1));
}

TEST_F(SourceTest, IntegersStayCodesAndTheBandsScaleIsTheStep) {
  RasterOptions options;
  options.scale = 0.1;
  options.offset = -5;
  options.unit = "ft";
  const Source dem = open(write(counting(), options));
  EXPECT_EQ(dem.description().step, (HeightStep{0.1, 1, -5, true}));
  EXPECT_EQ(dem.description().metres_per_unit, 0.3048);
  EXPECT_THAT(all_codes(dem).codes, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(Raster{folder_ / "dem.tif"}.read({{2, 1}, {2, 1}}).values[0], 5 * 0.1 - 5);
}

TEST_F(SourceTest, MinusZeroSurvives) {
  Terrain terrain = counting();
  terrain.at(0, 0) = -0.0;
  for (const SampleType type : {SampleType::float32, SampleType::float64}) {
    for (const double scale : {1.0, 0.5}) {
      RasterOptions options;
      options.type = type;
      options.scale = scale;
      const Source dem = open(write(terrain, options));
      EXPECT_TRUE(std::signbit(all_codes(dem).codes[0]));
      EXPECT_TRUE(std::signbit(Raster{folder_ / "dem.tif"}.read({{0, 0}, {0, 0}}).values[0]));
    }
  }
}

TEST_F(SourceTest, AValueThatIsNoHeightIsNamed) {
  Terrain terrain = counting();
  terrain.at(2, 1) = std::numeric_limits<double>::infinity();
  RasterOptions options;
  options.type = SampleType::float32;
  const Source dem = open(write(terrain, options));
  const Failure failure = failure_of([&] { static_cast<void>(all_codes(dem)); });
  EXPECT_EQ(failure.cause(), Cause::invalid_argument);
  EXPECT_THAT(failure.what(), HasSubstr("inf metre at column 2, row 1"));
}

TEST_F(SourceTest, APartBeyondTheExtentIsRefused) {
  const Source dem = open(write(counting()));
  for (const GridRect part : {GridRect{{0, 0}, {3, 1}}, GridRect{{-1, 0}, {1, 1}}, GridRect{{1, 1}, {0, 0}}}) {
    EXPECT_EQ(failure_of([&] { static_cast<void>(dem.read(part)); }).cause(), Cause::invalid_argument);
  }
}

TEST_F(SourceTest, UnitsAreKnownOrRefused) {
  RasterOptions options;
  options.unit = "US survey foot";
  EXPECT_EQ(open(write(counting(), options)).description().metres_per_unit, 1200.0 / 3937.0);
  options.unit = "fathom";
  const Failure failure = failure_of([&] { static_cast<void>(open(write(counting(), options))); });
  EXPECT_EQ(failure.cause(), Cause::unsupported);
  EXPECT_THAT(failure.what(), HasSubstr("fathom"));
}

TEST_F(SourceTest, NothingIsLeftBesideTheRaster) {
  const std::filesystem::path file = write(counting());
  static_cast<void>(all_codes(open(file)));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder_.path()}, {}), 1);
}

TEST_F(SourceTest, TheHostsErrorHandlerIsAsItWas) {
  int called = 0;
  CPLPushErrorHandlerEx([](CPLErr, CPLErrorNum, const char*) { ++*static_cast<int*>(CPLGetErrorHandlerUserData()); },
                        &called);
  static_cast<void>(failure_of([&] { static_cast<void>(open(write_text("not.tif", "II*"))); }));
  EXPECT_EQ(called, 0);
  CPLError(CE_Warning, CPLE_AppDefined, "ours again");
  CPLPopErrorHandler();
  EXPECT_EQ(called, 1);
}

// ---- virtual rasters -----------------------------------------------------------------------------

TEST_F(SourceTest, AVirtualRasterOfItsOwnFolderIsRead) {
  write(counting());
  std::filesystem::create_directory(folder_ / "tiles");
  std::filesystem::rename(folder_ / "dem.tif", folder_ / "tiles/dem.tif");
  write_vrt("inner.vrt", source("tiles/dem.tif"));
  EXPECT_THAT(all_codes(open(write_vrt("outer.vrt", source("inner.vrt")))).codes, ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST_F(SourceTest, AVirtualRasterThatReachesOutIsRefused) {
  write(counting());
  const TempFolder elsewhere;
  write_raster(counting(), elsewhere / "far.tif");
  std::filesystem::create_symlink(elsewhere / "far.tif", folder_ / "link.tif");
  write_text("net.xml",
             "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>http://localhost/</ServerUrl></Service></GDAL_WMS>");
  const std::string derived = R"(dataType="Int16" band="1" subClass="VRTDerivedRasterBand")";
  const std::string raw = R"(dataType="Int16" band="1" subClass="VRTRawRasterBand")";
  const std::filesystem::path cases[] = {
      write_vrt("far.vrt", source((elsewhere / "far.tif").string())),
      write_vrt("link.vrt", source("link.tif")),
      write_vrt("vsi.vrt", source("/vsicurl/http://localhost/dem.tif")),
      write_vrt("url.vrt", source("http://localhost/dem.tif")),
      write_vrt("subdataset.vrt", source("GTIFF_DIR:1:dem.tif")),
      write_vrt("service.vrt", source("net.xml")),
      write_vrt("itself.vrt", source("itself.vrt")),
      write_vrt("derived.vrt", source("dem.tif"), derived),
      write_vrt("raw.vrt", source("dem.tif"), raw),
      write_vrt("array.vrt", "<ArraySource/>"),
      write_vrt("overview.vrt", "<Overview>" + source("dem.tif") + "</Overview>" + source("dem.tif")),
      write_vrt("options.vrt", R"(<SimpleSource><SourceFilename relativeToVRT="1">dem.tif</SourceFilename>)"
                               "<OpenOptions/></SimpleSource>"),
      write_text("warped.vrt", R"(<VRTDataset rasterXSize="3" rasterYSize="2" subClass="VRTWarpedDataset"/>)"),
  };
  for (const std::filesystem::path& vrt : cases) {
    EXPECT_EQ(failure_of([&] { static_cast<void>(open(vrt)); }).cause(), Cause::unsupported) << vrt;
  }
}

TEST_F(SourceTest, AMaskFileThatIsNoPlainRasterIsRefused) {
  const std::filesystem::path file = write(counting());
  write_text("dem.tif.msk", R"(<VRTDataset rasterXSize="3" rasterYSize="2"><VRTRasterBand dataType="Byte" band="1">)" +
                                source("/vsicurl/http://localhost/mask.tif") + "</VRTRasterBand></VRTDataset>");
  EXPECT_EQ(failure_of([&] { static_cast<void>(open(file)); }).cause(), Cause::unsupported);
}

}  // namespace
}  // namespace talus
