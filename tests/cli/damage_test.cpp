// Files that were damaged, and work that was cut short.

#include <sys/wait.h>
#include <unistd.h>

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"
#include "tests/support/random.hpp"
#include "tests/support/stored_pages.hpp"

namespace talus::support {
namespace {

/// What became of a damaged database. Anything from `another_answer` on is a defect.
enum class Fate { unharmed, found_by_verify, refused, another_answer, missed_by_verify, unexpected, crashed };

struct Seen {
  Mesh mesh;
  SampleWindow samples;
};

Seen look_at(const std::filesystem::path& database) {
  const Snapshot now = Database::open(database).snapshot();
  return {now.mesh(Metres{0}), now.samples(now.description().extent)};
}

bool same(const Seen& a, const Seen& b) {
  return a.mesh.region == b.mesh.region && a.mesh.points == b.mesh.points && a.mesh.heights == b.mesh.heights &&
         a.mesh.triangles == b.mesh.triangles && a.samples.valid == b.samples.valid &&
         a.samples.values == b.samples.values;
}

bool verify_finds_something(const std::filesystem::path& database) {
  try {
    return verify(Database::open(database).snapshot()).finding_count > 0;
  } catch (const Failure&) {
    return true;
  }
}

Fate fate_of(const std::filesystem::path& database, const Seen& whole) {
  try {
    if (!same(look_at(database), whole)) return Fate::another_answer;
    return verify_finds_something(database) ? Fate::found_by_verify : Fate::unharmed;
  } catch (const Failure& failure) {
    // "another version" is a fair thing to say of a damaged version number
    if (failure.cause() != Cause::corrupt && failure.cause() != Cause::unsupported) return Fate::unexpected;
    return verify_finds_something(database) ? Fate::refused : Fate::missed_by_verify;
  } catch (...) {
    return Fate::unexpected;
  }
}

/// Calls decide() in a process of its own, which may crash.
template <class Decide>
Fate in_a_child(Decide&& decide) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    _exit(static_cast<int>(decide()));
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) < static_cast<int>(Fate::crashed) ? Fate{WEXITSTATUS(status)}
                                                                                    : Fate::crashed;
}

/// A small database, damaged in every way. It must answer as before, or say that it is damaged.
class Damage : public Command {
 protected:
  void SetUp() override {
    raster = void_blobs(fit(fractal(260, 200, 4, 600), SampleType::int16), 1, 7);
    make_database("whole.talus");
    bytes = bytes_of(folder / "whole.talus");
    seen = look_at(folder / "whole.talus");
  }

  Fate expect_harmless(const std::string& damaged_bytes, const std::string& what) {
    const auto file = folder / "bad.talus";
    write_bytes(file, damaged_bytes);
    const Fate fate = in_a_child([&] { return fate_of(file, seen); });
    static const char* const complaints[] = {"",
                                             "",
                                             "",
                                             "gives another answer and says nothing",
                                             "is refused by a query, and verify finds nothing",
                                             "fails in an unexpected way",
                                             "crashes"};
    EXPECT_LT(fate, Fate::another_answer) << what << ": the database " << complaints[static_cast<int>(fate)];
    ++tried;
    noticed += fate == Fate::unharmed ? 0 : 1;
    return fate;
  }
  /// Xors one byte.
  Fate expect_harmless(std::size_t place, int mask) {
    std::string changed = bytes;
    changed[place] = static_cast<char>(changed[place] ^ mask);
    return expect_harmless(changed, "byte " + std::to_string(place) + " ^ " + std::to_string(mask));
  }
  void TearDown() override { std::printf("%d of %d damages noticed, the others changed nothing\n", noticed, tried); }

  static constexpr std::size_t page_bytes = 4096;  // LMDB's own
  std::string bytes;
  Seen seen;
  int tried = 0, noticed = 0;
};

TEST_F(Damage, AFlippedBitIsFoundOrHarmless) {
  Random random(1);
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / 800);
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    const std::size_t place = at + static_cast<std::size_t>(random.between(0, static_cast<int>(step) - 1));
    expect_harmless(std::min(bytes.size() - 1, place), 1 << random.between(0, 7));
  }
}

TEST_F(Damage, TheFirstBytesOfTheFileAreFoundOrHarmless) {
  // What LMDB believes unseen: two pages of its own, whose first 200 bytes say where all the rest is.
  for (std::size_t at = 0; at < 200; ++at) {
    expect_harmless(at, 0xff);
    expect_harmless(page_bytes + at, 1 << at % 8);
  }
}

TEST_F(Damage, TheFirstBytesOfEachPageAreFoundOrHarmless) {
  // Page number, flags, bounds of the free space, and where the nodes are.
  for (std::size_t page = 2 * page_bytes; page < bytes.size(); page += page_bytes) {
    for (std::size_t at = 0; at < 32; at += 2) expect_harmless(page + at, 0x55);
  }
}

TEST_F(Damage, AZeroedPageIsFoundOrHarmless) {
  for (std::size_t page = 0; page < bytes.size(); page += page_bytes) {
    std::string changed = bytes;
    std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(page), std::min(page_bytes, bytes.size() - page), '\0');
    expect_harmless(changed, "page at byte " + std::to_string(page) + " zeroed");
  }
}

TEST_F(Damage, TwoPagesInEachOthersPlaceAreFoundOrHarmless) {
  for (std::size_t page = 2 * page_bytes; page + 2 * page_bytes <= bytes.size(); page += page_bytes) {
    std::string changed = bytes;
    const auto first = changed.begin() + static_cast<std::ptrdiff_t>(page);
    std::swap_ranges(first, first + page_bytes, first + page_bytes);
    expect_harmless(changed, "page at byte " + std::to_string(page) + " swapped with the next");
  }
}

TEST_F(Damage, ATruncatedDatabaseIsRefused) {
  for (int part = 0; part < 100; ++part) {
    const std::size_t keep = bytes.size() * static_cast<std::size_t>(part) / 100;
    EXPECT_EQ(expect_harmless(bytes.substr(0, keep), "cut to " + std::to_string(keep) + " bytes"), Fate::refused)
        << "cut to " << keep << " of " << bytes.size();
  }
}

TEST_F(Damage, BytesBehindTheEndAreHarmless) {
  expect_harmless(bytes + std::string(page_bytes, 'x'), "a page added");
  expect_harmless(bytes + "x", "a byte added");
}

TEST_F(Damage, IsSaidInASentenceAndAnExitCode) {
  const auto before = bytes_of(folder / "whole.talus");
  for (const std::size_t keep : {bytes.size() / 2, std::size_t{5000}, std::size_t{100}}) {
    write_bytes(folder / "bad.talus", bytes.substr(0, keep));
    expect_refusal(talus({"query", "bad.talus", "--tolerance=0", "-o", "bad.ply"}), {damaged}, {"bad.talus"});
    expect_refusal(talus({"info", "bad.talus"}), {damaged}, {"bad.talus"});
    EXPECT_EQ(talus({"verify", "bad.talus"}).exit_code, damaged);
    EXPECT_FALSE(std::filesystem::exists(folder / "bad.ply"));
  }
  // A bit in the middle of a page that is read: everything is tried until one is noticed.
  for (std::size_t at = bytes.size() - 1; at > 2 * page_bytes; at -= 97) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 4);
    if (expect_harmless(changed, "bit flipped in byte " + std::to_string(at)) != Fate::refused) continue;
    const Outcome query = talus({"query", "bad.talus", "--tolerance=0", "-o", "bad.ply"});
    expect_refusal(query, {damaged}, {"corrupt: bad.talus"});
    const Outcome check = talus({"verify", "bad.talus"});
    EXPECT_EQ(check.exit_code, damaged);
    EXPECT_EQ(check.signal, 0);
    EXPECT_FALSE(std::filesystem::exists(folder / "bad.ply"));
    return;
  }
  ADD_FAILURE() << "no flipped bit was noticed by a query";
}

// ---- cut short -------------------------------------------------------------------------------------

TEST_F(Command, AnIngestThatIsKilledAgainAndAgainEndsInTheSamePages) {
  raster = fit(fractal(2300, 1500, 6, 2000), SampleType::int16);
  for (int i = 0; i < 200; ++i) raster.valid[static_cast<std::size_t>(i * 7919 % (2300 * 1500))] = 0;
  make_raster("big.tif");
  ASSERT_EQ(talus({"ingest", "big.tif", "undisturbed.talus"}).exit_code, done);
  const auto undisturbed = pages_of(folder / "undisturbed.talus");
  Random random(20);
  int killed = 0;
  for (int i = 0; i < 20; ++i) {
    RunOptions options;
    options.kill_after = std::chrono::milliseconds(random.between(10, 400 + 60 * i));
    const Outcome outcome = talus({"ingest", "big.tif", "big.talus", "--resume"}, options);
    if (outcome.signal == 0) {
      EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    }
    // The kill can come between the database's name and the program's end.
    if (outcome.signal == 0 || std::filesystem::exists(folder / "big.talus")) {
      EXPECT_TRUE(pages_of(folder / "big.talus") == undisturbed);
      std::filesystem::remove(folder / "big.talus");
      continue;
    }
    ++killed;
    for (const auto& [name, bytes] : contents()) {
      EXPECT_TRUE(name.ends_with(".tif") || name == "undisturbed.talus" || name.starts_with("big.talus.part")) << name;
    }
  }
  EXPECT_GT(killed, 0);
  const Outcome outcome = talus({"ingest", "big.tif", "big.talus", "--resume"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_TRUE(pages_of(folder / "big.talus") == undisturbed);
  EXPECT_EQ(talus({"verify", "big.talus", "--against", "big.tif"}).exit_code, done);
}

// Killed after its last page and before its name: the plan is gone by then.
TEST_F(Command, AnIngestThatLacksOnlyItsNameIsGoneOnWith) {
  raster = fit(fractal(300, 200, 6, 2000), SampleType::int16);
  make_raster("big.tif");
  ASSERT_EQ(talus({"ingest", "big.tif", "undisturbed.talus"}).exit_code, done);
  const auto undisturbed = pages_of(folder / "undisturbed.talus");
  std::filesystem::copy_file(folder / "undisturbed.talus", folder / "big.talus.part");
  const Outcome other = talus({"ingest", "big.tif", "big.talus", "--resume", "--height-step", "5"});
  EXPECT_EQ(other.exit_code, usage) << other.err;
  ASSERT_TRUE(std::filesystem::exists(folder / "big.talus.part"));
  const Outcome outcome = talus({"ingest", "big.tif", "big.talus", "--resume"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_TRUE(pages_of(folder / "big.talus") == undisturbed);
  EXPECT_EQ(talus({"verify", "big.talus", "--against", "big.tif"}).exit_code, done);

  std::filesystem::copy_file(folder / "undisturbed.talus", folder / "else.talus.part");
  raster.values[17] += 1;
  make_raster("big.tif");
  const Outcome changed = talus({"ingest", "big.tif", "else.talus", "--resume"});
  EXPECT_EQ(changed.exit_code, usage) << changed.err;
}

TEST_F(Command, AnInterruptedIngestIsNeitherLostNorMixedUpWithAnother) {
  raster = fit(fractal(2300, 1500, 6, 2000), SampleType::int16);
  make_raster("big.tif");
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
  ASSERT_TRUE(std::filesystem::exists(folder / "big.talus.part"));
  EXPECT_THAT(bytes_of(folder / "said"), ::testing::HasSubstr("--resume"));
  std::filesystem::remove(folder / "said");
  const auto before = contents();
  expect_refusal(talus({"ingest", "big.tif", "big.talus"}), {usage}, {"big.talus.part", "--resume", "--overwrite"});
  expect_refusal(talus({"ingest", "big.tif", "big.talus", "--resume", "--void-weight", "2"}), {usage},
                 {"big.talus.part", "options"});
  expect_refusal(talus({"ingest", "big.tif", "big.talus", "--resume", "--metric", "perpendicular"}), {usage},
                 {"big.talus.part", "options"});
  EXPECT_EQ(contents(), before);
  EXPECT_EQ(talus({"ingest", "big.tif", "big.talus", "--overwrite"}).exit_code, done);
  EXPECT_FALSE(std::filesystem::exists(folder / "big.talus.part"));
}

TEST_F(Command, AnIngestThatIsKilledKeepsTheOlderDatabase) {
  make_database("a.talus");
  const std::string before = bytes_of(folder / "a.talus");
  raster = fit(fractal(1500, 1500, 6, 2000), SampleType::int16);
  make_raster("big.tif");
  RunOptions options;
  options.kill_after = std::chrono::milliseconds(100);
  const Outcome outcome = talus({"ingest", "big.tif", "a.talus", "--overwrite"}, options);
  ASSERT_NE(outcome.signal, 0);
  EXPECT_TRUE(bytes_of(folder / "a.talus") == before);
}

TEST_F(Command, AnIngestThatIsInterruptedLeavesWorkOrNothing) {
  raster = fit(fractal(1500, 1500, 6, 2000), SampleType::int16);
  make_raster("big.tif");
  for (const std::string signal : {"TERM", "HUP"}) {
    RunOptions options;
    options.folder = folder.path().string();
    const std::string start =
        std::string(TALUS_PROGRAM) + " ingest big.tif big.talus & while ! [ -e big.talus.part ]; do sleep 0.01; done; ";
    const Outcome outcome = run_program({"sh", "-c", start + "kill -" + signal + " $!; wait $!"}, options);
    EXPECT_EQ(outcome.exit_code, 130) << signal << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "big.talus"));
    std::filesystem::remove(folder / "big.talus.part");
    EXPECT_EQ(contents().size(), 1u) << signal;
  }
}

/// Runs talus inside a file system of `kilobytes`, mounted at "small"; false where that may not be done.
class FullDisk : public Command {
 protected:
  std::optional<Outcome> talus_in(int kilobytes, const std::string& arguments) const {
    std::filesystem::create_directories(folder / "small");
    const std::string mount = "mount -t tmpfs -o size=" + std::to_string(kilobytes) + "k none small";
    RunOptions options;
    options.folder = folder.path().string();
    if (run_program({"unshare", "-rm", "sh", "-c", mount}, options).exit_code != 0) return std::nullopt;
    // Afterwards the names that are left go to standard output, which the program itself must not use.
    return run_program({"unshare", "-rm", "sh", "-c",
                        mount + "; " + TALUS_PROGRAM + " " + arguments + "; code=$?; ls small; exit $code"},
                       options);
  }
};

TEST_F(FullDisk, StopsAnIngestThatIsGoneOnWithElsewhere) {
  raster = fit(noise(6200, 2100, 3, 0, 30000), SampleType::int16);
  make_raster("a.tif");
  const auto outcome =
      talus_in(20000, "ingest a.tif small/a.talus --threads 1; code=$?; cp small/a.talus.part .; (exit $code)");
  if (!outcome) GTEST_SKIP() << "a small file system cannot be mounted here";
  EXPECT_EQ(outcome->exit_code, disk_full) << outcome->err;
  EXPECT_EQ(outcome->out, "a.talus.part\n");
  EXPECT_THAT(outcome->err, ::testing::HasSubstr("a.talus"));
  ASSERT_TRUE(std::filesystem::exists(folder / "a.talus.part"));
  const Outcome resumed = talus({"ingest", "a.tif", "a.talus", "--resume", "--json"});
  EXPECT_EQ(resumed.exit_code, done) << resumed.err;
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "a.tif"}).exit_code, done);
  ASSERT_EQ(talus({"ingest", "a.tif", "b.talus"}).exit_code, done);
  EXPECT_TRUE(pages_of(folder / "a.talus") == pages_of(folder / "b.talus"));
}

TEST_F(FullDisk, StopsAnAnswerAndNothingIsLeft) {
  raster = fit(noise(400, 400, 3, 0, 30000), SampleType::int16);
  make_database("a.talus");
  const auto outcome = talus_in(200, "query a.talus --tolerance 0 -o small/a.ply");
  if (!outcome) GTEST_SKIP() << "a small file system cannot be mounted here";
  EXPECT_EQ(outcome->exit_code, disk_full) << outcome->err;
  EXPECT_EQ(outcome->out, "");
  EXPECT_THAT(outcome->err, ::testing::HasSubstr("a.ply"));
}

}  // namespace
}  // namespace talus::support
