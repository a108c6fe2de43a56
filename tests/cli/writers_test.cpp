// Updates that explain themselves, and writers that meet.

#include <csignal>
#include <numeric>

#include <sys/stat.h>
#include <unistd.h>

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"
#include "tests/support/random.hpp"
#include "tests/support/stored_pages.hpp"

namespace talus::support {
namespace {

namespace fs = std::filesystem;

class Writers : public Command {
 protected:
  void SetUp() override { raster = fit(fractal(2300, 1500, 6, 2000), SampleType::int16); }

  /// A part of a terrain as a file in its place.
  void make_part(const Terrain& whole, int col, int row, int cols, int rows, const std::string& name) const {
    RasterOptions options;
    options.geotransform = {static_cast<double>(col), 1, 0, -static_cast<double>(row), 0, -1};
    write_raster(crop(whole, col, row, cols, rows), folder / name, options);
  }
  Terrain higher(double by) const {
    Terrain changed = raster;
    for (double& h : changed.values) h += by;
    return fit(changed, SampleType::int16);
  }
  void make(const std::string& database) const {
    make_raster("base.tif");
    const Outcome outcome = talus({"ingest", "base.tif", database, "--overwrite"});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  }
  /// All samples of a database, row by row, as the library reads them.
  std::vector<double> samples_of(const std::string& database) const {
    const Snapshot now = Database::open(folder / database).snapshot();
    return now.samples(now.description().extent).values;
  }
  std::size_t at(int col, int row) const {
    return static_cast<std::size_t>(row) * 2300 + static_cast<std::size_t>(col);
  }
  unsigned mode_of(const std::string& name) const {
    struct stat about {};
    EXPECT_EQ(::lstat((folder / name).c_str(), &about), 0);
    return about.st_mode & 07777u;
  }
};

// ---- what an update says ---------------------------------------------------------------------------------

TEST_F(Writers, AnUpdateSaysWhatItChangesAndADryRunSaysItBefore) {
  make("a.talus");
  Terrain changed = raster;
  for (int row = 300; row < 340; ++row) {
    for (int col = 700; col < 760; ++col) changed.values[at(col, row)] += 7;
  }
  changed.values[at(733, 320)] -= 500;
  make_part(fit(changed, SampleType::int16), 690, 290, 100, 100, "b.tif");
  const std::string before = bytes_of(folder / "a.talus");
  const Outcome dry = talus({"ingest", "--update", "--dry-run", "--json", "b.tif", "a.talus"});
  ASSERT_EQ(dry.exit_code, done) << dry.err;
  EXPECT_TRUE(bytes_of(folder / "a.talus") == before);
  EXPECT_FALSE(fs::exists(folder / "a.talus.part"));
  const Outcome real = talus({"ingest", "--update", "--json", "b.tif", "a.talus"});
  ASSERT_EQ(real.exit_code, done) << real.err;
  for (const auto& json : {json_of(dry), json_of(real)}) {
    EXPECT_EQ(json["changed_samples"], 60 * 40);
    EXPECT_EQ(json["filled_samples"], 0);
    EXPECT_EQ(json["largest_difference"], 493.0);
    EXPECT_EQ(json["largest_at"], nlohmann::json({733.5, -320.5}));
    EXPECT_EQ(json["changed_region"], nlohmann::json({700.5, -339.5, 759.5, -300.5}));
    EXPECT_EQ(json["tiles"], 1);
  }
  EXPECT_GT(json_of(dry)["estimated_bytes"], before.size());
  EXPECT_GE(json_of(dry)["estimated_seconds"], 0.0);
  EXPECT_LE(fs::file_size(folder / "a.talus"), 1.2 * json_of(dry)["estimated_bytes"].get<double>());
  const Outcome words = talus({"ingest", "--update", "--dry-run", "base.tif", "a.talus"});
  EXPECT_EQ(words.exit_code, done);
  EXPECT_THAT(words.out, ::testing::HasSubstr("493"));
  EXPECT_THAT(words.out, ::testing::HasSubstr("733.5, -320.5"));
}

TEST_F(Writers, AnUpdateWithIdenticalDataDoesNothingAndSaysSo) {
  make("a.talus");
  const std::string before = bytes_of(folder / "a.talus");
  make_part(raster, 100, 50, 900, 1200, "b.tif");
  Terrain voids = crop(raster, 0, 0, 200, 200);
  for (std::size_t i = 0; i < voids.valid.size(); ++i) voids.valid[i] = i % 3 == 0 ? 1 : 0;
  write_raster(voids, folder / "c.tif");  // what is void covers nothing
  for (const std::vector<std::string>& inputs :
       {std::vector<std::string>{"base.tif"}, {"b.tif"}, {"c.tif"}, {"b.tif", "c.tif", "base.tif"}}) {
    std::vector<std::string> arguments{"ingest", "--update"};
    arguments.insert(arguments.end(), inputs.begin(), inputs.end());
    arguments.emplace_back("a.talus");
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    EXPECT_THAT(outcome.out, ::testing::HasSubstr("nothing"));
    EXPECT_TRUE(bytes_of(folder / "a.talus") == before);
    EXPECT_FALSE(fs::exists(folder / "a.talus.part"));
  }
  EXPECT_EQ(json_of(talus({"info", "--json", "a.talus"}))["generation"], 0);
}

TEST_F(Writers, AnUpdateComputesOnlyTilesWhoseSamplesDiffer) {
  make("a.talus");
  raster.values[at(500, 500)] += 3;
  make_raster("whole.tif");
  const Outcome outcome = talus({"ingest", "--update", "--json", "whole.tif", "a.talus"});
  EXPECT_EQ(json_of(outcome)["tiles"], 1);
  EXPECT_EQ(json_of(outcome)["changed_samples"], 1);
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "whole.tif"}).exit_code, done);
}

TEST_F(Writers, InfoListsVertexCountsOnce) {
  make("a.talus");
  const auto first = json_of(talus({"info", "--json", "a.talus"}))["vertices_above"];
  for (const int by : {3, 4}) {
    make_part(higher(by), 20, 30, 50, 50, "b.tif");
    ASSERT_EQ(talus({"ingest", "--update", "b.tif", "a.talus"}).exit_code, done);
  }
  make_part(raster, 20, 30, 50, 50, "b.tif");
  ASSERT_EQ(talus({"ingest", "--update", "b.tif", "a.talus"}).exit_code, done);
  EXPECT_EQ(json_of(talus({"info", "--json", "a.talus"}))["vertices_above"], first)
      << "the heights are the first again";
}

TEST_F(Writers, RatesAfterResumeCountWhatWasDoneNow) {
  make_raster("base.tif");
  RunOptions options;
  options.folder = folder.path().string();
  const std::string start =
      "rm -f said; " + std::string(TALUS_PROGRAM) +
      " ingest base.tif a.talus --threads 1 --memory 300MiB --progress=json 2>said & "
      "while ! grep -q '\"samples\":[1-9]' said 2>/dev/null; do sleep 0.005; done; kill -INT $!; wait $!";
  for (int again = 0; again < 20 && run_program({"sh", "-c", start}, options).exit_code != 130; ++again)
    fs::remove(folder / "a.talus");
  ASSERT_TRUE(fs::exists(folder / "a.talus.part"));
  const auto json = json_of(talus({"ingest", "base.tif", "a.talus", "--resume", "--json"}));
  EXPECT_GT(json["samples_now"], 0);
  EXPECT_LT(json["samples_now"], 2300 * 1500);
}

// ---- the file itself -------------------------------------------------------------------------------------

TEST_F(Writers, CompactDropsUnusedPagesAndNothingElse) {
  make("a.talus");
  for (const int by : {3, 4, 5, 6}) {
    make_part(higher(by), 0, 0, 2000, 1400, "b.tif");
    ASSERT_EQ(talus({"ingest", "--update", "b.tif", "a.talus"}).exit_code, done);
  }
  const auto before = pages_of(folder / "a.talus");
  const auto info = json_of(talus({"info", "--json", "a.talus"}));
  const auto size = fs::file_size(folder / "a.talus");
  const Outcome outcome = talus({"compact", "a.talus", "--json"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_LT(fs::file_size(folder / "a.talus"), size / 5 * 4);
  EXPECT_EQ(json_of(outcome)["bytes_before"], size);
  EXPECT_EQ(json_of(outcome)["bytes"], fs::file_size(folder / "a.talus"));
  EXPECT_TRUE(pages_of(folder / "a.talus") == before);
  auto after = json_of(talus({"info", "--json", "a.talus"}));
  after["file_bytes"] = info["file_bytes"];
  EXPECT_EQ(after, info) << "generation, sources and all";
  EXPECT_EQ(talus({"verify", "a.talus"}).exit_code, done);
  const std::string once = bytes_of(folder / "a.talus");
  EXPECT_EQ(talus({"compact", "a.talus"}).exit_code, done);
  EXPECT_TRUE(bytes_of(folder / "a.talus") == once) << "nothing is left to gain";
  make_part(higher(9), 0, 0, 300, 300, "b.tif");
  EXPECT_EQ(talus({"ingest", "--update", "b.tif", "a.talus"}).exit_code, done) << "it can be updated again";
  EXPECT_EQ(talus({"verify", "a.talus"}).exit_code, done);
}

TEST_F(Writers, CompactRefusesWhatIsDamagedOrNoDatabase) {
  make("a.talus");
  std::string bytes = bytes_of(folder / "a.talus");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_bytes(folder / "bad.talus", bytes);
  expect_refusal(talus({"compact", "bad.talus"}), {damaged}, {"bad.talus"});
  EXPECT_TRUE(bytes_of(folder / "bad.talus") == bytes);
  expect_refusal(talus({"compact", "base.tif"}), {damaged}, {"base.tif"});
  expect_refusal(talus({"compact", "none.talus"}), {failed}, {"none.talus"});
  EXPECT_FALSE(fs::exists(folder / "none.talus.part"));
}

TEST_F(Writers, ModeAndOwnerAreKept) {
  make("a.talus");
  make_part(higher(2), 0, 0, 300, 300, "b.tif");
  for (const unsigned mode : {0640u, 0600u, 0664u}) {
    ASSERT_EQ(::chmod((folder / "a.talus").c_str(), mode), 0);
    const bool is_given_away = ::geteuid() == 0 && ::chown((folder / "a.talus").c_str(), 1234, 5678) == 0;
    ASSERT_EQ(::chmod((folder / "a.talus").c_str(), mode), 0);
    for (const std::vector<std::string>& command : {std::vector<std::string>{"ingest", "--update", "b.tif", "a.talus"},
                                                    {"compact", "a.talus"},
                                                    {"ingest", "--overwrite", "base.tif", "a.talus"}}) {
      EXPECT_EQ(talus(command).exit_code, done);
      EXPECT_EQ(mode_of("a.talus"), mode) << command[1];
      struct stat about {};
      ASSERT_EQ(::stat((folder / "a.talus").c_str(), &about), 0);
      if (is_given_away) {
        EXPECT_EQ(about.st_uid, 1234u);
        EXPECT_EQ(about.st_gid, 5678u);
      }
    }
  }
}

TEST_F(Writers, AWriteProtectedDatabaseIsLeftAlone) {
  make("a.talus");
  make_part(higher(2), 0, 0, 300, 300, "b.tif");
  for (const unsigned mode : {0444u, 0400u, 0555u}) {
    ASSERT_EQ(::chmod((folder / "a.talus").c_str(), mode), 0);
    const auto before = contents();
    for (const std::vector<std::string>& command : {std::vector<std::string>{"ingest", "--update", "b.tif", "a.talus"},
                                                    {"compact", "a.talus"},
                                                    {"ingest", "--update", "--dry-run", "b.tif", "a.talus"},
                                                    {"ingest", "--overwrite", "base.tif", "a.talus"},
                                                    {"ingest", "--overwrite", "--dry-run", "base.tif", "a.talus"}}) {
      expect_refusal(talus(command), {failed}, {"a.talus", "write-protected"});
    }
    EXPECT_EQ(contents(), before);
  }
}

TEST_F(Writers, ASymbolicLinkStaysAndItsTargetIsReplaced) {
  fs::create_directory(folder / "store");
  make("store/real.talus");
  make_part(higher(2), 0, 0, 300, 300, "b.tif");
  fs::create_symlink("store/real.talus", folder / "link.talus");
  fs::create_symlink("link.talus", folder / "second.talus");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"ingest", "--update", "b.tif", "second.talus"},
        {"ingest", "--overwrite", "b.tif", "second.talus"},
        {"ingest", "--overwrite", "base.tif", "second.talus"},
        {"compact", "second.talus"}}) {
    EXPECT_EQ(talus(command).exit_code, done) << command[1];
    EXPECT_TRUE(fs::is_symlink(folder / "second.talus") && fs::is_symlink(folder / "link.talus"));
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(folder / "store" / "real.talus")));
    const double first = samples_of("store/real.talus").front();
    EXPECT_EQ(first, raster.values.front() + (command.size() > 2 && command[2] == "b.tif" ? 2 : 0));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "store"), {}), 1);
  }
  fs::create_symlink("store/new.talus", folder / "dangling.talus");
  EXPECT_EQ(talus({"ingest", "b.tif", "dangling.talus"}).exit_code, done);
  EXPECT_TRUE(fs::is_symlink(folder / "dangling.talus"));
  EXPECT_TRUE(fs::exists(folder / "store" / "new.talus"));
  fs::create_symlink("circle.talus", folder / "circle.talus");
  expect_refusal(talus({"ingest", "b.tif", "circle.talus"}), {failed, usage}, {"circle.talus"});
}

TEST_F(Writers, EveryDryRunLooksAtTheTarget) {
  make("a.talus");
  make_part(higher(2), 0, 0, 300, 300, "b.tif");
  expect_refusal(talus({"ingest", "--dry-run", "b.tif", "none/c.talus"}), {failed}, {"none"});
  expect_refusal(talus({"ingest", "--update", "--dry-run", "b.tif", "none.talus"}), {failed}, {"none.talus"});
  expect_refusal(talus({"ingest", "--dry-run", "b.tif", "."}), {usage}, {"folder"});
  const std::string mount = "mkdir -p small && mount -t tmpfs -o size=300k none small";
  RunOptions options;
  options.folder = folder.path().string();
  if (run_program({"unshare", "-rm", "sh", "-c", mount}, options).exit_code != 0)
    GTEST_SKIP() << "a small file system cannot be mounted here";
  const Outcome full = run_program(
      {"unshare", "-rm", "sh", "-c", mount + "; " + TALUS_PROGRAM + " ingest --dry-run base.tif small/c.talus"},
      options);
  expect_refusal(full, {disk_full}, {"c.talus", "MB"});
  const Outcome closed = run_program(
      {"unshare", "-rm", "sh", "-c", mount + " -r; " + TALUS_PROGRAM + " ingest --dry-run base.tif small/c.talus"},
      options);
  expect_refusal(closed, {failed}, {"c.talus"});
}

// ---- writers that meet, and leftovers ----------------------------------------------------------------------

TEST_F(Writers, TwoUpdatesAtOnceLoseNothing) {
  make_part(higher(100), 0, 0, 2000, 900, "west.tif");
  fs::create_directory(folder /
                       "middle");  // many files: looking at them takes a while, which is when things went wrong
  const Terrain by_200 = higher(200);
  for (int y = 0; y < 15; ++y) {
    for (int x = 0; x < 15; ++x)
      make_part(by_200, 600 + 20 * x, 300 + 20 * y, 20, 20, "middle/" + std::to_string(15 * y + x) + ".tif");
  }
  make("whole.talus");
  const auto over = [&](std::vector<double> samples, int col, int row, int cols, int rows, double by) {
    for (int y = row; y < row + rows; ++y) {
      for (int x = col; x < col + cols; ++x) samples[at(x, y)] = raster.values[at(x, y)] + by;
    }
    return samples;
  };
  Random random(5);
  RunOptions options;
  options.folder = folder.path().string();
  const std::string program = TALUS_PROGRAM;
  const std::string west_update = program + " ingest --update west.tif a.talus --json >/dev/null 2>said1";
  const std::string middle_update = program + " ingest --update middle a.talus --json >/dev/null 2>said2";
  constexpr int kRuns = 24;
  int both = 0;
  for (int i = 0; i < kRuns; ++i) {
    fs::copy_file(folder / "whole.talus", folder / "a.talus", fs::copy_options::overwrite_existing);
    // One is held wherever it is, for as long as the other one takes; or they simply meet.
    const std::string when = std::to_string(1000 + random.between(10, 20 + 30 * i)).substr(1);
    const std::string held = middle_update + " & held=$!; sleep 0." + when + "; kill -STOP $held; " + west_update +
                             "; west=$?; kill -CONT $held; wait $held; echo $?; echo $west";
    const std::string meet =
        west_update + " & west=$!; sleep 0." + when + "; " + middle_update + "; echo $?; wait $west; echo $?";
    const Outcome outcome = run_program({"sh", "-c", i % 4 != 0 ? held : meet}, options);
    const bool middle = outcome.out.starts_with("0\n"), west = outcome.out.ends_with("\n0\n");
    EXPECT_TRUE(middle || west) << outcome.out << bytes_of(folder / "said1") << bytes_of(folder / "said2");
    both += middle && west ? 1 : 0;
    const auto now = samples_of("a.talus");
    const auto base = raster.values;
    std::vector<std::vector<double>> allowed;
    if (west && !middle) allowed = {over(base, 0, 0, 2000, 900, 100)};
    if (middle && !west) allowed = {over(base, 600, 300, 300, 300, 200)};
    if (middle && west) {
      allowed = {over(over(base, 0, 0, 2000, 900, 100), 600, 300, 300, 300, 200),
                 over(over(base, 600, 300, 300, 300, 200), 0, 0, 2000, 900, 100)};
    }
    EXPECT_TRUE(std::find(allowed.begin(), allowed.end(), now) != allowed.end()) << "run " << i << ": " << outcome.out;
    if (both > 0 || i % 4 == 0) {
      EXPECT_EQ(talus({"verify", "a.talus"}).exit_code, done) << "run " << i;
    }
    EXPECT_EQ(json_of(talus({"info", "--json", "a.talus"}))["sources"].size(),
              1u + (west ? 1 : 0) + (middle ? 225 : 0));
    EXPECT_FALSE(fs::exists(folder / "a.talus.part"));
  }
  std::printf("%d of %d pairs were both done\n", both, kRuns);
}

TEST_F(Writers, APartFileOfAKilledUpdateIsTakenForNothingElse) {
  make("a.talus");
  make_part(higher(100), 0, 0, 2000, 1200, "b.tif");
  const auto fresh = pages_of(folder / "a.talus");
  const std::string before = bytes_of(folder / "a.talus");
  RunOptions options;
  options.folder = folder.path().string();
  int left = 0, refused = 0;
  for (int i = 0; i < 12; ++i) {
    const std::string start = "rm -f said; " + std::string(TALUS_PROGRAM) +
                              " ingest --update b.tif a.talus --threads 1 --progress=json 2>said & "
                              "while ! grep -q '\"samples\":[1-9]' said 2>/dev/null; do sleep 0.002; done; sleep 0.0" +
                              std::to_string(i % 6) + "; kill -KILL $!; wait $!";
    run_program({"sh", "-c", start}, options);
    if (bytes_of(folder / "a.talus") != before) {  // it was done before it was killed
      write_bytes(folder / "a.talus", before);
      continue;
    }
    if (!fs::exists(folder / "a.talus.part")) continue;
    ++left;
    const Outcome outcome = talus({"ingest", "--overwrite", "--resume", "base.tif", "a.talus"});
    EXPECT_EQ(outcome.signal, 0);
    if (outcome.exit_code == done) {
      EXPECT_TRUE(pages_of(folder / "a.talus") == fresh);
    } else {
      ++refused;
      EXPECT_THAT(outcome.err, ::testing::HasSubstr("update"));
      EXPECT_TRUE(bytes_of(folder / "a.talus") == before);
      // The same update, with or without --resume, is simply done.
      const Outcome again = i % 2 == 0 ? talus({"ingest", "--update", "b.tif", "a.talus"})
                                       : talus({"ingest", "--update", "--resume", "b.tif", "a.talus"});
      EXPECT_EQ(again.exit_code, done) << again.err;
      EXPECT_EQ(samples_of("a.talus").front(), raster.values.front() + 100);
      EXPECT_EQ(talus({"verify", "a.talus"}).exit_code, done);
    }
    write_bytes(folder / "a.talus", before);
    fs::remove(folder / "a.talus.part");
  }
  EXPECT_GT(left, 0);
  EXPECT_GT(refused, 0);
}

TEST_F(Writers, ADamagedPartFileIsNeverResumedToAWrongDatabase) {
  make("whole.talus");
  const auto whole = pages_of(folder / "whole.talus");
  RunOptions options;
  options.folder = folder.path().string();
  const std::string start =
      "rm -f said; " + std::string(TALUS_PROGRAM) +
      " ingest base.tif a.talus --threads 1 --memory 300MiB --progress=json 2>said & "
      "while ! grep -q '\"samples\":[1-9]' said 2>/dev/null; do sleep 0.005; done; kill -INT $!; wait $!";
  for (int again = 0; again < 20 && run_program({"sh", "-c", start}, options).exit_code != 130; ++again)
    fs::remove(folder / "a.talus");
  const std::string part = bytes_of(folder / "a.talus.part");
  ASSERT_GT(part.size(), 100'000u);
  Random random(9);
  constexpr std::size_t kPage = 4096;
  int finished = 0, refused = 0;
  for (int i = 0; i < 100; ++i) {
    std::string bad = part;
    const std::size_t pages = part.size() / kPage;
    const auto some_page = [&] {
      return static_cast<std::size_t>(random.between(0, static_cast<int>(pages) - 1)) * kPage;
    };
    if (i % 4 == 0)
      bad[some_page() + static_cast<std::size_t>(random.between(0, 4095))] ^=
          static_cast<char>(1 << random.between(0, 7));
    if (i % 4 == 1) std::fill_n(bad.begin() + static_cast<std::ptrdiff_t>(some_page()), kPage, '\0');
    if (i % 4 == 2) {
      const std::size_t a = some_page(), b = some_page();
      std::swap_ranges(bad.begin() + static_cast<std::ptrdiff_t>(a),
                       bad.begin() + static_cast<std::ptrdiff_t>(a + kPage),
                       bad.begin() + static_cast<std::ptrdiff_t>(b));
    }
    if (i % 4 == 3) bad.resize(static_cast<std::size_t>(random.between(1, static_cast<int>(part.size()) - 1)));
    write_bytes(folder / "a.talus.part", bad);
    const Outcome outcome = talus({"ingest", "base.tif", "a.talus", "--resume"});
    EXPECT_EQ(outcome.signal, 0) << "damage " << i;
    if (outcome.exit_code == done) {
      ++finished;
      EXPECT_TRUE(pages_of(folder / "a.talus") == whole) << "damage " << i;
      EXPECT_EQ(talus({"verify", "a.talus"}).exit_code, done) << "damage " << i;
    } else {
      ++refused;
      EXPECT_THAT(outcome.err, ::testing::HasSubstr("a.talus.part"));
      EXPECT_EQ(outcome.exit_code, damaged) << outcome.err;
      EXPECT_TRUE(bytes_of(folder / "a.talus.part") == bad) << "it is kept for who wants to look";
    }
    fs::remove(folder / "a.talus");
  }
  std::printf("%d of 100 damaged files were gone on with, %d refused\n", finished, refused);
  write_bytes(folder / "a.talus.part", part);
  EXPECT_EQ(talus({"ingest", "base.tif", "a.talus", "--resume"}).exit_code, done);
}

TEST_F(Writers, AnUpdateOfADamagedDatabaseIsRefused) {
  raster = fit(fractal(300, 260, 6, 2000), SampleType::int16);
  make("a.talus");
  const std::string bytes = bytes_of(folder / "a.talus");
  write_raster(fit(crop(fractal(300, 260, 7, 2000), 0, 0, 50, 50), SampleType::int16), folder / "b.tif");
  Random random(4);
  for (int i = 0; i < 60; ++i) {
    std::string bad = bytes;
    const auto place = static_cast<std::size_t>(random.between(0, static_cast<int>(bytes.size()) - 1));
    if (i % 3 == 0) bad[place] = static_cast<char>(bad[place] ^ (1 << random.between(0, 7)));
    if (i % 3 == 1) bad[place] = static_cast<char>(bad[place] + 100);
    if (i % 3 == 2) bad.resize(std::max<std::size_t>(place, 1));
    write_bytes(folder / "a.talus", bad);
    const Outcome outcome = talus({"ingest", "--update", "b.tif", "a.talus"});
    EXPECT_EQ(outcome.exit_code, damaged) << "byte " << place << " of " << bytes.size() << ": " << outcome.err;
    EXPECT_TRUE(bytes_of(folder / "a.talus") == bad);
    EXPECT_FALSE(fs::exists(folder / "a.talus.part"));
  }
}

}  // namespace
}  // namespace talus::support
