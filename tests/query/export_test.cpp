#include <array>
#include <clocale>
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
#include <sys/resource.h>

#include "query/export/writers.hpp"
#include "talus/database.hpp"
#include "tests/support/mesh_file.hpp"
#include "tests/support/raster_file.hpp"

namespace talus {
namespace {

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

Cause cause_of_writing(const Mesh& mesh, const std::filesystem::path& file) {
  try {
    write_mesh(mesh, georeferenced(), file);
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr(file.string()));
    return failure.cause();
  }
  ADD_FAILURE() << "nothing failed";
  return Cause::corrupt;
}

TEST(Export, PlyAndObjGiveEveryBitBack) {
  const TempFolder folder;
  for (const char* name : {"mesh.ply", "mesh.obj", "MESH.PLY"}) {
    write_mesh(square(), georeferenced(), folder / name);
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
  write_mesh(square(), georeferenced(), folder / "mesh.obj");
  std::setlocale(LC_ALL, "C");
  EXPECT_THAT(bytes_of(folder / "mesh.obj"), HasSubstr("v 500000.1 4000000.7 0.1\n"));
}

TEST(Export, AnEmptyMeshIsAValidFile) {
  const TempFolder folder;
  Mesh empty;
  empty.region = {{0, 0}, {2, 2}};
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.png"}) write_mesh(empty, georeferenced(), folder / name);
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
  write_mesh(square(), north, folder / "mesh.png");
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

TEST(Export, AMeshThatNamesWhatItLacksIsRefused) {
  const TempFolder folder;
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.png"}) {
    Mesh without_height = square(), without_point = square();
    without_height.heights.pop_back();
    without_point.triangles.push_back({0, 1, 4});
    EXPECT_EQ(cause_of_writing(without_height, folder / name), Cause::invalid_argument);
    EXPECT_EQ(cause_of_writing(without_point, folder / name), Cause::invalid_argument);
  }
  EXPECT_TRUE(names_in(folder).empty());
}

TEST(Export, AFailureHalfwayKeepsTheOldFile) {
  const TempFolder folder;
  write_mesh(square(), georeferenced(), folder / "mesh.ply");
  const std::string before = bytes_of(folder / "mesh.ply");

  Mesh large = square();
  large.triangles.resize(300000, {0, 3, 1});
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{2000000, limit.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);  // then writing beyond the limit fails instead
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Cause cause = cause_of_writing(large, folder / "mesh.ply");
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, SIG_DFL);

  EXPECT_EQ(cause, Cause::io);
  EXPECT_EQ(bytes_of(folder / "mesh.ply"), before);
  EXPECT_EQ(names_in(folder).size(), 1u);
}

TEST(Export, WhatWouldFailIsKnownBeforeTheWork) {
  const TempFolder folder;
  EXPECT_NO_THROW(check_mesh_file("mesh.ply"));
  EXPECT_NO_THROW(check_mesh_file(folder / "mesh.obj"));
  for (const std::filesystem::path& file : {folder / "mesh", folder / "mesh.txt", folder / "missing/mesh.ply"}) {
    EXPECT_THROW(check_mesh_file(file), Failure) << file;
  }
}

}  // namespace
}  // namespace talus
