// Points, lines and rasters of tolerance on the command line of `talus query`.

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;

class Interest : public Command {
 protected:
  void SetUp() override {
    raster = hole(raster, 20, 20, 30, 30);
    options.crs = "EPSG:32632";
    options.geotransform = {450000, 30, 0, 5200000, 0, -30};
    make_raster("a.tif", options);
    const Outcome outcome = talus({"ingest", "a.tif", "a.talus"});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  }
  [[nodiscard]] Outcome query(std::vector<std::string> more, const std::string& tolerance = "--tolerance=1000") const {
    std::vector<std::string> arguments{"query", "a.talus"};
    if (!tolerance.empty()) arguments.push_back(tolerance);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return talus(arguments);
  }
  [[nodiscard]] nlohmann::json asked(std::vector<std::string> more,
                                     const std::string& tolerance = "--tolerance=1000") const {
    more.push_back("--json");
    const Outcome outcome = query(more, tolerance);
    EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    return json_of(outcome);
  }
  /// The answer as it is in an .rqt file.
  [[nodiscard]] RestrictedQuadtree answer(std::vector<std::string> more,
                                          const std::string& tolerance = "--tolerance=1000") const {
    more.insert(more.end(), {"-o", "answer.rqt"});
    const Outcome outcome = query(more, tolerance);
    EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    return std::get<RestrictedQuadtree>(read_stream(folder / "answer.rqt").content);
  }
  void write_tolerances(const std::string& name, const Terrain& terrain,
                        std::array<double, 6> geotransform = {0, 1, 0, 0, 0, 1}, const std::string& crs = "") const {
    RasterOptions tolerances;
    tolerances.type = SampleType::float32;
    tolerances.geotransform = geotransform;
    tolerances.crs = crs;
    write_raster(terrain, folder / name, tolerances);
  }
  RasterOptions options;
};

TEST_F(Interest, APointIsAVertex) {
  EXPECT_FALSE(answer({}).vertices.contains({13, 7}));
  EXPECT_TRUE(answer({"--point=450413,5199770"}).vertices.contains({13, 7}));
  const RestrictedQuadtree two = answer({"--point", "450413,5199770", "--point=452000,5198009"});
  EXPECT_TRUE(two.vertices.contains({13, 7}));
  EXPECT_TRUE(two.vertices.contains({66, 66}));
  write_bytes(folder / "points.txt", "450413 5199770\n\n452000,\t5198009 \r\n");
  const RestrictedQuadtree from_file = answer({"--points", "points.txt"});
  EXPECT_EQ(from_file.heights, two.heights);
  EXPECT_TRUE(from_file.vertices.contains({66, 66}));
}

TEST_F(Interest, ALineIsARowOfVertices) {
  const RestrictedQuadtree along = answer({"--line=450075,5199925,450585,5199925,450585,5199415"});
  for (int v = 2; v <= 19; ++v) {
    EXPECT_TRUE(along.vertices.contains({v, 2})) << v;
    EXPECT_TRUE(along.vertices.contains({19, v})) << v;
  }
  write_bytes(folder / "lines.txt", "\n450075 5199925\n450585 5199925\n\n \n450585 5199925\n450585 5199415\n");
  EXPECT_EQ(answer({"--lines", "lines.txt"}).heights, along.heights);
}

TEST_F(Interest, SaysHowManyVerticesAreForThemAlone) {
  const std::vector<std::string> places{"--point=450413,5199770", "--line=450765,5199235,451400,5199235"};
  const auto without = asked({}), with = asked(places);
  EXPECT_EQ(without["point_vertices"], 0);
  EXPECT_EQ(with["point_vertices"], answer(places).vertices.size() - answer({}).vertices.size());
  EXPECT_GT(with["void_points"], 0) << "the line begins amid the hole";
  const Outcome text = query(places);
  EXPECT_THAT(text.out, HasSubstr("extra vertices for them"));
  EXPECT_THAT(text.err, HasSubstr("have no data"));
  const auto only_void = asked({"--point=450765,5199235"});
  EXPECT_EQ(only_void["void_points"], 1);
  EXPECT_EQ(only_void["vertices"], without["vertices"]);
}

TEST_F(Interest, PointsAndLinesThatAreNoneAreRefused) {
  expect_refusal(query({"--point=450413"}), {usage}, {"--point", "450413"});
  expect_refusal(query({"--point=450413,nan"}), {usage}, {"--point", "nan"});
  expect_refusal(query({"--point=1,2"}), {usage}, {"1, 2", "region"});
  expect_refusal(query({"--point=450413,5199770", "--bbox=451000,5198500,451500,5199000"}), {usage},
                 {"450413", "region"});
  expect_refusal(query({"--line=450413,5199770"}), {usage}, {"--line", "450413,5199770"});
  expect_refusal(query({"--line=450413,5199770,1,2"}), {usage}, {"1, 2", "region"});
  expect_refusal(query({"--points", "none.txt"}), {failed}, {"none.txt"});
  expect_refusal(query({"--points", "."}), {failed}, {"."});
  expect_refusal(query({"--points", ""}), {usage}, {"--points"});
  write_bytes(folder / "bad.txt", "450413 5199770\n450413 north\n");
  expect_refusal(query({"--points", "bad.txt"}), {usage}, {"bad.txt", "line 2", "north"});
  write_bytes(folder / "lines.txt", "450413 5199770\n450443 5199770\n\n450413 5199770\n");
  expect_refusal(query({"--lines", "lines.txt"}), {usage}, {"lines.txt", "line 4", "two"});
  expect_refusal(query({"--point=450413,5199770", "--border=cover"}), {usage}, {"must be constrained"});
  expect_refusal(query({"--point=450413,5199770", "--max-vertices=900"}, ""), {usage}, {"budget", "points"});
  expect_refusal(query({"--point=450413,5199770", "--from=2000", "-o", "out.rqt"}), {usage}, {"--from", "points"});
}

TEST_F(Interest, ARasterSaysTheToleranceOfEachPatch) {
  Terrain tolerances(2, 1);
  tolerances.at(0, 0) = 1000, tolerances.at(1, 0) = 1;
  const auto expect_halves = [&](const std::string& file) {
    const RestrictedQuadtree halves = answer({"--tolerance-raster", file}, "");
    std::size_t west = 0, east = 0;
    halves.vertices.for_each([&](GridPoint p) { ++(p.col < 45 ? west : east); });
    EXPECT_GT(west, 0u);
    EXPECT_GT(east, 4 * west) << file;
  };
  write_tolerances("plain.tif", tolerances);
  expect_halves("plain.tif");
  write_tolerances("placed.tif", tolerances, {450000, 1350, 0, 5200000, 0, -2100}, "EPSG:32632");
  expect_halves("placed.tif");
  write_tolerances("no_crs.tif", tolerances, {450000, 1350, 0, 5200000, 0, -2100});
  expect_halves("no_crs.tif");
  EXPECT_EQ(answer({"--tolerance-raster", "plain.tif"}, "").heights,
            answer({"--tolerance-raster", "placed.tif"}, "").heights);

  const auto json = asked({"--tolerance-raster", "placed.tif"}, "");
  EXPECT_EQ(json["tolerance"], 1);
  EXPECT_LE(json["bound"], 1000);
  const Outcome text = query({"--tolerance-raster", "placed.tif"}, "");
  EXPECT_THAT(text.out, HasSubstr("1 m or more, by placed.tif"));
  EXPECT_EQ(asked({"--tolerance-raster", "placed.tif", "--point=450413,5199770"}, "")["void_points"], 0);
}

TEST_F(Interest, ARasterOverTheRectangleAskedForWillDo) {
  write_tolerances("over.tif", Terrain(3, 4), {451001, 100, 0, 5199009, 0, -100}, "EPSG:32632");
  EXPECT_EQ(query({"--tolerance-raster", "over.tif", "--bbox=451001,5198609,451301,5199009"}, "").exit_code, done);
  expect_refusal(query({"--tolerance-raster", "over.tif", "--bbox=451001,5198609,451341,5199009"}, ""), {usage},
                 {"over.tif", "cover"});
}

TEST_F(Interest, RastersThatSayNoToleranceAreRefused) {
  const auto refused = [&](const std::string& file, std::vector<std::string> named) {
    named.push_back(file);
    expect_refusal(query({"--tolerance-raster", file}, ""), {usage}, named);
  };
  Terrain tolerances(2, 2);
  write_tolerances("elsewhere.tif", tolerances, {1000, 1350, 0, 2000, 0, -2100}, "EPSG:32632");
  refused("elsewhere.tif", {"does not overlap"});
  write_tolerances("part.tif", tolerances, {450000, 1000, 0, 5200000, 0, -2100}, "EPSG:32632");
  refused("part.tif", {"cover"});
  write_tolerances("other_crs.tif", tolerances, {450000, 1350, 0, 5200000, 0, -2100}, "EPSG:32633");
  refused("other_crs.tif", {"coordinate system"});
  tolerances.at(1, 1) = -2;
  write_tolerances("negative.tif", tolerances);
  refused("negative.tif", {"column 1, row 1", "-2"});
  tolerances.at(1, 1) = 2;
  tolerances.make_void(0, 1);
  write_tolerances("void.tif", tolerances);
  refused("void.tif", {"column 0, row 1", "is void"});
  expect_refusal(query({"--tolerance-raster", "none.tif"}, ""), {failed}, {"none.tif"});
  write_bytes(folder / "text.tif", "no raster");
  expect_refusal(query({"--tolerance-raster", "text.tif"}, ""), {failed, usage}, {"text.tif"});
}

TEST_F(Interest, OneThingDecidesAboutTheTolerance) {
  write_tolerances("one.tif", Terrain(1, 1));
  expect_refusal(query({"--tolerance-raster", "one.tif"}), {usage}, {"--tolerance-raster", "give one of them"});
  expect_refusal(query({"--tolerance-raster", "one.tif", "--max-triangles=900"}, ""), {usage}, {"--tolerance-raster"});
  expect_refusal(query({"--tolerance-raster", "one.tif", "--focus=450413,5199770,1"}, ""), {usage}, {"--focus"});
  expect_refusal(query({"--tolerance-raster", "one.tif", "--from=5", "-o", "out.rqt"}, ""), {usage}, {"--from"});
  expect_refusal(query({"--tolerance-raster", "one.tif", "--border=cover"}, ""), {usage}, {"must be constrained"});
  expect_refusal(query({}, ""), {usage}, {"--tolerance", "--max-vertices", "--tolerance-raster"});
}

}  // namespace
}  // namespace talus::support
