// What somebody found who had seen no code of Talus, only its help: rasters that went in silently wrong.

#include <cmath>
#include <filesystem>
#include <memory>

#include <gdal_priv.h>

#include "talus/ingest.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;

class Outsiders : public Report {
 protected:
  void write_vrt(const std::string& name, const std::string& source, const std::string& inside = "",
                 const std::string& band = "") const {
    write_bytes(
        folder / name,
        "<VRTDataset rasterXSize=\"40\" rasterYSize=\"40\"><GeoTransform>500000,10,0,5600400,0,-10</GeoTransform>"
        "<VRTRasterBand dataType=\"Float32\" band=\"1\">" +
            band + source + inside + "</VRTRasterBand></VRTDataset>");
  }
  static std::string source(const std::string& file, const std::string& attributes = "", const std::string& inside = "",
                            const char* kind = "SimpleSource") {
    return std::string("<") + kind + attributes + "><SourceFilename relativeToVRT=\"1\">" + file +
           "</SourceFilename><SourceBand>1</SourceBand>" + inside + "</" + kind + ">";
  }
  void write_asc(const std::string& rows) const {
    write_bytes(folder / "a.asc",
                "ncols 4\nnrows 2\nxllcorner 7\nyllcorner 46\ncellsize 0.5\nnodata_value -9999\n" + rows);
  }
};

TEST_F(Outsiders, AlphaBelow0AndNanAreNotTransparent) {
  for (const GDALDataType type : {GDT_Int16, GDT_Int32, GDT_Float32}) {
    Band alpha = constant(-1, GCI_AlphaBand);
    burn(alpha, 5, 5, 0);
    if (type == GDT_Float32) burn(alpha, 20, 20, std::nan(""));
    write("a.tif", {slope(), alpha}, {.type = type});
    expect_as_gdal_reads("a.tif", 100);
    EXPECT_EQ(talus({"verify", "d.talus", "--against", "a.tif"}).exit_code, done);
  }
}

TEST_F(Outsiders, AVirtualRasterThatDropsAlphaMaskOrVoidValueIsRefused) {
  Band alpha = constant(255, GCI_AlphaBand), holes = slope();
  burn(alpha, 5, 5, 0);
  burn(holes, 5, 5, -9999);
  write("alpha.tif", {slope(), alpha});
  write("holes.tif", {holes}, {.nodata = -9999});
  write_vrt("a.vrt", source("alpha.tif"));
  write_vrt("b.vrt", source("alpha.tif", " resampling=\"bilinear\""));
  write_vrt("c.vrt",
            source("holes.tif", "", "<ScaleRatio>0.5</ScaleRatio><ScaleOffset>100</ScaleOffset>", "ComplexSource"));
  write_vrt("d.vrt", source("a.vrt"));
  for (const char* name : {"a.vrt", "b.vrt", "c.vrt", "d.vrt"})
    expect_refusal(ingest({name, "d.talus"}), {failed}, {name});
  write_vrt("good.vrt", source("holes.tif", "", "<NODATA>-9999</NODATA>", "ComplexSource"), "",
            "<NoDataValue>-9999</NoDataValue>");
  expect_as_gdal_reads("good.vrt", 100);
}

TEST_F(Outsiders, ColoursInAnotherOrderWithScaleOrCompressedWithLossAreNotDecoded) {
  const BandsOptions bytes{.type = GDT_Byte};
  const auto band = [](GDALColorInterp meaning) { return constant(130, meaning); };
  write("bgr.tif", {band(GCI_BlueBand), band(GCI_GreenBand), band(GCI_RedBand)}, bytes);
  expect_refusal(ingest({"bgr.tif", "d.talus", "--decode", "terrarium"}), {usage}, {"bgr.tif", "band 1 is Blue"});
  write("rgb.tif", {band(GCI_RedBand), band(GCI_GreenBand), band(GCI_BlueBand)}, bytes);
  {
    const std::unique_ptr<GDALDataset> rgb(GDALDataset::Open((folder / "rgb.tif").c_str(), GDAL_OF_RASTER));
    const char* words[] = {"COMPRESS=JPEG", nullptr};
    GDALClose(GetGDALDriverManager()->GetDriverByName("GTiff")->CreateCopy(
        (folder / "jpeg.tif").c_str(), rgb.get(), 0, const_cast<char**>(words), nullptr, nullptr));
  }
  expect_refusal(ingest({"jpeg.tif", "d.talus", "--decode", "terrarium"}), {failed}, {"jpeg.tif", "JPEG"});
}

TEST_F(Outsiders, AsciiGridsHaveAsManyNumbersAsTheySay) {
  write_asc("1 2 3 4\n5 6 7 8\n");
  EXPECT_EQ(ingest({"a.asc", "d.talus"}).exit_code, done);
  write_asc("+1 2e0 -9999 4\n5\t6 7 nan");
  EXPECT_EQ(ingest({"a.asc", "d.talus"}).exit_code, done);
  for (const char* rows : {"1 nodata 3 4\n5 6 7 8\n", "1 inf 3 4\n5 6 7 8\n", "1 2 3 4\n5 6 7\n",
                           "1.5D+02 2 3 4\n5 6 7 8\n", "1 2 3 4\n5 6 7 8\n9 10 11 12\n", "1,5 2 3 4\n5 6 7 8\n", ""}) {
    SCOPED_TRACE(rows);
    write_asc(rows);
    expect_refusal(ingest({"a.asc", "d.talus"}), {failed}, {"a.asc"});
  }
}

TEST_F(Outsiders, PlacesThatDoNotExistAreRefused) {
  write("bare.tif", {slope()}, {.crs = ""});
  expect_refusal(ingest({"bare.tif", "d.talus", "--srs", "EPSG:4326"}), {usage}, {"bare.tif", "latitudes"});
  write("north.tif", {slope()}, {.crs = "EPSG:4326", .geotransform = {{8, 0.5, 0, 96, 0, -0.5}}});
  expect_refusal(ingest({"north.tif", "d.talus"}), {usage}, {"north.tif", "latitudes"});
  write("depths.tif", {slope()}, {.crs = "EPSG:4326+5715", .geotransform = {{8, 0.01, 0, 46, 0, -0.01}}});
  expect_refusal(ingest({"depths.tif", "d.talus"}), {failed}, {"depths.tif", "depths"});
}

TEST_F(Outsiders, VerifyRoundsAsTheSamplesDo) {
  Band band = slope();
  burn(band, 5, 5, -9999.1);
  write("n.tif", {band});
  ASSERT_EQ(ingest({"n.tif", "d.talus", "--nodata", "-9999.1"}).exit_code, done);
  EXPECT_EQ(cells_of_database(folder / "d.talus").voids(), 100);
  EXPECT_EQ(talus({"verify", "d.talus", "--against", "n.tif", "--nodata", "-9999.1"}).exit_code, done);
  write("shear.tif", {slope()}, {.geotransform = {{500000, 10, 1e-12, 5600400, 0, -10}}});
  ASSERT_EQ(ingest({"shear.tif", "d.talus"}).exit_code, done);
  EXPECT_EQ(talus({"verify", "d.talus", "--against", "shear.tif"}).exit_code, done);
}

TEST_F(Outsiders, ARemedyWorksOrAnotherIsNamed) {
  Band band = slope();
  burn(band, 5, 5, -9999);
  write("other.tif", {band}, {.type = GDT_Int16, .nodata = 32767});
  const Outcome doubted = ingest({"other.tif", "d.talus"});
  EXPECT_THAT(doubted.err, HasSubstr("gdal_translate -a_nodata -9999"));
  EXPECT_THAT(ingest({"other.tif", "d.talus", "--nodata", "-9999"}).err, HasSubstr("makes no sample void"));
}

TEST_F(Outsiders, AnUpdateThatIsResampledSaysThatItsJointsAreItsOwn) {
  write("a.tif", {slope()});
  write("b.tif", {slope()}, {.geotransform = {{500403, 10, 0, 5600400, 0, -10}}});
  ASSERT_EQ(ingest({"a.tif", "d.talus"}).exit_code, done);
  const Outcome outcome = talus({"ingest", "--update", "b.tif", "d.talus", "--grid-of", "d.talus"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("beside the joint"));
}

TEST_F(Outsiders, AListInUtf16IsCalledThat) {
  write_bytes(folder / "list.txt", std::string("\xff\xfe"
                                               "a\0.\0t\0i\0f\0\n\0",
                                               14));
  expect_refusal(ingest({"@list.txt", "d.talus"}), {usage}, {"list.txt", "UTF-16"});
}

TEST_F(Outsiders, ATiffThatIsCutShortIsCalledThat) {
  write("whole.tif", {slope()});
  std::filesystem::resize_file(folder / "whole.tif", 3000);
  expect_refusal(ingest({"whole.tif", "d.talus"}), {failed}, {"whole.tif", "cut short"});
}

}  // namespace
}  // namespace talus::support
