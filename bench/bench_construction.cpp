// What does saturation buy? One set of vertices three ways: a threshold on saturated errors, and both construction
// algorithms over errors that are not saturated.
//
// Data: 1025² samples of swiss_germany.vrt where the real models are (TALUS_DEM_DIR), and as many of a made terrain.
// Errors lie in memory row by row. `whole` is the window as an extent of its own; `inner` is a region of 513² amid it,
// where vertices beyond the region would have wanted some inside.

#include <memory>

#include <benchmark/benchmark.h>
#include <gdal_priv.h>

#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "engine/error/saturation.hpp"
#include "engine/quadtree/construction.hpp"

namespace talus {
namespace {

constexpr int kSide = 1025;
constexpr GridRect kWhole{{0, 0}, {kSide - 1, kSide - 1}}, kInner{{257, 257}, {769, 769}};

/// Error codes row by row; root corners are always selected.
struct Errors {
  std::vector<ErrorCode> codes;

  explicit Errors(const LevelGrid<ErrorCode>& by_level) : codes(static_cast<std::size_t>(kSide) * kSide) {
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) {
        const GridPoint p{col, row};
        codes[index(p)] = height_in_tree(p) < by_level.levels() ? by_level[p] : kAlwaysSelected;
      }
    }
  }
  static std::size_t index(GridPoint p) {
    return static_cast<std::size_t>(p.row) * kSide + static_cast<std::size_t>(p.col);
  }
  ErrorCode operator[](GridPoint p) const { return codes[index(p)]; }
};

/// All that the three ways read.
struct Ground {
  std::vector<std::int16_t> heights;
  ErrorInput input;
  std::int32_t root = root_side(kWhole);
  LevelGrid<ErrorCode> raw_by_level, squares;  ///< of squares: the largest error on their centres' places
  Errors raw, saturated;

  explicit Ground(std::vector<std::int16_t> samples)
      : heights(std::move(samples)),
        input{{kWhole, std::span<const std::int16_t>(heights), {}, {}}, nullptr, nullptr, {}, 1},
        raw_by_level(reference_errors(input, std::countr_zero(static_cast<std::uint32_t>(root)))),
        squares(raw_by_level),
        raw(raw_by_level),
        saturated(saturate_all()) {
    // Of a square: its centre, its side midpoints and the four squares in it. These are not saturated errors: nothing
    // passes from a square to its neighbours, and a centre does not count for the corners of its square.
    for (int shift = 0; shift < squares.levels(); ++shift) {
      squares.for_each(shift, true, [&](GridPoint p) {
        ErrorCode& largest = squares[p];
        const auto take = [&](GridPoint q) {
          if (squares.holds(q)) largest = std::max(largest, squares[q]);
        };
        for (const GridPoint q : children(p).at) take(q);
        if (const std::int32_t h = spacing(p) / 2; h > 0) {
          for (const std::int32_t south : {-h, h}) {
            for (const std::int32_t east : {-h, h}) take({p.col + east, p.row + south});
          }
        }
      });
    }
  }
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;

 private:
  [[nodiscard]] Errors saturate_all() const {
    LevelGrid<ErrorCode> errors = raw_by_level;
    saturate(input, errors);
    return Errors(errors);
  }
};

const Ground* made() {
  static const auto ground = [] {
    const auto heights = bench::mountains(kSide);
    return std::make_unique<Ground>(std::vector<std::int16_t>(heights.begin(), heights.end()));
  }();
  return ground.get();
}

/// Where bench_query asks, too. Its three voids take the height west of them: voids are not the question here.
const Ground* swiss() {
  static const auto ground = []() -> std::unique_ptr<Ground> {
    const auto file = bench::real_model("swiss_germany_3s/swiss_germany.vrt");
    if (!file) return nullptr;
    GDALAllRegister();
    const std::unique_ptr<GDALDataset> raster(GDALDataset::Open(file->c_str()));
    std::vector<std::int16_t> heights(static_cast<std::size_t>(kSide) * kSide);
    if (raster == nullptr || raster->GetRasterBand(1)->RasterIO(GF_Read, 1024, 2048, kSide, kSide, heights.data(),
                                                                kSide, kSide, GDT_Int16, 0, 0, nullptr) != CE_None) {
      return nullptr;
    }
    const double none = raster->GetRasterBand(1)->GetNoDataValue();
    for (std::size_t i = 1; i < heights.size(); ++i) {
      if (heights[i] == none) heights[i] = heights[i - 1];
    }
    return std::make_unique<Ground>(std::move(heights));
  }();
  return ground.get();
}

VertexMask above(const Errors& errors, GridRect region, ErrorCode threshold) {
  VertexMask found(region);
  for (std::int32_t row = region.first.row; row <= region.last.row; ++row) {
    const ErrorCode* code = &errors.codes[Errors::index({region.first.col, row})];
    auto left = region.cols();
    for (std::uint64_t& word : found.row_words(row)) {
      for (int bit = 0; bit < 64 && bit < left; ++bit) word |= std::uint64_t{*code++ > threshold} << bit;
      left -= 64;
    }
  }
  return found;
}

VertexMask by_threshold(const Ground& ground, GridRect region, ErrorCode threshold) {
  return above(ground.saturated, region, threshold);
}
VertexMask by_bottom_up(const Ground& ground, GridRect region, ErrorCode threshold) {
  VertexMask found = above(ground.raw, region, threshold);
  close_bottom_up(found, ground.root);
  return found;
}
VertexMask by_top_down(const Ground& ground, GridRect region, ErrorCode threshold) {
  return close_top_down(
      region, ground.root, [&](GridPoint p) { return ground.raw[p] > threshold; },
      [&](GridPoint centre) { return ground.squares[centre] > threshold; });
}

std::size_t size_of(VertexMask mask) {
  mask.seal();
  return mask.size();
}

const auto benches = [] {
  const auto add = [](const std::string& name, auto ground, GridRect region, double tolerance, auto select) {
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
      if (ground() == nullptr) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
      const ErrorCode threshold = largest_code_within(tolerance);
      for (auto _ : state) {
        const VertexMask found = select(*ground(), region, threshold);
        benchmark::DoNotOptimize(&found);
      }
      state.counters["vertices"] = static_cast<double>(size_of(select(*ground(), region, threshold)));
      state.counters["wanted"] = static_cast<double>(size_of(above(ground()->raw, region, threshold)));
    })->Unit(benchmark::kMicrosecond);
  };
  for (const auto& [where, ground] : {std::pair{"Made", &made}, {"Swiss", &swiss}}) {
    for (const auto& [part, region] : {std::pair{"whole", kWhole}, {"inner", kInner}}) {
      for (const int tolerance : {1, 5, 20}) {
        const std::string rest = std::string(where) + "/" + part + "/tolerance_m:" + std::to_string(tolerance);
        add("BM_SaturatedThreshold/" + rest, ground, region, tolerance, by_threshold);
        add("BM_BottomUp/" + rest, ground, region, tolerance, by_bottom_up);
        add("BM_TopDown/" + rest, ground, region, tolerance, by_top_down);
      }
    }
  }
  return 0;
}();

/// What is paid once, at ingest.
void BM_Saturation(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    LevelGrid<ErrorCode> errors = made()->raw_by_level;
    state.ResumeTiming();
    saturate(made()->input, errors);
    benchmark::DoNotOptimize(&errors);
  }
}
BENCHMARK(BM_Saturation)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace talus
