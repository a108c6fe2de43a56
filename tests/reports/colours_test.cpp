// Reports of pictures that were taken for heights, and of heights that are written as colours.

#include <memory>

#include <gdal_priv.h>

#include "talus/ingest.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

class Colours : public Report {
 protected:
  /// Bytes of a number of 24 bits.
  static std::vector<Band> in_bytes(const Band& numbers) {
    std::vector<Band> bands(3);
    bands[0].meaning = GCI_RedBand, bands[1].meaning = GCI_GreenBand, bands[2].meaning = GCI_BlueBand;
    for (const double number : numbers.samples) {
      const auto whole = static_cast<unsigned>(number);
      bands[0].samples.push_back(whole >> 16);
      bands[1].samples.push_back(whole >> 8 & 255);
      bands[2].samples.push_back(whole & 255);
    }
    return bands;
  }
  static BandsOptions bytes(const char* driver = "GTiff") { return {.type = GDT_Byte, .driver = driver}; }
};

// mapbox/mercantile#139, OSGeo/gdal#14520: one byte of three read as a height.
TEST_F(Colours, PicturesAreRefused) {
  const std::vector<Band> picture = in_bytes(slope([](int col, int row) { return 100000 + 37 * col + row; }));
  std::vector<Band> with_alpha = picture;
  with_alpha.push_back(constant(255, GCI_AlphaBand));
  write("rgb.tif", picture, bytes());
  write("rgba.tif", with_alpha, bytes());
  write("rgb.png", picture, bytes("PNG"));
  write("rgba.png", with_alpha, bytes("PNG"));
  for (const char* name : {"rgb.tif", "rgba.tif", "rgb.png", "rgba.png"}) {
    const auto before = contents();
    expect_refusal(ingest({name, "c.talus"}), {failed}, {name, "colours", "--decode", "terrain-rgb"});
    EXPECT_TRUE(contents() == before);
  }
}

// rasterio/rasterio#2257: imagery of four bands whose last is no alpha.
TEST_F(Colours, OneBandOfColourAmongOthersIsEnough) {
  for (const GDALColorInterp meaning :
       {GCI_RedBand, GCI_GreenBand, GCI_BlueBand, GCI_HueBand, GCI_CyanBand, GCI_YCbCr_YBand}) {
    SCOPED_TRACE(GDALGetColorInterpretationName(meaning));
    write("mixed.tif", {slope(), with_meaning(slope(), meaning), slope(), slope()}, {.type = GDT_UInt16});
    if (cells_of(folder / "mixed.tif").cols != kSide) continue;
    expect_refusal(ingest({"mixed.tif", "c.talus"}), {failed}, {"mixed.tif", "colours", "band 2"});
  }
}

TEST_F(Colours, PalettesAreRefused) {
  write("plain.tif", {slope([](int col, int row) { return (col + row) % 7; })}, bytes());
  {
    const std::unique_ptr<GDALDataset> plain(GDALDataset::Open((folder / "plain.tif").c_str(), GDAL_OF_RASTER));
    const std::unique_ptr<GDALDataset> memory(
        GetGDALDriverManager()->GetDriverByName("MEM")->CreateCopy("", plain.get(), 0, nullptr, nullptr, nullptr));
    GDALColorTable table;
    for (short i = 0; i < 7; ++i) {
      const GDALColorEntry entry{i, i, i, 255};
      table.SetColorEntry(i, &entry);
    }
    memory->GetRasterBand(1)->SetColorInterpretation(GCI_PaletteIndex);
    memory->GetRasterBand(1)->SetColorTable(&table);
    for (const auto& [driver, name] : {std::pair("GTiff", "palette.tif"), std::pair("PNG", "palette.png")}) {
      GDALClose(GetGDALDriverManager()->GetDriverByName(driver)->CreateCopy((folder / name).c_str(), memory.get(), 0,
                                                                            nullptr, nullptr, nullptr));
    }
  }
  expect_refusal(ingest({"palette.tif", "c.talus"}), {failed}, {"palette.tif", "palette"});
  expect_refusal(ingest({"palette.png", "c.talus"}), {failed}, {"palette.png", "palette"});
}

// openglobus/openglobus#99: height = -10000 + (R·65536 + G·256 + B)·0.1.
TEST_F(Colours, TerrainRgbIsDecoded) {
  const Band numbers = slope([](int col, int row) { return 100000 + 4111 * col + 17 * row; });
  for (const char* driver : {"GTiff", "PNG"}) {
    SCOPED_TRACE(driver);
    const std::string name = driver == std::string("PNG") ? "t.png" : "t.tif";
    write(name, in_bytes(numbers), bytes(driver));
    const Outcome outcome = ingest({name, "t.talus", "--decode", "terrain-rgb"});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    const Cells cells = cells_of_database(folder / "t.talus");
    for (std::size_t i = 0; i < numbers.samples.size(); ++i)
      ASSERT_EQ(cells.heights[i], -10000 + numbers.samples[i] * 0.1) << i;
  }
}

// protomaps/PMTiles#660, Yucareux/Tellus#7: height = R·256 + G + B/256 − 32768; transparent and black cells are no
// heights.
TEST_F(Colours, TerrariumIsDecodedAndBlackCanBeVoid) {
  Band numbers = slope([](int col, int row) { return 256 * (32768 + 100 + col) + 13 * row; }),
       alpha = constant(255, GCI_AlphaBand);
  burn(numbers, 2, 2, 0);
  burn(alpha, 25, 25, 0);
  std::vector<Band> bands = in_bytes(numbers);
  bands.push_back(alpha);
  write("t.tif", bands, bytes());
  const Outcome outcome = ingest({"t.tif", "t.talus", "--decode", "terrarium", "--nodata", "-32768"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Cells cells = cells_of_database(folder / "t.talus");
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const bool is_void =
          (col >= 2 && col < 12 && row >= 2 && row < 12) || (col >= 25 && col < 35 && row >= 25 && row < 35);
      if (is_void) {
        ASSERT_EQ(cells.at(col, row), std::nullopt) << col << " " << row;
      } else {
        ASSERT_EQ(cells.at(col, row), 100 + col + 13 * row / 256.0) << col << " " << row;
      }
    }
  }
}

// mapnik/mapnik#3970: colours must not be averaged, heights may.
TEST_F(Colours, DecodedHeightsAreResampledAndNotTheirColours) {
  write("t.tif", in_bytes(slope([](int col, int) { return 100000 + 100 * col; })), bytes());
  const Outcome outcome = ingest({"t.tif", "t.talus", "--decode", "terrain-rgb", "--tr", "5,5"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Cells cells = cells_of_database(folder / "t.talus");
  for (int col = 4; col + 4 < cells.cols; ++col) {
    const double x = (col + 0.5) * 5 / 10 - 0.5;  // in cells of the source
    ASSERT_NEAR(*cells.at(col, 20), 10 * x, 1e-3) << col;
  }
}

TEST_F(Colours, WhatIsNoPictureOfBytesIsNotDecoded) {
  write("one.tif", {slope()}, bytes());
  write("wide.tif", {slope(), slope(), slope()}, {.type = GDT_UInt16});
  expect_refusal(ingest({"one.tif", "c.talus", "--decode", "terrarium"}), {usage}, {"one.tif", "three bands of bytes"});
  expect_refusal(ingest({"wide.tif", "c.talus", "--decode", "terrarium"}), {usage},
                 {"wide.tif", "three bands of bytes"});
  expect_refusal(ingest({"one.tif", "c.talus", "--decode", "mapbox"}), {usage}, {"--decode", "mapbox"});
}

TEST_F(Colours, GreyAndUndefinedBandsAreHeightsAndOneCanBeChosen) {
  write("two.tif", {with_meaning(slope(), GCI_GrayIndex), constant(7)}, {.type = GDT_Int16});
  const Outcome first = ingest({"two.tif", "c.talus", "--json"});
  ASSERT_EQ(first.exit_code, done) << first.err;
  EXPECT_THAT(first.out, ::testing::HasSubstr("--band"));
  EXPECT_EQ(cells_of_database(folder / "c.talus").at(3, 3), 109);
  ASSERT_EQ(ingest({"two.tif", "c.talus", "--band", "2"}).exit_code, done);
  EXPECT_EQ(cells_of_database(folder / "c.talus").at(3, 3), 7);
  expect_refusal(ingest({"two.tif", "c.talus", "--band", "3"}), {usage}, {"two.tif", "--band 3"});
}

}  // namespace
}  // namespace talus::support
