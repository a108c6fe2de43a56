// How a rectangle in coordinates becomes a rectangle of samples.

#include <cmath>

#include <gtest/gtest.h>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {
namespace {

/// 40 x 30 samples, 10 apart, the north-western one at (105, 995).
class Region : public ::testing::Test {
 protected:
  static Snapshot open(const TempFolder& folder) {
    RasterOptions options;
    options.geotransform = {100, 10, 0, 1000, 0, -10};
    write_raster(fit(sine_hills(40, 30), SampleType::int16), folder / "a.tif", options);
    ingest(folder / "a.tif", folder / "a.talus");
    return Database::open(folder / "a.talus").snapshot();
  }
  TempFolder folder_;
  Snapshot now_ = open(folder_);

  Cause refused(const Rectangle& rectangle) {
    try {
      static_cast<void>(now_.region(rectangle).samples);
    } catch (const Failure& failure) {
      EXPECT_STRNE(failure.what(), "");
      return failure.cause();
    }
    ADD_FAILURE() << "was not refused";
    return Cause{};
  }
};

TEST_F(Region, OnSamplesIsThoseSamples) {
  EXPECT_EQ(now_.region({125, 865, 245, 965}).samples, (GridRect{{2, 3}, {14, 13}}));
}

TEST_F(Region, BetweenSamplesGoesOutward) {
  EXPECT_EQ(now_.region({126, 866, 244, 964}).samples, (GridRect{{2, 3}, {14, 13}}));
  EXPECT_EQ(now_.region({124, 864, 246, 966}).samples, (GridRect{{1, 2}, {15, 14}}));
}

TEST_F(Region, WithinAMillionthOfACellIsOnTheLine) {
  const double less = 9e-6, more = 1.1e-5;  // cells are ten wide
  EXPECT_EQ(now_.region({125 - less, 865 - less, 245 + less, 965 + less}).samples, (GridRect{{2, 3}, {14, 13}}));
  EXPECT_EQ(now_.region({125 - more, 865 - more, 245 + more, 965 + more}).samples, (GridRect{{1, 2}, {15, 14}}));
}

TEST_F(Region, IsClippedToTheRaster) {
  EXPECT_EQ(now_.region({-1e9, -1e9, 1e9, 1e9}).samples, (GridRect{{0, 0}, {39, 29}}));
  EXPECT_EQ(now_.region({-1e300, -1e300, 1e300, 1e300}).samples, (GridRect{{0, 0}, {39, 29}}));
  EXPECT_EQ(now_.region({100, 700, 500, 1000}).samples, (GridRect{{0, 0}, {39, 29}}));
}

TEST_F(Region, OutsideSwappedOrNaNIsRefused) {
  EXPECT_EQ(refused({600, 865, 700, 965}), Cause::invalid_argument);
  EXPECT_EQ(refused({125, 2000, 245, 3000}), Cause::invalid_argument);
  EXPECT_EQ(refused({245, 865, 125, 965}), Cause::invalid_argument);
  EXPECT_EQ(refused({125, 965, 245, 865}), Cause::invalid_argument);
  EXPECT_EQ(refused({125, 865, 125, 965}), Cause::invalid_argument);
  EXPECT_EQ(refused({NAN, 865, 245, 965}), Cause::invalid_argument);
  EXPECT_EQ(refused({125, 865, 245, NAN}), Cause::invalid_argument);
}

TEST_F(Region, OutsideTheExtentIsRefusedByRangeAndSamples) {
  const GridRect outside{{0, 0}, {40, 29}}, empty{{5, 5}, {4, 8}};
  EXPECT_THROW(static_cast<void>(now_.ask({.region = outside, .tolerance = Metres{1}})), Failure);
  EXPECT_THROW(static_cast<void>(now_.ask({.region = empty, .tolerance = Metres{1}})), Failure);
  EXPECT_THROW(static_cast<void>(now_.samples(outside)), Failure);
  EXPECT_THROW(static_cast<void>(now_.ask({.region = {{0, 0}, {39, 29}}, .tolerance = Metres{-1}})), Failure);
  EXPECT_THROW(static_cast<void>(now_.ask({.region = {{0, 0}, {39, 29}}, .tolerance = Metres{NAN}})), Failure);
}

TEST_F(Region, OfTheMeshIsThatOfTheRectangle) {
  const Rectangle rectangle{126, 866, 244, 964};
  EXPECT_EQ(now_.mesh(rectangle, Metres{2}).region, now_.region(rectangle).samples);
}

}  // namespace
}  // namespace talus::support
