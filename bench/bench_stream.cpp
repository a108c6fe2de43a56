// Streams of answers: what they take, and how fast they are written and read.
//
// Data: windows of at most 4097² samples amid the real models, at 5 m, where these are (TALUS_DEM_DIR). Each row:
// model, heights (exact, or bounded with a quantum of about the tolerance). `bits` are bits a triangle, header
// and all. BM_Chain: the bytes of 20 → 10 → 5 → 2 → 1 m over those of 1 m at once.

#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/kept.hpp"
#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "engine/stream/stream_codec.hpp"
#include "talus/talus.hpp"

namespace talus::bench {
namespace {

struct Model {
  const char* name;
  const char* file;
};
constexpr Model kModels[] = {{"S36E149", "srtm3_S36E149.tif"},   {"taiwan", "taiwan_z13/taiwan.vrt"},
                             {"kenya", "kenya_central_z11.tif"}, {"bigtujunga", "bigtujunga_30m_utm11.tif"},
                             {"N46E008", "srtm3_N46E008.tif"},   {"gabilan", "gabilan.bil"},
                             {"tirol", "tirol5m_avaPfa.tif"}};

struct Asked {
  Description description;
  RestrictedQuadtree quadtree;
  std::size_t triangles = 0;
};

std::optional<Snapshot> snapshot_of(const Model& model) {
  const auto file = real_model(model.file);
  if (!file) return std::nullopt;
  return Database::open(kept_database(file->stem().string(), [&] { return *file; }), {.threads = 0}).snapshot();
}

/// A window of at most 4097² samples amid a model.
GridRect window_of(GridRect extent) {
  const auto cut = [](std::int32_t& first, std::int32_t& last) {
    const std::int32_t over = std::max(0, last - first - 4096);
    first += over / 2;
    last -= over - over / 2;
  };
  cut(extent.first.col, extent.last.col);
  cut(extent.first.row, extent.last.row);
  return extent;
}

const Asked* asked(int model, bool bounded) {
  static std::map<std::pair<int, bool>, Asked> made;
  if (const auto found = made.find({model, bounded}); found != made.end()) return &found->second;
  const auto now = snapshot_of(kModels[model]);
  if (!now) return nullptr;
  Asked a;
  a.description = now->description();
  const GridRect window = window_of(a.description.extent);
  a.quadtree =
      bounded ? now->ask({.region = window, .tolerance = Metres{5}, .heights = {.kind = HeightKind::bounded}}).quadtree
              : now->ask({.region = window, .tolerance = Metres{5}}).quadtree;
  a.triangles = triangulate(a.quadtree, 1).triangles.size();
  return &(made[{model, bounded}] = std::move(a));
}

constexpr StreamOptions kOneThread{.threads = 1};

void say(benchmark::State& state, const Asked& a, std::size_t bytes) {
  state.SetLabel(std::string(kModels[state.range(0)].name) + (state.range(1) != 0 ? " bounded" : " exact"));
  state.counters["vertices"] = static_cast<double>(a.quadtree.vertices.size());
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["bits"] = 8.0 * static_cast<double>(bytes) / static_cast<double>(a.triangles);
  state.counters["vertices_per_second"] = benchmark::Counter(static_cast<double>(a.quadtree.vertices.size()),
                                                             benchmark::Counter::kIsIterationInvariantRate);
}

void BM_Encode(benchmark::State& state) {
  const Asked* a = asked(static_cast<int>(state.range(0)), state.range(1) != 0);
  if (a == nullptr) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
  const Stream stream{a->description, a->quadtree};
  std::vector<std::byte> bytes;
  for (auto _ : state) bytes = encode(stream, kOneThread);
  say(state, *a, bytes.size());
}

void BM_Decode(benchmark::State& state) {
  const Asked* a = asked(static_cast<int>(state.range(0)), state.range(1) != 0);
  if (a == nullptr) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
  const auto bytes = encode({a->description, a->quadtree}, kOneThread);
  for (auto _ : state) benchmark::DoNotOptimize(decode_stream(bytes, {}, nullptr, 1));
  say(state, *a, bytes.size());
}

void every_row(benchmark::internal::Benchmark* bench) {
  for (int model = 0; model < 7; ++model) {
    for (int bounded = 0; bounded < 2; ++bounded) bench->Args({model, bounded});
  }
}
BENCHMARK(BM_Encode)->Apply(every_row)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Decode)->Apply(every_row)->Unit(benchmark::kMillisecond);

/// Bands and threads: what independence costs, and buys.
void BM_DecodeBands(benchmark::State& state) {
  const Asked* a = asked(1, false);
  if (a == nullptr) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
  StreamOptions options;
  options.stripes = static_cast<int>(state.range(0));
  const auto bytes = encode({a->description, a->quadtree}, options);
  for (auto _ : state) benchmark::DoNotOptimize(decode_stream(bytes, {}, nullptr, static_cast<int>(state.range(1))));
  state.counters["bytes"] = static_cast<double>(bytes.size());
}
BENCHMARK(BM_DecodeBands)->ArgsProduct({{1, 16, 64}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_Chain(benchmark::State& state) {
  const auto now = snapshot_of(kModels[state.range(0)]);
  if (!now) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
  const GridRect window = window_of(now->description().extent);
  std::size_t chain = 0, once = 0;
  for (auto _ : state) {
    RestrictedQuadtree client = now->ask({.region = window, .tolerance = Metres{20}}).quadtree;
    chain = encode({now->description(), client}).size();
    double from = 20;
    for (const double to : {10.0, 5.0, 2.0, 1.0}) {
      const Increment more = increment_of(now->ask({.region = window, .tolerance = Metres{to}, .from = Metres{from}}));
      chain += encode({now->description(), more}, {}, &client).size();
      client = merge(client, more);
      from = to;
    }
    once = encode({now->description(), client}).size();
  }
  state.SetLabel(kModels[state.range(0)].name);
  state.counters["chain_bytes"] = static_cast<double>(chain);
  state.counters["once_bytes"] = static_cast<double>(once);
  state.counters["ratio"] = static_cast<double>(chain) / static_cast<double>(once);
}
BENCHMARK(BM_Chain)->DenseRange(0, 6)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace talus::bench
