// The command verify, and where accuracy finds a sample beyond the bound: what is said, and the exit codes.

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"
#include "tests/support/forged_database.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Verify : public Command {
 protected:
  void SetUp() override {
    raster = fit(fractal(300, 260, 4, 600), SampleType::int16);
    RasterOptions options;
    options.geotransform = {500000, 10, 0, 5600400, 0, -10};
    make_raster("a.tif", options);
    ASSERT_EQ(talus({"ingest", "a.tif", "a.talus"}).exit_code, done);
  }
};

TEST_F(Verify, ListsDamagedRectanglesAndSaysWhatToDo) {
  Forgery forged(folder / "a.talus");
  for (const PageId id : {PageId{0, 1, 1}, PageId{0, 2, 0}}) {
    Page page = forged.page(id);
    page.heights[0] += 1;  // the page above repeats it
    forged.put(page);
  }
  forged.hide();
  forged.write(folder / "b.talus");
  const Outcome said = talus({"verify", "b.talus"});
  EXPECT_EQ(said.exit_code, damaged);
  EXPECT_THAT(said.out, HasSubstr("DAMAGED"));
  EXPECT_THAT(said.out, HasSubstr("ingest again from: a.tif"));
  EXPECT_THAT(said.out, HasSubstr("answers that read nothing from the damaged rectangles are right"));
  EXPECT_THAT(said.err, HasSubstr("b.talus is damaged"));
  const auto json = json_of(talus({"verify", "b.talus", "--json"}));
  EXPECT_EQ(json["verdict"], "damaged");
  EXPECT_EQ(json["rest_usable"], true);
  EXPECT_THAT(json["advice"].get<std::string>(), HasSubstr("a.tif"));
  bool has_first = false, has_second = false;
  for (const auto& part : json["damaged"]) {
    // Sample (col, row) is at 500005 + 10 col, 5600395 - 10 row; pages are 128 samples a side.
    has_first = has_first || part["rectangle"] == nlohmann::json{501285, 5597845, 502555, 5599115};
    has_second = has_second || part["rectangle"] == nlohmann::json{502565, 5599125, 502995, 5600395};
    EXPECT_FALSE(part["finding"].get<std::string>().empty());
  }
  EXPECT_TRUE(has_first && has_second) << json["damaged"].dump();
}

TEST_F(Verify, GoesOnAfterAPageThatCannotBeRead) {
  // A byte in each of several pages of the file, seal and checksums as they were.
  const std::string whole = bytes_of(folder / "a.talus");
  int several = 0;
  for (std::size_t at = 20000; at + 9000 < whole.size(); at += 9000) {
    std::string bytes = whole;
    for (std::size_t i = 0; i < 3; ++i) bytes[at + i * 3000] = static_cast<char>(bytes[at + i * 3000] ^ 64);
    write_bytes(folder / "bad.talus", bytes);
    const Outcome said = talus({"verify", "bad.talus", "--json"});
    EXPECT_EQ(said.exit_code, damaged) << said.err;
    if (said.out.empty()) continue;  // it could not be opened, and was told what to do
    several += json_of(said)["damaged"].size() > 1 ? 1 : 0;
  }
  EXPECT_GT(several, 0);
}

TEST_F(Verify, ASoundDatabaseThatDiffersFromItsSourceIsNotDamaged) {
  raster.at(40, 30) += 1;
  RasterOptions options;
  options.geotransform = {500000, 10, 0, 5600400, 0, -10};
  make_raster("other.tif", options);
  const Outcome said = talus({"verify", "a.talus", "--against", "other.tif"});
  EXPECT_EQ(said.exit_code, differs);
  EXPECT_THAT(said.out, HasSubstr("column 40, row 30"));
  EXPECT_THAT(said.out, HasSubstr("sound in itself"));
  EXPECT_THAT(said.err, HasSubstr("differs from its source"));
  const auto json = json_of(talus({"verify", "a.talus", "--against", "other.tif", "--json"}));
  EXPECT_EQ(json["verdict"], "differs");
  EXPECT_EQ(json["differences"], 1);
  EXPECT_TRUE(json["damaged"].empty());
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", "3"}).exit_code, done);
}

TEST_F(Verify, AccuracySaysLoudlyThatASampleLiesBeyondTheBound) {
  Forgery forged(folder / "a.talus");
  const Manifest m = forged.manifest();
  for (int band = 0; band < m.bands; ++band) {  // all errors a hundredth of what they were: nothing else is amiss
    for (const PageId id : pages_of_band(band, m.description.extent)) {
      if (!forged.has(id)) continue;
      Page page = forged.page(id);
      for (ErrorCode& error : page.errors) {
        if (error > 0 && error < kAlwaysSelected) error = error_code(error_of(error) / 100);
      }
      forged.put(page);
    }
  }
  forged.hide();
  forged.write(folder / "low.talus");
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--against", "a.tif"}}) {
    std::vector<std::string> words{"accuracy", "low.talus", "--tolerances", "1"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome said = talus(words);
    EXPECT_EQ(said.exit_code, differs) << said.out << said.err;
    EXPECT_THAT(said.err, HasSubstr("BEYOND ITS BOUND"));
    words.push_back("--json");
    EXPECT_EQ(json_of(talus(words))["points"][0]["beyond_bound"], true);
  }
  EXPECT_EQ(talus({"verify", "low.talus"}).exit_code, damaged);
  const Outcome sound = talus({"accuracy", "a.talus", "--tolerances", "1"});
  EXPECT_EQ(sound.exit_code, done);
  EXPECT_THAT(sound.err, Not(HasSubstr("BEYOND")));  // a note about wavering times may be there
}

}  // namespace
}  // namespace talus::support
