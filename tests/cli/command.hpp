#pragma once
// The program `talus` in a folder of its own, for the tests of the command line.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/raster_file.hpp"

namespace talus::support {

enum Exit { done = 0, failed = 1, usage = 2, damaged = 3, disk_full = 4, differs = 5 };

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

class Command : public ::testing::Test {
 protected:
  /// Runs `talus` in the folder. File names in arguments may be relative to it.
  Outcome talus(std::vector<std::string> arguments, RunOptions options = {}) const {
    arguments.insert(arguments.begin(), TALUS_PROGRAM);
    options.folder = folder.path().string();
    return run_program(arguments, options);
  }

  /// Names and contents of all that lies in the folder: two of these are equal iff nothing happened.
  /// Lock files may come and go: readers need them.
  [[nodiscard]] std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      const std::string name = entry.path().lexically_relative(folder.path()).string();
      if (name.ends_with("-lock")) continue;
      found[name] = entry.is_regular_file() ? bytes_of(entry.path()) : "";
    }
    return found;
  }

  void make_raster(const std::string& name, const RasterOptions& options = {}) const {
    write_raster(raster, folder / name, options);
  }
  void make_database(const std::string& name) const {
    make_raster(name + ".tif");
    const Outcome outcome = talus({"ingest", name + ".tif", name});
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    std::filesystem::remove(folder / (name + ".tif"));
  }

  const TempFolder folder;
  Terrain raster = fit(fractal(90, 70, 4, 600), SampleType::int16);
};

/// One object on standard output and nothing else.
inline nlohmann::json json_of(const Outcome& outcome) {
  auto parsed = nlohmann::json::parse(outcome.out, nullptr, false);
  EXPECT_TRUE(parsed.is_object()) << "not one JSON object: " << outcome.out;
  return parsed;
}

/// The program said no as it should: this exit code, nothing on standard output, and on standard error one
/// sentence that names the thing. (Usage may come with one more line.)
inline void expect_refusal(const Outcome& outcome, const std::vector<int>& exit_codes,
                           const std::vector<std::string>& named) {
  EXPECT_EQ(outcome.signal, 0);
  EXPECT_THAT(exit_codes, ::testing::Contains(outcome.exit_code)) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ::testing::EndsWith("\n"));
  const auto lines = std::count(outcome.err.begin(), outcome.err.end(), '\n');
  EXPECT_GE(lines, 1);
  EXPECT_LE(lines, outcome.exit_code == usage ? 2 : 1) << outcome.err;
  EXPECT_GE(outcome.err.size(), 15u) << outcome.err;
  for (const std::string& name : named) EXPECT_THAT(outcome.err, ::testing::HasSubstr(name));
}

}  // namespace talus::support
