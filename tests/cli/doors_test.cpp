// Inputs without end, outputs and logs that cannot be written, inputs that an output would replace.

#include <chrono>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Doors : public Command {
 protected:
  void SetUp() override {
    options.crs = "EPSG:32632";
    options.geotransform = {450000, 30, 0, 5200000, 0, -30};
    make_raster("a.tif", options);
    ASSERT_EQ(talus({"ingest", "a.tif", "a.talus"}).exit_code, done);
    ASSERT_EQ(talus({"query", "a.talus", "--tolerance", "30", "-o", "a.rqt"}).exit_code, done);
    write_bytes(folder / "points.txt", "450015 5199985\n451000 5199001\n");
  }
  /// A line of the shell in the folder; $talus is the program.
  Outcome shell(const std::string& line, std::chrono::seconds at_most = std::chrono::seconds(60)) const {
    RunOptions run;
    run.folder = folder.path().string();
    run.at_most = at_most;
    return run_program({"/bin/sh", "-c", "talus='" TALUS_PROGRAM "'; " + line}, run);
  }
  /// The same with so many kilobytes of addresses. Sanitizers need more than any limit for their shadows.
  Outcome shell_within(int kilobytes, const std::string& line,
                       std::chrono::seconds at_most = std::chrono::seconds(60)) const {
    const std::string limit = kIsSanitized ? "" : "ulimit -v " + std::to_string(kilobytes) + "; ";
    return shell(limit + line, at_most);
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, bytes] : contents()) all.push_back(name);
    return all;
  }
  RasterOptions options;
};

// One of each command, all of which succeed, and one that fails with exit code 2.
const std::vector<std::string> kCommands{"--version",
                                         "--help",
                                         "query --help",
                                         "info a.talus",
                                         "info a.rqt --json",
                                         "query a.talus --tolerance 5",
                                         "query a.talus --tolerance 5 -o out.ply --json",
                                         "query a.talus --from 30 --tolerance 5",
                                         "height a.talus 450015 5199985",
                                         "height a.talus - < points.txt",
                                         "profile a.talus --line=450015,5199985,451000,5199001 --tolerance 5",
                                         "merge a.rqt -o out.ply",
                                         "convert a.rqt -o out.ply",
                                         "convert - -o out.ply < a.rqt",
                                         "accuracy a.talus --tolerances 20",
                                         "verify a.talus",
                                         "ingest a.tif b.talus --overwrite",
                                         "ingest a.tif c.talus --dry-run"};

TEST_F(Doors, AFullStandardOutputIsADiskThatIsFull) {
  for (const std::string& command : kCommands) {
    const Outcome outcome = shell("$talus " + command + " > /dev/full");
    EXPECT_EQ(outcome.exit_code, disk_full) << command << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("standard output")) << command;
  }
}

TEST_F(Doors, AClosedStandardOutputFails) {
  for (const std::string& command : kCommands) {
    const Outcome outcome = shell("$talus " + command + " >&-");
    EXPECT_EQ(outcome.exit_code, failed) << command << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("standard output")) << command;
  }
  for (const auto& [name, bytes] : contents()) EXPECT_THAT(bytes, Not(HasSubstr("talus: "))) << name;
}

TEST_F(Doors, AnErrorLogThatCannotBeWrittenChangesNoExitCode) {
  const std::vector<std::pair<std::string, int>> failing{{"info none.talus", failed},
                                                         {"info a.tif", damaged},
                                                         {"info points.txt --json", damaged},
                                                         {"nonsense", usage},
                                                         {"query a.talus --tolerance west", usage},
                                                         {"query a.talus --tolerance 1 --points none.txt", failed},
                                                         {"height a.talus north 5", usage},
                                                         {"merge a.rqt a.rqt -o out.rqt", usage},
                                                         {"convert - -o out.ply < points.txt", damaged},
                                                         {"accuracy a.talus --time soon", usage},
                                                         {"verify a.tif", damaged},
                                                         {"ingest none.tif b.talus --progress json", failed},
                                                         {"info a.talus > /dev/full", disk_full}};
  for (const char* log : {"2> /dev/full", "2>&-"}) {
    for (const std::string& command : kCommands) {
      const Outcome outcome = shell("$talus " + command + " " + log);
      EXPECT_EQ(outcome.exit_code, done) << command << " " << log << " signal " << outcome.signal;
      EXPECT_NE(outcome.out, "") << command;
    }
    for (const auto& [command, exit_code] : failing)
      EXPECT_EQ(shell("$talus " + command + " " + log).exit_code, exit_code) << command << " " << log;
    EXPECT_EQ(shell(std::string("$talus ingest a.tif b.talus --overwrite --progress json ") + log).exit_code, done)
        << log;
  }
  for (const auto& [name, bytes] : contents()) EXPECT_THAT(bytes, Not(HasSubstr("talus: "))) << name;
}

TEST_F(Doors, AClosedStandardInputIsNoOpenFile) {
  for (const std::string& command : kCommands) {
    if (command.find('<') != std::string::npos) continue;
    EXPECT_EQ(shell("$talus " + command + " <&-").exit_code, done) << command;
  }
  EXPECT_EQ(shell("$talus height a.talus - <&-").exit_code, failed);
  EXPECT_EQ(shell("$talus convert - -o out.ply <&-").exit_code, failed);
  const Outcome all = shell("$talus query a.talus --tolerance 5 -o whole.ply <&- >&- 2>&-");
  EXPECT_EQ(all.exit_code, failed);
  EXPECT_EQ(shell("$talus ingest a.tif b.talus --overwrite <&- >&- 2>&-").exit_code, failed);
  EXPECT_EQ(talus({"verify", "b.talus", "--against", "a.tif"}).exit_code, done);
  EXPECT_EQ(talus({"query", "a.talus", "--tolerance", "5", "-o", "again.ply"}).exit_code, done);
  EXPECT_EQ(bytes_of(folder / "whole.ply"), bytes_of(folder / "again.ply"));
}

TEST_F(Doors, APipeThatNobodyReadsIsAFailureAndNoSignal) {
  const Outcome outcome = shell("{ $talus height a.talus - < many.txt; echo $? > code; } | head -c 1 > /dev/null");
  EXPECT_EQ(outcome.exit_code, done);
  std::string many;
  for (int i = 0; i < 200000; ++i) many += "450015 5199985\n";
  write_bytes(folder / "many.txt", many);
  shell("{ $talus height a.talus - < many.txt; echo $? > code; } | head -c 1 > /dev/null");
  EXPECT_EQ(bytes_of(folder / "code"), "1\n");
  shell(
      "{ $talus ingest a.tif b.talus --overwrite --progress json; echo $? > code; } 2>&1 > /dev/null | head -c 1 > "
      "/dev/null");
  EXPECT_EQ(bytes_of(folder / "code"), "0\n");
}

TEST_F(Doors, ALimitOnFileSizesLeavesNoTemporaryFile) {
  const auto before = names();
  for (const char* output : {"big.ply", "big.obj", "big.glb", "big.tif", "big.png", "big.rqt"}) {
    const Outcome outcome = shell(std::string("ulimit -f 4; $talus query a.talus --tolerance 0 -o ") + output);
    EXPECT_EQ(outcome.signal, 0) << output;
    EXPECT_EQ(outcome.exit_code, failed) << output << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(output));
    EXPECT_EQ(names(), before) << output;
  }
  EXPECT_THAT(shell("ulimit -f 4; $talus query a.talus --tolerance 0 -o big.ply").err, HasSubstr("ulimit -f"));
  EXPECT_EQ(
      shell("ulimit -f 4; $talus profile a.talus --line=450015,5199985,452600,5198000,450015,5198000,452600,5199985 "
            "--tolerance 0 -o big.csv")
          .exit_code,
      failed);
  EXPECT_EQ(shell("ulimit -f 4; $talus accuracy a.talus --tolerances 5,20 -o big.html").exit_code, failed);
  EXPECT_EQ(names(), before);
  const Outcome ingest = shell("ulimit -f 40; $talus ingest a.tif b.talus");
  EXPECT_EQ(ingest.signal, 0);
  EXPECT_NE(ingest.exit_code, done);
  EXPECT_THAT(ingest.err, HasSubstr("b.talus"));
}

// ---- outputs that are inputs ----------------------------------------------------------------------------------

TEST_F(Doors, AnInputIsNeverReplacedByAnOutput) {
  ASSERT_EQ(talus({"query", "a.talus", "--tolerance", "10", "--bbox=450000,5197000,451455,5200000", "-o", "west.rqt"})
                .exit_code,
            done);
  ASSERT_EQ(talus({"query", "a.talus", "--from", "30", "--tolerance", "10", "-o", "more.rqt"}).exit_code, done);
  write_bytes(folder / "points.obj", "450015 5199985\n451000 5199001\n");
  write_bytes(folder / "lines.ply", "450015 5199985\n451000 5199001\n");
  RasterOptions tolerances = options;
  tolerances.type = SampleType::float32;
  write_raster(raster, folder / "tolerances.tif", tolerances);
  for (const char* name :
       {"west.rqt", "points.obj", "lines.ply", "tolerances.tif", "a.rqt", "more.rqt", "a.talus", "a.tif"}) {
    std::string hard = std::string("hard-") + name, soft = std::string("soft-") + name;
    std::filesystem::create_hard_link(folder / name, folder / hard);
    std::filesystem::create_symlink(name, folder / soft);
  }
  std::filesystem::create_hard_link(folder / "a.talus", folder / "hard.ply");
  std::filesystem::create_symlink("a.talus", folder / "soft.csv");
  std::filesystem::create_symlink("a.tif", folder / "soft.svg");
  const auto before = contents();
  const std::vector<std::string> ask{"query", "a.talus", "--tolerance", "20"};
  const auto refused = [&](std::vector<std::string> arguments, const std::string& output) {
    arguments.insert(arguments.end(), {"-o", output});
    const Outcome outcome = talus(arguments);
    expect_refusal(outcome, {usage}, {output, "name another file"});
    EXPECT_TRUE(contents() == before) << output;
  };
  for (const std::string link : {"", "hard-", "soft-"}) {
    refused({"query", "a.talus", "--tolerance", "20", "--bbox=451455,5197000,453000,5200000", "--match", "west.rqt"},
            link + "west.rqt");
    refused({"query", "a.talus", "--tolerance", "20", "--points", "points.obj"}, link + "points.obj");
    refused({"query", "a.talus", "--tolerance", "20", "--lines", "lines.ply"}, link + "lines.ply");
    refused({"query", "a.talus", "--tolerance-raster", "tolerances.tif"}, link + "tolerances.tif");
    refused({"merge", "a.rqt", "more.rqt"}, link + "a.rqt");
    refused({"merge", "a.rqt", "more.rqt"}, link + "more.rqt");
    refused({"convert", "a.rqt"}, link + "a.rqt");
  }
  refused({"convert", "soft-a.rqt"}, "hard-a.rqt");
  refused({"query", "a.talus", "--tolerance", "20"}, "hard.ply");
  refused({"profile", "a.talus", "--line=450015,5199985,451000,5199001", "--tolerance", "5"}, "soft.csv");
  refused({"accuracy", "a.talus", "--against", "a.tif"}, "soft.svg");
}

// ---- inputs without end ---------------------------------------------------------------------------------------

TEST_F(Doors, DevicesAndPipesAreRefusedWhereverAFileIsRead) {
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder / "pipe.rqt").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder / "pipe.tif").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", folder / "zero.rqt");
  const auto refused = [&](const std::string& command, const std::string& named) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = shell_within(4000000, "$talus " + command, std::chrono::seconds(20));
    EXPECT_EQ(outcome.signal, 0) << command;
    EXPECT_THAT((std::vector<int>{failed, usage, damaged}), ::testing::Contains(outcome.exit_code))
        << command << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(named)) << command;
    EXPECT_THAT(outcome.err, Not(HasSubstr("out of memory"))) << command;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << command;
  };
  for (const std::string endless : {"/dev/zero", "pipe"}) {
    refused("ingest @" + endless + " b.talus", endless);
    refused("ingest " + endless + " b.talus", endless);
    refused("ingest a.tif b.talus --grid-of " + endless, endless);
    refused("query a.talus --tolerance 5 --points " + endless, endless);
    refused("query a.talus --tolerance 5 --lines " + endless, endless);
    refused("query a.talus --tolerance-raster " + endless, endless);
    refused("query " + endless + " --tolerance 5", endless);
    refused("info " + endless, endless);
    refused("verify " + endless, endless);
    refused("verify a.talus --against " + endless, endless);
    refused("verify a.talus --against @" + endless, endless);
  }
  for (const std::string stream : {"pipe.rqt", "zero.rqt"}) {
    refused("info " + stream, stream);
    refused("merge a.rqt " + stream + " -o out.ply", stream);
    refused("convert " + stream + " -o out.ply", stream);
    refused("query a.talus --tolerance 5 --match " + stream, stream);
  }
  refused("ingest pipe.tif b.talus", "pipe.tif");
  refused("height a.talus - < /dev/zero", "standard input, line 1");
  refused("convert - -o out.ply < /dev/zero", "not the stream");
  for (const std::string side :
       {".tif.aux.xml", ".tif.msk", ".tif.ovr", ".hdr", ".prj", ".tfw", ".tifw", ".wld", ".aux", ".IMD"}) {
    ASSERT_EQ(::mkfifo((folder / ("a" + side)).c_str(), 0600), 0);
    refused("ingest a.tif b.talus", "a" + side);
    std::filesystem::remove(folder / ("a" + side));
  }
}

TEST_F(Doors, LinesThatAreTooLongAreNamed) {
  write_bytes(folder / "long.txt", "450015 5199985\n" + std::string(5000, ' ') + "450015 5199985\n");
  expect_refusal(talus({"query", "a.talus", "--tolerance", "5", "--points", "long.txt"}), {usage},
                 {"long.txt, line 2", "4096 bytes"});
  write_bytes(folder / "list.txt", "a.tif\n" + std::string(70000, 'x') + "\n");
  expect_refusal(talus({"ingest", "@list.txt", "b.talus"}), {usage}, {"list.txt, line 2", "65536 bytes"});
  // A file of zeros that takes no room, as large as files may be.
  std::ofstream(folder / "zeros.txt") << "";
  std::filesystem::resize_file(folder / "zeros.txt", std::uintmax_t{1} << 40);
  for (const char* command : {"query a.talus --tolerance 5 --points zeros.txt", "ingest @zeros.txt b.talus"}) {
    const Outcome outcome = shell_within(4000000, std::string("$talus ") + command, std::chrono::seconds(20));
    EXPECT_EQ(outcome.exit_code, usage) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("zeros.txt, line 1"));
  }
  std::filesystem::rename(folder / "zeros.txt", folder / "zeros.rqt");
  EXPECT_EQ(shell_within(4000000, "$talus info zeros.rqt", std::chrono::seconds(20)).exit_code, damaged);
  EXPECT_EQ(shell("$talus height a.talus - < points.txt").exit_code, done);
  EXPECT_EQ(shell("cat points.txt | $talus height a.talus -").exit_code, done) << "a pipe as standard input";
  EXPECT_EQ(shell("cat a.rqt | $talus convert - -o out.ply").exit_code, done);
}

TEST_F(Doors, ALineToAndFroTakesNoMoreThanTheRaster) {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += i % 2 == 0 ? "450015 5199985\n" : "452685 5197915\n";
  write_bytes(folder / "zigzag.txt", text);
  const Outcome outcome =
      shell_within(1000000, "$talus query a.talus --tolerance 1000 --lines zigzag.txt -o zigzag.rqt");
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  ASSERT_EQ(talus({"query", "a.talus", "--tolerance", "1000", "--line=450015,5199985,452685,5197915", "-o", "once.rqt"})
                .exit_code,
            done);
  EXPECT_EQ(bytes_of(folder / "zigzag.rqt"), bytes_of(folder / "once.rqt"));
}

}  // namespace
}  // namespace talus::support
