// What the program says where, and which words it understands.

#include <array>

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Words : public Command {
 protected:
  void SetUp() override {
    options.crs = "EPSG:32632";
    options.geotransform = {450000, 30, 0, 5200000, 0, -30};
    make_raster("a.tif", options);
    ASSERT_EQ(talus({"ingest", "a.tif", "a.talus"}).exit_code, done);
  }
  Outcome must(const std::vector<std::string>& arguments) const {
    Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done) << outcome.err << ::testing::PrintToString(arguments);
    return outcome;
  }
  RasterOptions options;
};

// ---- notes ---------------------------------------------------------------------------------------------------

TEST_F(Words, NotesGoToStandardErrorALineEach) {
  options.crs = "";
  make_raster("bare.tif", options);
  const Outcome text = must({"ingest", "bare.tif", "bare.talus"});
  EXPECT_THAT(text.err, StartsWith("talus: note: "));
  EXPECT_THAT(text.out, Not(HasSubstr("note")));
  const Outcome json = must({"ingest", "bare.tif", "bare.talus", "--overwrite", "--json"});
  EXPECT_EQ(json.err, text.err);
  const auto notes = json_of(json)["notes"];
  ASSERT_FALSE(notes.empty());
  EXPECT_THAT(json.err, HasSubstr("talus: note: " + notes[0].get<std::string>() + "\n"));
  const Outcome dry = must({"ingest", "bare.tif", "other.talus", "--dry-run"});
  EXPECT_EQ(dry.err, text.err);
  EXPECT_THAT(dry.out, Not(HasSubstr("note")));
  // What the work would be refused for, the dry run is.
  expect_refusal(talus({"ingest", "a.tif", "a.talus", "--dry-run"}), {usage},
                 {"a.talus", "exists already", "--overwrite"});
}

TEST_F(Words, AQueryThatWritesNothingSaysSo) {
  const Outcome outcome = must({"query", "a.talus", "--tolerance", "5"});
  EXPECT_EQ(outcome.err, "talus: note: nothing was written; add -o FILE to keep the mesh\n");
  EXPECT_EQ(must({"query", "a.talus", "--tolerance", "5", "-o", "a.ply"}).err, "");
  EXPECT_THAT(must({"query", "a.talus", "--from", "9", "--tolerance", "5"}).err,
              HasSubstr("nothing was written; add -o FILE.rqt"));
  const auto json = json_of(must({"query", "a.talus", "--tolerance", "5", "--json"}));
  EXPECT_THAT(json["notes"].dump(), HasSubstr("nothing was written"));
}

TEST_F(Words, AnAccuracyReportsCaveatsAreNotes) {
  must({"ingest", "a.tif", "few.talus", "--tolerance", "5"});
  const Outcome outcome = must({"accuracy", "few.talus", "--tolerances", "10"});
  EXPECT_THAT(outcome.err, HasSubstr("talus: note: the database keeps only the vertices"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("the database keeps only the vertices")));
}

TEST_F(Words, AnInterruptedIngestSaysSoOnALineOfItsOwn) {
  raster = plane(8000, 8000);  // so that it takes more than a second
  make_raster("large.tif");
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (::chdir(folder.path().c_str()) == 0)
      ::execl(TALUS_PROGRAM, "talus", "ingest", "large.tif", "large.talus", "--threads", "1", nullptr);
    ::_exit(127);
  }
  std::string shown;
  bool is_told = false;
  for (pollfd waiting{terminal, POLLIN, 0}; ::poll(&waiting, 1, 60'000) == 1;) {
    std::array<char, 4096> room;
    const ssize_t got = ::read(terminal, room.data(), room.size());
    if (got <= 0) break;
    shown.append(room.data(), static_cast<std::size_t>(got));
    if (!is_told && shown.find("\x1b[K") != std::string::npos) is_told = ::kill(child, SIGINT) == 0;
  }
  ::close(terminal);
  ::kill(child, SIGKILL);  // of one that hangs; another is gone already
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(is_told) << "no progress was shown: " << shown;
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_THAT(shown, HasSubstr("\x1b[K\r\ntalus: interrupted"));
}

// ---- failures as JSON ----------------------------------------------------------------------------------------

TEST_F(Words, FailuresInJsonNameCauseFileAndExitCode) {
  must({"query", "a.talus", "--tolerance", "20", "-o", "base.rqt"});
  write_bytes(folder / "text", "no raster, no database, no points\n");
  write_bytes(folder / "cut.rqt", bytes_of(folder / "base.rqt").substr(0, 400));
  write_bytes(folder / "cut.talus", bytes_of(folder / "a.talus").substr(0, 9000));
  struct Case {
    std::vector<std::string> arguments;
    std::string cause;
    int exit_code;
    std::optional<std::string> file;
  };
  const std::vector<Case> cases{
      {{"info", "none.talus"}, "not_found", failed, "none.talus"},
      {{"info", "text"}, "corrupt", damaged, "text"},
      {{"info", "cut.rqt"}, "corrupt", damaged, "cut.rqt"},
      {{"info", "none.rqt"}, "not_found", failed, "none.rqt"},
      {{"query", "cut.talus", "--tolerance", "1"}, "corrupt", damaged, "cut.talus"},
      {{"verify", "none.talus"}, "not_found", failed, "none.talus"},
      {{"height", "none.talus", "1", "2"}, "not_found", failed, "none.talus"},
      {{"profile", "none.talus", "--line=1,2,3,4", "--tolerance=1"}, "not_found", failed, "none.talus"},
      {{"accuracy", "none.talus"}, "not_found", failed, "none.talus"},
      {{"query", "a.talus", "--tolerance", "1", "-o", "nowhere/a.ply"}, "io", failed, "nowhere/a.ply"},
      {{"query", "a.talus", "--tolerance", "1", "-o", "a.xyz"}, "invalid_argument", usage, "a.xyz"},
      {{"query", "a.talus", "--tolerance", "1", "--points", "text"}, "invalid_argument", usage, "text"},
      {{"query", "a.talus", "--tolerance", "1", "--lines", "none.txt"}, "not_found", failed, "none.txt"},
      {{"query", "a.talus", "--tolerance", "1", "--match", "cut.rqt"}, "corrupt", damaged, "cut.rqt"},
      {{"query", "a.talus", "--tolerance-raster", "text"}, "unsupported", failed, "text"},
      {{"merge", "base.rqt", "cut.rqt", "-o", "a.rqt"}, "corrupt", damaged, "cut.rqt"},
      {{"convert", "none.rqt", "-o", "a.ply"}, "not_found", failed, "none.rqt"},
      {{"ingest", "@none.txt", "b.talus"}, "not_found", failed, "none.txt"},
      {{"query", "a.talus", "--tolerance", "west"}, "invalid_argument", usage, std::nullopt},
      {{"query", "a.talus", "--tolerance", "1", "--snap", "west"}, "invalid_argument", usage, std::nullopt},
      {{"query", "--tolerance", "1"}, "invalid_argument", usage, std::nullopt},
      {{"query", "a.talus", "--tolerance", "1", "--nonsense"}, "invalid_argument", usage, std::nullopt},
      {{"nonsense"}, "invalid_argument", usage, std::nullopt},
  };
  for (const Case& c : cases) {
    auto arguments = c.arguments;
    const Outcome plain = talus(arguments);
    arguments.push_back("--json");
    const Outcome outcome = talus(arguments);
    SCOPED_TRACE(::testing::PrintToString(arguments) + " " + outcome.err);
    EXPECT_EQ(plain.out, "");
    EXPECT_EQ(plain.exit_code, c.exit_code);
    EXPECT_EQ(outcome.exit_code, c.exit_code);
    EXPECT_EQ(outcome.err, plain.err);
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1);
    const auto json = json_of(outcome);
    ASSERT_TRUE(json.contains("failure"));
    const auto& failure = json["failure"];
    EXPECT_EQ(failure["cause"], c.cause);
    EXPECT_EQ(failure["exit_code"], c.exit_code);
    EXPECT_EQ(failure["file"], c.file ? nlohmann::json(*c.file) : nlohmann::json());
    EXPECT_THAT(outcome.err, StartsWith("talus: " + failure["message"].get<std::string>()));
  }
}

TEST_F(Words, AFailureAmidLinesOfJsonIsALineOfItsOwn) {
  write_bytes(folder / "points.txt", "450015 5199985\nnorth\n");
  RunOptions input;
  input.input = (folder / "points.txt").string();
  const Outcome outcome = talus({"height", "a.talus", "-", "--json"}, input);
  EXPECT_EQ(outcome.exit_code, usage);
  const std::size_t end = outcome.out.find('\n');
  EXPECT_TRUE(nlohmann::json::parse(outcome.out.substr(0, end))["height"].is_number());
  EXPECT_EQ(nlohmann::json::parse(outcome.out.substr(end))["failure"]["exit_code"], usage);
}

// ---- merge ----------------------------------------------------------------------------------------------------

TEST_F(Words, MergeBlamesTheFileAtFault) {
  must({"query", "a.talus", "--tolerance", "40", "-o", "base.rqt"});
  must({"query", "a.talus", "--from", "40", "--tolerance", "20", "-o", "1.rqt"});
  must({"query", "a.talus", "--from", "20", "--tolerance", "5", "-o", "2.rqt"});
  must({"query", "a.talus", "--tolerance", "40", "--border", "cover", "--bbox=450300,5198500,451000,5199500", "-o",
        "cover.rqt"});
  must({"query", "a.talus", "--from", "40", "--tolerance", "20", "--bbox=450300,5198500,451000,5199500", "-o",
        "part.rqt"});
  raster.at(3, 3) += 1;
  make_raster("b.tif", options);
  must({"ingest", "b.tif", "b.talus"});
  must({"query", "b.talus", "--from", "20", "--tolerance", "5", "-o", "other.rqt"});
  const std::string bytes = bytes_of(folder / "2.rqt");
  write_bytes(folder / "cut.rqt", bytes.substr(0, bytes.size() - 30));
  std::string flipped = bytes;
  flipped[flipped.size() - 20] = static_cast<char>(flipped[flipped.size() - 20] ^ 4);
  write_bytes(folder / "flipped.rqt", flipped);
  write_bytes(folder / "text.rqt", "not a stream at all");
  struct Case {
    std::vector<std::string> inputs;
    std::string at_fault;
  };
  for (const Case& c : std::vector<Case>{{{"1.rqt", "2.rqt"}, "1.rqt"},
                                         {{"base.rqt", "2.rqt"}, "2.rqt"},
                                         {{"base.rqt", "2.rqt", "1.rqt"}, "2.rqt"},
                                         {{"base.rqt", "1.rqt", "1.rqt"}, "1.rqt"},
                                         {{"base.rqt", "1.rqt", "base.rqt"}, "base.rqt"},
                                         {{"base.rqt", "1.rqt", "other.rqt"}, "other.rqt"},
                                         {{"base.rqt", "1.rqt", "cut.rqt"}, "cut.rqt"},
                                         {{"base.rqt", "1.rqt", "flipped.rqt"}, "flipped.rqt"},
                                         {{"base.rqt", "1.rqt", "text.rqt"}, "text.rqt"},
                                         {{"base.rqt", "1.rqt", "none.rqt"}, "none.rqt"},
                                         {{"base.rqt", "1.rqt", "a.talus"}, "a.talus"},
                                         {{"base.rqt", "1.rqt", "a.tif"}, "a.tif"},
                                         {{"base.rqt", "part.rqt"}, "part.rqt"},
                                         {{"cover.rqt", "1.rqt", "2.rqt"}, "cover.rqt"},
                                         {{"text.rqt", "1.rqt"}, "text.rqt"},
                                         {{"a.talus", "1.rqt"}, "a.talus"}}) {
    std::vector<std::string> arguments{"merge"};
    arguments.insert(arguments.end(), c.inputs.begin(), c.inputs.end());
    arguments.insert(arguments.end(), {"-o", "out.rqt", "--json"});
    const Outcome outcome = talus(arguments);
    SCOPED_TRACE(::testing::PrintToString(c.inputs) + " " + outcome.err);
    EXPECT_NE(outcome.exit_code, done);
    const auto failure = json_of(outcome)["failure"];
    EXPECT_EQ(failure["file"], c.at_fault);
    EXPECT_THAT(failure["message"].get<std::string>(), HasSubstr(c.at_fault));
    EXPECT_FALSE(std::filesystem::exists(folder / "out.rqt"));
  }
  EXPECT_THAT(talus({"merge", "base.rqt", "1.rqt", "1.rqt", "-o", "out.rqt"}).err,
              HasSubstr("base.rqt merged with 1.rqt"));
}

// ---- a file of another kind -----------------------------------------------------------------------------------

TEST_F(Words, ARasterWhereADatabaseIsExpectedIsNamed) {
  const std::string remedy = "a.tif is a GeoTIFF, not a database; make one from it first: talus ingest a.tif a.talus\n";
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"info", "a.tif"},
                                             {"query", "a.tif", "--tolerance", "1"},
                                             {"height", "a.tif", "1", "2"},
                                             {"profile", "a.tif", "--line=1,2,3,4", "--tolerance=1"},
                                             {"accuracy", "a.tif"},
                                             {"verify", "a.tif"},
                                             {"ingest", "a.tif", "b.talus", "--grid-of", "a.tif"},
                                             {"ingest", "--update", "a.talus", "a.tif"}}) {
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, damaged) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(remedy));
  }
}

TEST_F(Words, OtherFilesWhereADatabaseIsExpectedAreNamed) {
  for (const auto& [name, bytes, said] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {"x.png", "\x89PNG\r\n\x1a\n", "a PNG, not a database; make one from it first: talus ingest x.png x.talus"},
           {"big.tif", std::string("MM\0+\0\x08\0\0", 8), "a GeoTIFF"},
           {"x.nc", "\x89HDF\r\n\x1a\n", "netCDF"},
           {"x.asc", "ncols 5\nnrows 4\n", "an ASCII grid"},
           {"x.vrt", "<VRTDataset rasterXSize=\"3\"", "a virtual raster"},
           {"with blank.img", "EHFA_HEADER_TAG", "talus ingest 'with blank.img' 'with blank.talus'"},
           {"x.dt2", "UHL10", "a DTED file"},
           {"x.hgt", "\1\2\3\4", "an SRTM tile"},
           {"x.zip", "PK\3\4xx", "a .zip archive, not a database; name a database"}}) {
    write_bytes(folder / name, bytes);
    const Outcome outcome = talus({"query", name, "--tolerance", "1"});
    EXPECT_EQ(outcome.exit_code, damaged) << name;
    EXPECT_THAT(outcome.err, HasSubstr(said)) << name;
  }
}

TEST_F(Words, AStreamAndADatabaseAreNotTakenForEachOther) {
  must({"query", "a.talus", "--tolerance", "20", "-o", "a.rqt"});
  std::filesystem::copy(folder / "a.rqt", folder / "stream.talus");
  const Outcome query = talus({"query", "a.rqt", "--tolerance", "1"});
  EXPECT_EQ(query.exit_code, damaged);
  EXPECT_THAT(query.err, HasSubstr("a.rqt is an .rqt file, not a database"));
  const Outcome convert = talus({"convert", "a.talus", "-o", "x.ply"});
  EXPECT_EQ(convert.exit_code, damaged);
  EXPECT_THAT(convert.err,
              HasSubstr("a.talus is a database, not an .rqt file; make one from it first: talus query a.talus"));
  EXPECT_THAT(talus({"query", "a.talus", "--tolerance", "1", "--match", "a.tif"}).err,
              HasSubstr("a.tif is a GeoTIFF, not an .rqt file"));
  EXPECT_THAT(must({"info", "stream.talus"}).out, HasSubstr("an answer"));
}

// ---- numbers ---------------------------------------------------------------------------------------------------

TEST_F(Words, NumbersMayStandInWordsOfTheirOwn) {
  const auto region = [&](std::vector<std::string> box) {
    box.insert(box.begin(), {"query", "a.talus", "--tolerance", "5", "--json"});
    return json_of(must(box))["region"];
  };
  const auto expected = region({"--bbox=450300,5198500,451000,5199500"});
  EXPECT_EQ(region({"--bbox", "450300", "5198500", "451000", "5199500"}), expected);
  EXPECT_EQ(region({"--bbox", "450300,", "5198500,", "451000,", "5199500"}), expected);
  EXPECT_EQ(region({"--bbox", "450300 5198500 451000 5199500"}), expected);
  EXPECT_EQ(region({"--bbox", "4.503e5", "5.1985e+6", "+451000", "5199500"}), expected);
  EXPECT_EQ(region({"--bbox=450300", "5198500", "451000", "5199500"}), expected);
  const auto western = region({"--bbox=-10,-20,451000,5199500"});
  EXPECT_EQ(region({"--bbox", "-10", "-20", "451000", "5199500"}), western);
  EXPECT_EQ(region({"--bbox", "-1e1", "-.2e2", "451000", "5199500"}), western);
  EXPECT_EQ(json_of(must({"query", "--bbox", "450300", "5198500", "451000", "5199500", "a.talus", "--tolerance", "5",
                          "--json"}))["region"],
            expected);
  EXPECT_EQ(must({"query", "a.talus", "--tolerance", "5", "--point", "450413", "5199770", "--point", "452000",
                  "5198009", "--json"})
                .exit_code,
            done);
  const std::string line = "450015,5199535,452685,5199535,452685,5199000";
  EXPECT_EQ(must({"profile", "a.talus", "--line", "450015", "5199535", "452685", "5199535", "452685", "5199000",
                  "--tolerance", "5"})
                .out,
            must({"profile", "a.talus", "--line=" + line, "--tolerance=5"}).out);
  EXPECT_EQ(must({"height", "a.talus", "--surface", "4e+1", "450015", "5199985"}).out,
            must({"height", "a.talus", "450015", "5199985", "--surface=40"}).out);
  EXPECT_EQ(must({"height", "a.talus", "450015,5199985"}).out, must({"height", "a.talus", "450015", "5199985"}).out);
  EXPECT_EQ(must({"height", "a.talus", "-5e0", "-1.5e+1"}).out, "outside\n");
  must({"query", "a.talus", "--tolerance", "5", "--focus", "450413", "5199770", "0.5"});
  expect_refusal(talus({"query", "a.talus", "--tolerance", "5", "--bbox", "450300", "5198500", "451000"}), {usage},
                 {"--bbox", "four numbers"});
}

TEST_F(Words, CountsMayBeWrittenShort) {
  const auto vertices = [&](const std::string& word) {
    return json_of(must({"query", "a.talus", "--max-vertices", word, "--json"}))["vertices"].get<int>();
  };
  const int expected = vertices("1000");
  EXPECT_LE(expected, 1000);
  for (const char* word : {"1e3", "1e+3", "1k", "1K", "0.001M", "+1000", "1000.0"})
    EXPECT_EQ(vertices(word), expected) << word;
  EXPECT_GT(vertices("2.5k"), 1000);
  must({"query", "a.talus", "--max-triangles", "1M"});
  must({"query", "a.talus", "--tolerance", "1e1", "--bands", "1e1", "--threads", "2e0", "--snap", "1e1", "--max-level",
        "5e0"});
  must({"ingest", "a.tif", "b.talus", "--memory", "5e8", "--threads", "1e0"});
  must({"accuracy", "a.talus", "--tolerances", "1e1,20", "--window", "3.3e1"});
  for (const char* word : {"1x", "k", "1e", "1.5", "1.2345k", "nan", "inf", "1e99", "-5", ""}) {
    const Outcome outcome = talus({"query", "a.talus", std::string("--max-vertices=") + word});
    EXPECT_EQ(outcome.exit_code, usage) << word;
    EXPECT_THAT(outcome.err, HasSubstr("--max-vertices")) << word;
  }
}

// ---- rectangles and longitudes ----------------------------------------------------------------------------------

TEST_F(Words, ARectangleThatIsCutSaysSo) {
  const Outcome cut =
      must({"query", "a.talus", "--tolerance", "5", "--bbox=450300,5190000,451000,5199500", "-o", "a.ply", "--json"});
  EXPECT_THAT(cut.err,
              StartsWith("talus: note: the rectangle 450300,5190000,451000,5199500 reaches beyond the raster"));
  EXPECT_EQ(json_of(cut)["clipped"], true);
  EXPECT_EQ(json_of(cut)["asked"], (nlohmann::json{450300.0, 5190000.0, 451000.0, 5199500.0}));
  const Outcome edges =
      must({"query", "a.talus", "--tolerance", "5", "--bbox=450000,5197900,452700,5200000", "-o", "a.ply", "--json"});
  EXPECT_EQ(edges.err, "") << "the raster's own outline";
  EXPECT_EQ(json_of(edges)["clipped"], false);
  EXPECT_FALSE(json_of(must({"query", "a.talus", "--tolerance", "5", "-o", "a.ply", "--json"})).contains("clipped"));
  const Outcome accuracy =
      must({"accuracy", "a.talus", "--tolerances", "20", "--bbox=450300,5190000,451000,5199500", "--json"});
  EXPECT_THAT(accuracy.err, HasSubstr("reaches beyond the raster"));
  EXPECT_EQ(json_of(accuracy)["clipped"], true);
}

TEST_F(Words, TilesOnBothSidesOfTheAntimeridianAreOnePlace) {
  raster = fractal(100, 100, 5, 600);
  RasterOptions east = options, west = options;
  east.crs = west.crs = "EPSG:4326";
  east.type = west.type = SampleType::float64;
  east.geotransform = {179, 0.01, 0, 52, 0, -0.01};
  west.geotransform = {-180, 0.01, 0, 52, 0, -0.01};
  make_raster("east.tif", east);
  make_raster("west.tif", west);
  for (const auto& inputs : std::vector<std::vector<std::string>>{{"east.tif", "west.tif"}, {"west.tif", "east.tif"}}) {
    must({"ingest", inputs[0], inputs[1], "both.talus", "--overwrite"});
    for (const char* x : {"179.305", "-180.695", "539.305"})
      EXPECT_EQ(std::stod(must({"height", "both.talus", x, "51.495"}).out), raster.at(30, 50)) << x;
    for (const char* x : {"-179.695", "180.305"})
      EXPECT_EQ(std::stod(must({"height", "both.talus", x, "51.495"}).out), raster.at(30, 50)) << x;
    EXPECT_EQ(must({"height", "both.talus", "178.5", "51.495"}).out, "outside\n");
    const auto box = [&](const std::string& bbox) {
      return json_of(must({"query", "both.talus", "--tolerance", "5", "--bbox=" + bbox, "--json"}));
    };
    const auto across = box("179.5,51.5,-179.5,51.9");
    for (const char* other : {"179.5,51.5,180.5,51.9", "-180.5,51.5,-179.5,51.9"}) {
      EXPECT_EQ(box(other)["region"], across["region"]) << other;
      EXPECT_EQ(box(other)["vertices"], across["vertices"]) << other;
    }
    EXPECT_EQ(across["clipped"], false);
    EXPECT_EQ(box("178,51.5,-179.5,51.9")["clipped"], true);
    for (const char* line : {"179.5,51.5,-179.5,51.5", "-180.5,51.5,-179.5,51.5", "-179.5,51.5,179.5,51.5"}) {
      const auto profile =
          json_of(must({"profile", "both.talus", std::string("--line=") + line, "--tolerance=5", "--json"}));
      EXPECT_NEAR(profile["length"].get<double>(), 69'400, 300) << line;
      EXPECT_EQ(profile["parts"].size(), 1u) << line;
    }
    Terrain tolerances(2, 1);
    tolerances.at(0, 0) = 100, tolerances.at(1, 0) = 1;
    RasterOptions placed = west;
    for (const double x : {-181.0, 179.0, 539.0}) {
      placed.geotransform = {x, 1, 0, 52, 0, -1};
      write_raster(tolerances, folder / "tolerances.tif", placed);
      EXPECT_EQ(talus({"query", "both.talus", "--tolerance-raster", "tolerances.tif"}).exit_code, done) << x;
    }
    must({"query", "both.talus", "--tolerance", "9", "--point=-179.695,51.495", "--point=179.305,51.495",
          "--line=179.9,51.5,-179.9,51.6", "--focus=-179.5,51.5,1"});
  }
}

}  // namespace
}  // namespace talus::support
