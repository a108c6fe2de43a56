// `talus query --explain`: its numbers are the question's, in text and as JSON.

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

class Explain : public Command {
 protected:
  void SetUp() override {
    raster = hole(fit(fractal(700, 500, 4, 600), SampleType::int16), 400, 200, 690, 490);
    make_database("a.talus");
  }
  [[nodiscard]] nlohmann::json asked(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"query", "a.talus", "--explain", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    return json_of(outcome);
  }
};

/// The bands are those of the cost, coarse ones first, and add up.
void expect_bands(const nlohmann::json& json, const QueryCost& cost) {
  const auto& bands = json["explain"]["bands"];
  ASSERT_EQ(bands.size(), cost.bands.size());
  std::uint64_t read = 1;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const BandCost& band = cost.bands[bands.size() - 1 - i];
    EXPECT_EQ(bands[i]["spacing"], band.spacing);
    EXPECT_EQ(bands[i]["wanted"], band.wanted);
    EXPECT_EQ(bands[i]["needed"], band.needed);
    EXPECT_EQ(bands[i]["below_tolerance"], band.below_tolerance);
    EXPECT_EQ(bands[i]["only_voids"], band.only_voids);
    EXPECT_EQ(bands[i]["outside"], band.outside);
    EXPECT_EQ(bands[i]["pages_read"], band.pages_read);
    read += bands[i]["pages_read"].get<std::uint64_t>();
    std::uint64_t in_region = 0;
    for (const char* part : {"wanted", "needed", "from_slice", "below_tolerance", "too_fine", "only_voids", "unasked"})
      in_region += bands[i][part].get<std::uint64_t>();
    EXPECT_EQ(bands[i]["in_region"], in_region);
  }
  EXPECT_EQ(json["pages_read"], read);
}

TEST_F(Explain, SaysWhatWasReadAndLeftOutAndHowLongItTook) {
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const auto json = asked({"--tolerance=40", "--bbox=50,-300,450,-20", "-o", "out.ply"});
  expect_bands(json, now.ask({.region = now.region({50, -300, 450, -20}).samples, .tolerance = Metres{40}}).cost);
  for (const char* stage : {"read and decode", "choose", "gather", "triangulate", "write"}) {
    ASSERT_TRUE(json["explain"]["seconds"].contains(stage)) << stage;
    EXPECT_GE(json["explain"]["seconds"][stage], 0);
  }
  EXPECT_FALSE(json_of(talus({"query", "a.talus", "--tolerance=40", "--json"})).contains("explain"));
}

TEST_F(Explain, IsATableForPeople) {
  const Outcome outcome = talus({"query", "a.talus", "--tolerance=40", "--bbox=50,-300,450,-20", "--explain"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  for (const char* part :
       {"pages of spacing", "64 and more", "8 to 32", "1 to 4", "in the region", "read and decode", "gather"})
    EXPECT_THAT(outcome.out, ::testing::HasSubstr(part));
  EXPECT_THAT(outcome.out, ::testing::Not(::testing::HasSubstr("level asked for")))
      << "rows that say nothing are left out";
  const Outcome plain = talus({"query", "a.talus", "--tolerance=40"});
  EXPECT_THAT(plain.out, ::testing::Not(::testing::HasSubstr("pages of spacing")));
}

TEST_F(Explain, WorksForEveryKindOfQuestion) {
  const Snapshot now = Database::open(folder / "a.talus").snapshot();
  const GridRect all = now.description().extent;
  expect_bands(asked({"--from=40", "--tolerance=9"}),
               increment_of(now.ask({.region = all, .tolerance = Metres{9}, .from = Metres{40}})).cost);
  const auto budget = asked({"--max-triangles=30000"});
  EXPECT_GT(budget["explain"]["search"]["pages_read"], 0);
  EXPECT_TRUE(budget["explain"]["seconds"].contains("find the tolerance"));
  const auto levels = asked({"--tolerance=0", "--max-level=4"});
  EXPECT_GT(levels["explain"]["bands"].back()["too_fine"], 0);
  const auto clip = asked({"--tolerance=3", "--bbox=50,-300,450,-20", "--border=clip"});
  EXPECT_TRUE(clip["explain"]["seconds"].contains("cut"));
  const auto points = asked({"--tolerance=inf", "--point=20.5,-20.5"});
  EXPECT_GT(points["explain"]["bands"].back()["needed"], 0);
}

}  // namespace
}  // namespace talus::support
