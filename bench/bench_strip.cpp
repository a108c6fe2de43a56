// What does an answer take as one strip, and what as the bits of Dick et al., and how fast are they made and read?
//
// Data: whole real models at 1, 5 and 20 m, where these are (TALUS_DEM_DIR). Rows: model, tolerance in metres, threads.
// `indices` are indices a triangle, without swaps; `alternating` is what hardware without swaps takes. Swaps and jumps
// are counted, and given a triangle. BM_Triangulate is the yardstick: the same answer as an indexed mesh.

#include <map>
#include <string>

#include <benchmark/benchmark.h>

#include "bench/kept.hpp"
#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "talus/strip.hpp"
#include "talus/talus.hpp"

namespace talus::bench {
namespace {

struct Model {
  const char* name;
  const char* file;
};
constexpr Model kModels[] = {{"S36E149", "srtm3_S36E149.tif"},
                             {"bigtujunga", "bigtujunga_30m_utm11.tif"},
                             {"N46E008 with voids", "srtm3_N46E008.tif"}};

const RestrictedQuadtree* asked(benchmark::State& state) {
  static std::map<std::pair<std::int64_t, std::int64_t>, RestrictedQuadtree> kept;
  const Model& model = kModels[state.range(0)];
  const auto file = real_model(model.file);
  if (!file) {
    state.SkipWithError("no real models here, see TALUS_DEM_DIR");
    return nullptr;
  }
  auto found = kept.find({state.range(0), state.range(1)});
  if (found == kept.end()) {
    const Snapshot now =
        Database::open(kept_database(file->stem().string(), [&] { return *file; }), {.threads = 1}).snapshot();
    found =
        kept.emplace(
                std::pair(state.range(0), state.range(1)),
                now.ask({.region = now.description().extent, .tolerance = Metres{static_cast<double>(state.range(1))}})
                    .quadtree)
            .first;
  }
  state.SetLabel(model.name);
  return &found->second;
}

void count(benchmark::State& state, std::size_t triangles) {
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["triangles_per_second"] =
      benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsIterationInvariantRate);
}

void BM_Triangulate(benchmark::State& state) {
  const RestrictedQuadtree* answer = asked(state);
  if (answer == nullptr) return;
  std::size_t triangles = 0;
  for (auto _ : state) {
    const Mesh mesh = triangulate(*answer, 1);
    triangles = mesh.triangles.size();
    benchmark::DoNotOptimize(mesh.triangles.data());
  }
  count(state, triangles);
}

void BM_Strip(benchmark::State& state) {
  const RestrictedQuadtree* answer = asked(state);
  if (answer == nullptr) return;
  for (auto _ : state) {
    const TriangleStrip strip = strip_of(*answer);
    benchmark::DoNotOptimize(strip.corners.data());
  }
  const TriangleStrip strip = strip_of(*answer);
  const auto triangles = static_cast<double>(strip.triangles());
  count(state, strip.triangles());
  state.counters["indices"] = static_cast<double>(strip.indices()) / triangles;
  state.counters["swaps"] = static_cast<double>(strip.swaps) / triangles;
  state.counters["jumps"] = static_cast<double>(strip.jumps());
  state.counters["alternating"] = static_cast<double>(alternating_indices(strip).size()) / triangles;
}

void BM_EncodeStrip(benchmark::State& state) {
  const RestrictedQuadtree* answer = asked(state);
  if (answer == nullptr) return;
  const TriangleStrip strip = strip_of(*answer);
  std::size_t bytes = 0;
  for (auto _ : state) {
    const auto coded = encode_strip(strip);
    bytes = coded.size();
    benchmark::DoNotOptimize(coded.data());
  }
  count(state, strip.triangles());
  const StripSizes sizes = strip_sizes(encode_strip(strip));
  state.counters["bits"] = 8.0 * static_cast<double>(bytes) / static_cast<double>(strip.triangles());
  state.counters["height_bits"] = sizes.height_bits;
  state.counters["patches"] = static_cast<double>(sizes.patches);
}

void BM_DecodeStrip(benchmark::State& state) {
  const RestrictedQuadtree* answer = asked(state);
  if (answer == nullptr) return;
  const auto coded = encode_strip(strip_of(*answer));
  std::size_t triangles = 0;
  for (auto _ : state) {
    const Mesh mesh = decode_strip(coded, static_cast<int>(state.range(2)));
    triangles = mesh.triangles.size();
    benchmark::DoNotOptimize(mesh.points.data());
  }
  count(state, triangles);
}

const std::vector<std::int64_t> kWhich{0, 1, 2}, kTolerances{1, 5, 20};
BENCHMARK(BM_Triangulate)->ArgsProduct({kWhich, kTolerances})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Strip)->ArgsProduct({kWhich, kTolerances})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_EncodeStrip)->ArgsProduct({kWhich, kTolerances})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_DecodeStrip)->ArgsProduct({kWhich, kTolerances, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace talus::bench
