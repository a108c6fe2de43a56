// Reports of tiles that went missing without a word, and of joints between tiles.

#include <cmath>
#include <filesystem>

#include <sys/stat.h>

#include "talus/ingest.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Tiles : public Report {
 protected:
  static BandsOptions at(int col, int row, const std::string& crs = "EPSG:25832") {
    return {
        .type = GDT_Float32, .crs = crs, .geotransform = {{500000 + 10.0 * col, 10, 0, 5600400 - 10.0 * row, 0, -10}}};
  }
  /// A wavy surface over the whole grid, of which each tile is a part.
  static double wave(int col, int row) {
    return std::round(100 * (300 + 80 * std::sin(col / 3.0) + 60 * std::cos(row / 2.5))) / 100;
  }
  void write_tile(const std::string& name, int col, int row, int cols, int rows) const {
    Band band;
    for (int r = row; r < row + rows; ++r) {
      for (int c = col; c < col + cols; ++c) band.samples.push_back(wave(c, r));
    }
    write_bands(folder / name, cols, rows, {band}, at(col, row));
  }
};

// serapeum-org/pyramids#832, xarray-contrib/xarray-spatial#1799: a mosaic that leaves out what it cannot open.
TEST_F(Tiles, ABrokenTileEndsTheWorkOrIsLeftOutIfAsked) {
  fs::create_directory(folder / "t");
  write_tile("t/t1.tif", 0, 0, 40, 20);
  write_tile("t/t3.tif", 0, 40, 40, 20);
  struct Broken {
    const char* name;
    std::string bytes;
    const char* said;
  };
  for (const auto& [name, bytes, said] :
       {Broken{"t2.tif", "", "is empty"},
        Broken{"t2.tif", "<html><body>404 Not Found</body></html>", "is not a raster"},
        Broken{"t2.TIFF", "garbage", "is not a raster"}, Broken{"t2.bil", std::string(3200, 'x'), "is not a raster"},
        Broken{"t2.hgt", "PK\3\4 something", "is not a raster"}, Broken{"t2.asc", "no grid", "is not a raster"},
        Broken{"t2.hgt.gz", "\x1f\x8b\x08", "archive"}, Broken{"t2.zip", "PK\3\4", "archive"},
        Broken{"t2.xyz", "500005 5600195 1\n500015 5600195 2\n500005 5600185 1\n500015 5600185 2\n",
               "--allow-driver XYZ"}}) {
    SCOPED_TRACE(name);
    write_bytes(folder / "t" / name, bytes);
    expect_refusal(ingest({"t", "t.talus"}), {failed}, {name, said, "--skip-broken"});
    EXPECT_FALSE(fs::exists(folder / "t.talus"));
    const Outcome skipped = ingest({"t", "t.talus", "--skip-broken", "--json"});
    EXPECT_EQ(skipped.exit_code, done) << skipped.err;
    EXPECT_THAT(skipped.out, HasSubstr("left out: ")) << name;
    EXPECT_THAT(skipped.out, HasSubstr(name));
    fs::remove(folder / "t" / name);
    fs::remove(folder / "t.talus");
  }
}

TEST_F(Tiles, AFileThatIsCutShortIsNamed) {
  fs::create_directory(folder / "t");
  write_tile("t/t1.tif", 0, 0, 40, 20);
  write_tile("t/t2.tif", 0, 20, 40, 20);
  fs::resize_file(folder / "t/t2.tif", 1200);
  expect_refusal(ingest({"t", "t.talus"}), {failed}, {"t2.tif"});
  EXPECT_FALSE(fs::exists(folder / "t.talus"));
}

TEST_F(Tiles, SubfoldersAreNamedAndLookedIntoIfAsked) {
  fs::create_directories(folder / "t/north/deep");
  write_tile("t/north/deep/a.tif", 0, 0, 40, 20);
  expect_refusal(ingest({"t", "t.talus"}), {usage}, {"no raster in folder t", "--recursive"});
  write_tile("t/b.tif", 0, 20, 40, 20);
  const Outcome flat = ingest({"t", "t.talus", "--json"});
  EXPECT_EQ(json_of(flat).at("rows"), 20);
  EXPECT_THAT(flat.out, HasSubstr("--recursive"));
  EXPECT_EQ(json_of(ingest({"t", "t.talus", "--json", "--recursive"})).at("rows"), 40);
}

TEST_F(Tiles, AListMayBeginWithAByteOrderMark) {
  write_tile("a.tif", 0, 0, 40, 20);
  write_tile("b.tif", 0, 20, 40, 20);
  write_bytes(folder / "list.txt",
              "\xef\xbb\xbf"
              "a.tif\r\nb.tif\r\n");
  EXPECT_EQ(json_of(ingest({"@list.txt", "l.talus", "--json"})).at("rows"), 40);
}

TEST_F(Tiles, ALinkOutOfAFolderIsFollowedOnlyWhereAllowed) {
  fs::create_directory(folder / "t");
  fs::create_directory(folder / "elsewhere");
  write_tile("t/a.tif", 0, 0, 40, 20);
  write_tile("elsewhere/b.tif", 0, 20, 40, 20);
  fs::create_symlink("../elsewhere/b.tif", folder / "t/b.tif");
  expect_refusal(ingest({"t", "t.talus"}), {failed}, {"t/b.tif", "elsewhere", "--allow-outside"});
  EXPECT_EQ(json_of(ingest({"t", "t.talus", "--json", "--allow-outside", "elsewhere"})).at("rows"), 40);
  fs::create_symlink("a.tif", folder / "t/same.tif");  // inside it is just another name
  EXPECT_EQ(ingest({"t", "t.talus", "--allow-outside", "elsewhere"}).exit_code, done);
}

// What GDAL opens beside a raster without being asked must be files, and stay where the raster is.
TEST_F(Tiles, SideFilesAreFilesOfTheirFolder) {
  for (const char* ending : {".aux.xml", ".msk", ".ovr"}) {
    SCOPED_TRACE(ending);
    fs::create_directory(folder / "t");
    write_tile("t/a.tif", 0, 0, 40, 20);
    ASSERT_EQ(::mkfifo((folder / "t/a.tif").string().append(ending).c_str(), 0600), 0);
    expect_refusal(ingest({"t/a.tif", "t.talus"}), {failed}, {std::string("a.tif") + ending, "pipe"});
    fs::remove_all(folder / "t");
  }
  fs::create_directory(folder / "t");
  write_tile("t/a.tif", 0, 0, 40, 20);
  write_bytes(folder / "outside.xml", "<PAMDataset/>");
  fs::create_symlink("../outside.xml", folder / "t/a.tif.aux.xml");
  expect_refusal(ingest({"t/a.tif", "t.talus"}), {failed}, {"a.tif.aux.xml", "--allow-outside"});
}

// OSGeo/gdal: the everyday gdalbuildvrt my.vrt /elsewhere/*.tif.
TEST_F(Tiles, AVirtualRasterOfTilesElsewhereOpensWhereAllowed) {
  fs::create_directories(folder / "elsewhere/deep");
  fs::create_directory(folder / "third");
  write_tile("elsewhere/deep/a.tif", 0, 0, 40, 40);
  const auto vrt = [&](const std::string& source) {
    write_bytes(
        folder / "my.vrt",
        "<VRTDataset rasterXSize=\"40\" rasterYSize=\"40\"><GeoTransform>500000,10,0,5600400,0,-10</GeoTransform>"
        "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename relativeToVRT=\"0\">" +
            source + "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>");
  };
  fs::create_directory(folder / "work");
  vrt((folder / "elsewhere/deep/a.tif").string());
  fs::rename(folder / "my.vrt", folder / "work/my.vrt");
  expect_refusal(ingest({"work/my.vrt", "v.talus"}), {failed}, {"my.vrt", "deep/a.tif", "--allow-outside"});
  expect_refusal(ingest({"work/my.vrt", "v.talus", "--allow-driver", "VRT"}), {failed}, {"--allow-outside"});
  expect_refusal(ingest({"work/my.vrt", "v.talus", "--allow-outside", "third"}), {failed}, {"--allow-outside"});
  const Outcome opened = ingest({"work/my.vrt", "v.talus", "--allow-outside", "elsewhere"});
  EXPECT_EQ(opened.exit_code, done) << opened.err;
  EXPECT_EQ(different(cells_of_database(folder / "v.talus"), cells_of(folder / "work/my.vrt")), 0);
  for (const char* other :
       {"/vsicurl/http://127.0.0.1:9/a.tif", "/vsizip/a.zip/a.tif", "http://127.0.0.1:9/a.tif", "<VRTDataset/>"}) {
    vrt(std::string(other) == "<VRTDataset/>" ? "&lt;VRTDataset/&gt;" : other);
    expect_refusal(ingest({"my.vrt", "v.talus", "--allow-outside", "/"}), {failed}, {"my.vrt"});
  }
}

// mapnik/mapnik#888, cryogars/ice-road-copters#2: tiles that are resampled one by one have seams where they join.
TEST_F(Tiles, TilesOfOneGridAreLaidTogetherBeforeTheyAreResampled) {
  fs::create_directory(folder / "t");
  write_tile("whole.tif", 0, 0, 80, 60);
  for (const int row : {0, 30}) {
    for (const int col : {0, 27, 54}) {
      const int cols = col == 54 ? 26 : 27;
      write_tile("t/" + std::to_string(row) + "-" + std::to_string(col) + ".tif", col, row, cols, 30);
    }
  }
  struct How {
    std::vector<std::string> words;
  };
  for (const How& how :
       {How{{"--t-srs", "EPSG:3035"}}, How{{"--t-srs", "EPSG:3035", "--tr", "7,7"}}, How{{"--tr", "15,15"}},
        How{{"--tr", "4,6", "--resampling", "cubic"}}, How{{"--t-srs", "EPSG:4326", "--resampling", "near"}},
        How{{"--tr", "33,33", "--resampling", "average"}}}) {
    SCOPED_TRACE(::testing::PrintToString(how.words));
    std::vector<std::string> whole{"whole.tif", "whole.talus"}, tiles{"t", "tiles.talus"};
    whole.insert(whole.end(), how.words.begin(), how.words.end());
    tiles.insert(tiles.end(), how.words.begin(), how.words.end());
    const Outcome one = ingest(whole), many = ingest(tiles);
    ASSERT_EQ(one.exit_code, done) << one.err;
    ASSERT_EQ(many.exit_code, done) << many.err;
    EXPECT_EQ(different(cells_of_database(folder / "tiles.talus"), cells_of_database(folder / "whole.talus")), 0);
  }
}

// The same where another input lies between them in the order, and over both.
TEST_F(Tiles, AnInputBetweenTilesKeepsItsPlaceInTheOrder) {
  write_tile("west.tif", 0, 0, 40, 40);
  write_tile("east.tif", 40, 0, 40, 40);
  Band flat;
  flat.samples.assign(30 * 10, 1000);
  write_bands(folder / "flat.tif", 30, 10, {flat},
              {.type = GDT_Float32, .crs = "EPSG:25832", .geotransform = {{500252.5, 10, 0, 5600302.5, 0, -10}}});
  const Outcome outcome = ingest({"west.tif", "flat.tif", "east.tif", "o.talus", "--tr", "5,5"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Cells cells = cells_of_database(folder / "o.talus");
  const int row = 28;                           // amid the flat one
  EXPECT_NEAR(*cells.at(64, row), 1000, 1e-3);  // over the west
  EXPECT_LT(*cells.at(84, row), 500);           // below the east
}

}  // namespace
}  // namespace talus::support
