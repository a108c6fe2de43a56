// Reports of transparent cells that were taken for heights.

#include <memory>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gdal_utils.h>

#include "talus/ingest.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

constexpr GDALDataType kTypes[] = {GDT_Byte, GDT_Int16, GDT_UInt16, GDT_Int32, GDT_UInt32, GDT_Float32, GDT_Float64};

class Alpha : public Report {
 protected:
  /// gdalwarp -t_srs EPSG:3035 -dstalpha
  void warp_with_alpha(const std::string& from, const std::string& to) const {
    CPLStringList words;
    for (const char* word : {"-t_srs", "EPSG:3035", "-dstalpha"}) words.AddString(word);
    const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> options(
        GDALWarpAppOptionsNew(words.List(), nullptr), GDALWarpAppOptionsFree);
    GDALDatasetH source = GDALOpen((folder / from).c_str(), GA_ReadOnly);
    GDALDatasetH made = GDALWarp((folder / to).c_str(), nullptr, 1, &source, options.get(), nullptr);
    ASSERT_NE(made, nullptr) << CPLGetLastErrorMsg();
    GDALClose(made);
    GDALClose(source);
  }
  void build_vrt(const std::string& from, const std::string& to) const {
    const std::string name = (folder / from).string();
    const char* names[] = {name.c_str(), nullptr};
    GDALDatasetH made = GDALBuildVRT((folder / to).c_str(), 1, nullptr, names, nullptr, nullptr);
    ASSERT_NE(made, nullptr) << CPLGetLastErrorMsg();
    GDALClose(made);
  }
};

// rasterio/rasterio#1241, OSGeo/gdal#4253: what gdalwarp -dstalpha leaves outside the source is transparent and 0.
TEST_F(Alpha, WhatGdalwarpLeavesTransparentIsVoidInEachType) {
  for (const GDALDataType type : kTypes) {
    SCOPED_TRACE(GDALGetDataTypeName(type));
    write("dem.tif", {slope()}, {.type = type});
    warp_with_alpha("dem.tif", "w.tif");
    build_vrt("w.tif", "w.vrt");
    const int voids = cells_of(folder / "w.tif").voids();
    ASSERT_GT(voids, 50);
    expect_as_gdal_reads("w.tif", voids);
    expect_as_gdal_reads("w.vrt", voids);
  }
}

// OSGeo/gdal#4253: a void value and alpha in one raster; each makes voids.
TEST_F(Alpha, AVoidValueAndAlphaBothMakeVoids) {
  for (const GDALDataType type : {GDT_Int16, GDT_Int32, GDT_Float32, GDT_Float64}) {
    SCOPED_TRACE(GDALGetDataTypeName(type));
    Band heights = slope(), alpha = constant(255, GCI_AlphaBand);
    burn(heights, 3, 3, -9999);
    burn(heights, 20, 20, 0);
    burn(alpha, 20, 20, 0);
    write("both.tif", {heights, alpha}, {.type = type, .nodata = -9999});
    expect_as_gdal_reads("both.tif", 200);
  }
}

// rasterio/rasterio#1382: alpha is not only the fourth band of four.
TEST_F(Alpha, AlphaIsFoundWhereverItStandsAmongTheBands) {
  for (const GDALDataType type : kTypes) {
    for (const int bands : {2, 3, 4, 5}) {
      SCOPED_TRACE(GDALGetDataTypeName(type) + std::string(" ") + std::to_string(bands));
      std::vector<Band> all{slope()};
      for (int i = 1; i + 1 < bands; ++i) all.push_back(constant(7));
      Band alpha = constant(200, GCI_AlphaBand);
      burn(alpha, 12, 7, 0);
      all.push_back(alpha);
      for (Band& band : all) {
        if (band.meaning == GCI_Undefined) band.meaning = GCI_GrayIndex;
      }
      write("bands.tif", all, {.type = type});
      expect_as_gdal_reads("bands.tif", 100);
    }
  }
}

// rasterio/rasterio#984: resampling must not mix what is transparent into the heights beside it.
TEST_F(Alpha, ATransparentCellChangesNoHeightThatIsResampled) {
  for (const GDALDataType type : kTypes) {
    for (const char* method : {"near", "bilinear", "cubic", "average"}) {
      SCOPED_TRACE(GDALGetDataTypeName(type) + std::string(" ") + method);
      Band heights = constant(200), alpha = constant(255, GCI_AlphaBand);
      burn(heights, 15, 15, 0);  // a hole, and 0 where the alpha says so
      burn(alpha, 15, 15, 0);
      write("hole.tif", {heights, alpha}, {.type = type});
      const Outcome outcome = ingest({"hole.tif", "r.talus", "--tr", "7,9", "--resampling", method});
      ASSERT_EQ(outcome.exit_code, done) << outcome.err;
      const Cells cells = cells_of_database(folder / "r.talus");
      EXPECT_GT(cells.voids(), 50);
      for (const std::optional<double>& height : cells.heights) {
        if (height) {
          EXPECT_NEAR(*height, 200, 1e-3);
        }
      }
    }
  }
}

// mapnik/mapnik#888: a tile that is transparent at its edge covers nothing of its neighbour.
TEST_F(Alpha, ATransparentCellCoversNothing) {
  Band below = slope(), above = constant(500), alpha = constant(255, GCI_AlphaBand);
  burn(above, 0, 0, 0);
  burn(alpha, 0, 0, 0);
  write("a.tif", {below}, {.type = GDT_Int16});
  write("b.tif", {above, alpha}, {.type = GDT_Int16});
  const Outcome outcome = ingest({"a.tif", "b.tif", "ab.talus"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Cells cells = cells_of_database(folder / "ab.talus");
  EXPECT_EQ(cells.voids(), 0);
  EXPECT_EQ(cells.at(9, 9), 127);
  EXPECT_EQ(cells.at(10, 10), 500);
}

// A virtual raster that interpolates mixes them before anybody else can look.
TEST_F(Alpha, AVirtualRasterThatInterpolatesTransparentSourcesIsRefused) {
  Band alpha = constant(255, GCI_AlphaBand);
  burn(alpha, 5, 5, 0);
  write("t.tif", {slope(), alpha});
  write_bytes(folder / "i.vrt",
              "<VRTDataset rasterXSize=\"80\" rasterYSize=\"80\"><GeoTransform>500000,5,0,5600400,0,-5</GeoTransform>"
              "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource resampling=\"bilinear\">"
              "<SourceFilename relativeToVRT=\"1\">t.tif</SourceFilename><SourceBand>1</SourceBand>"
              "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"40\" ySize=\"40\"/><DstRect xOff=\"0\" yOff=\"0\" xSize=\"80\" "
              "ySize=\"80\"/>"
              "</SimpleSource></VRTRasterBand>"
              "<VRTRasterBand dataType=\"Float32\" band=\"2\"><ColorInterp>Alpha</ColorInterp><SimpleSource "
              "resampling=\"bilinear\">"
              "<SourceFilename relativeToVRT=\"1\">t.tif</SourceFilename><SourceBand>2</SourceBand>"
              "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"40\" ySize=\"40\"/><DstRect xOff=\"0\" yOff=\"0\" xSize=\"80\" "
              "ySize=\"80\"/>"
              "</SimpleSource></VRTRasterBand></VRTDataset>");
  expect_refusal(ingest({"i.vrt", "i.talus"}), {failed}, {"i.vrt", "interpolates"});
}

}  // namespace
}  // namespace talus::support
