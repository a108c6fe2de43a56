// The program as it is meant to be used, and its output held against the source it was made of.

#include <chrono>
#include <filesystem>
#include <string>

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"
#include "tests/support/mesh_file.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/real_models.hpp"

namespace talus::support {
namespace {

class Commands : public Command {
 protected:
  void SetUp() override {
    RasterOptions options;
    options.crs = "EPSG:32632";
    options.geotransform = {450000, 30, 0, 5200000, 0, -30};
    make_raster("a.tif", options);
    const Outcome outcome = talus({"ingest", "a.tif", "a.talus"});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  }
  const GridMapping mapping{450015, 5199985, 30, -30};
};

TEST_F(Commands, IngestLeavesADatabaseAndNothingElse) {
  std::vector<std::string> names;
  for (const auto& [name, bytes] : contents()) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"a.talus", "a.tif"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.talus.part-lock"));
}

TEST_F(Commands, IngestOverwritesWhenAsked) {
  const Outcome outcome = talus({"ingest", "a.tif", "a.talus", "--overwrite"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "a.tif"}).exit_code, done);
}

TEST_F(Commands, IngestTwiceGivesTheSameBytes) {
  ASSERT_EQ(talus({"ingest", "a.tif", "b.talus"}).exit_code, done);
  EXPECT_TRUE(bytes_of(folder / "a.talus") == bytes_of(folder / "b.talus"));
}

TEST_F(Commands, ADatabaseTellsNothingOfTheMachineThatMadeIt) {
  EXPECT_EQ(bytes_of(folder / "a.talus").find(folder.path().string()), std::string::npos);
  std::filesystem::last_write_time(folder / "a.tif",
                                   std::filesystem::last_write_time(folder / "a.tif") - std::chrono::hours(30));
  ASSERT_EQ(talus({"ingest", "a.tif", "b.talus"}).exit_code, done);
  EXPECT_TRUE(bytes_of(folder / "a.talus") == bytes_of(folder / "b.talus"));
}

TEST_F(Commands, InfoSaysWhatIsInside) {
  const Outcome text = talus({"info", "a.talus"});
  EXPECT_EQ(text.exit_code, done) << text.err;
  EXPECT_THAT(text.out, ::testing::HasSubstr("90"));
  EXPECT_THAT(text.out, ::testing::HasSubstr("70"));
  const Outcome json = talus({"info", "a.talus", "--json"});
  EXPECT_EQ(json.exit_code, done);
  EXPECT_EQ(json.err, "");
  EXPECT_FALSE(json_of(json).empty());
}

TEST_F(Commands, QueryAnswersWithAMeshThatKeepsThePromise) {
  for (const std::string output : {"out.ply", "out.obj"}) {
    for (const char* tolerance : {"0", "0.5", "3", "40", "inf"}) {
      const Outcome outcome = talus({"query", "a.talus", "--tolerance", tolerance, "-o", output, "--json"});
      ASSERT_EQ(outcome.exit_code, done) << outcome.err;
      EXPECT_EQ(outcome.err, "");
      const Mesh mesh = read_mesh(folder / output, mapping);
      EXPECT_EQ(mesh.region, (GridRect{{0, 0}, {89, 69}}));
      const auto report = check_mesh(mesh, raster, 1, std::strtod(tolerance, nullptr));
      EXPECT_TRUE(report.sound()) << report.summary();
      const auto json = json_of(outcome);
      EXPECT_EQ(json["vertices"], mesh.points.size());
      EXPECT_EQ(json["triangles"], mesh.triangles.size());
      EXPECT_EQ(json["region"], (nlohmann::json{450015.0, 5199985.0 - 69 * 30, 450015.0 + 89 * 30, 5199985.0}));
      if (std::string(tolerance) != "inf") {
        EXPECT_EQ(json["tolerance"], std::strtod(tolerance, nullptr));
        EXPECT_LE(json["bound"], json["tolerance"]);
        EXPECT_GE(json["bound"].get<double>(), report.largest_error);
      }
      EXPECT_GT(json["pages_read"], 0);
      EXPECT_GT(json["bytes_read"], 0);
      EXPECT_GE(json["seconds"], 0);
    }
  }
}

TEST_F(Commands, QueryAnswersARectangle) {
  const Outcome outcome =
      talus({"query", "a.talus", "--tolerance=2", "--bbox=450320,5199010,451290,5199500", "-o", "part.ply", "--json"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const Mesh mesh = read_mesh(folder / "part.ply", mapping);
  EXPECT_EQ(mesh.region, (GridRect{{10, 16}, {43, 33}}));
  const auto report = check_mesh(mesh, raster, 1, 2);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_EQ(json_of(outcome)["region"], (nlohmann::json{450315.0, 5198995.0, 451305.0, 5199505.0}));
}

TEST_F(Commands, QueryTakesARectangleWithNegativeCorners) {
  make_database("plain.talus");  // no mapping: rows run to negative y
  const Outcome outcome =
      talus({"query", "plain.talus", "--tolerance=2", "--bbox=-5,-40.5,20.5,-10.5", "-o", "part.ply"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(read_mesh(folder / "part.ply", {0.5, -0.5, 1, -1}).region, (GridRect{{0, 10}, {20, 40}}));
}

TEST_F(Commands, QueryReplacesAnOlderAnswerAndLeavesNothingBeside) {
  write_bytes(folder / "out.ply", "an older answer");
  ASSERT_EQ(talus({"query", "a.talus", "--tolerance=2", "-o", "out.ply"}).exit_code, done);
  EXPECT_FALSE(read_mesh(folder / "out.ply", mapping).triangles.empty());
  std::vector<std::string> names;
  for (const auto& [name, bytes] : contents()) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"a.talus", "a.tif", "out.ply"}));
}

TEST_F(Commands, QueryOfVoidsOnlyIsAnEmptyAnswer) {
  raster = hole(raster, 20, 20, 60, 60);
  make_raster("holed.tif");
  ASSERT_EQ(talus({"ingest", "holed.tif", "holed.talus"}).exit_code, done);
  const Outcome outcome =
      talus({"query", "holed.talus", "--tolerance=2", "--bbox=25,-45,50,-30", "-o", "out.ply", "--json"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(json_of(outcome)["triangles"], 0);
  EXPECT_TRUE(read_mesh(folder / "out.ply", {0.5, -0.5, 1, -1}).triangles.empty());
}

TEST_F(Commands, AnAnswerWithoutTrianglesSaysWhy) {
  raster = crop(raster, 0, 0, 1, 50);
  make_raster("line.tif");
  const Outcome ingest = talus({"ingest", "line.tif", "line.talus"});
  EXPECT_THAT(ingest.err, ::testing::HasSubstr("talus: note: the raster is one sample wide"));
  const Outcome query = talus({"query", "line.talus", "--tolerance=-0"});
  EXPECT_EQ(query.exit_code, done) << query.err;
  EXPECT_THAT(query.err, ::testing::HasSubstr("no triangle"));
  EXPECT_THAT(query.out, ::testing::Not(::testing::HasSubstr("-0 m")));
}

TEST_F(Commands, IngestAndInfoSayTheSameSize) {
  const Outcome ingest = talus({"ingest", "a.tif", "a.talus", "--overwrite"}), info = talus({"info", "a.talus"});
  const auto size = [](const Outcome& outcome) {
    const std::size_t at = outcome.out.find_first_of("0123456789", outcome.out.find("file size"));
    return outcome.out.substr(at, outcome.out.find('\n', at) - at);
  };
  EXPECT_EQ(size(ingest), size(info));
  EXPECT_THAT(size(ingest), ::testing::HasSubstr("bits a sample"));
}

TEST_F(Commands, VerifyFindsASoundDatabaseSound) {
  for (const auto& more : std::vector<std::vector<std::string>>{{},
                                                                {"--against", "a.tif"},
                                                                {"--against", "a.tif", "--tolerance", "2"},
                                                                {"--against", "a.tif", "--tolerance", "0"}}) {
    std::vector<std::string> arguments{"verify", "a.talus"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done) << outcome.out << outcome.err;
  }
}

TEST_F(Commands, VerifyMeasuresTheErrorThatTheOracleMeasures) {
  const Outcome outcome = talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", "7", "--json"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.out << outcome.err;
  const auto json = json_of(outcome);
  const auto mesh = Database::open(folder / "a.talus").snapshot().mesh(Metres{7});
  const auto report = check_mesh(mesh, raster, 1, 7);
  EXPECT_EQ(json["true_error"], report.largest_error);
  EXPECT_EQ(json["vertices"], mesh.points.size());
  EXPECT_EQ(json["triangles"], mesh.triangles.size());
  EXPECT_TRUE(json["findings"].empty());
}

TEST_F(Commands, ADatabaseThatNobodyMayWriteIsRead) {
  std::filesystem::permissions(folder / "a.talus", std::filesystem::perms::owner_read);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const TempFolder elsewhere;
  const Outcome outcome = talus({"query", "a.talus", "--tolerance=2", "-o", (elsewhere / "out.ply").string()});
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
}

TEST_F(Commands, HelpAndVersionGoToStandardOutput) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"--help"}, {"--version"}, {"query", "--help"}}) {
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done);
    EXPECT_NE(outcome.out, "");
    EXPECT_EQ(outcome.err, "");
  }
}

}  // namespace
}  // namespace talus::support
