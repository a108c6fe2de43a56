// Terrain that is hard for arithmetic, against ordinary terrain of the same size and shape: what a sample costs to
// ingest and to ask for. Must: no case more than three times as dear a sample as ordinary terrain.

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <gdal.h>
#include <unistd.h>

#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::bench {
namespace {

namespace fs = std::filesystem;
using support::Terrain;

constexpr int kSide = 2049;
constexpr int kRounds = 5;  ///< of which the fastest counts: others use the machine

struct Kind {
  const char* name;
  GDALDataType type;
  std::function<Terrain()> make;
  double share = 1;  ///< of 2049², where the shape is another
  double cell = 1;   ///< metres; with `degrees` those
  bool degrees = false;
};

Terrain ordinary(int cols, int rows) {
  Terrain terrain(cols, rows);
  const std::vector<double> heights = mountains(std::max(cols, rows) > kSide ? kSide : std::max(cols, rows));
  const int side = std::min(kSide, std::max(cols, rows));
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      terrain.at(col, row) = heights[static_cast<std::size_t>(row % side) * static_cast<std::size_t>(side) +
                                     static_cast<std::size_t>(col % side)];
    }
  }
  return terrain;
}
Terrain ordinary() { return ordinary(kSide, kSide); }

template <class Change>
Terrain changed(Change&& change) {
  Terrain terrain = ordinary();
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) terrain.at(col, row) = change(terrain.at(col, row), col, row);
  }
  return terrain;
}

double hash(int col, int row) {  // 0 to 1, all bits
  auto h =
      static_cast<std::uint64_t>(col) * 0x9E3779B97F4A7C15u ^ static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4Fu;
  h = (h ^ h >> 32) * 0xD6E8FEB86659FD93u;
  h = (h ^ h >> 32) * 0xD6E8FEB86659FD93u;
  return static_cast<double>((h ^ h >> 32) >> 11) * 0x1p-53;
}

/// The first of each type, size and shape is the ordinary terrain that the others are held against.
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"ordinary", GDT_Int16, [] { return ordinary(); }},
      {"constant", GDT_Int16, [] { return support::plane(kSide, kSide, 417, 0, 0); }},
      {"plane", GDT_Int16, [] { return support::plane(kSide, kSide, 100, 3, -2); }},
      {"one_spike", GDT_Int16, [] { return support::spike(kSide, kSide, 1023, 1025, 50); }},
      {"checkerboard_of_extremes", GDT_Int16, [] { return support::checkerboard(kSide, kSide); }},
      {"saw_teeth", GDT_Int16,
       [] {
         return support::surface(kSide, kSide,
                                 [](int col, int row) { return (row / 40 % 2 == 0 ? 1 : 100) * ((4 - col % 4) % 4); });
       }},
      {"cliffs_on_borders", GDT_Int16,
       [] {
         return support::surface(kSide, kSide,
                                 [](int col, int row) { return col / 64 % 2 * 3000 + row / 64 % 2 * 500; });
       }},
      {"plateaus", GDT_Int16, [] { return support::plateaus(kSide, kSide); }},
      {"noise", GDT_Int16,
       [] { return changed([](double, int col, int row) { return std::floor(hash(col, row) * 60000) - 30000; }); }},
      {"quadratic_surface", GDT_Int32,
       [] {
         return support::surface(kSide, kSide,
                                 [](int col, int row) { return (col - 700.) * (col - 700.) / 4 + row * 60; });
       }},
      {"pages_of_other_ranges", GDT_Int32,
       [] { return changed([](double h, int col, int) { return col / 128 % 2 == 0 ? h : h * 400; }); }},
      {"float32_ordinary_decimetres", GDT_Float32, [] { return changed([](double h, int, int) { return h / 10; }); }},
      {"float32_all_bits", GDT_Float32,
       [] { return changed([](double h, int col, int row) { return h + hash(col, row); }); }},
      {"float32_absorption", GDT_Float32,
       [] {
         return changed(
             [](double h, int col, int row) { return col % 64 == 0 ? (row % 2 == 0 ? 1e6 : -1e6) : h / 1e5; });
       }},
      {"float32_denormals", GDT_Float32,
       [] {
         return changed(
             [](double h, int, int) { return std::round(h) * double{std::numeric_limits<float>::denorm_min()}; });
       }},
      {"float32_signed_zero", GDT_Float32,
       [] { return changed([](double, int col, int row) { return (col / 3 + row) % 2 == 0 ? 0.0 : -0.0; }); }},
      {"float64_whole", GDT_Float64, [] { return ordinary(); }},
      {"float64_all_bits", GDT_Float64,
       [] { return changed([](double h, int col, int row) { return h + hash(col, row); }); }},
      {"float64_denormals", GDT_Float64,
       [] { return changed([](double h, int, int) { return h * std::numeric_limits<double>::denorm_min(); }); }},
      {"float64_millimetres_at_1e6_m", GDT_Float64,
       [] {
         return changed([](double h, int col, int) { return ((col < 1024 ? 999000000 : -999000000) + h) / 1000; });
       }},
      {"one_void", GDT_Int16,
       [] {
         Terrain t = ordinary();
         t.make_void(1024, 1023);
         return t;
       }},
      {"void_lakes", GDT_Int16, [] { return support::void_blobs(ordinary(), 9, 3); }},
      {"void_diagonal_lines", GDT_Int16, [] { return support::void_diagonals(ordinary(), 64); }},
      {"void_block_corners", GDT_Int16,
       [] {
         Terrain t = ordinary();
         for (int row = 0; row < kSide; row += 64) {
           for (int col = 0; col < kSide; col += 64) t.make_void(col, row);
         }
         return t;
       }},
      {"void_1_percent", GDT_Int16, [] { return support::random_voids(ordinary(), 0.01, 7); }},
      {"void_97_percent", GDT_Int16, [] { return support::random_voids(ordinary(), 0.97, 7); }},
      {"one_valid_sample", GDT_Int16,
       [] {
         Terrain t = support::hole(ordinary(), 0, 0, kSide, kSide);
         t.valid[t.index(1024, 1023)] = 1;
         return t;
       }},
      {"cells_of_100_km_voids", GDT_Int16, [] { return support::void_blobs(ordinary(), 9, 3); }, 1, 100000},
      {"geographic_pole_voids", GDT_Int16, [] { return support::void_blobs(ordinary(), 9, 3); }, 1, 90.0 / 2049, true},
      {"side_2048", GDT_Int16, [] { return ordinary(2048, 2048); }},
      {"side_2050", GDT_Int16, [] { return ordinary(2050, 2050); }},
      {"long_and_thin", GDT_Int16, [] { return ordinary(524544, 8); }},
      {"tall_and_thin", GDT_Int16, [] { return ordinary(8, 524544); }},
  };
  return all;
}

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("talus_bench_hard_{}", ::getpid())) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] fs::path file(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

void write(const Kind& kind, const Terrain& terrain, const fs::path& file) {
  GDALAllRegister();
  GDALDatasetH made =
      GDALCreate(GDALGetDriverByName("GTiff"), file.c_str(), terrain.cols, terrain.rows, 1, kind.type, nullptr);
  double place[] = {0, kind.cell, 0, kind.degrees ? 90.0 : 0.0, 0, -kind.cell};
  GDALSetGeoTransform(made, place);
  if (kind.degrees) {
    GDALSetProjection(made,
                      "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
                      "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433],AUTHORITY[\"EPSG\",\"4326\"]]");
  }
  constexpr double kVoid = -32768;
  GDALRasterBandH band = GDALGetRasterBand(made, 1);
  GDALSetRasterNoDataValue(band, kVoid);
  std::vector<double> values = terrain.values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (terrain.valid[i] == 0) values[i] = kVoid;
  }
  if (GDALRasterIO(band, GF_Write, 0, 0, terrain.cols, terrain.rows, values.data(), terrain.cols, terrain.rows,
                   GDT_Float64, 0, 0) != CE_None)
    throw std::runtime_error("cannot write " + file.string());
  GDALClose(made);
}

/// Processor time of this process, all threads: others at work blur it less.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

struct Cost {
  double ingest_ns = 1e300, exact_ns = 1e300, coarse_ns = 1e300;  ///< a sample, the least of all rounds
};

/// A kind's raster and database, asked one round at a time.
class Case {
 public:
  Case(const Kind& kind, const Folder& folder, const char* name)
      : raster_(folder.file(std::string(name) + ".tif")), database_(folder.file(std::string(name) + ".talus")) {
    const Terrain terrain = kind.make();
    samples_ = static_cast<double>(terrain.values.size());
    write(kind, terrain, raster_);
  }
  void ingest_once() {
    IngestOptions options;
    options.threads = 1, options.overwrite = true;
    take(cost_.ingest_ns, [&] { (void)ingest(raster_, database_, options); });
  }
  /// The coarse question is at the tolerance that leaves a hundredth of the samples, as a range of heights allows.
  void ask_once() {
    const Snapshot now = Database::open(database_, {.threads = 1}).snapshot();
    const Description& d = now.description();
    const auto ask = [&](double tolerance) {
      const Mesh mesh = triangulate(now.ask({.region = d.extent, .tolerance = Metres{tolerance}}).quadtree, 1);
      benchmark::DoNotOptimize(mesh.triangles.data());
    };
    take(cost_.exact_ns, [&] { ask(0); });
    take(cost_.coarse_ns, [&] { ask((d.maximum_height - d.minimum_height) / 32); });
  }
  [[nodiscard]] const Cost& cost() const { return cost_; }

 private:
  template <class Work>
  void take(double& ns, Work&& work) const {
    const double begun = processor_seconds();
    work();
    ns = std::min(ns, (processor_seconds() - begun) * 1e9 / samples_);
  }

  fs::path raster_, database_;
  double samples_ = 0;
  Cost cost_;
};

/// A kind and ordinary terrain by turns, so that a machine that changes its speed changes it for both.
struct Compared {
  Cost own, ordinary;
};
Compared compared(const Kind& kind) {
  static const Folder folder;
  Case own(kind, folder, "own"), plain(kinds().front(), folder, "plain");
  for (int round = 0; round < kRounds; ++round) plain.ingest_once(), own.ingest_once();
  for (int round = 0; round < kRounds; ++round) plain.ask_once(), own.ask_once();
  return {own.cost(), plain.cost()};
}

/// One row a kind: the time is that of its ingest and its two answers, counters hold them apart and against the
/// ordinary.
void hard(benchmark::State& state, const Kind& kind) {
  const auto [own, ordinary] = compared(kind);
  for (auto _ : state) state.SetIterationTime((own.ingest_ns + own.exact_ns + own.coarse_ns) * 1e-9);
  const double ingest = own.ingest_ns / ordinary.ingest_ns, exact = own.exact_ns / ordinary.exact_ns;
  state.counters["ingest_ns"] = own.ingest_ns;
  state.counters["ingest_against_ordinary"] = ingest;
  state.counters["exact_ns"] = own.exact_ns;
  state.counters["exact_against_ordinary"] = exact;
  state.counters["coarse_ns"] = own.coarse_ns;
  state.counters["coarse_against_ordinary"] = own.coarse_ns / ordinary.coarse_ns;
  state.counters["against_ordinary"] = std::max(ingest, exact);
}

[[maybe_unused]] const bool registered = [] {
  for (const Kind& kind : kinds()) {
    benchmark::RegisterBenchmark(fmt::format("BM_Hard/{}", kind.name).c_str(),
                                 [&kind](benchmark::State& state) { hard(state, kind); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kNanosecond);
  }
  return true;
}();

}  // namespace
}  // namespace talus::bench
