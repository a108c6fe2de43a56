#pragma once
// What this machine can do in this run: absolute times mean little without it.

#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>

namespace talus::bench {

/// Copies 64 MiB in memory. Include this header once in a bench, and it is the first line of its table.
inline void BM_Memcpy(benchmark::State& state) {
  std::vector<char> from(std::size_t{64} << 20, 1), to(from.size());
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::DoNotOptimize(to.data());
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(from.size()) * state.iterations());
}
BENCHMARK(BM_Memcpy)->Unit(benchmark::kMillisecond);

}  // namespace talus::bench
