// `talus accuracy`: what it prints and writes, and that its recommendation can be followed.

#include <algorithm>
#include <regex>
#include <sstream>

#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

class Accuracy : public Command {
 protected:
  void SetUp() override {
    raster = hole(fit(fractal(200, 150, 4, 600), SampleType::int16), 20, 20, 30, 30);
    RasterOptions options;
    options.crs = "EPSG:32632";
    options.geotransform = {450000, 30, 0, 5200000, 0, -30};
    make_raster("a.tif", options);
    const Outcome outcome = talus({"ingest", "a.tif", "a.talus"});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  }
  /// A reader of XML that is not ours; what it counts of each element, or what it objects to.
  [[nodiscard]] std::string elements(const std::string& name) const {
    RunOptions options;
    options.folder = folder.path().string();
    const Outcome outcome =
        run_program({TALUS_PYTHON, "-c",
                     "import sys, collections, xml.etree.ElementTree as t\n"
                     "c = collections.Counter(e.tag.split('}')[-1] for e in t.parse(sys.argv[1]).iter())\n"
                     "print(*(f'{k}={v}' for k, v in sorted(c.items())))",
                     name},
                    options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return " " + outcome.out;
  }
  static std::string bbox(const nlohmann::json& corners) {
    std::string word = "--bbox=";
    for (const auto& corner : corners) word += (word.ends_with('=') ? "" : ",") + corner.dump();
    return word;
  }
  void expect_followed(const std::vector<std::string>& question, bool is_whole) const {
    auto with = question;
    with.insert(with.end(), {"--json"});
    const auto json = json_of(talus(with));
    EXPECT_EQ(json["is_whole_region"], is_whole);
    const auto& advice = json["recommendation"];
    ASSERT_TRUE(advice.contains("tolerance")) << advice;
    // What is offered beside it is finer and slower, or coarser and faster.
    std::smatch offered;
    const std::string text = advice["text"];
    if (std::regex_search(text, offered, std::regex("; (for )?(\\S+) m (you pay|take) "))) {
      const bool is_finer = offered[1].matched;
      for (const auto& point : json["points"]) {
        if (point["tolerance"] != std::stod(offered[2])) continue;
        EXPECT_EQ(point["tolerance"] < advice["tolerance"], is_finer) << text;
        EXPECT_EQ(point["warm_seconds"] > advice["seconds"], is_finer) << text;
      }
    }
    for (const auto& window : json["windows"]) {
      const auto answer = json_of(
          talus({"query", "a.talus", "--tolerance", advice["tolerance"].dump(), bbox(window["bbox"]), "--json"}));
      EXPECT_LE(answer["vertices"], advice["vertices"]);
      if (is_whole) {
        EXPECT_EQ(answer["vertices"], advice["vertices"]);
      }
    }
    // The command it prints, word by word.
    std::vector<std::string> command;
    std::istringstream words(advice["command"].get<std::string>());
    for (std::string word; words >> word;) command.push_back(word);
    ASSERT_EQ(command.front(), "talus");
    command.erase(command.begin());
    command.push_back("--json");
    EXPECT_LE(json_of(talus(command))["vertices"], advice["vertices"]);
    EXPECT_GT(advice["command_seconds"], 0) << "it is tried, too";
  }
};

TEST_F(Accuracy, PrintsATableAndARecommendation) {
  const Outcome outcome = talus({"accuracy", "a.talus", "--tolerances", "50,5,0.5"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  for (const char* word :
       {"question", "truth", "warm", "cold", "tolerance", "largest", "95 %", "RMS", "vertices", "triangles", "stream",
        "middle half", "\n50 m ", "\n5 m ", "\n0.5 m ", "you can have 5 m", "talus query a.talus --tolerance"}) {
    EXPECT_THAT(outcome.out, ::testing::HasSubstr(word));
  }
  std::istringstream lines(outcome.err);
  for (std::string line; std::getline(lines, line);) EXPECT_THAT(line, ::testing::StartsWith("talus: note: "));
}

TEST_F(Accuracy, InJsonEachPointHasItsFigures) {
  const auto json = json_of(talus({"accuracy", "a.talus", "--tolerances", "50,5,0.5", "--time", "1000s", "--json"}));
  ASSERT_EQ(json["points"].size(), 3u);
  double tolerance = 1e9, vertices = 0;
  for (const auto& point : json["points"]) {
    EXPECT_LT(point["tolerance"], tolerance);
    EXPECT_GT(point["vertices"], vertices);
    EXPECT_LE(point["largest_error"], point["bound"]);
    EXPECT_LE(point["percentile_95_error"], point["largest_error"]);
    EXPECT_LE(point["rms_error"], point["largest_error"]);
    EXPECT_GT(point["bytes"], 0);
    EXPECT_GT(point["warm_seconds"], 0);
    EXPECT_GT(point["cold_seconds"], 0);
    tolerance = point["tolerance"];
    vertices = point["vertices"];
    // The same as the judge of verify finds.
    const auto verified =
        json_of(talus({"verify", "a.talus", "--against", "a.tif", "--tolerance", point["tolerance"].dump(), "--json"}));
    EXPECT_EQ(verified["true_error"], point["largest_error"]);
    EXPECT_EQ(verified["vertices"], point["vertices"]);
    EXPECT_EQ(verified["triangles"], point["triangles"]);
  }
  EXPECT_EQ(json["truth"], "samples");
  EXPECT_EQ(json["recommendation"]["budget_seconds"], 1000);
  EXPECT_EQ(json["recommendation"]["tolerance"], 0.5);
  EXPECT_EQ(json["recommendation"]["is_finest"], true);
}

TEST_F(Accuracy, ErrorsAgainstTheRasterAreThoseAgainstTheSamples) {
  const auto own = json_of(talus({"accuracy", "a.talus", "--tolerances", "30,3", "--json"}));
  const auto against = json_of(talus({"accuracy", "a.talus", "--tolerances", "30,3", "--against", "a.tif", "--json"}));
  EXPECT_EQ(against["truth"], "a.tif");
  for (const std::size_t i : {0u, 1u}) {
    const auto find = [&](const nlohmann::json& report) {
      for (const auto& point : report["points"]) {
        if (point["tolerance"] == (i == 0 ? 30 : 3)) return point;
      }
      return nlohmann::json();
    };
    for (const char* figure : {"largest_error", "percentile_95_error", "rms_error", "samples", "bytes", "vertices"})
      EXPECT_EQ(find(own)[figure], find(against)[figure]) << figure;
  }
}

TEST_F(Accuracy, TheRecommendationCanBeFollowed) {
  expect_followed({"accuracy", "a.talus"}, true);
  expect_followed({"accuracy", "a.talus", "--bbox=451000,5197000,454000,5199000"}, true);
  expect_followed({"accuracy", "a.talus", "--window", "33"}, false);
}

TEST_F(Accuracy, ReportsAreWellFormed) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--window", "33"}, {"--tolerances", "0"}}) {
    std::vector<std::string> question{"accuracy", "a.talus", "-o", "r.svg", "-o", "r.html", "--tolerances", "100,10,1"};
    question.insert(question.end(), more.begin(), more.end());
    if (more.size() == 2 && more.front() == "--tolerances") question.erase(question.begin() + 6, question.begin() + 8);
    const Outcome outcome = talus(question);
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    EXPECT_THAT(outcome.out, ::testing::HasSubstr("output: r.svg\noutput: r.html\n"));
    const std::string maps = more.size() == 2 && more.front() == "--window" ? " image=9 " : " image=1 ";
    EXPECT_THAT(elements("r.svg"), ::testing::HasSubstr(maps));
    EXPECT_THAT(elements("r.svg"), ::testing::HasSubstr(" svg=1 "));
    const std::string page = bytes_of(folder / "r.html");
    EXPECT_THAT(page, ::testing::StartsWith("<!DOCTYPE html>"));
    EXPECT_THAT(elements("r.html"), ::testing::HasSubstr(maps));
    EXPECT_THAT(elements("r.html"), ::testing::HasSubstr(" svg=4 table=1 "));
    for (const char* bad : {"\"nan", " nan", ">nan", "\"inf", "-inf", ">inf"}) {
      EXPECT_EQ(bytes_of(folder / "r.svg").find(bad), std::string::npos) << bad;
    }
  }
}

TEST_F(Accuracy, NamesThatXmlDoesNotLikeAreEscaped) {
  const std::string name = "a <b> & \"c\" \xff\x01.talus";
  std::filesystem::copy_file(folder / "a.talus", folder / name);
  const Outcome outcome = talus({"accuracy", name, "-o", "r.svg", "-o", "r.html", "--tolerances", "10"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_THAT(elements("r.svg"), ::testing::HasSubstr(" svg=1 "));
  EXPECT_THAT(elements("r.html"), ::testing::HasSubstr(" svg=4 "));
  EXPECT_THAT(bytes_of(folder / "r.svg"), ::testing::HasSubstr("a &lt;b&gt; &amp; &quot;c&quot;"));
}

TEST_F(Accuracy, ADatabaseOfATolerancesVerticesNeedsTheRasterForErrors) {
  ASSERT_EQ(talus({"ingest", "a.tif", "b.talus", "--tolerance", "5"}).exit_code, done);
  const Outcome outcome = talus({"accuracy", "b.talus", "-o", "r.html", "-o", "r.svg"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("without --against"));
  EXPECT_THAT(outcome.out, ::testing::Not(::testing::HasSubstr("RMS")));
  EXPECT_THAT(elements("r.html"), ::testing::Not(::testing::HasSubstr("image")));
  static_cast<void>(elements("r.svg"));
  const auto json = json_of(talus({"accuracy", "b.talus", "--against", "a.tif", "--json"}));
  for (const auto& point : json["points"]) EXPECT_LE(point["largest_error"], point["bound"]);
}

TEST_F(Accuracy, ErrorsOfRoundedHeightsAreAgainstTheSource) {
  ASSERT_EQ(talus({"ingest", "a.tif", "b.talus", "--height-step", "8"}).exit_code, done);
  const auto own = json_of(talus({"accuracy", "b.talus", "--tolerances", "4", "--json"}));
  EXPECT_EQ(own["points"][0]["largest_error"], 0);
  EXPECT_THAT(own["notes"].dump(), ::testing::HasSubstr("against the rounded heights"));
  const auto source = json_of(talus({"accuracy", "b.talus", "--tolerances", "4", "--against", "a.tif", "--json"}));
  EXPECT_EQ(source["points"][0]["largest_error"], 4);
  EXPECT_THAT(source["notes"].dump(), ::testing::HasSubstr("rounded heights by up to 4 m"));
}

TEST_F(Accuracy, BadInputIsRefusedAndNothingIsLeft) {
  RasterOptions elsewhere;
  elsewhere.crs = "EPSG:32632";
  elsewhere.geotransform = {450030, 30, 0, 5200000, 0, -30};
  make_raster("elsewhere.tif", elsewhere);
  RasterOptions another_crs = elsewhere;
  another_crs.crs = "EPSG:32633";
  another_crs.geotransform = {450000, 30, 0, 5200000, 0, -30};
  make_raster("another_crs.tif", another_crs);
  another_crs.crs = "";
  make_raster("no_crs.tif", another_crs);
  another_crs.crs = "EPSG:32632";
  raster.at(100, 75) += 100;
  make_raster("other_heights.tif", another_crs);
  raster.at(100, 75) -= 100;
  raster.make_void(90, 60);
  make_raster("other_voids.tif", another_crs);
  raster = fit(fractal(90, 70, 4, 600), SampleType::int16);
  make_raster("smaller.tif");
  write_bytes(folder / "notes.txt", "no database\n");
  std::filesystem::create_directory(folder / "folder.svg");
  const auto before = contents();
  const auto refused = [&](const std::vector<std::string>& more, int code, const std::string& named) {
    std::vector<std::string> words{"accuracy"};
    words.insert(words.end(), more.begin(), more.end());
    SCOPED_TRACE(::testing::PrintToString(words));
    expect_refusal(talus(words), {code}, {named});
  };
  refused({}, usage, "DATABASE");
  refused({"none.talus"}, failed, "none.talus");
  refused({"notes.txt"}, damaged, "notes.txt");
  refused({"a.talus", "--bbox=1,2,3,4"}, usage, "nothing in common");
  refused({"a.talus", "--bbox=1,2,3"}, usage, "--bbox");
  refused({"a.talus", "--bbox=450615,5199085,450870,5199370"}, usage, "no three neighbouring valid samples");
  refused({"a.talus", "--against", "elsewhere.tif"}, usage, "elsewhere.tif");
  refused({"a.talus", "--against", "smaller.tif"}, usage, "smaller.tif");
  refused({"a.talus", "--against", "another_crs.tif"}, usage, "another CRS");
  refused({"a.talus", "--against", "no_crs.tif"}, usage, "another CRS");
  refused({"a.talus", "--against", "other_heights.tif"}, usage, "column 100, row 75");
  refused({"a.talus", "--against", "other_voids.tif"}, usage, "no data");
  refused({"a.talus", "--against", "none.tif"}, failed, "none.tif");
  for (const char* bad : {"", ",", "1,", "1,,2", "-1", "nan", "inf", "1,nan", "1;2", "two"})
    refused({"a.talus", "--tolerances", bad}, usage, "--tolerances");
  for (const char* bad : {"", "10", "0ms", "-1s", "nans", "infs", "ms"})
    refused({"a.talus", "--time", bad}, usage, "--time");
  refused({"a.talus", "--window", "16"}, usage, "--window");
  refused({"a.talus", "--map", "5"}, usage, "--output");
  refused({"a.talus", "--map", "-5", "-o", "r.svg"}, usage, "--map");
  refused({"a.talus", "-o", "r.png"}, usage, "r.png");
  refused({"a.talus", "-o", "r"}, usage, "--output r");
  refused({"a.talus", "-o", ""}, usage, "file name");
  refused({"a.talus", "-o", "nowhere/r.svg"}, failed, "nowhere");
  refused({"a.talus", "-o", "folder.svg"}, failed, "folder.svg");
  EXPECT_TRUE(before == contents());
}

TEST_F(Accuracy, OfASingleLineThereIsNothingToMeasure) {
  raster = fit(fractal(90, 1, 4, 600), SampleType::int16);
  make_database("line.talus");
  expect_refusal(talus({"accuracy", "line.talus"}), {usage}, {"one sample wide or high"});
}

TEST_F(Accuracy, AFullDiskStopsAReportAndNothingIsLeft) {
  std::filesystem::create_directories(folder / "small");
  const std::string mount = "mount -t tmpfs -o size=8k none small";
  RunOptions options;
  options.folder = folder.path().string();
  if (run_program({"unshare", "-rm", "sh", "-c", mount}, options).exit_code != 0)
    GTEST_SKIP() << "a small file system cannot be mounted here";
  const std::string command = std::string(TALUS_PROGRAM) + " accuracy a.talus --tolerances 10 -o small/r.svg";
  const Outcome outcome =
      run_program({"unshare", "-rm", "sh", "-c", mount + "; " + command + "; code=$?; ls small; exit $code"}, options);
  EXPECT_EQ(outcome.exit_code, disk_full) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("r.svg"));
}

}  // namespace
}  // namespace talus::support
