// Reports of void values that did not match, or that nobody had declared.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>

#include "talus/ingest.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class VoidValues : public Report {
 protected:
  /// A raster of ESRI's float kind: raw floats and a header of text.
  void write_flt(const std::string& stem, const Band& band, const std::string& nodata) const {
    std::string bytes;
    for (const double sample : band.samples) {
      const auto value = static_cast<float>(sample);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    write_bytes(folder / (stem + ".flt"), bytes);
    write_bytes(folder / (stem + ".hdr"),
                "ncols 40\nnrows 40\nxllcorner 500000\nyllcorner 5600000\ncellsize 10\nNODATA_value " + nodata +
                    "\nbyteorder LSBFIRST\n");
  }
  void write_asc(const std::string& name, const std::string& void_cell, const std::string& nodata) const {
    std::string text =
        "ncols 40\nnrows 40\nxllcorner 500000\nyllcorner 5600000\ncellsize 10\nNODATA_value " + nodata + "\n";
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col)
        text += (row == 5 && col < 8 ? void_cell : std::to_string(100 + col) + ".5") + " ";
      text += "\n";
    }
    write_bytes(folder / name, text);
  }
};

// geotiffjs/geotiff.js#259, firelab/windninja#576: cells hold the lowest float, the tag its first two digits.
TEST_F(VoidValues, TheLowestFloatIsVoidHoweverManyDigitsTheTagHas) {
  const double lowest = std::numeric_limits<float>::lowest();
  for (const GDALDataType type : {GDT_Float32, GDT_Float64}) {
    for (const double tag : {-3.39999999999999996e+38, -3.4028234663852886e+38, -3.402823e+38}) {
      if (type == GDT_Float64 && tag == -3.39999999999999996e+38)
        continue;  // GDAL says these are two values, see below
      SCOPED_TRACE(GDALGetDataTypeName(type) + std::string(" ") + std::to_string(tag));
      Band band = slope();
      burn(band, 4, 4, lowest);
      write("low.tif", {band}, {.type = type, .nodata = tag});
      expect_as_gdal_reads("low.tif", 100);
    }
  }
}

// A tag a little beyond the floats, as texts of twelve digits have it: GDAL drops it, and the cells are no heights.
TEST_F(VoidValues, ATagALittleBeyondTheFloatsIsTheLowestFloat) {
  Band band = slope();
  burn(band, 4, 4, std::numeric_limits<float>::lowest());
  write("low.tif", {band}, {.type = GDT_Float32, .nodata = -3.40282346639e+38});
  const Outcome outcome = ingest({"low.tif", "d.talus"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(cells_of_database(folder / "d.talus").voids(), 100);
}

// Where GDAL does not take a cell for void it is no height either: it is named, and nothing is written.
TEST_F(VoidValues, AFarLowerCellThatIsNoVoidIsNamed) {
  Band band = slope();
  burn(band, 4, 4, std::numeric_limits<float>::lowest());
  write("low64.tif", {band}, {.type = GDT_Float64, .nodata = -3.4e38});
  expect_refusal(ingest({"low64.tif", "d.talus"}), {usage},
                 {"low64.tif", "-3.4028234663852886e+38", "column 4, row 4"});
}

// OSGeo/gdal#3791, csiro-hydrogeology/pyela#2: the value in the header has fewer or more digits than the floats.
TEST_F(VoidValues, VoidValuesOfFloatGridsMatchTheirCells) {
  Band band = slope();
  burn(band, 20, 9, std::numeric_limits<float>::lowest());
  write_flt("g", band, "-3.402823e+038");
  expect_as_gdal_reads("g.flt", 100);
  for (const char* tag : {"-3.4028235e+38", "-3.40282346638529e+38"}) {  // a little beyond the floats: GDAL drops these
    SCOPED_TRACE(tag);
    write_flt("g", band, tag);
    ASSERT_EQ(ingest({"g.flt", "d.talus"}).exit_code, done);
    EXPECT_EQ(cells_of_database(folder / "d.talus").voids(), 100);
  }
  for (const char* cell : {"-3.4e38", "-3.4028234663852886e+38", "-3.402823e+38"}) {
    SCOPED_TRACE(cell);
    write_asc("g.asc", cell, "-3.4e38");
    expect_as_gdal_reads("g.asc", 8);
  }
}

// OSGeo/gdal#1536: a void value that floats round. A height beside it stays a height.
TEST_F(VoidValues, AHeightBesideTheVoidValueStays) {
  Band band = slope();
  burn(band, 4, 4, -9999.1);
  burn(band, 20, 20, -9999);
  write("near.tif", {band}, {.type = GDT_Float32, .nodata = -9999});
  expect_as_gdal_reads("near.tif", 100);
  EXPECT_NEAR(*cells_of_database(folder / "d.talus").at(5, 5), -9999.1, 1e-3);
}

// mapbox/rio-rgbify#45, Yucareux/Tellus#7: -9999, -32768 and the like as heights, because nobody declared them.
TEST_F(VoidValues, AnUndeclaredVoidValueIsDoubtedAndCanBeSaid) {
  for (const auto& [value, type] :
       {std::pair(-9999.0, GDT_Float32), std::pair(-9999.0, GDT_Int16), std::pair(-32768.0, GDT_Int16),
        std::pair(-32768.0, GDT_Int32), std::pair(32767.0, GDT_Int16), std::pair(-99999.0, GDT_Float64)}) {
    SCOPED_TRACE(value);
    Band band = slope();
    burn(band, 8, 8, value);
    write("u.tif", {band}, {.type = type});
    const std::string said = std::to_string(static_cast<int>(value));
    const Outcome doubted = ingest({"u.tif", "u.talus", "--json"});
    EXPECT_EQ(doubted.exit_code, done) << doubted.err;
    EXPECT_THAT(doubted.out + doubted.err, HasSubstr("--nodata " + said));
    const Outcome told = ingest({"u.tif", "u.talus", "--nodata", said, "--json"});
    EXPECT_EQ(told.exit_code, done) << told.err;
    EXPECT_THAT(told.out + told.err, Not(HasSubstr("often means no data")));
    const Cells cells = cells_of_database(folder / "u.talus");
    EXPECT_EQ(cells.voids(), 100);
    EXPECT_FALSE(cells.at(10, 10).has_value());
  }
}

// Several kinds of inputs, several values; a file that declares its own keeps to that.
TEST_F(VoidValues, SeveralValuesCanBeSaidAndFilesThatDeclareOneKeepIt) {
  Band first = slope(), second = slope();
  burn(first, 0, 0, -9999);
  burn(first, 20, 0, -32768);
  burn(second, 0, 0, -9999);
  burn(second, 20, 0, -1);
  write("first.tif", {first}, {.type = GDT_Int16});
  write("second.tif", {second}, {.type = GDT_Int16, .geotransform = {{500400, 10, 0, 5600400, 0, -10}}, .nodata = -1});
  const Outcome outcome = ingest({"first.tif", "second.tif", "two.talus", "--nodata=-9999", "--nodata=-32768"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Cells cells = cells_of_database(folder / "two.talus");
  EXPECT_EQ(cells.voids(), 300);
  EXPECT_EQ(cells.at(40, 0), -9999);
  EXPECT_FALSE(cells.at(60, 0).has_value());
}

// 0 for no data in a raster that declares none: a hole with cliffs around it. A coast is none.
TEST_F(VoidValues, ZeroAmidHighGroundIsDoubtedAndACoastIsNot) {
  Band hole = slope();
  burn(hole, 8, 8, 0);
  write("hole.tif", {hole}, {.type = GDT_Int16});
  EXPECT_THAT(ingest({"hole.tif", "h.talus", "--json"}).out, HasSubstr("--nodata 0"));
  write("coast.tif", {slope([](int col, int row) { return std::max(0.0, 3.0 * col + row - 60); })},
        {.type = GDT_Int16});
  EXPECT_THAT(ingest({"coast.tif", "c.talus", "--json"}).out, Not(HasSubstr("--nodata 0")));
}

}  // namespace
}  // namespace talus::support
