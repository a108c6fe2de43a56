// Ingest against the tools people use today, on real models: time against writing a cloud-optimised GeoTIFF (which
// makes overviews, too, but no errors), bytes against a compressed GeoTIFF of the same samples.

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal.h>
#include <gdal_utils.h>
#include <unistd.h>

#include "bench/yardstick.hpp"
#include "talus/ingest.hpp"

namespace talus::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Model {
  const char* file;
  bool is_float;
};
constexpr Model kModels[] = {{"srtm3_S36E149.tif", false},
                             {"srtm3_N46E008.tif", false},
                             {"bigtujunga_30m_utm11.tif", false},
                             {"swiss_germany_3s/swiss_germany.vrt", false},
                             {"kenya_central_z11.tif", false},
                             {"taiwan_z13/taiwan.vrt", false},
                             {"tirol5m_avaPfa.tif", true},
                             {"tirol5m_avaGar.tif", true},
                             {"gabilan.bil", true}};

fs::path folder_of_models() {
  const char* folder = std::getenv("TALUS_DEM_DIR");
  return folder == nullptr ? "../shared/dem" : folder;
}

class Scratch {
 public:
  Scratch() : folder_(fs::temp_directory_path() / fmt::format("talus_bench_{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] fs::path file(const char* name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

/// gdal_translate SOURCE TARGET with options; returns seconds, or less than 0 if it fails.
double translate(const fs::path& source, const fs::path& target, const std::vector<std::string>& options) {
  GDALAllRegister();
  char** words = nullptr;
  for (const std::string& word : options) words = CSLAddString(words, word.c_str());
  GDALTranslateOptions* parsed = GDALTranslateOptionsNew(words, nullptr);
  CSLDestroy(words);
  const auto begun = Clock::now();
  GDALDatasetH from = GDALOpen(source.c_str(), GA_ReadOnly);
  int failed = 0;
  GDALDatasetH made = from == nullptr ? nullptr : GDALTranslate(target.c_str(), from, parsed, &failed);
  if (made != nullptr) GDALClose(made);
  if (from != nullptr) GDALClose(from);
  GDALTranslateOptionsFree(parsed);
  return made == nullptr ? -1 : std::chrono::duration<double>(Clock::now() - begun).count();
}

void ingest_against_cog(benchmark::State& state, const Model& model, int threads) {
  const fs::path source = folder_of_models() / model.file;
  if (!fs::exists(source)) return state.SkipWithError("no such model in TALUS_DEM_DIR");
  const Scratch scratch;
  double cog = 0, ours = 0, samples = 0, bytes = 0, cog_bytes = 0;
  for (auto _ : state) {
    const double seconds = translate(source, scratch.file("cog.tif"),
                                     {"-of", "COG", "-co", "COMPRESS=LERC_ZSTD", "-co",
                                      fmt::format("NUM_THREADS={}", threads), "-co", "BIGTIFF=IF_SAFER"});
    if (seconds < 0) return state.SkipWithError("GDAL writes no COG with LERC_ZSTD");
    cog += seconds;
    const auto begun = Clock::now();
    IngestOptions options;
    options.overwrite = true;
    options.threads = threads;
    const IngestReport report = ingest(source, scratch.file("a.talus"), options);
    const double now = std::chrono::duration<double>(Clock::now() - begun).count();
    ours += now;
    state.SetIterationTime(now);
    samples += static_cast<double>(report.description.extent.samples());
    bytes = static_cast<double>(report.bytes);
    cog_bytes = static_cast<double>(fs::file_size(scratch.file("cog.tif")));
  }
  state.counters["cog_s"] = cog / static_cast<double>(state.iterations());
  state.counters["time/cog"] = ours / cog;
  state.counters["bytes/cog"] = bytes / cog_bytes;
  state.counters["Msamples/s"] = samples / 1e6 / ours;
}

void bytes_against_geotiff(benchmark::State& state, const Model& model) {
  const fs::path source = folder_of_models() / model.file;
  if (!fs::exists(source)) return state.SkipWithError("no such model in TALUS_DEM_DIR");
  const Scratch scratch;
  double ours = 0, theirs = 0, samples = 0;
  for (auto _ : state) {
    translate(source, scratch.file("a.tif"),
              {"-of", "GTiff", "-co", "COMPRESS=ZSTD", "-co", "ZSTD_LEVEL=9", "-co",
               fmt::format("PREDICTOR={}", model.is_float ? 3 : 2), "-co", "TILED=YES"});
    IngestOptions options;
    options.overwrite = true;
    const IngestReport report = ingest(source, scratch.file("a.talus"), options);
    ours = static_cast<double>(report.bytes);
    theirs = static_cast<double>(fs::file_size(scratch.file("a.tif")));
    samples = static_cast<double>(report.description.extent.samples());
  }
  state.counters["talus_bits"] = 8 * ours / samples;
  state.counters["geotiff_bits"] = 8 * theirs / samples;
  state.counters["bytes/geotiff"] = ours / theirs;
}

const bool registered = [] {
  for (const Model& model : kModels) {
    for (const int threads : {1, 2}) {
      benchmark::RegisterBenchmark(fmt::format("IngestAgainstCog/{}/threads:{}", model.file, threads).c_str(),
                                   [model, threads](benchmark::State& s) { ingest_against_cog(s, model, threads); })
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  }
  for (const Model& model : kModels) {
    benchmark::RegisterBenchmark(fmt::format("BytesAgainstGeotiff/{}", model.file).c_str(),
                                 [model](benchmark::State& s) { bytes_against_geotiff(s, model); })
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace talus::bench
