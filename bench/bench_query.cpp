// How long does a rectangle take, from file to indexed mesh?
//
// Data: swiss_germany.vrt where the real models are (TALUS_DEM_DIR), and a made terrain of 2049² samples that is
// always there. The file is in the system's cache, nothing decoded is kept between questions: warm.

#include <map>

#include <benchmark/benchmark.h>
#include <gdal_priv.h>

#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "talus/talus.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// Databases of this run, removed at its end.
class Databases {
 public:
  ~Databases() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  const Snapshot& made() {
    return open("made.talus", [&] { return write_made(); });
  }
  const Snapshot* real(const std::string& name) {
    const auto file = bench::real_model(name);
    return file ? &open(fs::path(name).stem().string() + ".talus", [&] { return *file; }) : nullptr;
  }

 private:
  template <class Source>
  const Snapshot& open(const std::string& name, Source&& source) {
    auto found = open_.find(name);
    if (found == open_.end()) {
      ingest(source(), folder_ / name, {.overwrite = true});
      found = open_.emplace(name, Database::open(folder_ / name).snapshot()).first;
    }
    return found->second;
  }
  fs::path write_made() {
    constexpr int kSide = 2049;
    const auto heights = bench::mountains(kSide);
    std::vector<std::int16_t> whole(heights.begin(), heights.end());
    GDALAllRegister();
    const fs::path file = folder_ / "made.tif";
    auto* dataset =
        GetGDALDriverManager()->GetDriverByName("GTiff")->Create(file.c_str(), kSide, kSide, 1, GDT_Int16, nullptr);
    const CPLErr written = dataset->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, kSide, kSide, whole.data(), kSide, kSide,
                                                               GDT_Int16, 0, 0, nullptr);
    GDALClose(dataset);
    if (written != CE_None) throw Failure(Cause::io, file.string() + ": cannot be written");
    return file;
  }
  static fs::path make_folder() {
    std::string name = (fs::temp_directory_path() / "talus-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Failure(Cause::io, name + ": cannot make a folder");
    return name;
  }
  fs::path folder_ = make_folder();
  std::map<std::string, Snapshot> open_;
};
Databases& databases() {
  static Databases all;
  return all;
}

void ask(benchmark::State& state, const Snapshot& now, GridRect region, double tolerance) {
  std::size_t vertices = 0, triangles = 0;
  QueryCost cost;
  for (auto _ : state) {
    const Answer answer = now.range(region, Metres{tolerance});
    const Mesh mesh = triangulate(answer.quadtree);
    benchmark::DoNotOptimize(mesh.triangles.data());
    vertices = mesh.points.size();
    triangles = mesh.triangles.size();
    cost = answer.cost;
  }
  state.counters["vertices"] = static_cast<double>(vertices);
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["pages"] = static_cast<double>(cost.pages_read);
  state.counters["kB"] = static_cast<double>(cost.bytes_read) / 1000;
}

void BM_WindowMade_Warm(benchmark::State& state) {
  ask(state, databases().made(), {{512, 512}, {1536, 1536}}, static_cast<double>(state.range(0)));
}
BENCHMARK(BM_WindowMade_Warm)->ArgName("tolerance_m")->Arg(1)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

/// 1025² samples of the Alps and their foreland.
void BM_WindowSwiss_Warm(benchmark::State& state) {
  const Snapshot* now = databases().real("swiss_germany_3s/swiss_germany.vrt");
  if (now == nullptr) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
  ask(state, *now, {{1024, 2048}, {2048, 3072}}, static_cast<double>(state.range(0)));
}
BENCHMARK(BM_WindowSwiss_Warm)->ArgName("tolerance_m")->Arg(1)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

/// 65² samples at tolerance 0: what the smallest question costs.
void BM_SmallWindowSwiss_Warm(benchmark::State& state) {
  const Snapshot* now = databases().real("swiss_germany_3s/swiss_germany.vrt");
  if (now == nullptr) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
  ask(state, *now, {{1700, 2500}, {1764, 2564}}, 0);
}
BENCHMARK(BM_SmallWindowSwiss_Warm)->Unit(benchmark::kMillisecond);

/// The whole mosaic at 50 m.
void BM_WholeSwiss_Warm(benchmark::State& state) {
  const Snapshot* now = databases().real("swiss_germany_3s/swiss_germany.vrt");
  if (now == nullptr) return state.SkipWithError("no real models here, see TALUS_DEM_DIR");
  ask(state, *now, now->description().extent, static_cast<double>(state.range(0)));
}
BENCHMARK(BM_WholeSwiss_Warm)->ArgName("tolerance_m")->Arg(50)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace talus
