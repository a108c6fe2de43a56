// How fast are the pure parts: errors, saturation, selection, triangulation? The page codec: bench_codec.

#include <benchmark/benchmark.h>

#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "engine/saturation.hpp"
#include "engine/triangulation.hpp"

namespace talus {
namespace {

struct Ground {
  explicit Ground(int side, double step = 1) : heights(bench::mountains(side)) {
    for (double& h : heights) h = h * step;
    extent = {{0, 0}, {side - 1, side - 1}};
    input.field = {
        extent, heights, {}, {}, interpolation_is_exact(heights, root_side(extent)), are_whole_numbers(heights)};
  }
  std::vector<double> heights;
  GridRect extent;
  ErrorInput input;
};

const Ground& ground(int side) {
  static const Ground small(1025), large(4097);
  return side == 1025 ? small : large;
}

void samples_per_second(benchmark::State& state, double samples) {
  state.counters["samples/s"] =
      benchmark::Counter(samples * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void BM_ErrorsReference(benchmark::State& state) {
  const Ground& g = ground(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    auto errors = reference_errors(g.input);
    saturate(g.input, errors);
    benchmark::DoNotOptimize(&errors);
  }
  samples_per_second(state, static_cast<double>(g.extent.samples()));
}
BENCHMARK(BM_ErrorsReference)->ArgName("side")->Arg(1025)->Unit(benchmark::kMillisecond);

void BM_ErrorsAndSaturation(benchmark::State& state) {
  const Ground& g = ground(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    auto errors = vertex_errors(g.input);
    saturate(g.input, errors);
    benchmark::DoNotOptimize(&errors);
  }
  samples_per_second(state, static_cast<double>(g.extent.samples()));
}
BENCHMARK(BM_ErrorsAndSaturation)->ArgName("side")->Arg(1025)->Arg(4097)->Unit(benchmark::kMillisecond);

/// Float decimetres: not whole numbers, doubles in the kernel.
void BM_ErrorsAndSaturationFloat(benchmark::State& state) {
  static const Ground g(1025, 0.1);
  for (auto _ : state) {
    auto errors = vertex_errors(g.input);
    saturate(g.input, errors);
    benchmark::DoNotOptimize(&errors);
  }
  samples_per_second(state, static_cast<double>(g.extent.samples()));
}
BENCHMARK(BM_ErrorsAndSaturationFloat)->Unit(benchmark::kMillisecond);

void BM_Saturation(benchmark::State& state) {
  const Ground& g = ground(static_cast<int>(state.range(0)));
  auto errors = vertex_errors(g.input);
  for (auto _ : state) {
    saturate(g.input, errors);  // the same work each time
    benchmark::DoNotOptimize(&errors);
  }
  samples_per_second(state, static_cast<double>(g.extent.samples()));
}
BENCHMARK(BM_Saturation)->ArgName("side")->Arg(4097)->Unit(benchmark::kMillisecond);

RestrictedQuadtree selected(const Ground& g, double tolerance) {
  static LevelGrid<ErrorCode> errors = [&] {
    auto e = vertex_errors(g.input);
    saturate(g.input, e);
    return e;
  }();
  RestrictedQuadtree q;
  q.vertices = VertexMask(g.extent);
  for (std::int32_t row = 0; row <= g.extent.last.row; ++row) {
    for (std::int32_t col = 0; col <= g.extent.last.col; ++col) {
      const GridPoint p{col, row};
      if (spacing(p) >= errors.root() || error_of(errors[p]) > tolerance) q.vertices.insert(p);
    }
  }
  q.vertices.seal();
  q.heights.resize(q.vertices.size());
  return q;
}

void BM_Triangulation(benchmark::State& state) {
  const RestrictedQuadtree q = selected(ground(4097), static_cast<double>(state.range(0)));
  std::size_t triangles = 0;
  for (auto _ : state) {
    const Mesh mesh = triangulate(q);
    triangles += mesh.triangles.size();
    benchmark::DoNotOptimize(mesh.triangles.data());
  }
  state.counters["triangles/s"] = benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
  state.counters["vertices"] = static_cast<double>(q.vertices.size());
}
BENCHMARK(BM_Triangulation)->ArgName("tolerance_m")->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace talus
