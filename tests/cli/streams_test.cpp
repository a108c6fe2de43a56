// Answers and increments as files, through the program.

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"
#include "tests/support/mesh_file.hpp"
#include "tests/support/oracle.hpp"

namespace talus::support {
namespace {

class StreamCommands : public Command {
 protected:
  void SetUp() override {
    raster = void_blobs(raster, 2, 3);
    RasterOptions options;
    options.crs = "EPSG:32632";
    options.geotransform = {450000, 30, 0, 5200000, 0, -30};
    make_raster("a.tif", options);
    must({"ingest", "a.tif", "a.talus"});
  }
  Outcome must(const std::vector<std::string>& arguments) const {
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    EXPECT_EQ(outcome.err.find("talus:"), std::string::npos) << outcome.err;
    return outcome;
  }
};

TEST_F(StreamCommands, MergedAnswersAreTheBytesOfTheAnswerAskedInOneGo) {
  for (const char* bbox : {"--bbox=450000,5197000,453000,5200000", "--bbox=450615,5198485,451815,5199685"}) {
    must({"query", "a.talus", bbox, "--tolerance", "inf", "-o", "base.rqt"});
    must({"query", "a.talus", bbox, "--from", "inf", "--tolerance", "20", "-o", "1.rqt"});
    must({"query", "a.talus", bbox, "--from", "20", "--tolerance", "3", "-o", "2.rqt"});
    must({"query", "a.talus", bbox, "--from", "3", "--tolerance", "0", "-o", "3.rqt"});
    must({"query", "a.talus", bbox, "--tolerance", "0", "-o", "whole.rqt", "-o", "whole.ply", "-o", "whole.obj"});
    must({"merge", "base.rqt", "1.rqt", "2.rqt", "3.rqt", "-o", "merged.rqt", "-o", "merged.ply"});
    EXPECT_TRUE(bytes_of(folder / "merged.rqt") == bytes_of(folder / "whole.rqt"));
    EXPECT_TRUE(bytes_of(folder / "merged.ply") == bytes_of(folder / "whole.ply"));
    must({"convert", "merged.rqt", "-o", "converted.ply", "-o", "converted.obj", "-o", "converted.png"});
    EXPECT_TRUE(bytes_of(folder / "converted.ply") == bytes_of(folder / "whole.ply"));
    EXPECT_TRUE(bytes_of(folder / "converted.obj") == bytes_of(folder / "whole.obj"));
    must({"merge", "base.rqt", "1.rqt", "-o", "base.rqt"});  // over its own input
    must({"merge", "base.rqt", "2.rqt", "3.rqt", "-o", "base.rqt"});
    EXPECT_TRUE(bytes_of(folder / "base.rqt") == bytes_of(folder / "whole.rqt"));
  }
}

TEST_F(StreamCommands, SayWhatTheyDidInJson) {
  const auto base = json_of(must({"query", "a.talus", "--tolerance", "20", "-o", "base.rqt", "--json"}));
  const auto delta = json_of(must({"query", "a.talus", "--from", "20", "--tolerance", "3", "-o", "d.rqt", "--json"}));
  const auto whole = json_of(must({"query", "a.talus", "--tolerance", "3", "--json"}));
  const auto merged = json_of(must({"merge", "base.rqt", "d.rqt", "-o", "m.rqt", "--json"}));
  EXPECT_EQ(delta["from"], 20);
  EXPECT_EQ(delta["tolerance"], 3);
  EXPECT_GT(delta["vertices"], 0);
  EXPECT_EQ(delta["bound"], whole["bound"]);
  for (const char* name : {"region", "tolerance", "bound", "triangles"}) EXPECT_EQ(merged[name], whole[name]) << name;
  const auto converted = json_of(must({"convert", "m.rqt", "-o", "m.ply", "--json"}));
  EXPECT_EQ(converted["triangles"], whole["triangles"]);
  const Outcome text = must({"query", "a.talus", "--from", "20", "--tolerance", "3"});
  EXPECT_THAT(text.out, ::testing::HasSubstr("vertices"));
}

TEST_F(StreamCommands, RefuseWhatDoesNotFit) {
  must({"query", "a.talus", "--tolerance", "20", "-o", "base.rqt"});
  must({"query", "a.talus", "--from", "20", "--tolerance", "3", "-o", "d.rqt"});
  must({"query", "a.talus", "--from", "10", "--tolerance", "3", "-o", "ten.rqt"});
  const auto before = contents();
  expect_refusal(talus({"query", "a.talus", "--from", "3", "--tolerance", "20", "-o", "x.rqt"}), {usage}, {"3 m", "20 m"});
  expect_refusal(talus({"query", "a.talus", "--from", "20", "--tolerance", "3", "-o", "x.ply"}), {usage}, {"--from", "x.ply", ".rqt"});
  expect_refusal(talus({"query", "a.talus", "--from", "much", "--tolerance", "3"}), {usage}, {"--from", "much"});
  expect_refusal(talus({"query", "a.talus", "--from", "-3", "--tolerance", "3"}), {usage}, {"--from", "-3"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "3", "-o", "nowhere/x.rqt"}), {failed}, {"nowhere"});
  expect_refusal(talus({"merge", "base.rqt", "ten.rqt", "-o", "x.rqt"}), {usage}, {"ten.rqt", "10 m", "20 m"});
  expect_refusal(talus({"merge", "base.rqt", "d.rqt", "d.rqt", "-o", "x.rqt"}), {usage}, {"d.rqt"});
  expect_refusal(talus({"merge", "base.rqt", "base.rqt", "-o", "x.rqt"}), {usage}, {"no increment"});
  expect_refusal(talus({"merge", "d.rqt", "base.rqt", "-o", "x.rqt"}), {usage}, {"d.rqt", "increment"});
  expect_refusal(talus({"convert", "d.rqt", "-o", "x.ply"}), {usage}, {"d.rqt", "increment"});
  expect_refusal(talus({"convert", "a.tif", "-o", "x.ply"}), {damaged}, {"a.tif"});
  expect_refusal(talus({"convert", "none.rqt", "-o", "x.ply"}), {failed}, {"none.rqt"});
  expect_refusal(talus({"convert", "base.rqt", "-o", "x.txt"}), {usage}, {"x.txt", ".rqt"});
  expect_refusal(talus({"convert", "base.rqt"}), {usage}, {"--output"});
  EXPECT_TRUE(contents() == before) << "nothing was written";
  std::string bytes = bytes_of(folder / "base.rqt");
  bytes[bytes.size() / 2] ^= 1;
  write_bytes(folder / "bad.rqt", bytes);
  expect_refusal(talus({"convert", "bad.rqt", "-o", "x.ply"}), {damaged}, {"bad.rqt", "byte"});
}

}  // namespace
}  // namespace talus::support
