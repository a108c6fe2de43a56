#include <algorithm>
#include <array>
#include <clocale>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gdal.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>

#include "engine/geo/crs_text.hpp"
#include "query/export/writers.hpp"
#include "talus/database.hpp"
#include "talus/raster_output.hpp"
#include "tests/support/asked.hpp"
#include "tests/support/mesh_file.hpp"
#include "tests/support/raster_file.hpp"
#include "tests/support/surface_of_mesh.hpp"

namespace talus {
namespace {

/// Whatever the ending says.
Metres write(const Mesh& mesh, const Description& description, const std::filesystem::path& file) {
  if (!is_raster_file(file)) return write_mesh(mesh, description, file);
  write_raster(mesh, description, file);
  return Metres{0};
}

using support::TempFolder;
using ::testing::HasSubstr;

// Two triangles over 3 x 3 samples, at heights that need all digits.
Mesh square() {
  return {{{0, 0}, {2, 2}}, {{0, 0}, {2, 0}, {0, 2}, {2, 2}}, {0.1, -1.0 / 3, 1e-17, 4000}, {{0, 3, 1}, {0, 2, 3}}};
}

Description georeferenced() {
  Description description;
  description.extent = {{0, 0}, {2, 2}};
  description.mapping = {500000.1, 4000000.7, 0.3, -0.3};
  return description;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

std::vector<std::string> names_in(const TempFolder& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator{folder.path()}) names.push_back(entry.path().filename());
  return names;
}

Cause cause_of_writing(const Mesh& mesh, const std::filesystem::path& file, bool names_it = true) {
  try {
    write(mesh, georeferenced(), file);
  } catch (const Failure& failure) {
    if (names_it) {
      EXPECT_THAT(failure.what(), HasSubstr(file.string()));
    }
    return failure.cause();
  }
  ADD_FAILURE() << "nothing failed";
  return Cause::corrupt;
}

TEST(Export, PlyAndObjGiveEveryBitBack) {
  const TempFolder folder;
  for (const char* name : {"mesh.ply", "mesh.obj", "MESH.PLY"}) {
    write(square(), georeferenced(), folder / name);
  }
  EXPECT_EQ(bytes_of(folder / "mesh.ply"), bytes_of(folder / "MESH.PLY"));
  for (const char* name : {"mesh.ply", "mesh.obj"}) {
    const Mesh read = support::read_mesh(folder / name, georeferenced().mapping);
    EXPECT_EQ(read.points, square().points) << name;
    EXPECT_EQ(read.heights, square().heights) << name;
    EXPECT_EQ(read.triangles, square().triangles) << name;
  }
}

TEST(Export, ObjHasPointsInAnyLocale) {
  const TempFolder folder;
  if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) GTEST_SKIP() << "no locale de_DE.UTF-8 here";
  write(square(), georeferenced(), folder / "mesh.obj");
  std::setlocale(LC_ALL, "C");
  EXPECT_THAT(bytes_of(folder / "mesh.obj"), HasSubstr("v 500000.1 4000000.7 0.1\n"));
}

TEST(Export, AnEmptyMeshIsAValidFile) {
  const TempFolder folder;
  Mesh empty;
  empty.region = {{0, 0}, {2, 2}};
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.png", "mesh.glb", "mesh.tif"})
    write(empty, georeferenced(), folder / name);
  EXPECT_TRUE(support::read_mesh(folder / "mesh.glb", georeferenced().mapping).points.empty());
  EXPECT_FALSE(support::read_raster(folder / "mesh.tif").has_data());
  EXPECT_THAT(bytes_of(folder / "mesh.ply"), HasSubstr("element vertex 0\n"));
  EXPECT_THAT(bytes_of(folder / "mesh.ply"), HasSubstr("element face 0\n"));
  EXPECT_THAT(bytes_of(folder / "mesh.png"), HasSubstr("IHDR"));
}

TEST(Export, APictureHasTheShapeOfTheGround) {
  const TempFolder folder;
  Description north = georeferenced();
  north.mapping = {10, 60.001, 0.001, -0.001};  // two cells around 60°: half as wide as high
  north.crs_wkt = R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
                  R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])";
  north.crs = facts_of_wkt(north.crs_wkt);
  write(square(), north, folder / "mesh.png");
  EXPECT_EQ(names_in(folder).size(), 1u);  // no side files
  GDALAllRegister();
  GDALDatasetH picture = GDALOpen((folder / "mesh.png").c_str(), GA_ReadOnly);
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(GDALGetRasterYSize(picture), 1600);
  EXPECT_NEAR(GDALGetRasterXSize(picture), 800, 1);
  GDALClose(picture);
}

TEST(Export, AFileThatCannotBeMadeLeavesNothing) {
  const TempFolder folder;
  EXPECT_EQ(cause_of_writing(square(), folder / "mesh.stl"), Cause::invalid_argument);
  EXPECT_EQ(cause_of_writing(square(), folder / "missing/mesh.ply"), Cause::io);
  std::filesystem::create_directory(folder / "folder.ply");
  EXPECT_EQ(cause_of_writing(square(), folder / "folder.ply"), Cause::io);
  EXPECT_THAT(names_in(folder), ::testing::ElementsAre("folder.ply"));
}

TEST(Export, ALinkStaysAndWhatItLeadsToIsReplaced) {
  const TempFolder folder;
  namespace fs = std::filesystem;
  fs::create_directory(folder / "far");
  write(square(), georeferenced(), folder / "plain.ply");
  std::ofstream(folder / "far/old.ply") << "old";
  fs::create_symlink("far/old.ply", folder / "one.ply");
  fs::create_symlink("one.ply", folder / "two.ply");
  fs::create_symlink("far/new.ply", folder / "dangling.ply");
  for (const char* name : {"two.ply", "dangling.ply"}) {
    write(square(), georeferenced(), folder / name);
    EXPECT_TRUE(fs::is_symlink(folder / name));
    EXPECT_EQ(bytes_of(folder / name), bytes_of(folder / "plain.ply"));
  }
  EXPECT_TRUE(fs::is_symlink(folder / "one.ply"));
  EXPECT_EQ(bytes_of(folder / "far/old.ply"), bytes_of(folder / "plain.ply"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "far"), {}), 2);  // nothing else was left there
  fs::create_symlink("round.ply", folder / "round.ply");
  EXPECT_EQ(cause_of_writing(square(), folder / "round.ply"), Cause::io);
}

TEST(Export, ADeviceIsNotReplaced) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.ply").c_str(), 0600), 0);
  EXPECT_EQ(cause_of_writing(square(), folder / "pipe.ply"), Cause::io);
  std::filesystem::create_symlink("/dev/null", folder / "null.ply");
  EXPECT_EQ(cause_of_writing(square(), folder / "null.ply"), Cause::io);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(Export, AMeshThatNamesWhatItLacksIsRefused) {
  const TempFolder folder;
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.png", "mesh.glb", "mesh.tif"}) {
    Mesh without_height = square(), without_point = square();
    without_height.heights.pop_back();
    without_point.triangles.push_back({0, 1, 4});
    EXPECT_EQ(cause_of_writing(without_height, folder / name), Cause::invalid_argument);
    EXPECT_EQ(cause_of_writing(without_point, folder / name), Cause::invalid_argument);
  }
  EXPECT_TRUE(names_in(folder).empty());
}

// Of a raster large enough that each format writes more than once.
Mesh rough() {
  support::Random random(5);
  Mesh mesh;
  mesh.region = {{0, 0}, {511, 511}};
  for (std::int32_t row = 0; row <= 511; ++row) {
    for (std::int32_t col = 0; col <= 511; ++col) {
      mesh.points.push_back({col, row});
      mesh.heights.push_back(random.within(0, 1000));
    }
  }
  for (std::uint32_t row = 0; row < 511; ++row) {
    for (std::uint32_t col = 0; col < 511; ++col) {
      const std::uint32_t nw = row * 512 + col, sw = nw + 512;
      mesh.triangles.push_back({nw, sw, nw + 1});
      mesh.triangles.push_back({nw + 1, sw, sw + 1});
    }
  }
  return mesh;
}

TEST(Export, AFailureHalfwayKeepsTheOldFile) {
  const Mesh large = rough();
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.glb", "mesh.tif"}) {
    const TempFolder folder;
    write(large, georeferenced(), folder / name);
    const auto whole = static_cast<rlim_t>(std::filesystem::file_size(folder / name));
    write(square(), georeferenced(), folder / name);
    const std::string before = bytes_of(folder / name);
    for (const rlim_t most : {rlim_t{0}, rlim_t{100}, whole / 3, whole - 70000, whole - 1}) {
      rlimit limit{};
      ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
      const rlimit small{most, limit.rlim_max};
      std::signal(SIGXFSZ, SIG_IGN);  // then writing beyond the limit fails instead
      ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
      const Cause cause = cause_of_writing(large, folder / name);
      setrlimit(RLIMIT_FSIZE, &limit);
      std::signal(SIGXFSZ, SIG_DFL);

      EXPECT_EQ(cause, Cause::io) << name << " of " << most << " bytes";
      EXPECT_EQ(bytes_of(folder / name), before) << name << " of " << most << " bytes";
      EXPECT_EQ(names_in(folder).size(), 1u) << name << " of " << most << " bytes";
    }
  }
}

// ---- .glb ------------------------------------------------------------------------------------------

TEST(Export, GlbHoldsFloatsAndHeightStepsExactly) {
  const TempFolder folder;
  Mesh mesh = square();
  Description description = georeferenced();
  for (const auto& heights : {std::array{0.5, -3.25, 0x1p-56, 4000.0}, std::array{1e6, 1e6 + 1, 1e6 - 7, 1e6 + 16e6}}) {
    mesh.heights.assign(heights.begin(), heights.end());
    EXPECT_EQ(write(mesh, description, folder / "mesh.glb").value, 0);
    const Mesh read = support::read_mesh(folder / "mesh.glb", description.mapping);
    EXPECT_EQ(read.points, mesh.points);
    EXPECT_EQ(read.heights, mesh.heights);
    EXPECT_EQ(read.triangles, mesh.triangles);
  }
  description.step = {1, 10, 0, true};  // decimetres, which no float holds
  mesh.heights = {0.1, -0.3, 8848.9, 1234.5};
  EXPECT_EQ(write(mesh, description, folder / "mesh.glb").value, 0);
  const Mesh read = support::read_mesh(folder / "mesh.glb", description.mapping);
  for (std::size_t i = 0; i < mesh.size(); ++i) EXPECT_NEAR(read.heights[i], mesh.heights[i], 1e-11);
}

TEST(Export, GlbSaysHowFarItRounds) {
  const TempFolder folder;
  Description description = georeferenced();
  description.metres_per_unit = 1000;
  description.vertical_unit = "kilometre";
  const Mesh mesh = square();
  const double rounding = write(mesh, description, folder / "mesh.glb").value;
  const Mesh read = support::read_mesh(folder / "mesh.glb", description.mapping);
  double largest = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i)
    largest = std::max(largest, std::abs(read.heights[i] - 1000 * mesh.heights[i]));
  EXPECT_GT(rounding, 0);
  EXPECT_LE(largest, rounding + 1e-9);
  EXPECT_LE(rounding, 1000 * (4000 + 1.0 / 3) * 0x1p-25);
}

TEST(Export, GlbOfDegreesIsInMetresOnTheGround) {
  const TempFolder folder;
  Description north = georeferenced();
  north.mapping = {10, 60.001, 0.001, -0.001};
  north.crs_wkt = R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
                  R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])";
  north.crs = facts_of_wkt(north.crs_wkt);
  write(square(), north, folder / "mesh.glb");
  const std::string bytes = bytes_of(folder / "mesh.glb");
  const auto json = nlohmann::json::parse(bytes.substr(20, bytes.rfind("}]}") + 3 - 20));
  const auto& node = json["nodes"][0];
  EXPECT_NEAR(node["scale"][0], 55.80, 0.01);  // a thousandth of a degree at 60°, on this ellipsoid
  EXPECT_NEAR(node["scale"][2], 111.41, 0.01);
  EXPECT_EQ(node["translation"][0], 0);
  EXPECT_EQ(node["translation"][2], 0);
  const auto& extras = json["asset"]["extras"];
  EXPECT_EQ(extras["crs_wkt"], north.crs_wkt);
  EXPECT_EQ(extras["origin"]["x"], north.mapping.x(1));
  EXPECT_EQ(extras["origin"]["y"], north.mapping.y(1));
}

TEST(Export, GlbOfFeetIsInMetres) {
  const TempFolder folder;
  Description feet = georeferenced();
  feet.crs_wkt = R"(PROJCS["x",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
                 R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
                 R"(PARAMETER["central_meridian",9],UNIT["foot",0.3048]])";
  feet.crs = facts_of_wkt(feet.crs_wkt);
  feet.metres_per_unit = 0.3048;
  write(square(), feet, folder / "mesh.glb");
  GridMapping metres = feet.mapping;
  for (double* v : {&metres.x0, &metres.y0, &metres.dx, &metres.dy}) *v *= 0.3048;
  const Mesh read = support::read_mesh(folder / "mesh.glb", metres);
  EXPECT_EQ(read.points, square().points);
  EXPECT_NEAR(read.heights[3], 4000 * 0.3048, 1e-3);
}

TEST(Export, WhatNoGlbHoldsIsRefused) {
  const TempFolder folder;
  Mesh mesh = square();
  mesh.heights[0] = 1e300;
  EXPECT_EQ(cause_of_writing(mesh, folder / "mesh.glb", false), Cause::unsupported);
  mesh = square();
  mesh.region.last.col = mesh.points[1].col = 1 << 27;
  EXPECT_EQ(cause_of_writing(mesh, folder / "mesh.glb", false), Cause::unsupported);
  EXPECT_TRUE(names_in(folder).empty());
}

TEST(Export, EverySampleLiesWithinTheBoundOfAGlb) {
  support::for_rasters(60, [](support::Asked& asked) {
    const Question q = asked.question();
    const Answer answer = asked.now->ask(q);
    Description d = asked.now->description();
    d.crs = {};
    d.crs_wkt.clear();  // then positions come back as they are, and the judge has metres as it has them
    const Mesh mesh = triangulate(answer.quadtree);
    const Metres rounding = write(mesh, d, asked.folder / "mesh.glb");
    Mesh read = support::read_mesh(asked.folder / "mesh.glb", d.mapping);
    read.region = mesh.region;
    ASSERT_EQ(read.points, mesh.points) << asked.name(q);
    ASSERT_EQ(read.triangles, mesh.triangles) << asked.name(q);
    support::Terrain metres = asked.raster.terrain;
    for (double& v : metres.values) v *= d.metres_per_unit;
    support::OracleOptions judging = asked.raster.judging;
    judging.heights_are_source = false;
    const auto report =
        support::check_mesh(read, metres, 1, answer.quadtree.bound.value + rounding.value + 1e-9, judging);
    EXPECT_TRUE(report.sound()) << asked.name(q) << ": " << report.summary();
  });
}

// ---- .tif ------------------------------------------------------------------------------------------

TEST(Export, TifHasTheSurfaceAtEverySampleAndNothingBesideIt) {
  support::for_rasters(80, [](support::Asked& asked) {
    Question q = asked.question();
    if (q.region.cols() < 2 || q.region.rows() < 2) return;
    q.border = asked.random.chance(0.3) ? Border::cover : Border::constrain;
    const Answer answer = asked.now->ask(q);
    Mesh mesh = triangulate(answer.quadtree);
    const auto place = [&](std::int32_t from, std::int32_t to) { return asked.random.within(from, to); };
    const GridRect r = mesh.region;
    const bool clipped = q.border == Border::cover && asked.random.chance(0.5);
    if (clipped) {
      mesh = clip_mesh(mesh, {place(r.first.col, r.first.col + 1), place(r.first.row, r.first.row + 1),
                              place(r.last.col - 1, r.last.col), place(r.last.row - 1, r.last.row)});
    }
    write(mesh, asked.now->description(), asked.folder / "mesh.tif");
    const support::Terrain read = support::read_raster(asked.folder / "mesh.tif");
    ASSERT_EQ(read.cols, r.cols());
    ASSERT_EQ(read.rows, r.rows());

    // The plane of each triangle, by another formula than the writer's.
    std::vector<double> surface(read.values.size(), NAN);
    for (const auto& t : mesh.triangles) {
      const Place a = mesh.place(t[0]), b = mesh.place(t[1]), c = mesh.place(t[2]);
      const auto [north, south] = std::minmax({a.row, b.row, c.row});
      const auto [west, east] = std::minmax({a.col, b.col, c.col});
      for (int row = std::max(0, static_cast<int>(north) - r.first.row); row < read.rows && row + r.first.row <= south;
           ++row) {
        for (int col = std::max(0, static_cast<int>(west) - r.first.col); col < read.cols && col + r.first.col <= east;
             ++col) {
          const double x = col + r.first.col, y = row + r.first.row;
          const long double det =
              (long double)(b.row - c.row) * (a.col - c.col) + (long double)(c.col - b.col) * (a.row - c.row);
          const long double u = ((b.row - c.row) * (x - c.col) + (c.col - b.col) * (y - c.row)) / det;
          const long double v = ((c.row - a.row) * (x - c.col) + (a.col - c.col) * (y - c.row)) / det;
          if (u < -1e-11L || v < -1e-11L || u + v > 1 + 1e-11L) continue;
          surface[read.index(col, row)] =
              static_cast<double>(u * mesh.heights[t[0]] + v * mesh.heights[t[1]] + (1 - u - v) * mesh.heights[t[2]]);
        }
      }
    }
    const double unit = asked.now->description().metres_per_unit;
    for (int row = 0; row < read.rows; ++row) {
      for (int col = 0; col < read.cols; ++col) {
        const GridPoint p{col + r.first.col, row + r.first.row};
        const double expected = surface[read.index(col, row)];
        ASSERT_EQ(read.is_valid(col, row), !std::isnan(expected)) << asked.name(q) << " at " << p.col << "/" << p.row;
        if (std::isnan(expected)) continue;
        const double height = read.at(col, row);
        ASSERT_NEAR(height, expected, 1e-12 * (1 + std::abs(expected)) + 1e-9 / unit)
            << asked.name(q) << " at " << p.col << "/" << p.row;
        if (asked.raster.terrain.is_valid(p.col, p.row)) {
          ASSERT_LE(std::abs(height - asked.raster.terrain.at(p.col, p.row)) * unit, answer.quadtree.bound.value + 2e-9)
              << asked.name(q);
        }
      }
    }
  });
}

TEST(Export, TifLiesWhereTheSamplesDo) {
  const TempFolder folder;
  Description description = georeferenced();
  description.vertical_unit = "US survey foot";
  description.crs_wkt = R"(LOCAL_CS["somewhere",UNIT["metre",1]])";
  Mesh mesh = square();
  write(mesh, description, folder / "mesh.tif");
  EXPECT_EQ(names_in(folder).size(), 1u);  // no side files
  GDALAllRegister();
  const auto open = [&] { return GDALOpen((folder / "mesh.tif").c_str(), GA_ReadOnly); };
  GDALDatasetH raster = open();
  ASSERT_NE(raster, nullptr);
  std::array<double, 6> corner{};
  ASSERT_EQ(GDALGetGeoTransform(raster, corner.data()), CE_None);
  for (const GridPoint p : mesh.points) {
    EXPECT_NEAR(corner[0] + (p.col + 0.5) * corner[1], description.mapping.x(p.col), 1e-9);
    EXPECT_NEAR(corner[3] + (p.row + 0.5) * corner[5], description.mapping.y(p.row), 1e-9);
  }
  GDALRasterBandH band = GDALGetRasterBand(raster, 1);
  EXPECT_STREQ(GDALGetRasterUnitType(band), "US survey foot");
  EXPECT_THAT(GDALGetProjectionRef(raster), HasSubstr("somewhere"));
  EXPECT_TRUE(std::isnan(GDALGetRasterNoDataValue(band, nullptr)));
  EXPECT_EQ(GDALGetRasterDataType(band), GDT_Float64) << "a third is no float";
  GDALClose(raster);
  mesh.heights = {1, 2, 3, 4};
  write(mesh, description, folder / "mesh.tif");
  raster = open();
  EXPECT_EQ(GDALGetRasterDataType(GDALGetRasterBand(raster, 1)), GDT_Float32);
  GDALClose(raster);
}

TEST(Export, EachFunctionNamesTheOtherForItsEndings) {
  const TempFolder folder;
  const auto refused = [](auto&& write) -> std::string {
    try {
      write();
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::invalid_argument);
      return failure.what();
    }
    return "not refused";
  };
  EXPECT_THAT(refused([&] { write_mesh(square(), georeferenced(), folder / "mesh.tif"); }), HasSubstr("write_raster"));
  EXPECT_THAT(refused([&] { write_raster(square(), georeferenced(), folder / "mesh.ply"); }),
              HasSubstr(".tif or .png"));
  EXPECT_TRUE(names_in(folder).empty());
}

TEST(Export, WhatWouldFailIsKnownBeforeTheWork) {
  const TempFolder folder;
  EXPECT_TRUE(is_mesh_file("mesh.ply") && is_mesh_file(folder / "mesh.OBJ"));
  for (const char* name : {"mesh", "mesh.txt", "mesh.tif", "mesh.rqt"}) EXPECT_FALSE(is_mesh_file(name)) << name;
  EXPECT_NO_THROW(check_folder("mesh.ply"));
  EXPECT_THROW(check_folder(folder / "missing/mesh.ply"), Failure);
  EXPECT_THROW(check_folder(folder.path()), Failure) << "a folder itself";
}

}  // namespace
}  // namespace talus
