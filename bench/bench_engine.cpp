// How fast are the pure parts: errors, saturation, selection, triangulation, the page codec?

#include <algorithm>
#include <limits>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "engine/error/saturation.hpp"
#include "engine/quadtree/rect.hpp"
#include "engine/quadtree/triangulation_by_vertices.hpp"
#include "engine/tile/tile.hpp"
#include "talus/quadtree.hpp"

namespace talus {
namespace {

/// A tile amid a larger raster, and its window of made mountains.
struct Ground {
  explicit Ground(Codes window) : codes(std::move(window)) {}
  Codes codes;
  std::vector<std::uint8_t> valid;
  [[nodiscard]] TileInput input() const {
    return {{1, 1}, {{0, 0}, {4 * kTileSide, 4 * kTileSide}}, view(codes), valid, {}, ground_side, 1};
  }
  static double ground_side(const HalfDiamond& t) { return t.s * 180.0; }
};

constexpr int kWindow = kTileSide + 2 * kHalo;

template <class Code>
Codes codes(double step, double base) {
  std::vector<Code> made;
  for (const double h : bench::mountains(kWindow)) made.push_back(static_cast<Code>(base + h * step));
  return made;
}

/// Scattered single voids, or little islands of data: `fraction` of all samples are void.
Ground with_voids(Codes codes, double fraction, bool islands) {
  Ground ground(std::move(codes));
  std::uint64_t state = 1;
  const auto unit = [&] {
    return static_cast<double>((state = state * 6364136223846793005u + 1) >> 33) / 2147483648.0;
  };
  ground.valid.assign(static_cast<std::size_t>(kWindow) * kWindow, islands ? 0 : 1);
  if (!islands) {
    for (auto& v : ground.valid) v = unit() >= fraction;
    return ground;
  }
  double data = 0;
  while (data < (1 - fraction) * kWindow * kWindow) {
    const auto col = static_cast<int>(unit() * kWindow), row = static_cast<int>(unit() * kWindow);
    const int radius = 10 + static_cast<int>(unit() * 50);
    for (int r = std::max(0, row - radius); r < std::min(kWindow, row + radius); ++r) {
      for (int c = std::max(0, col - radius); c < std::min(kWindow, col + radius); ++c) {
        auto& v = ground.valid[static_cast<std::size_t>(r) * kWindow + static_cast<std::size_t>(c)];
        if (v == 0 && (c - col) * (c - col) + (r - row) * (r - row) < radius * radius) v = 1, ++data;
      }
    }
  }
  return ground;
}

const Ground& whole_metres() {
  static const Ground ground(codes<std::int16_t>(1, 0));
  return ground;
}

void samples_per_second(benchmark::State& state, double samples) {
  state.counters["samples/s"] =
      benchmark::Counter(samples * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

/// Samples of the tile, the halo's work included in the time; in the memory of the tile before, as ingest does.
void BM_TileErrors(benchmark::State& state, const Ground& ground) {
  const TileInput input = ground.input();
  TileErrors errors;
  for (auto _ : state) {
    tile_errors(input, errors);
    benchmark::DoNotOptimize(&errors);
  }
  samples_per_second(state, static_cast<double>(kTileSide) * kTileSide);
}
const auto tile_benches = [] {
  const auto add = [](const std::string& name, auto&& make) {
    benchmark::RegisterBenchmark(("BM_TileErrors/" + name).c_str(), [make](benchmark::State& state) {
      const Ground ground = make();
      BM_TileErrors(state, ground);
    })->Unit(benchmark::kMillisecond);
  };
  add("int16", [] { return whole_metres(); });
  add("float_decimals", [] { return Ground(codes<float>(0.1, 200)); });
  add("float_whole_beyond_int16", [] { return Ground(codes<float>(10, 100000)); });
  add("double_decimals", [] { return Ground(codes<double>(0.1, 200)); });
  add("int16_10%_scattered_voids", [] { return with_voids(codes<std::int16_t>(1, 0), 0.1, false); });
  add("int16_0.01%_scattered_voids", [] { return with_voids(codes<std::int16_t>(1, 0), 1e-4, false); });
  add("int16_50%_voids", [] { return with_voids(codes<std::int16_t>(1, 0), 0.5, true); });
  add("int16_97%_voids", [] { return with_voids(codes<std::int16_t>(1, 0), 0.97, true); });
  add("float_decimals_97%_voids", [] { return with_voids(codes<float>(0.1, 200), 0.97, true); });
  add("int16_all_void", [] {
    Ground ground = whole_metres();
    ground.valid.assign(static_cast<std::size_t>(kWindow) * kWindow, 0);
    return ground;
  });
  return 0;
}();

/// The plain loops that the kernels are held to, of spacings below 64.
void BM_ErrorsReference(benchmark::State& state) {
  const Ground& ground = whole_metres();
  ErrorInput input;
  input.field = {{{0, 0}, {kWindow - 1, kWindow - 1}}, view(ground.codes), {}, {}};
  for (auto _ : state) {
    auto errors = reference_errors(input, kTileLevels);
    saturate(input, errors);
    benchmark::DoNotOptimize(&errors);
  }
  samples_per_second(state, static_cast<double>(kWindow) * kWindow);
}
BENCHMARK(BM_ErrorsReference)->Unit(benchmark::kMillisecond);

/// A tile and its errors. The heights are no whole numbers, so that there is a tolerance for every share of the samples.
struct Settled {
  GridRect extent{{kTileSide, kTileSide}, {2 * kTileSide - 1, 2 * kTileSide - 1}};
  TileErrors tile = tile_errors(uneven().input());

  static Ground uneven() {
    std::vector<float> heights;
    std::uint32_t state = 1;
    for (const double h : bench::mountains(kWindow)) {
      state = state * 1664525 + 1013904223;
      heights.push_back(static_cast<float>(h) + static_cast<float>(state >> 24) / 256);
    }
    return Ground(std::move(heights));
  }
};
const Settled& settled() {
  static const Settled s;
  return s;
}

/// The vertices above the tolerance that selects about this many per cent of all samples.
RestrictedQuadtree selected(int percent) {
  const Settled& ground = settled();
  std::vector<double> errors;
  for_each_point(ground.extent, [&](GridPoint p) {
    errors.push_back(spacing(p) >= kBlockSide ? std::numeric_limits<double>::infinity()
                                              : error_of(ground.tile.errors[p]));
  });
  const auto left_out = static_cast<std::ptrdiff_t>(errors.size()) * (100 - percent) / 100;
  std::vector<double> by_size = errors;
  std::nth_element(by_size.begin(), by_size.begin() + left_out, by_size.end());
  const double tolerance = by_size[static_cast<std::size_t>(left_out)];
  RestrictedQuadtree q;
  q.vertices = VertexMask(ground.extent);
  std::size_t next = 0;
  for_each_point(ground.extent, [&](GridPoint p) {
    if (errors[next++] > tolerance) q.vertices.insert(p);
  });
  q.vertices.seal();
  q.heights.resize(q.vertices.size());
  return q;
}

/// One thread, with the kernel that TALUS_KERNEL names: into the memory of the mesh before, into fresh memory, and the
/// loop over vertices that small quadtrees are left to.
enum class Way { reused, fresh, by_vertices };
template <Way way>
void BM_Triangulation(benchmark::State& state) {
  const RestrictedQuadtree q = selected(static_cast<int>(state.range(0)));
  Mesh mesh;
  for (auto _ : state) {
    if constexpr (way == Way::fresh) mesh = triangulate(q, 1);
    if constexpr (way == Way::reused) triangulate(q, mesh, 1);
    if constexpr (way == Way::by_vertices) detail::triangulate_by_vertices(q, mesh, 1, {});
    benchmark::DoNotOptimize(mesh.triangles.data());
  }
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(mesh.triangles.size()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["selected_%"] =
      100.0 * static_cast<double>(q.vertices.size()) / static_cast<double>(settled().extent.samples());
}
void shares(benchmark::internal::Benchmark* bench) {
  bench->ArgName("percent")->Arg(2)->Arg(12)->Arg(45)->Arg(88)->Unit(benchmark::kMillisecond);
}
BENCHMARK(BM_Triangulation<Way::reused>)->Name("BM_Triangulation/reused")->Apply(shares);
BENCHMARK(BM_Triangulation<Way::fresh>)->Name("BM_Triangulation/fresh")->Apply(shares);
BENCHMARK(BM_Triangulation<Way::by_vertices>)->Name("BM_Triangulation/by_vertices")->Apply(shares);

}  // namespace
}  // namespace talus
