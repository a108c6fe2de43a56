// --error, --metric and --no-guarantee: what is chosen is stored, and every answer says what its bound is worth.

#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;

class ErrorKindCommands : public Command {
 protected:
  void ingested(const std::string& name, std::vector<std::string> options) {
    if (!std::filesystem::exists(folder / "a.tif")) make_raster("a.tif");
    options.insert(options.begin(), {"ingest", "a.tif", name});
    const Outcome outcome = talus(options);
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  }
};

TEST_F(ErrorKindCommands, WithoutAWordErrorsAreExactAndVertical) {
  ingested("a.talus", {});
  const auto json = json_of(talus({"info", "a.talus", "--json"}));
  EXPECT_EQ(json["error_kind"], "exact");
  EXPECT_EQ(json["error_metric"], "vertical");
  EXPECT_THAT(talus({"info", "a.talus"}).out, HasSubstr("exact, vertical"));
}

TEST_F(ErrorKindCommands, MidpointNeedsConsentAndEveryAnswerSaysSo) {
  make_raster("a.tif");
  expect_refusal(talus({"ingest", "a.tif", "a.talus", "--error", "midpoint"}), {failed, usage}, {"--no-guarantee"});
  EXPECT_FALSE(std::filesystem::exists(folder / "a.talus"));
  ingested("a.talus", {"--error", "midpoint", "--no-guarantee"});
  EXPECT_THAT(talus({"info", "a.talus"}).out, HasSubstr("answers keep no bound"));
  EXPECT_THAT(talus({"info", "a.talus"}).out, HasSubstr("--error midpoint"));  // made by

  const Outcome text = talus({"query", "a.talus", "--tolerance", "30", "-o", "a.rqt"});
  EXPECT_THAT(text.out, HasSubstr("bound      none"));
  const auto json = json_of(talus({"query", "a.talus", "--tolerance", "30", "--json"}));
  EXPECT_TRUE(json["bound"].is_null());
  EXPECT_EQ(json["error_kind"], "midpoint");
  for (std::vector<std::string> words :
       {std::vector<std::string>{"info", "a.rqt"}, {"convert", "a.rqt", "-o", "a.ply"}}) {
    SCOPED_TRACE(words.front());
    EXPECT_THAT(talus(words).out, HasSubstr("bound      none"));
    words.push_back("--json");
    const auto said = json_of(talus(words));
    EXPECT_TRUE(said["bound"].is_null());
    EXPECT_EQ(said["error_kind"], "midpoint");
  }
  const auto profile =
      json_of(talus({"profile", "a.talus", "--line=450100,5199900,452000,5198200", "--tolerance", "30", "--json"}));
  EXPECT_TRUE(profile["bound"].is_null());

  const Outcome checked = talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", "30"});
  EXPECT_EQ(checked.exit_code, done) << "what was never promised is no damage";
  EXPECT_THAT(checked.out, HasSubstr("beyond the tolerance"));
  EXPECT_THAT(checked.out, HasSubstr("times the tolerance"));
  EXPECT_THAT(checked.out, HasSubstr("sound; the database keeps no bound"));
  const auto verified = json_of(talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", "30", "--json"}));
  EXPECT_EQ(verified["keeps_bound"], false);
  EXPECT_GT(verified["true_error"], 30);
}

TEST_F(ErrorKindCommands, PerpendicularBoundsAreCheckedAtRightAngles) {
  ingested("a.talus", {"--metric", "perpendicular"});
  EXPECT_THAT(talus({"query", "a.talus", "--tolerance", "30"}).out, HasSubstr("right angles"));
  const Outcome checked = talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", "20", "--json"});
  EXPECT_EQ(checked.exit_code, done);
  const auto json = json_of(checked);
  EXPECT_LE(json["perpendicular_error"], 20.0001);
  EXPECT_GT(json["true_error"], 20) << "on slopes the vertical distance is more";
}

TEST_F(ErrorKindCommands, NestedAnswersHaveMoreVerticesAndKeepTheirBound) {
  ingested("exact.talus", {});
  ingested("nested.talus", {"--error", "nested"});
  const auto vertices = [&](const char* name) {
    return json_of(talus({"query", name, "--tolerance", "30", "--json"}))["vertices"].get<int>();
  };
  EXPECT_GT(vertices("nested.talus"), vertices("exact.talus"));
  EXPECT_EQ(talus({"verify", "nested.talus", "--against", "a.tif", "--tolerance", "30"}).exit_code, done);
}

TEST_F(ErrorKindCommands, WhatDoesNotGoTogetherIsRefused) {
  make_raster("a.tif");
  const auto before = contents();
  const auto refused = [&](std::vector<std::string> words, const char* named) {
    words.insert(words.begin(), {"ingest", "a.tif", "a.talus"});
    expect_refusal(talus(words), {failed, usage}, {named});
  };
  refused({"--error", "average"}, "average");
  refused({"--metric", "diagonal"}, "diagonal");
  refused({"--error", "nested", "--metric", "perpendicular"}, "perpendicular");
  refused({"--no-guarantee"}, "--no-guarantee");
  refused({"--error", "midpoint", "--no-guarantee", "--tolerance", "5"}, "vertical");
  EXPECT_EQ(contents(), before);
  ingested("a.talus", {"--error", "midpoint", "--no-guarantee"});
  expect_refusal(talus({"ingest", "--update", "a.tif", "a.talus", "--error", "nested"}), {failed, usage}, {"--update"});
  for (const char* heights : {"bounded", "dense"})
    expect_refusal(talus({"query", "a.talus", "--tolerance", "5", "--heights", heights}), {failed, usage},
                   {"midpoint"});
  EXPECT_EQ(talus({"ingest", "--update", "a.tif", "a.talus"}).exit_code, done);
  EXPECT_EQ(json_of(talus({"info", "a.talus", "--json"}))["error_kind"], "midpoint");
}

}  // namespace
}  // namespace talus::support
