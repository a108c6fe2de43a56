// `talus height` and `talus profile`, held against the raster.

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

class Points : public Command {
 protected:
  void SetUp() override {
    raster = hole(raster, 20, 20, 30, 30);
    RasterOptions options;
    options.crs = "EPSG:32632";
    options.geotransform = {450000, 30, 0, 5200000, 0, -30};
    make_raster("a.tif", options);
    const Outcome outcome = talus({"ingest", "a.tif", "a.talus"});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  }
  [[nodiscard]] Outcome from_input(const std::string& text, std::vector<std::string> more = {}) const {
    write_bytes(folder / "points.txt", text);
    std::vector<std::string> arguments{"height", "a.talus", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOptions options;
    options.input = (folder / "points.txt").string();
    return talus(arguments, options);
  }
  [[nodiscard]] std::string line_of(int col, int row) const {
    return std::to_string(static_cast<int>(raster.at(col, row))) + "\n";
  }
};

TEST_F(Points, AHeightIsOneLine) {
  const Outcome on_sample = talus({"height", "a.talus", "450015", "5199985"});
  EXPECT_EQ(on_sample.exit_code, done) << on_sample.err;
  EXPECT_EQ(on_sample.out, line_of(0, 0));
  const Outcome between = talus({"height", "a.talus", "450030", "5199985"});
  EXPECT_EQ(std::stod(between.out), (raster.at(0, 0) + raster.at(1, 0)) / 2);
  EXPECT_EQ(talus({"height", "a.talus", "450765", "5199235"}).out, "void\n");
  EXPECT_EQ(talus({"height", "a.talus", "0", "-5"}).out, "outside\n");
  EXPECT_EQ(talus({"height", "a.talus", "-.5", "-.25"}).out, "outside\n");
}

TEST_F(Points, AHeightOfASurfaceIsThatOfTheMesh) {
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const Outcome outcome = talus({"height", "a.talus", "451000", "5199001", "--surface", "40"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(std::stod(outcome.out), now.height(451000, 5199001, Metres{40}).value());
  EXPECT_NE(std::stod(outcome.out), now.height(451000, 5199001).value());
}

TEST_F(Points, HeightsInJsonAreAnObjectALine) {
  const auto json = json_of(talus({"height", "a.talus", "450015", "5199985", "--json"}));
  EXPECT_EQ(json, (nlohmann::json{{"x", 450015.0}, {"y", 5199985.0}, {"height", raster.at(0, 0)}}));
  const auto nothing = json_of(talus({"height", "a.talus", "450765", "5199235", "--json"}));
  EXPECT_EQ(nothing, (nlohmann::json{{"x", 450765.0}, {"y", 5199235.0}, {"height", nullptr}, {"why", "void"}}));
}

TEST_F(Points, StandardInputIsAnsweredLineByLine) {
  const Outcome outcome = from_input("450015 5199985\n450045,5199985\n  450075\t5199985 \r\n1e3 , -7\n450765 5199235");
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(outcome.out, line_of(0, 0) + line_of(1, 0) + line_of(2, 0) + "outside\nvoid\n");
  EXPECT_EQ(from_input("").out, "");
  EXPECT_EQ(from_input("").exit_code, done);
}

TEST_F(Points, ManyLinesAreAnsweredInTheirOrder) {
  std::string text, expected;
  for (int row = raster.rows - 1; row >= 0; --row) {
    for (int col = 0; col < raster.cols; ++col) {
      text += std::to_string(450015 + 30 * col) + "," + std::to_string(5199985 - 30 * row) + "\n";
      expected += raster.is_valid(col, row) ? line_of(col, row) : "void\n";
    }
  }
  EXPECT_EQ(from_input(text).out, expected);
}

TEST_F(Points, AMalformedLineIsNamedAfterTheAnswersBeforeIt) {
  for (const std::string bad :
       {"450015", "", "450015 5199985 7", "north east", "450015;5199985", "nan 5", "inf 5", "1,,2"}) {
    const Outcome outcome = from_input("450015 5199985\n450045 5199985\n" + bad + "\n450075 5199985\n");
    EXPECT_EQ(outcome.exit_code, usage) << bad;
    EXPECT_EQ(outcome.out, line_of(0, 0) + line_of(1, 0)) << bad;
    EXPECT_THAT(outcome.err, ::testing::HasSubstr("line 3")) << bad;
  }
}

TEST_F(Points, WhatIsNoPointIsRefused) {
  expect_refusal(talus({"height", "a.talus", "5"}), {usage}, {"5"});
  expect_refusal(talus({"height", "a.talus", "5", "north"}), {usage}, {"north"});
  expect_refusal(talus({"height", "a.talus", "5", "nan"}), {usage}, {"nan"});
  expect_refusal(talus({"height", "a.talus", "-", "5"}), {usage}, {"-"});
  expect_refusal(talus({"height", "a.talus"}), {usage}, {"X Y is missing"});
  expect_refusal(talus({"height", "a.talus", "5", "6", "--surface", "-1"}), {usage}, {"--surface"});
  expect_refusal(talus({"height", "none.talus", "5", "6"}), {failed}, {"none.talus"});
}

TEST_F(Points, ADatabaseOfATolerancesVerticesHasSurfacesOnly) {
  ASSERT_EQ(talus({"ingest", "a.tif", "b.talus", "--tolerance", "5"}).exit_code, done);
  expect_refusal(talus({"height", "b.talus", "450015", "5199985"}), {failed}, {"5 m"});
  EXPECT_EQ(talus({"height", "b.talus", "450015", "5199985", "--surface", "5"}).out, line_of(0, 0));
}

TEST_F(Points, AProfileIsCsvOrJsonOrAFile) {
  const std::vector<std::string> question{"profile", "a.talus", "--line=450015,5199535,452685,5199535", "--tolerance",
                                          "5"};
  const Outcome text = talus(question);
  EXPECT_EQ(text.exit_code, done) << text.err;
  EXPECT_THAT(text.out, ::testing::StartsWith("part,distance,x,y,height\n1,0,450015,5199535,"));
  auto with = question;
  with.insert(with.end(), {"--json"});
  const auto json = json_of(talus(with));
  EXPECT_DOUBLE_EQ(json["length"], 2670);
  EXPECT_EQ(json["tolerance"], 5);
  EXPECT_LE(json["bound"], 5);
  ASSERT_EQ(json["parts"].size(), 1u);
  EXPECT_EQ(json["parts"][0].size(), json["vertices"]);
  EXPECT_EQ(json["parts"][0].size(), std::count(text.out.begin(), text.out.end(), '\n') - 1);
  with = question;
  with.insert(with.end(), {"-o", "out.csv"});
  const Outcome file = talus(with);
  EXPECT_EQ(file.exit_code, done) << file.err;
  EXPECT_EQ(bytes_of(folder / "out.csv"), text.out);
  EXPECT_THAT(file.out, ::testing::HasSubstr("out.csv"));
}

TEST_F(Points, AProfileHasPartsBesideVoids) {
  const Outcome outcome = talus({"profile", "a.talus", "--line", "-450015,5199235,452685,5199235", "--tolerance=0"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("\n2,"));
  EXPECT_THAT(outcome.out, ::testing::Not(::testing::HasSubstr("\n3,")));
}

TEST_F(Points, WhatIsNoLineIsRefused) {
  const auto refused = [&](const std::string& line, const std::string& named) {
    expect_refusal(talus({"profile", "a.talus", "--line=" + line, "--tolerance=1"}), {usage}, {named});
  };
  refused("1,2", "--line");
  refused("1,2,3", "--line");
  refused("1,2,3,nan", "--line");
  refused("1,2,3,4,", "--line");
  refused("1,2,1,2", "two different points");
  expect_refusal(talus({"profile", "a.talus", "--line=1,2,3,4"}), {usage}, {"--tolerance"});
  expect_refusal(talus({"profile", "a.talus", "--tolerance=1"}), {usage}, {"--line"});
  expect_refusal(talus({"profile", "a.talus", "--line=1,2,3,4", "--tolerance=1", "-o", "out.ply"}), {usage},
                 {"out.ply"});
}

}  // namespace
}  // namespace talus::support
