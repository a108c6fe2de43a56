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
    return outcome;
  }
};

TEST_F(StreamCommands, MergedAnswersAreTheBytesOfTheAnswerAskedInOneGo) {
  for (const char* bbox : {"--bbox=450000,5197000,453000,5200000", "--bbox=450615,5198485,451815,5199685"}) {
    must({"query", "a.talus", bbox, "--tolerance", "inf", "-o", "base.rqt"});
    must({"query", "a.talus", bbox, "--from", "inf", "--tolerance", "20", "-o", "1.rqt"});
    must({"query", "a.talus", bbox, "--from", "20", "--tolerance", "3", "-o", "2.rqt"});
    must({"query", "a.talus", bbox, "--from", "3", "--tolerance", "0", "-o", "3.rqt"});
    must({"query", "a.talus", bbox, "--tolerance", "0", "-o", "whole.rqt", "-o", "whole.ply", "-o", "whole.obj", "-o",
          "whole.glb", "-o", "whole.tif"});
    must({"merge", "base.rqt", "1.rqt", "2.rqt", "3.rqt", "-o", "merged.rqt", "-o", "merged.ply", "-o", "merged.tif"});
    EXPECT_TRUE(bytes_of(folder / "merged.rqt") == bytes_of(folder / "whole.rqt"));
    EXPECT_TRUE(bytes_of(folder / "merged.ply") == bytes_of(folder / "whole.ply"));
    must({"convert", "merged.rqt", "-o", "converted.ply", "-o", "converted.obj", "-o", "converted.png", "-o",
          "converted.glb"});
    EXPECT_TRUE(bytes_of(folder / "converted.glb") == bytes_of(folder / "whole.glb"));
    EXPECT_TRUE(bytes_of(folder / "merged.tif") == bytes_of(folder / "whole.tif"));
    EXPECT_TRUE(bytes_of(folder / "converted.ply") == bytes_of(folder / "whole.ply"));
    EXPECT_TRUE(bytes_of(folder / "converted.obj") == bytes_of(folder / "whole.obj"));
    must({"merge", "base.rqt", "1.rqt", "-o", "finer.rqt"});
    must({"merge", "finer.rqt", "2.rqt", "3.rqt", "-o", "finest.rqt"});
    EXPECT_TRUE(bytes_of(folder / "finest.rqt") == bytes_of(folder / "whole.rqt"));
  }
}

TEST_F(StreamCommands, AnswersOfDifferentDetailMeetWhereOneMatchesTheOther) {
  const char *west = "--bbox=450000,5197000,451455,5200000", *east = "--bbox=451455,5197000,453000,5200000";
  must({"query", "a.talus", west, "--tolerance", "1", "-o", "west.rqt"});
  const auto alone = json_of(must({"query", "a.talus", east, "--tolerance", "30", "--json"}));
  const auto matched =
      json_of(must({"query", "a.talus", east, "--tolerance", "30", "--match", "west.rqt", "-o", "east.rqt", "--json"}));
  EXPECT_GT(matched["matching_vertices"], 0);
  EXPECT_EQ(matched["unmatched_vertices"], 0);
  EXPECT_GT(matched["triangles"], alone["triangles"]);
  EXPECT_EQ(json_of(must({"convert", "east.rqt", "-o", "east.ply", "--json"}))["triangles"], matched["triangles"]);
  // The other way round the neighbour lacks something, and the program says so.
  must({"query", "a.talus", east, "--tolerance", "30", "-o", "coarse.rqt"});
  const Outcome finer = must({"query", "a.talus", west, "--tolerance", "1", "--match", "coarse.rqt"});
  EXPECT_NE(finer.err.find("the mesh has cracks"), std::string::npos) << finer.err;

  EXPECT_EQ(talus({"query", "a.talus", west, "--tolerance", "1", "--match", "west.rqt"}).exit_code, usage);
  EXPECT_EQ(talus({"query", "a.talus", east, "--max-vertices", "5000", "--match", "west.rqt"}).exit_code, usage);
  EXPECT_EQ(talus({"query", "a.talus", east, "--tolerance", "1", "--border", "cover", "--match", "west.rqt"}).exit_code,
            usage);
  EXPECT_EQ(talus({"query", "a.talus", east, "--from", "5", "--tolerance", "1", "--match", "west.rqt"}).exit_code,
            usage);
  must({"query", "a.talus", west, "--from", "1", "--tolerance", "0.5", "-o", "delta.rqt"});
  EXPECT_EQ(talus({"query", "a.talus", east, "--tolerance", "1", "--match", "delta.rqt"}).exit_code, usage);
  must({"ingest", "--overwrite", "a.tif", "b.talus", "--height-step", "5"});
  const Outcome other = talus({"query", "b.talus", east, "--tolerance", "30", "--match", "west.rqt"});
  EXPECT_EQ(other.exit_code, usage);
  EXPECT_NE(other.err.find("another database"), std::string::npos) << other.err;
}

TEST_F(StreamCommands, HoldTheAnswerWhateverTheirBands) {
  must({"query", "a.talus", "--tolerance", "3", "-o", "whole.ply"});
  must({"query", "a.talus", "--tolerance", "3", "-o", "p.rqt"});
  must({"convert", "p.rqt", "-o", "p.ply"});
  EXPECT_TRUE(bytes_of(folder / "p.ply") == bytes_of(folder / "whole.ply"));
  const auto info = json_of(must({"info", "p.rqt", "--json"}));
  EXPECT_EQ(info["bytes"], bytes_of(folder / "p.rqt").size());
  std::uint64_t vertices = 0, bytes = info["header_bytes"];
  for (const auto& part : info["parts"])
    vertices += part["vertices"].get<std::uint64_t>(), bytes += part["bytes"].get<std::uint64_t>();
  EXPECT_EQ(vertices, info["vertices"]);
  EXPECT_EQ(bytes, info["bytes"]);
  must({"convert", "p.rqt", "--bands", "3", "--threads", "2", "-o", "q.rqt"});
  must({"convert", "q.rqt", "-o", "q.ply"});
  EXPECT_TRUE(bytes_of(folder / "q.ply") == bytes_of(folder / "whole.ply"));
  expect_refusal(talus({"info", "none.rqt"}), {failed}, {"none.rqt"});
}

TEST_F(StreamCommands, RoundHeightsWithinTheTolerance) {
  const auto exact = json_of(must({"query", "a.talus", "--tolerance", "6", "-o", "exact.rqt", "--json"}));
  const auto bounded =
      json_of(must({"query", "a.talus", "--tolerance", "6", "--heights", "bounded", "-o", "bounded.rqt", "--json"}));
  EXPECT_EQ(exact["quantum"], 0);
  EXPECT_GT(bounded["quantum"], 0);
  EXPECT_LE(bounded["bound"].get<double>(), 6.00000001);
  EXPECT_LT(bytes_of(folder / "bounded.rqt").size(), bytes_of(folder / "exact.rqt").size());
  const auto dense =
      json_of(must({"query", "a.talus", "--tolerance", "6", "--heights", "dense", "-o", "dense.rqt", "--json"}));
  EXPECT_GT(dense["quantum"].get<double>(), 6);
  EXPECT_LE(dense["bound"].get<double>(), 6.00000001);
  EXPECT_GT(dense["vertices"].get<int>(), bounded["vertices"].get<int>());
  must({"query", "a.talus", "--tolerance", "20", "--heights", "bounded", "--quantum", "2", "-o", "base.rqt"});
  must({"query", "a.talus", "--from", "20", "--tolerance", "6", "--heights", "bounded", "--quantum", "2", "-o",
        "more.rqt"});
  must({"query", "a.talus", "--tolerance", "6", "--heights", "bounded", "--quantum", "2", "-o", "whole.rqt"});
  must({"merge", "base.rqt", "more.rqt", "-o", "merged.rqt"});
  EXPECT_TRUE(bytes_of(folder / "merged.rqt") == bytes_of(folder / "whole.rqt"));

  must({"query", "a.talus", "--from", "20", "--tolerance", "6", "-o", "plain.rqt"});
  expect_refusal(talus({"merge", "base.rqt", "plain.rqt", "-o", "x.rqt"}), {usage}, {"plain.rqt", "--quantum"});
  expect_refusal(talus({"merge", "bounded.rqt", "more.rqt", "-o", "x.rqt"}), {usage}, {"bounded.rqt"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "6", "--heights", "rough"}), {usage},
                 {"--heights", "rough"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "6", "--quantum", "2"}), {usage},
                 {"--quantum", "bounded and fitted"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "6", "--heights", "bounded", "--quantum", "0"}), {usage},
                 {"--quantum", "0"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "1", "--heights", "bounded", "--quantum", "40"}), {usage},
                 {"40 m", "1 m"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "0", "--heights", "bounded"}), {usage}, {"0 m"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "6", "--heights", "bounded", "--border", "cover"}), {usage},
                 {"--border"});
  expect_refusal(talus({"query", "a.talus", "--from", "20", "--tolerance", "6", "--heights", "dense"}), {usage},
                 {"dense"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "6", "--heights", "dense", "--quantum", "2"}), {usage},
                 {"--quantum"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "6", "--heights", "rough"}), {usage}, {"rough", "dense"});
  expect_refusal(talus({"query", "a.talus", "--from", "20", "--tolerance", "6", "--heights", "bounded"}), {usage},
                 {"--quantum"});
}

TEST_F(StreamCommands, AreReadFromAPipeAsTheyArrive) {
  must({"query", "a.talus", "--tolerance", "3", "-o", "a.rqt", "-o", "a.ply"});
  const std::string bytes = bytes_of(folder / "a.rqt");
  const auto piped = [&](const std::string& output, const std::string& input) {
    write_bytes(folder / "pipe", input);
    RunOptions options;
    options.input = (folder / "pipe").string();
    return talus({"convert", "-", "-o", output}, options);
  };
  const Outcome outcome = piped("piped.ply", bytes);
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_TRUE(bytes_of(folder / "piped.ply") == bytes_of(folder / "a.ply"));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("bound "));
  const Outcome cut = piped("x.ply", bytes.substr(0, bytes.size() - 1));
  EXPECT_EQ(cut.exit_code, damaged);
  EXPECT_THAT(cut.err, ::testing::HasSubstr("the stream is cut"));
  EXPECT_FALSE(std::filesystem::exists(folder / "x.ply"));
  expect_refusal(piped("x.ply", ""), {damaged}, {"cut"});
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
  expect_refusal(talus({"query", "a.talus", "--from", "3", "--tolerance", "20", "-o", "x.rqt"}), {usage},
                 {"3 m", "20 m"});
  expect_refusal(talus({"query", "a.talus", "--from", "20", "--tolerance", "3", "-o", "x.ply"}), {usage},
                 {"--from", "x.ply", ".rqt"});
  expect_refusal(talus({"query", "a.talus", "--from", "much", "--tolerance", "3"}), {usage}, {"--from", "much"});
  expect_refusal(talus({"query", "a.talus", "--from", "-3", "--tolerance", "3"}), {usage}, {"--from", "-3"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "3", "-o", "nowhere/x.rqt"}), {failed}, {"nowhere"});
  expect_refusal(talus({"merge", "base.rqt", "ten.rqt", "-o", "x.rqt"}), {usage}, {"ten.rqt", "10 m", "20 m"});
  expect_refusal(talus({"merge", "base.rqt", "d.rqt", "d.rqt", "-o", "x.rqt"}), {usage}, {"d.rqt"});
  expect_refusal(talus({"merge", "base.rqt", "base.rqt", "-o", "x.rqt"}), {usage}, {"is an answer"});
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
