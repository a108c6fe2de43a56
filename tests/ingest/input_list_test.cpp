#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ingest/mosaic/input_files.hpp"
#include "ingest/mosaic/source.hpp"
#include "talus/failure.hpp"
#include "talus/ingest.hpp"
#include "tests/support/inputs.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surfaces.hpp"
#include "tests/support/tiles.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;
using support::all_codes;
using support::failure_of;
using support::RasterOptions;
using support::says;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using InputListTest = support::TilesTest;

TEST_F(InputListTest, AFolderStandsForItsRasters) {
  fs::create_directory(folder_ / "dem");
  fs::create_directory(folder_ / "dem/deeper");
  constant("dem/b.tif", 2, 1, 2, at(2, 0));
  constant("dem/a.tif", 2, 1, 1, at(0, 0));
  constant("dem/deeper/c.tif", 2, 1, 3, at(4, 0));
  write_text("dem/readme.txt", "heights");
  write_text("dem/all.vrt", R"(<VRTDataset rasterXSize="2" rasterYSize="1"><VRTRasterBand dataType="Int16" band="1">
    <SimpleSource><SourceFilename relativeToVRT="1">a.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>)");
  const Source source{{folder_ / "dem"}, {}};
  EXPECT_THAT(all_codes(source).codes, ElementsAre(1, 1, 2, 2));
  EXPECT_TRUE(says(source.notes(), "readme.txt"));
  EXPECT_TRUE(says(source.notes(), "all.vrt"));

  fs::create_directory(folder_ / "empty");
  EXPECT_THAT(failure_with({folder_ / "empty"}).what(), HasSubstr("no raster"));
}

TEST_F(InputListTest, AListNamesFilesAndFoldersRelativeToItself) {
  fs::create_directory(folder_ / "lists");
  fs::create_directory(folder_ / "dem");
  constant("a.tif", 2, 1, 1, at(0, 0));
  constant("dem/b.tif", 2, 1, 2, at(2, 0));
  write_text("lists/all.txt", "# tiles\n\n../a.tif\r\n  ../dem  \n");
  EXPECT_THAT(all_codes(Source{{"@" + (folder_ / "lists/all.txt").string()}, {}}).codes, ElementsAre(1, 1, 2, 2));

  const Failure missing = failure_with({"@" + (folder_ / "none.txt").string()});
  EXPECT_EQ(missing.cause(), Cause::not_found);
  EXPECT_THAT(missing.what(), HasSubstr("none.txt"));
  write_text("empty.txt", "# nothing\n");
  EXPECT_EQ(failure_with({"@" + (folder_ / "empty.txt").string()}).cause(), Cause::invalid_argument);
  write_text("wrong.txt", "missing.tif\n");
  EXPECT_THAT(failure_with({"@" + (folder_ / "wrong.txt").string()}).what(), HasSubstr("missing.tif"));
  write_text("nested.txt", "@wrong.txt\n");
  EXPECT_EQ(failure_with({"@" + (folder_ / "nested.txt").string()}).cause(), Cause::invalid_argument);
  EXPECT_EQ(failure_with({}).cause(), Cause::invalid_argument);
}

TEST_F(InputListTest, AFileNamedTwiceCountsOnce) {
  const fs::path a = constant("a.tif", 2, 1, 1, at(0, 0)), b = constant("b.tif", 2, 1, 2, at(1, 0));
  const Source source{{a, b, folder_ / "." / "a.tif"}, {}};
  EXPECT_THAT(all_codes(source).codes, ElementsAre(1, 1, 2));
  EXPECT_EQ(source.inputs().size(), 2u);
  EXPECT_TRUE(says(source.notes(), "more than once"));
}

TEST_F(InputListTest, AFileThatIsDamagedLaterIsNamed) {
  const fs::path a = constant("a.tif", 64, 64, 1, at(0, 0)), b = constant("b.tif", 300, 300, 2, at(64, 0));
  const Source source{{a, b}, {}};
  fs::resize_file(b, fs::file_size(b) / 2);
  const Failure failure = failure_of([&] { static_cast<void>(source.read(source.description().extent)); });
  EXPECT_EQ(failure.cause(), Cause::io);
  EXPECT_THAT(failure.what(), AllOf(HasSubstr("b.tif"), HasSubstr("rows")));
}

TEST_F(InputListTest, ManyTilesNeedFewOpenFiles) {
  std::vector<fs::path> files;
  for (int i = 0; i < 150; ++i) files.push_back(constant("t" + std::to_string(i) + ".tif", 4, 4, i, at(4 * i, 0)));
  const Source source{files, {}};
  const auto all = all_codes(source);
  for (std::size_t i = 0; i < 150; ++i) EXPECT_EQ(all.codes[4 * i], static_cast<double>(i));
  std::size_t open = 0;
  for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
    std::error_code error;
    if (fs::read_symlink(entry.path(), error).string().starts_with(folder_.path().string())) ++open;
  }
  EXPECT_LE(open, 64u);
}

TEST_F(InputListTest, InputsAreDescribedAndHaveAChecksum) {
  RasterOptions options = at(0, 0);
  options.nodata = -77;
  const fs::path a = constant("a.tif", 5, 4, 1, options);
  const Source source{{a}, {}};
  const InputFile& input = source.inputs()[0];
  EXPECT_EQ(input.name, "a.tif");
  EXPECT_EQ(input.driver, "GTiff");
  EXPECT_EQ(input.type, "Int16");
  EXPECT_EQ(input.cols, 5);
  EXPECT_EQ(input.bytes, fs::file_size(a));
  EXPECT_EQ(input.void_value, "-77");
  const auto checksum = [&] { return InputFiles(Source{{a}, {}}, {}, [] {}).checksum(0); };
  const std::uint64_t before = checksum();
  EXPECT_EQ(before, checksum());
  std::fstream file{a, std::ios::in | std::ios::out | std::ios::binary};
  file.seekp(-1, std::ios::end);
  file.put('x');
  file.close();
  EXPECT_NE(before, checksum());
}

TEST_F(InputListTest, DriversBeyondTheListNeedTheUsersWord) {
  const fs::path file = write_text("a.xyz", "0.5 1.5 10\n1.5 1.5 11\n0.5 0.5 12\n1.5 0.5 13\n");
  EXPECT_THAT(failure_with({file}).what(), HasSubstr("InputOptions::allow_drivers XYZ"));
  InputOptions options;
  options.allow_drivers = {"XYZ"};
  EXPECT_THAT(all_codes(Source{{file}, options}).codes, ElementsAre(10, 11, 12, 13));
  options.allow_drivers = {"NoSuchDriver"};
  EXPECT_EQ(failure_with({file}, options).cause(), Cause::invalid_argument);
}

}  // namespace
}  // namespace talus
