// The rules of docs/inputs.md, through the program.

#include <cmath>
#include <sstream>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;

class Inputs : public Command {
 protected:
  /// Where a raster lies: its first sample on a grid of 30 m.
  static RasterOptions at(int col, int row, const std::string& crs = "EPSG:32632") {
    RasterOptions options;
    options.crs = crs;
    options.geotransform = {450000 + 30.0 * col, 30, 0, 5200000 - 30.0 * row, 0, -30};
    return options;
  }
  void put(const std::string& name, const Terrain& terrain, const RasterOptions& options) const {
    write_raster(terrain, folder / name, options);
  }
  /// A part of `raster` in its place, raised.
  void put_part(const std::string& name, int col, int row, int cols, int rows, double raised = 0) const {
    Terrain part = crop(raster, col, row, cols, rows);
    for (double& height : part.values) height += raised;
    put(name, part, at(col, row));
  }

  /// What the program says of an ingest that works.
  nlohmann::json ingest(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "ingest");
    arguments.insert(arguments.end(), "--json");
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done) << ::testing::PrintToString(arguments) << ": " << outcome.err;
    return json_of(outcome);
  }
  /// Refuses, and leaves the folder as it was.
  void expect_refused(const std::vector<std::string>& arguments, int exit_code,
                      const std::vector<std::string>& named) const {
    const auto before = contents();
    SCOPED_TRACE(::testing::PrintToString(arguments));
    expect_refusal(talus(arguments), {exit_code}, named);
    EXPECT_TRUE(contents() == before) << "something was left behind or changed";
  }
  static std::string notes_of(const nlohmann::json& report) { return report.at("notes").dump(); }

  /// All samples of a database, as a terrain.
  [[nodiscard]] Terrain stored(const std::string& name) const {
    const Snapshot now = Database::open(folder / name).snapshot();
    const SampleWindow window = now.samples(now.description().extent);
    Terrain terrain(static_cast<int>(window.region.cols()), static_cast<int>(window.region.rows()));
    terrain.values = window.values;
    terrain.valid = window.valid;
    return terrain;
  }
  static void expect_same(const Terrain& found, const Terrain& expected) {
    ASSERT_EQ(std::pair(found.cols, found.rows), std::pair(expected.cols, expected.rows));
    int different = 0;
    for (std::size_t i = 0; i < found.values.size(); ++i) {
      const bool same_height = found.valid[i] == 0 || found.values[i] == expected.values[i];
      if (found.valid[i] != expected.valid[i] || !same_height) ++different;
    }
    EXPECT_EQ(different, 0);
  }
  [[nodiscard]] double bound_at(const std::string& database, const std::string& tolerance) const {
    const Outcome outcome = talus({"query", database, "--tolerance", tolerance, "--json"});
    EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    return json_of(outcome).at("bound");
  }
};

// ---- what is named ---------------------------------------------------------------------------------

TEST_F(Inputs, AFolderStandsForItsRasters) {
  std::filesystem::create_directory(folder / "tiles");
  put_part("tiles/west.tif", 0, 0, 50, 70);
  put_part("tiles/east.tif", 50, 0, 40, 70);
  write_bytes(folder / "tiles/readme.txt", "two tiles\n");
  EXPECT_EQ(ingest({"tiles", "a.talus"}).at("cols"), 90);
  expect_same(stored("a.talus"), raster);
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "tiles"}).exit_code, done);
}

TEST_F(Inputs, AFolderWithoutRastersIsRefused) {
  std::filesystem::create_directory(folder / "empty");
  expect_refused({"ingest", "empty", "a.talus"}, usage, {"empty"});
}

TEST_F(Inputs, AListNamesFilesAndFolders) {
  std::filesystem::create_directories(folder / "lists/tiles");
  put_part("lists/west.tif", 0, 0, 50, 70);
  put_part("lists/tiles/east.tif", 50, 0, 40, 70);
  write_bytes(folder / "lists/all.txt", "# relative to this list\nwest.tif\ntiles\n");
  ingest({"@lists/all.txt", "a.talus"});
  expect_same(stored("a.talus"), raster);
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "@lists/all.txt", "--tolerance=3"}).exit_code, done);
}

TEST_F(Inputs, AListThatIsMissingEmptyOrNamesNothingIsRefused) {
  expect_refused({"ingest", "@missing.txt", "a.talus"}, failed, {"missing.txt"});
  write_bytes(folder / "comments.txt", "# nothing yet\n\n");
  expect_refused({"ingest", "@comments.txt", "a.talus"}, usage, {"comments.txt"});
  write_bytes(folder / "gone.txt", "gone.tif\n");
  expect_refused({"ingest", "@gone.txt", "a.talus"}, failed, {"gone.tif"});
}

TEST_F(Inputs, OneThatIsBadSpoilsNothing) {
  put_part("west.tif", 0, 0, 50, 70);
  write_bytes(folder / "notes.txt", "the mountain is high\n");
  expect_refused({"ingest", "west.tif", "notes.txt", "a.talus"}, failed, {"notes.txt"});
  expect_refused({"ingest", "west.tif", "missing.tif", "a.talus"}, failed, {"missing.tif"});
}

TEST_F(Inputs, ADriverBeyondTheListNeedsTheUsersWord) {
  write_bytes(folder / "points.xyz", "0 0 1\n1 0 2\n2 0 3\n0 -1 4\n1 -1 5\n2 -1 7\n");
  expect_refused({"ingest", "points.xyz", "a.talus"}, failed, {"points.xyz", "--allow-driver XYZ"});
  expect_refused({"ingest", "points.xyz", "a.talus", "--allow-driver=NONE"}, usage, {"NONE"});
  const auto report = ingest({"points.xyz", "a.talus", "--allow-driver", "XYZ"});
  EXPECT_EQ(report.at("cols"), 3);
  EXPECT_EQ(report.at("maximum"), 7);
}

// ---- one grid --------------------------------------------------------------------------------------

TEST_F(Inputs, TilesThatShareARowMeet) {
  put_part("north.tif", 0, 0, 90, 36);
  put_part("south.tif", 0, 35, 90, 35);
  for (const std::vector<std::string>& inputs :
       {std::vector<std::string>{"north.tif", "south.tif"}, {"south.tif", "north.tif"}}) {
    const auto report = ingest({inputs[0], inputs[1], "a.talus", "--overwrite"});
    EXPECT_THAT(notes_of(report), ::testing::Not(HasSubstr("differ")));
    expect_same(stored("a.talus"), raster);
  }
}

TEST_F(Inputs, WhereTheyOverlapTheLaterWinsAndTheDifferenceIsSaid) {
  put_part("first.tif", 0, 0, 60, 70);
  put_part("later.tif", 40, 10, 50, 40, 7);
  const auto report = ingest({"first.tif", "later.tif", "a.talus"});
  EXPECT_EQ(report.at("cols"), 90);
  EXPECT_EQ(report.at("void_samples"), 30 * 30);  // east of the one, above and below the other
  EXPECT_THAT(notes_of(report), HasSubstr("800 of 800 samples differ. The largest difference is 7 m"));
  EXPECT_THAT(notes_of(report), HasSubstr("later.tif covers first.tif"));
  const Terrain found = stored("a.talus");
  EXPECT_EQ(found.at(39, 20), raster.at(39, 20));
  EXPECT_EQ(found.at(40, 20), raster.at(40, 20) + 7);
  EXPECT_EQ(found.at(89, 49), raster.at(89, 49) + 7);
  EXPECT_FALSE(found.is_valid(89, 9));

  const auto turned = ingest({"later.tif", "first.tif", "b.talus"});
  EXPECT_THAT(notes_of(turned), HasSubstr("first.tif covers later.tif"));
  EXPECT_EQ(talus({"verify", "b.talus", "--tolerance=0"}).exit_code, usage);  // --tolerance needs --against
  EXPECT_EQ(talus({"verify", "b.talus"}).exit_code, done);
}

TEST_F(Inputs, WithPriorityResolutionTheFinerWinsWhereverItIsNamed) {
  const Terrain coarse = plane(40, 40, 1000, 0, 0);
  const Terrain fine = plane(40, 40, 1500, 0, 0);
  put("coarse.tif", coarse, at(0, 0));
  RasterOptions options = at(10, 10);
  options.geotransform[1] = 15;
  options.geotransform[5] = -15;
  put("fine.tif", fine, options);
  for (const std::vector<std::string>& inputs :
       {std::vector<std::string>{"coarse.tif", "fine.tif"}, {"fine.tif", "coarse.tif"}}) {
    ingest({inputs[0], inputs[1], "a.talus", "--overwrite", "--tr=30", "--priority=resolution"});
    EXPECT_EQ(Database::open(folder / "a.talus").snapshot().description().maximum_height, 1500);
    ingest({inputs[0], inputs[1], "a.talus", "--overwrite", "--tr=30", "--priority=later"});
    const double expected = inputs[1] == "fine.tif" ? 1500 : 1000;
    EXPECT_EQ(Database::open(folder / "a.talus").snapshot().description().maximum_height, expected) << inputs[1];
  }
  expect_refused({"ingest", "coarse.tif", "b.talus", "--priority=first"}, usage, {"--priority", "first"});
}

// ---- other grids -----------------------------------------------------------------------------------

TEST_F(Inputs, OtherCellsAreRefusedUnlessAnOptionSaysHow) {
  put("coarse.tif", plane(40, 40), at(0, 0));
  RasterOptions options = at(0, 0);
  options.geotransform[1] = 20;
  options.geotransform[5] = -20;
  put("fine.tif", plane(60, 60), options);
  expect_refused({"ingest", "coarse.tif", "fine.tif", "a.talus"}, failed, {"fine.tif", "--tr", "--grid-of"});
  const auto report = ingest({"coarse.tif", "fine.tif", "a.talus", "--tr=30,30"});
  EXPECT_THAT(notes_of(report), HasSubstr("resampled"));
  expect_refused({"ingest", "coarse.tif", "b.talus", "--tr=0"}, usage, {"--tr"});
  expect_refused({"ingest", "coarse.tif", "b.talus", "--tr=30", "--resampling=wishful"}, usage, {"wishful"});
}

TEST_F(Inputs, AnotherCrsIsRefusedUnlessAnOptionSaysHow) {
  put("here.tif", plane(60, 60, 1000, 0, 0), at(0, 0));
  RasterOptions options;
  options.crs = "EPSG:32633";  // the same place, in the next zone
  options.geotransform = {-6600, 30, 0, 5221300, 0, -30};
  put("zone33.tif", plane(60, 60, 1000, 0, 0), options);
  expect_refused({"ingest", "here.tif", "zone33.tif", "a.talus"}, failed, {"zone33.tif", "here.tif", "--t-srs"});
  const auto report = ingest({"here.tif", "zone33.tif", "a.talus", "--t-srs", "EPSG:32632"});
  EXPECT_THAT(notes_of(report), HasSubstr("zone33.tif: is resampled"));
  EXPECT_EQ(report.at("minimum"), 1000);
  EXPECT_EQ(report.at("maximum"), 1000);
  expect_refused({"ingest", "here.tif", "b.talus", "--t-srs", "EPSG:nowhere"}, usage, {"EPSG:nowhere"});
}

TEST_F(Inputs, TheGridCanBeThatOfADatabase) {
  put("here.tif", plane(60, 60, 1000, 0, 0), at(0, 0));
  ingest({"here.tif", "grid.talus"});
  RasterOptions options = at(2, 2);
  options.geotransform = {450077, 20, 0, 5199917, 0, -20};
  put("beside.tif", plane(60, 60, 1200, 0, 0), options);
  ingest({"beside.tif", "a.talus", "--grid-of", "grid.talus"});
  const Description a = Database::open(folder / "a.talus").snapshot().description();
  const Description grid = Database::open(folder / "grid.talus").snapshot().description();
  EXPECT_EQ(a.mapping, grid.mapping);
  EXPECT_EQ(a.minimum_height, 1200);
  EXPECT_EQ(a.maximum_height, 1200);
  expect_refused({"ingest", "beside.tif", "b.talus", "--grid-of", "missing.talus"}, failed, {"missing.talus"});
}

TEST_F(Inputs, ACrsThatIsMissingCanBeSaid) {
  put_part("here.tif", 0, 0, 50, 70);
  put("bare.tif", crop(raster, 50, 0, 40, 70), at(50, 0, ""));
  expect_refused({"ingest", "here.tif", "bare.tif", "a.talus"}, failed, {"bare.tif", "--srs"});
  ingest({"here.tif", "bare.tif", "a.talus", "--srs", "EPSG:32632"});
  expect_same(stored("a.talus"), raster);
  expect_refused({"ingest", "bare.tif", "b.talus", "--srs", "nonsense"}, usage, {"--srs", "nonsense"});
}

// ---- heights ---------------------------------------------------------------------------------------

TEST_F(Inputs, HeightsInFeetCountAsFeet) {
  put("spike.tif", spike(40, 40, 11, 13, 100), at(0, 0));
  ingest({"spike.tif", "a.talus", "--vertical-unit", "foot"});
  const Description d = Database::open(folder / "a.talus").snapshot().description();
  EXPECT_EQ(d.metres_per_unit, 0.3048);
  EXPECT_EQ(d.maximum_height, 200);  // as the source has them
  const auto triangles = [&](const char* tolerance) {
    return json_of(talus({"query", "a.talus", "--tolerance", tolerance, "--json"})).at("triangles").get<int>();
  };
  EXPECT_GT(triangles("30.4"), triangles("30.5"));  // 100 feet are 30.48 m
  expect_refused({"ingest", "spike.tif", "b.talus", "--vertical-unit", "cubit"}, usage, {"cubit"});
}

TEST_F(Inputs, AHeightStepRoundsAndHalfOfItIsPartOfEveryBound) {
  put_part("a.tif", 0, 0, 90, 70);
  ingest({"a.tif", "a.talus", "--height-step", "5"});
  const Terrain found = stored("a.talus");
  for (int row = 0; row < 70; ++row) {
    for (int col = 0; col < 90; ++col) {
      ASSERT_LE(std::abs(found.at(col, row) - raster.at(col, row)), 2.5) << col << " " << row;
      ASSERT_EQ(std::fmod(found.at(col, row), 5), 0) << col << " " << row;
    }
  }
  for (const char* tolerance : {"0", "1", "2.5", "20"}) EXPECT_GE(bound_at("a.talus", tolerance), 2.5) << tolerance;
  EXPECT_LE(bound_at("a.talus", "20"), 20 + 1e-6);
  EXPECT_EQ(json_of(talus({"info", "a.talus", "--json"})).at("lossy_metres"), 2.5);
  // verify holds the mesh against the source itself.
  double largest = 0;
  for (std::size_t i = 0; i < found.values.size(); ++i)
    largest = std::max(largest, std::abs(found.values[i] - raster.values[i]));
  const auto verified = [&](const char* tolerance) {
    const Outcome outcome = talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", tolerance, "--json"});
    EXPECT_EQ(outcome.exit_code, done) << outcome.out;
    return json_of(outcome).at("true_error").get<double>();
  };
  EXPECT_EQ(verified("1"), largest) << "the finest there is";
  EXPECT_GT(verified("20"), 17.5) << "not what is left of the tolerance";
  EXPECT_LE(verified("20"), 20);
  const Outcome finest = talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", "1"});
  EXPECT_NE(finest.out.find("ingest rounded heights by up to 2.5 m"), std::string::npos) << finest.out;
  // One height that is farther from the source's than rounding takes it, by half a metre.
  const double was = raster.at(40, 30);
  raster.at(40, 30) = found.at(40, 30) + 3;
  put_part("b.tif", 0, 0, 90, 70);
  raster.at(40, 30) = was;
  const Outcome other = talus({"verify", "a.talus", "--against", "b.tif"});
  EXPECT_EQ(other.exit_code, differs);
  EXPECT_NE(other.out.find("column 40, row 30"), std::string::npos) << other.out;
  // What ingest has spent is not there for a quantum, neither of heights that are split nor of nested ones.
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--quantum", "1"}}) {
    std::vector<std::string> words{"query", "a.talus", "--tolerance", "2", "--heights", "bounded"};
    words.insert(words.end(), more.begin(), more.end());
    expect_refused(words, usage, {"rounded heights by up to 2.5 m"});
  }
  for (const char* step : {"0", "-1", "nan", "much"})
    expect_refused({"ingest", "a.tif", "b.talus", std::string("--height-step=") + step}, usage, {"--height-step"});
}

// ---- before, while, and after ----------------------------------------------------------------------

TEST_F(Inputs, ADryRunSaysWhatWouldBeDoneAndWritesNothing) {
  put_part("west.tif", 0, 0, 50, 70);
  put_part("east.tif", 50, 0, 40, 70);
  const auto before = contents();
  const auto report = ingest({"west.tif", "east.tif", "a.talus", "--dry-run"});
  EXPECT_EQ(report.at("cols"), 90);
  EXPECT_EQ(report.at("rows"), 70);
  EXPECT_GT(report.at("tiles"), 0);
  EXPECT_GT(report.at("threads"), 0);
  EXPECT_GT(report.at("estimated_bytes"), 0);
  EXPECT_GE(report.at("estimated_seconds"), 0);
  const Outcome text = talus({"ingest", "west.tif", "east.tif", "a.talus", "--dry-run"});
  EXPECT_EQ(text.exit_code, done);
  EXPECT_THAT(text.out, HasSubstr("a.talus"));
  EXPECT_TRUE(contents() == before);
  expect_refused({"ingest", "missing.tif", "a.talus", "--dry-run"}, failed, {"missing.tif"});
}

TEST_F(Inputs, ProgressAsJsonIsOneObjectALineOnStandardError) {
  put_part("a.tif", 0, 0, 90, 70);
  const Outcome outcome = talus({"ingest", "a.tif", "a.talus", "--progress=json", "--json"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  json_of(outcome);  // standard output has the report and nothing else
  std::istringstream lines(outcome.err);
  int count = 0;
  double before = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("talus: note: ")) continue;
    ++count;
    const auto json = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(json.is_object()) << line;
    for (const char* field : {"fraction", "stage", "samples", "all_samples", "seconds", "seconds_left"})
      EXPECT_TRUE(json.contains(field)) << field << " in " << line;
    EXPECT_GE(json.at("fraction"), before);
    before = json.at("fraction");
    EXPECT_LE(before, 1);
    EXPECT_EQ(json.at("all_samples"), 90 * 70);
  }
  EXPECT_GE(count, 1);
  expect_refused({"ingest", "a.tif", "b.talus", "--progress=loud"}, usage, {"--progress", "loud"});
}

TEST_F(Inputs, TooLittleMemoryIsRefusedWithWhatWouldDo) {
  put_part("a.tif", 0, 0, 90, 70);
  const Outcome outcome = talus({"ingest", "a.tif", "a.talus", "--memory=20MiB"});
  expect_refusal(outcome, {usage}, {"limit", "MiB at least"});
  const std::string words = "samples need ";
  const std::size_t from = outcome.err.find(words) + words.size();
  const std::string enough = outcome.err.substr(from, outcome.err.find(' ', from) - from);
  EXPECT_EQ(talus({"ingest", "a.tif", "a.talus", "--memory", enough + "MiB"}).exit_code, done) << enough;
  for (const char* memory : {"little", "0", "-5MiB", "5XiB"})
    expect_refused({"ingest", "a.tif", "b.talus", std::string("--memory=") + memory}, usage, {"--memory"});
}

TEST_F(Inputs, WhatWasBegunInMetresIsNotGoneOnWithInFeet) {
  raster = fit(fractal(2300, 1500, 6, 2000), SampleType::int16);
  put("big.tif", raster, at(0, 0));
  RunOptions options;
  options.folder = folder.path().string();
  const std::string start = std::string(TALUS_PROGRAM) +
                            " ingest big.tif big.talus --threads 1 --progress=json 2>said & "
                            "while ! grep -q '\"samples\":[1-9]' said; do sleep 0.01; done; ";
  Outcome interrupted = run_program({"sh", "-c", start + "kill -INT $!; wait $!"}, options);
  for (int again = 0; again < 20 && interrupted.exit_code == done; ++again) {  // it was done before it was interrupted
    std::filesystem::remove(folder / "big.talus");
    interrupted = run_program({"sh", "-c", start + "kill -INT $!; wait $!"}, options);
  }
  ASSERT_EQ(interrupted.exit_code, 130) << interrupted.err;
  expect_refused({"ingest", "big.tif", "big.talus", "--resume", "--vertical-unit", "foot"}, usage, {"big.talus.part"});
  expect_refused({"ingest", "big.tif", "big.talus", "--resume", "--height-step", "5"}, usage, {"big.talus.part"});
  ingest({"big.tif", "big.talus", "--resume"});
  EXPECT_EQ(talus({"verify", "big.talus", "--against", "big.tif"}).exit_code, done);
}

TEST_F(Inputs, AnUpdateEqualsAnIngestOfEverything) {
  put_part("first.tif", 0, 0, 60, 70);
  put_part("later.tif", 40, 0, 50, 70, 7);
  ingest({"first.tif", "a.talus"});
  const auto report = ingest({"later.tif", "a.talus", "--update"});
  EXPECT_EQ(report.at("cols"), 90);
  ingest({"first.tif", "later.tif", "whole.talus"});
  expect_same(stored("a.talus"), stored("whole.talus"));
  for (const char* tolerance : {"0", "3", "40"}) {
    const auto of = [&](const char* database) {
      return json_of(talus({"query", database, "--tolerance", tolerance, "--json"})).at("triangles").get<int>();
    };
    EXPECT_EQ(of("a.talus"), of("whole.talus")) << tolerance;
  }
  EXPECT_EQ(talus({"verify", "a.talus"}).exit_code, done);
  const auto info = json_of(talus({"info", "a.talus", "--json"}));
  EXPECT_EQ(info.at("generation"), 1);
  EXPECT_EQ(info.at("sources").size(), 2u);
}

TEST_F(Inputs, AnUpdateThatCannotBeLeavesTheDatabase) {
  put_part("first.tif", 0, 0, 60, 70);
  ingest({"first.tif", "a.talus"});
  expect_refused({"ingest", "--update", "missing.tif", "a.talus"}, failed, {"missing.tif"});
  expect_refused({"ingest", "--update", "first.tif", "missing.talus"}, failed, {"missing.talus"});
  put("feet.tif", crop(raster, 40, 0, 50, 70), [] {
    RasterOptions options = at(40, 0);
    options.unit = "ft";
    return options;
  }());
  expect_refused({"ingest", "--update", "feet.tif", "a.talus"}, failed, {"feet.tif", "--vertical-unit"});
}

}  // namespace
}  // namespace talus::support
