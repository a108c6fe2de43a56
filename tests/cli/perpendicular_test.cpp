// --metric: what is chosen is stored, and every answer says what its bound is worth.

#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;

class MetricCommands : public Command {
 protected:
  void ingested(std::vector<std::string> options) {
    if (!std::filesystem::exists(folder / "a.tif")) make_raster("a.tif");
    options.insert(options.begin(), {"ingest", "a.tif", "a.talus"});
    const Outcome outcome = talus(options);
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  }
};

TEST_F(MetricCommands, WithoutAWordErrorsAreVertical) {
  ingested({});
  EXPECT_EQ(json_of(talus({"info", "a.talus", "--json"}))["error_metric"], "vertical");
  EXPECT_THAT(talus({"info", "a.talus"}).out, HasSubstr("vertical"));
}

TEST_F(MetricCommands, PerpendicularBoundsAreCheckedAtRightAngles) {
  ingested({"--metric", "perpendicular"});
  EXPECT_THAT(talus({"info", "a.talus"}).out, HasSubstr("--metric perpendicular"));  // made by
  EXPECT_THAT(talus({"query", "a.talus", "--tolerance", "30"}).out, HasSubstr("right angles"));
  const Outcome checked = talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", "20", "--json"});
  EXPECT_EQ(checked.exit_code, done);
  const auto json = json_of(checked);
  EXPECT_LE(json["perpendicular_error"], 20.0001);
  EXPECT_GT(json["true_error"], 20) << "on slopes the vertical distance is more";
}

TEST_F(MetricCommands, WhatDoesNotGoTogetherIsRefused) {
  make_raster("a.tif");
  const auto before = contents();
  const auto refused = [&](std::vector<std::string> words, const char* named) {
    words.insert(words.begin(), {"ingest", "a.tif", "a.talus"});
    expect_refusal(talus(words), {failed, usage}, {named});
  };
  refused({"--metric", "diagonal"}, "diagonal");
  refused({"--metric", "perpendicular", "--tolerance", "5"}, "vertical");
  EXPECT_EQ(contents(), before);
  ingested({"--metric", "perpendicular"});
  expect_refusal(talus({"ingest", "--update", "a.tif", "a.talus", "--metric", "perpendicular"}), {failed, usage},
                 {"--update"});
  for (const char* heights : {"bounded", "dense"})
    expect_refusal(talus({"query", "a.talus", "--tolerance", "5", "--heights", heights}), {failed, usage},
                   {"perpendicular"});
  EXPECT_EQ(talus({"ingest", "--update", "a.tif", "a.talus"}).exit_code, done);
  EXPECT_EQ(json_of(talus({"info", "a.talus", "--json"}))["error_metric"], "perpendicular");
}

}  // namespace
}  // namespace talus::support
