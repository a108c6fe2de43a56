// What verify holds databases against: values here are those that the test itself wrote, through GDAL alone.

#include "ingest/raster/plain_reader.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "talus/ingest.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

constexpr int kCols = 7, kRows = 5;

struct Written {
  GDALDataType type = GDT_Int16;
  int bands = 1;
  double x = 100, y = 200, dx = 10, dy = -10;  ///< of the corner of the first cell
};

class PlainReading : public ::testing::Test {
 protected:
  PlainReading() {
    GDALAllRegister();
    description.mapping = {105, 195, 10, -10};
    description.extent = {{0, 0}, {kCols - 1, kRows - 1}};
  }
  /// Heights 1, 2, 3 … row by row as the file has them.
  GDALDataset* create(const std::string& name, const Written& w) const {
    GDALDataset* set = GetGDALDriverManager()->GetDriverByName("GTiff")->Create((folder / name).c_str(), kCols, kRows,
                                                                                w.bands, w.type, nullptr);
    double t[6] = {w.x, w.dx, 0, w.y, 0, w.dy};
    EXPECT_EQ(set->SetGeoTransform(t), CE_None);
    std::vector<double> heights(kCols * kRows);
    for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = static_cast<double>(i + 1);
    put(set->GetRasterBand(1), heights);
    return set;
  }
  static void put(GDALRasterBand* band, std::vector<double> values) {
    EXPECT_EQ(band->RasterIO(GF_Write, 0, 0, kCols, kRows, values.data(), kCols, kRows, GDT_Float64, 0, 0), CE_None);
  }
  static std::vector<double> with_zero_at(std::size_t cell, double otherwise) {
    std::vector<double> values(kCols * kRows, otherwise);
    values[cell] = 0;
    return values;
  }
  [[nodiscard]] SampleWindow read(const std::vector<std::filesystem::path>& files,
                                  const InputOptions& rules = {}) const {
    const PlainReader reader(files, rules, description, "a.talus");
    return reader.read(reader.extent());
  }
  static void expect_only_void(const SampleWindow& window, std::size_t cell) {
    for (std::size_t i = 0; i < window.valid.size(); ++i) {
      EXPECT_EQ(window.valid[i] != 0, i != cell) << i;
      if (i != cell) {
        EXPECT_EQ(window.values[i], static_cast<double>(i + 1)) << i;
      }
    }
  }

  TempFolder folder;
  Description description;
};

TEST_F(PlainReading, AnAlphaOfZeroIsVoidInEveryTypeAndBand) {
  for (const GDALDataType type : {GDT_Byte, GDT_Int16, GDT_UInt16, GDT_Int32, GDT_UInt32, GDT_Float32, GDT_Float64}) {
    for (int bands = 2; bands <= 5; ++bands) {
      SCOPED_TRACE(std::string(GDALGetDataTypeName(type)) + " " + std::to_string(bands));
      Written w;
      w.type = type;
      w.bands = bands;
      GDALDataset* set = create("a.tif", w);
      for (int i = 1; i < bands; ++i)
        set->GetRasterBand(i)->SetColorInterpretation(i == 1 ? GCI_GrayIndex : GCI_Undefined);
      set->GetRasterBand(bands)->SetColorInterpretation(GCI_AlphaBand);
      put(set->GetRasterBand(bands), with_zero_at(9, type == GDT_Int16 ? 32767 : 255));
      GDALClose(set);
      expect_only_void(read({folder / "a.tif"}), 9);
    }
  }
}

TEST_F(PlainReading, NodataAndAlphaTogetherAreBothVoid) {
  Written w;
  w.type = GDT_Float32;
  w.bands = 2;
  GDALDataset* set = create("a.tif", w);
  set->GetRasterBand(1)->SetNoDataValue(3);
  set->GetRasterBand(2)->SetColorInterpretation(GCI_AlphaBand);
  put(set->GetRasterBand(2), with_zero_at(9, 255));
  GDALClose(set);
  const SampleWindow window = read({folder / "a.tif"});
  for (std::size_t i = 0; i < window.valid.size(); ++i) EXPECT_EQ(window.valid[i] != 0, i != 2 && i != 9) << i;
}

TEST_F(PlainReading, WhatGdalMasksIsVoid) {
  // A mask of the dataset, a nodata value with fewer digits than the cells have, and no number at all.
  GDALDataset* set = create("a.tif", {});
  EXPECT_EQ(set->CreateMaskBand(GMF_PER_DATASET), CE_None);
  put(set->GetRasterBand(1)->GetMaskBand(), with_zero_at(9, 255));
  GDALClose(set);
  expect_only_void(read({folder / "a.tif"}), 9);
  Written floats;
  floats.type = GDT_Float32;
  set = create("b.tif", floats);
  std::vector<double> heights(kCols * kRows);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = i == 9 ? std::numeric_limits<float>::lowest() : static_cast<double>(i + 1);
  put(set->GetRasterBand(1), heights);
  set->GetRasterBand(1)->SetNoDataValue(-3.39999999999999996e+38);
  GDALClose(set);
  const SampleWindow window = read({folder / "b.tif"});
  auto* read_again = GDALDataset::Open((folder / "b.tif").c_str());
  std::vector<std::uint8_t> mask(kCols * kRows);
  EXPECT_EQ(read_again->GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Read, 0, 0, kCols, kRows, mask.data(), kCols,
                                                                  kRows, GDT_Byte, 0, 0),
            CE_None);
  GDALClose(read_again);
  for (std::size_t i = 0; i < mask.size(); ++i) EXPECT_EQ(window.valid[i] != 0, mask[i] != 0) << i;
  heights[9] = std::numeric_limits<double>::quiet_NaN();
  set = create("c.tif", floats);
  put(set->GetRasterBand(1), heights);
  GDALClose(set);
  expect_only_void(read({folder / "c.tif"}), 9);
  set = create("d.tif", {});
  GDALClose(set);
  InputOptions rules;
  rules.nodata = {10};
  expect_only_void(read({folder / "d.tif"}, rules), 9);
}

TEST_F(PlainReading, ScaleAndOffsetAreApplied) {
  GDALDataset* set = create("a.tif", {});
  set->GetRasterBand(1)->SetScale(0.1);
  set->GetRasterBand(1)->SetOffset(1000);
  GDALClose(set);
  const SampleWindow window = read({folder / "a.tif"});
  for (std::size_t i = 0; i < window.values.size(); ++i)
    EXPECT_EQ(window.values[i], static_cast<double>(i + 1) * 0.1 + 1000);
}

TEST_F(PlainReading, RowsThatRunNorthAndColumnsThatRunWestAreTurned) {
  Written w;
  w.y = 150, w.dy = 10;
  GDALClose(create("north.tif", w));
  w = {};
  w.x = 170, w.dx = -10;
  GDALClose(create("west.tif", w));
  const SampleWindow north = read({folder / "north.tif"}), west = read({folder / "west.tif"});
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      EXPECT_EQ(north.values[north.index({col, row})], (kRows - 1 - row) * kCols + col + 1);
      EXPECT_EQ(west.values[west.index({col, row})], row * kCols + (kCols - 1 - col) + 1);
    }
  }
  // A part that begins in the middle.
  const PlainReader reader({folder / "west.tif"}, {}, description, "a.talus");
  const SampleWindow part = reader.read({{2, 1}, {4, 3}});
  EXPECT_EQ(part.values[part.index({3, 2})], 2 * kCols + (kCols - 1 - 3) + 1);
}

TEST_F(PlainReading, ALaterInputCoversAnEarlierOneAndAVoidCoversNothing) {
  GDALClose(create("a.tif", {}));
  Written w;
  w.x = 120;
  GDALDataset* set = create("b.tif", w);
  std::vector<double> other(kCols * kRows, 500);
  other[8] = -1;
  put(set->GetRasterBand(1), other);
  set->GetRasterBand(1)->SetNoDataValue(-1);
  GDALClose(set);
  const SampleWindow window = read({folder / "a.tif", folder / "b.tif"});
  EXPECT_EQ(window.region, (GridRect{{0, 0}, {kCols + 1, kRows - 1}}));
  EXPECT_EQ(window.values[window.index({1, 1})], kCols + 2);
  EXPECT_EQ(window.values[window.index({2, 1})], 500);
  EXPECT_EQ(window.values[window.index({3, 1})], kCols + 4) << "a void covers nothing";
  EXPECT_EQ(window.values[window.index({8, 1})], 500);
}

TEST_F(PlainReading, AnotherGridIsRefused) {
  Written w;
  w.x = 103;
  GDALClose(create("a.tif", w));
  EXPECT_THROW(static_cast<void>(read({folder / "a.tif"})), Failure);
  w = {};
  w.dx = 11;
  GDALClose(create("b.tif", w));
  EXPECT_THROW(static_cast<void>(read({folder / "b.tif"})), Failure);
}

}  // namespace
}  // namespace talus::support
