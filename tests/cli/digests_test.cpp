// Pages, streams and meshes of six models, byte for byte as they have been: a change of the code's shape changes none.
// tests/golden/digests.txt holds their digests. Who changes a format or an answer on purpose replaces the lines that
// this test prints, and says so in the commit.
//
// A stream's identity and its checksums are left out: they follow from the manifest.

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <string>

#include <fmt/format.h>
#include <xxhash.h>

#include "tests/cli/command.hpp"
#include "tests/support/real_models.hpp"
#include "tests/support/stored_pages.hpp"

namespace talus::support {
namespace {

std::string digest(const std::string& bytes) { return fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size())); }

std::string digest_of_pages(const std::filesystem::path& database) {
  std::string all;
  for (const auto& [key, bytes] : pages_of(database))
    all += fmt::format("{} {} {}:", key.table, key.position, bytes.size()) + bytes;
  return digest(all);
}

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// docs/format/rqt-v1.md, sections 2 and 3.
std::string digest_of_stream(const std::string& bytes) {
  std::string kept;
  const std::size_t header = number_at(bytes, 12), parts = number_at(bytes, 20);
  kept += bytes.substr(0, 24) + bytes.substr(36, header - 8 - 36);
  std::size_t at = header;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t length = 8 + number_at(bytes, at);
    kept += bytes.substr(at, length);
    at += length + 4;
  }
  EXPECT_EQ(at, bytes.size()) << "parts do not fill the stream";
  return digest(kept);
}

class Digests : public Command {
 protected:
  /// What is in the file of digests: "model what" to digest.
  static std::map<std::string, std::string> expected() {
    std::map<std::string, std::string> all;
    std::ifstream in(std::filesystem::path(TALUS_SOURCE_DIR) / "tests/golden/digests.txt");
    for (std::string model, what, number; in >> model >> what >> number;) all[model + " " + what] = number;
    return all;
  }

  void expect_digest(const std::string& model, const std::string& what, const std::string& found) {
    static const auto all = expected();
    const auto known = all.find(model + " " + what);
    EXPECT_EQ(known == all.end() ? "none" : known->second, found)
        << "tests/golden/digests.txt: " << model << " " << what << " " << found;
  }

  void expect_output(const std::string& model, const std::string& what, std::vector<std::string> question,
                     const std::string& ending) {
    const std::string name = what + ending;
    question.insert(question.begin(), {"query", model + ".talus"});
    question.insert(question.end(), {"-o", name});
    const Outcome outcome = talus(question);
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    const std::string bytes = bytes_of(folder / name);
    expect_digest(model, what, ending == ".rqt" ? digest_of_stream(bytes) : digest(bytes));
    std::filesystem::remove(folder / name);
  }

  /// `step`: a tolerance at which some of the vertices are needed.
  void expect_unchanged(const std::string& model, const std::string& input, double step,
                        const std::vector<std::string>& options = {}) {
    std::vector<std::string> words{"ingest", input, model + ".talus"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = talus(words);
    ASSERT_EQ(outcome.exit_code, done) << outcome.err;
    expect_digest(model, "pages", digest_of_pages(folder / (model + ".talus")));
    const auto at = [&](double times) {
      return std::vector<std::string>{"--tolerance", fmt::format("{}", times * step)};
    };
    const auto with = [&](std::vector<std::string> more) {
      std::vector<std::string> all = at(1);
      all.insert(all.end(), more.begin(), more.end());
      return all;
    };
    expect_output(model, "mesh-at-0", {"--tolerance", "0"}, ".ply");
    expect_output(model, "mesh", at(1), ".ply");
    expect_output(model, "coarse-mesh", at(8), ".ply");
    expect_output(model, "cover", with({"--border", "cover"}), ".ply");
    expect_output(model, "levels", with({"--max-level", "5"}), ".ply");
    expect_output(model, "budget", {"--max-vertices", "20000"}, ".ply");
    expect_output(model, "glb", at(2), ".glb");
    expect_output(model, "obj", at(4), ".obj");
    expect_output(model, "stream", at(1), ".rqt");
    expect_output(model, "striped-stream", with({"--bands", "3"}), ".rqt");
    expect_output(model, "bounded-stream", with({"--heights", "bounded"}), ".rqt");
    expect_output(model, "fitted-stream", with({"--heights", "fitted"}), ".rqt");
    expect_output(model, "dense-stream", with({"--heights", "dense"}), ".rqt");
    expect_output(model, "quantised-stream", with({"--heights", "bounded", "--quantum", fmt::format("{}", step / 4)}),
                  ".rqt");
    ASSERT_EQ(
        talus({"query", model + ".talus", "--tolerance", fmt::format("{}", 4 * step), "-o", "base.rqt"}).exit_code,
        done);
    const Outcome increment = talus({"query", model + ".talus", "--from", fmt::format("{}", 4 * step), "--tolerance",
                                     fmt::format("{}", step), "-o", "more.rqt"});
    ASSERT_EQ(increment.exit_code, done) << increment.err;
    expect_digest(model, "increment", digest_of_stream(bytes_of(folder / "more.rqt")));
  }
};

TEST_F(Digests, MountainsInInt16) {
  raster = fit(fractal(1300, 1100, 11, 2000), SampleType::int16);
  RasterOptions options;
  options.geotransform = {500000, 10, 0, 5600400, 0, -10};
  options.crs = "EPSG:32632";
  make_raster("a.tif", options);
  expect_unchanged("mountains", "a.tif", 4);
}

TEST_F(Digests, LakesOfVoidInFloat32) {
  raster = fit(void_blobs(fractal(500, 700, 12, 900), 9, 5), SampleType::float32);
  RasterOptions options;
  options.type = SampleType::float32;
  options.geotransform = {7, 0.001, 0, 47, 0, -0.001};
  options.crs = "EPSG:4326";
  make_raster("a.tif", options);
  expect_unchanged("lakes", "a.tif", 3);
}

TEST_F(Digests, StrewnVoidsInDoubles) {
  raster = random_voids(noise(210, 190, 13, 0, 60), 0.03, 14);
  RasterOptions options;
  options.type = SampleType::float64;
  options.geotransform = {100, 2, 0, 900, 0, -3};
  make_raster("a.tif", options);
  expect_unchanged("doubles", "a.tif", 7);
}

TEST_F(Digests, TerracesInFeetThatAreRounded) {
  raster = fit(plateaus(600, 400), SampleType::int32);
  RasterOptions options;
  options.type = SampleType::int32;
  options.geotransform = {500000, 30, 0, 5600400, 0, -30};
  options.crs = "EPSG:32632";
  options.unit = "ft";
  make_raster("a.tif", options);
  expect_unchanged("terraces", "a.tif", 2, {"--height-step", "0.5"});
}

TEST_F(Digests, AStripOfDecimetresInUint16) {
  raster = fit(fractal(2100, 40, 15, 5000), SampleType::uint16);
  RasterOptions options;
  options.type = SampleType::uint16;
  options.geotransform = {0, 1, 0, 0, 0, -1};
  options.scale = 0.1;
  options.offset = -50;
  make_raster("a.tif", options);
  expect_unchanged("strip", "a.tif", 1);
}

TEST_F(Digests, Jacksboro) {
  const RealModel model = real_model("jacksboro", folder);
  if (!model.file) GTEST_SKIP() << model.why_not;
  expect_unchanged("jacksboro", model.file->string(), 5);
}

}  // namespace
}  // namespace talus::support
