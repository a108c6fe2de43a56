// How long does a rectangle take, from file to indexed mesh?
//
// Data: swiss_germany.vrt where the real models are (TALUS_DEM_DIR), and a made terrain of 2049² samples that is
// always there. The file is in the system's cache: warm. Rectangles keep nothing decoded between questions, points and
// lines do.

#include <list>
#include <map>

#include <benchmark/benchmark.h>
#include <gdal_priv.h>

#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "query/pages/page_cache.hpp"
#include "talus/ingest.hpp"
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
  /// The same, with a cache of decoded pages.
  const Snapshot& kept() {
    static const Snapshot kept = Database::open(made_file(), {.threads = 1}).snapshot();
    return kept;
  }
  fs::path made_file() {
    (void)made();
    return folder_ / "made.talus";
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
      found = open_.emplace(name, Database::open(folder_ / name, {.cache_bytes = 0, .threads = 1}).snapshot()).first;
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
    const Answer answer = now.ask({.region = region, .tolerance = Metres{tolerance}});
    const Mesh mesh = triangulate(answer.quadtree, 1);
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

/// A million points strewn over the made terrain, its pages decoded but for the first time (all fit), or each time
/// anew.
void heights(benchmark::State& state, std::uint64_t cache_bytes, std::optional<Metres> tolerance, double spread) {
  const Snapshot now = Database::open(databases().made_file(), {.cache_bytes = cache_bytes, .threads = 1}).snapshot();
  std::vector<Position> points;
  std::uint64_t bits = 1;
  const auto random = [&] {
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    return 0.5 + spread * static_cast<double>(bits >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 1000000; ++i) {
    const double x = random();
    points.push_back({x, -random()});
  }
  std::vector<std::optional<double>> found(points.size());
  const auto ask = [&] { return tolerance ? now.heights(points, found, *tolerance) : now.heights(points, found); };
  ask();
  QueryCost cost;
  for (auto _ : state) cost = ask();
  state.counters["pages"] = static_cast<double>(cost.pages_read);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
constexpr std::uint64_t kAll = std::uint64_t{1} << 30;
void BM_Heights_Warm(benchmark::State& state) { heights(state, kAll, std::nullopt, 2048); }
BENCHMARK(BM_Heights_Warm)->Unit(benchmark::kMillisecond);
void BM_Heights_NothingKept(benchmark::State& state) { heights(state, 0, std::nullopt, 2048); }
BENCHMARK(BM_Heights_NothingKept)->Unit(benchmark::kMillisecond);
void BM_HeightsOfSurface_Warm(benchmark::State& state) {
  heights(state, kAll, Metres{static_cast<double>(state.range(0))}, 2048);
}
BENCHMARK(BM_HeightsOfSurface_Warm)->ArgName("tolerance_m")->Arg(1)->Arg(20)->Unit(benchmark::kMillisecond);

/// One point at a time, the way programs ask.
void BM_Height_Warm(benchmark::State& state) {
  const Snapshot& now = databases().kept();
  for (auto _ : state) benchmark::DoNotOptimize(now.height(700.3, -900.7));
}
BENCHMARK(BM_Height_Warm);
void BM_HeightOfSurface_Warm(benchmark::State& state) {
  const Snapshot& now = databases().kept();
  for (auto _ : state) benchmark::DoNotOptimize(now.height(700.3, -900.7, Metres{1}));
}
BENCHMARK(BM_HeightOfSurface_Warm);

/// From corner to corner.
void BM_Profile_Warm(benchmark::State& state) {
  const Snapshot& now = databases().kept();
  const std::vector<Position> line{{1, -3}, {2040, -2030}};
  std::size_t vertices = 0;
  for (auto _ : state) {
    const Profile profile = now.profile(line, Metres{static_cast<double>(state.range(0))});
    vertices = profile.parts.at(0).size();
  }
  state.counters["vertices"] = static_cast<double>(vertices);
}
BENCHMARK(BM_Profile_Warm)->ArgName("tolerance_m")->Arg(1)->Arg(20)->Unit(benchmark::kMillisecond);

/// What a page costs to keep a copy of: in memory that is used again, or in fresh memory.
void BM_PageCache(benchmark::State& state) {
  const bool recycled = state.range(0) != 0;
  Page page;
  page.is_dense = true;
  page.squares.resize(1);
  PageCache cache(std::uint64_t{64} << 20);
  std::list<std::shared_ptr<const Page>> fresh;
  std::uint64_t position = 0;
  for (auto _ : state) {
    if (recycled) {
      const PageCache::BorrowedDecoder decoder = cache.borrow_decoder();
      benchmark::DoNotOptimize(cache.keep({0, ++position, 0}, page));
    } else {
      fresh.push_back(std::make_shared<const Page>(page));
      if (fresh.size() > 256) fresh.pop_front();
    }
  }
}
BENCHMARK(BM_PageCache)->ArgName("recycled")->Arg(1)->Arg(0)->Unit(benchmark::kMicrosecond)->Iterations(5000);

}  // namespace
}  // namespace talus
