// Notes and refusals that keep a user from a surprise.

#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Notes : public Command {};

TEST_F(Notes, ABudgetThatTheBorderUsesUpNamesSnap) {
  raster = fit(fractal(1000, 900, 8, 2000), SampleType::int16);
  make_database("a.talus");
  const std::vector<std::string> odd{"query", "a.talus", "--max-triangles", "12000", "--bbox=3,-893,991,-5"};
  const Outcome beside = talus(odd);
  ASSERT_EQ(beside.exit_code, done) << beside.err;
  EXPECT_THAT(beside.err, HasSubstr("--snap 16"));
  std::vector<std::string> snapped = odd;
  snapped.insert(snapped.end(), {"--snap", "16"});
  EXPECT_THAT(talus(snapped).err, Not(HasSubstr("--snap 16")));
  EXPECT_THAT(talus({"query", "a.talus", "--tolerance", "20", "--bbox=3,-893,991,-5"}).err, Not(HasSubstr("--snap")));
}

TEST_F(Notes, AProfileThatLeavesTheRasterSaysSo) {
  make_database("a.talus");
  const std::vector<std::string> across{"profile", "a.talus", "--tolerance", "2", "--line=-50,-10,40,-10"};
  EXPECT_THAT(talus(across).err, HasSubstr("leaves the raster"));
  EXPECT_THAT(talus({"profile", "a.talus", "--tolerance", "2", "--line=5,-10,40,-10"}).err, Not(HasSubstr("leaves")));
}

TEST_F(Notes, ADatabaseIsNotNamedLikeARaster) {
  make_raster("a.tif");
  const auto before = contents();
  expect_refusal(talus({"ingest", "a.tif", "b.tif"}), {usage}, {"b.tif", "land.talus"});
  EXPECT_EQ(contents(), before);
}

TEST_F(Notes, ProgressForProgramsSaysTheFirstSamplesOfAShortIngest) {
  make_raster("a.tif");
  const Outcome outcome = talus({"ingest", "a.tif", "a.talus", "--progress", "json"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::ContainsRegex("\"fraction\":0[.][0-9]+,\"stage\":\"[^\"]*\",\"samples\":[1-9]"));
}

TEST_F(Notes, ABoundIsReadableForPeopleAndCompleteForPrograms) {
  RasterOptions options;
  options.type = SampleType::int16;
  options.scale = 0.1;
  make_raster("a.tif", options);
  ASSERT_EQ(talus({"ingest", "a.tif", "a.talus"}).exit_code, done);
  EXPECT_THAT(talus({"query", "a.talus", "--tolerance", "5"}).out, Not(HasSubstr("00000")));
  EXPECT_GT(json_of(talus({"query", "a.talus", "--tolerance", "0", "--json"})).at("bound").get<double>(), 0);
}

}  // namespace
}  // namespace talus::support
