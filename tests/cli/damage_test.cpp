// Files that were damaged, and work that was cut short.

#include <sys/stat.h>

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

class Damage : public Command {
 protected:
  void SetUp() override {
    raster = void_blobs(raster, 1, 7);
    make_database("whole.talus");
    whole = bytes_of(folder / "whole.talus");
    ASSERT_EQ(talus({"query", "whole.talus", "--tolerance=0", "-o", "whole.ply"}).exit_code, done);
    answer = bytes_of(folder / "whole.ply");
  }

  /// Does a database of these bytes either answer as the whole one does, or say clearly that it is damaged?
  /// `may_be_ignored`: that it is found by verify alone is not asked.
  void expect_harmless(const std::string& bytes, const std::string& what) {
    SCOPED_TRACE(what);
    write_bytes(folder / "bad.talus", bytes);
    std::filesystem::remove(folder / "bad.ply");
    const Outcome query = talus({"query", "bad.talus", "--tolerance=0", "-o", "bad.ply"});
    const Outcome verify = talus({"verify", "bad.talus"});
    EXPECT_EQ(query.signal, 0) << "query crashed";
    EXPECT_EQ(verify.signal, 0) << "verify crashed";
    if (query.exit_code == done) {
      EXPECT_TRUE(bytes_of(folder / "bad.ply") == answer) << "another answer, and nothing said";
    } else {
      // "another version" is a fair thing to say of a damaged version number
      EXPECT_TRUE(query.exit_code == damaged || query.exit_code == failed) << query.exit_code << query.err;
      EXPECT_EQ(verify.exit_code, query.exit_code)
          << "query refuses it: " << query.err << "verify says: " << verify.out << verify.err;
      EXPECT_FALSE(std::filesystem::exists(folder / "bad.ply"));
      EXPECT_NE(query.err, "");
    }
    EXPECT_TRUE(verify.exit_code == done || verify.exit_code == damaged || verify.exit_code == failed)
        << verify.exit_code << verify.err;
    found += verify.exit_code == done ? 0 : 1;
  }

  std::string whole, answer;
  int found = 0;
};

TEST_F(Damage, AFlippedByteIsFoundOrHarmless) {
  int tried = 0;
  Random random(1);
  const std::size_t step = std::max<std::size_t>(1, whole.size() / 300);
  for (std::size_t at = 0; at < whole.size(); at += step) {
    const std::size_t place =
        std::min(whole.size() - 1, at + static_cast<std::size_t>(random.between(0, static_cast<int>(step) - 1)));
    std::string bytes = whole;
    bytes[place] = static_cast<char>(bytes[place] ^ (1 << random.between(0, 7)));
    expect_harmless(bytes, "bit flipped in byte " + std::to_string(place));
    ++tried;
  }
  std::printf("%d of %d flipped bytes were found by verify; the others changed nothing\n", found, tried);
}

TEST_F(Damage, EveryByteOfTheFirstPagesIsFoundOrHarmless) {
  // What LMDB believes unseen: two pages of its own, of which the first 200 bytes say where all the rest is.
  for (std::size_t page = 0; page < 2; ++page) {
    for (std::size_t at = 0; at < 200; ++at) {
      std::string bytes = whole;
      bytes[page * 4096 + at] = static_cast<char>(~bytes[page * 4096 + at]);
      expect_harmless(bytes, "byte " + std::to_string(page * 4096 + at) + " inverted");
    }
  }
}

TEST_F(Damage, PageHeadersAreFoundOrHarmless) {
  // The first bytes of each page of the tree: page number, flags, bounds of the free space, node offsets.
  for (std::size_t page = 2 * 4096; page < whole.size(); page += 4096) {
    for (const std::size_t at : {std::size_t{0}, std::size_t{10}, std::size_t{12}, std::size_t{13}, std::size_t{14},
                                 std::size_t{16}, std::size_t{18}}) {
      if (page >= 12 * 4096 && page + 12 * 4096 < whole.size()) continue;  // those in the middle are alike
      std::string bytes = whole;
      bytes[page + at] = static_cast<char>(bytes[page + at] ^ 0x55);
      expect_harmless(bytes, "byte " + std::to_string(page + at) + " changed");
    }
  }
}

TEST_F(Damage, AZeroedPageIsFoundOrHarmless) {
  for (std::size_t page = 0; page < whole.size(); page += 4096) {
    std::string bytes = whole;
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(page), std::min<std::size_t>(4096, bytes.size() - page),
                '\0');
    expect_harmless(bytes, "page at byte " + std::to_string(page) + " zeroed");
  }
}

TEST_F(Damage, ATruncatedDatabaseIsRefused) {
  for (int part = 0; part < 40; ++part) {
    const std::size_t keep = whole.size() * static_cast<std::size_t>(part) / 40;
    expect_harmless(whole.substr(0, keep), "cut to " + std::to_string(keep) + " bytes");
    if (part < 36) {
      EXPECT_EQ(talus({"verify", "bad.talus"}).exit_code, damaged) << "cut to " << keep;
    }
  }
}

TEST_F(Damage, BytesBehindTheEndAreHarmless) {
  expect_harmless(whole + std::string(4096, 'x'), "4096 bytes added");
  expect_harmless(whole + "x", "one byte added");
}

// ---- cut short -------------------------------------------------------------------------------------

TEST_F(Command, AnIngestThatIsKilledLeavesNoDatabase) {
  raster = fit(fractal(1500, 1500, 6, 2000), SampleType::int16);
  make_raster("big.tif");
  int killed = 0;
  for (const int milliseconds : {20, 60, 120, 200, 300, 450, 700, 1000}) {
    RunOptions options;
    options.kill_after = std::chrono::milliseconds(milliseconds);
    const Outcome outcome = talus({"ingest", "big.tif", "big.talus"}, options);
    if (outcome.signal == 0) break;  // it was done before
    ++killed;
    EXPECT_FALSE(std::filesystem::exists(folder / "big.talus")) << "after " << milliseconds << " ms";
    for (const auto& [name, bytes] : contents()) {
      EXPECT_TRUE(name == "big.tif" || name.starts_with("big.talus.part")) << name;
    }
  }
  EXPECT_GT(killed, 0);
  std::filesystem::remove(folder / "big.talus");
  const Outcome outcome = talus({"ingest", "big.tif", "big.talus"});  // what was left is no obstacle
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  std::vector<std::string> names;
  for (const auto& [name, bytes] : contents()) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"big.talus", "big.tif"}));
  EXPECT_EQ(talus({"verify", "big.talus", "--against", "big.tif"}).exit_code, done);
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

TEST_F(FullDisk, StopsAnIngestAndNothingIsLeft) {
  raster = fit(noise(400, 400, 3, 0, 30000), SampleType::int16);
  make_raster("a.tif");
  const auto outcome = talus_in(200, "ingest a.tif small/a.talus");
  if (!outcome) GTEST_SKIP() << "a small file system cannot be mounted here";
  EXPECT_EQ(outcome->exit_code, disk_full) << outcome->err;
  EXPECT_EQ(outcome->out, "");
  EXPECT_THAT(outcome->err, ::testing::HasSubstr("a.talus"));
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
