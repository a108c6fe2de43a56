// What questions must reach, a row each: `measured` beside `must`. Those against other programs are in bench/peers.
//
// Databases are kept under build/kept. Times are this process's processor time, on one thread, unless said otherwise:
// the same as the clock's where nobody else is at work. Ratios are of medians of two times taken by turns; `by_clock`
// is the same ratio of the clock's.

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <vector>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "bench/kept.hpp"
#include "bench/page_trace.hpp"
#include "bench/terrain.hpp"
#include "talus/talus.hpp"

namespace talus::bench {
namespace {

namespace fs = std::filesystem;
constexpr int kTurns = 9;
constexpr const char* kNoModels = "no real models here, see TALUS_DEM_DIR";
constexpr const char* kSwiss = "swiss_germany_3s/swiss_germany.vrt";
constexpr GridRect kSwissWindow{{1024, 2048}, {2048, 3072}};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Seconds of one work, time after time.
class Times {
 public:
  template <class Work>
  void add(Work&& work) {
    const auto begun = std::chrono::steady_clock::now();
    const double worked = processor_seconds();
    work();
    processor_.push_back(processor_seconds() - worked);
    clock_.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
  }
  [[nodiscard]] double last() const { return processor_.back(); }
  [[nodiscard]] double last_by_clock() const { return clock_.back(); }
  [[nodiscard]] double by_processor() const { return median(processor_); }
  [[nodiscard]] double by_clock() const { return median(clock_); }

 private:
  static double processor_seconds() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }
  std::vector<double> processor_, clock_;
};

void say(benchmark::State& state, double measured, double must) {
  state.counters["measured"] = measured;
  state.counters["must"] = must;
}

/// Time over time.
void say(benchmark::State& state, const Times& ours, const Times& theirs, double must) {
  say(state, ours.by_processor() / theirs.by_processor(), must);
  state.counters["by_clock"] = ours.by_clock() / theirs.by_clock();
}

std::optional<fs::path> kept(const char* model) {
  const auto source = real_model(model);
  if (!source) return std::nullopt;
  return kept_database(source->stem().string(), [&] { return *source; });
}

Mesh mesh(const Snapshot& now, GridRect region, Metres tolerance) {
  Mesh made = triangulate(now.ask({.region = region, .tolerance = tolerance}).quadtree, 1);
  benchmark::DoNotOptimize(made.triangles.data());
  return made;
}

// ---- large windows and whole countries --------------------------------------------------------------------------

constexpr GridRect kTaiwanWindow{{4096, 8192}, {8192, 12288}};   // the island's highest mountains, on tiles' sides
constexpr GridRect kTaiwanShifted{{4700, 8900}, {8796, 12996}};  // on no tile's side

/// 4097² samples, as many vertices as two million allow. Must: milliseconds.
void BM_Window4097_Warm(benchmark::State& state) {
  const auto file = kept("taiwan_z13/taiwan.vrt");
  if (!file) return state.SkipWithError(kNoModels);
  const Snapshot now = Database::open(*file, {.cache_bytes = 0, .threads = 1}).snapshot();
  const Metres tolerance = now.ask({.region = kTaiwanWindow, .budget = {.vertices = 2'000'000}}).quadtree.tolerance;
  Times asked, triangulated;
  std::size_t vertices = 0, triangles = 0;
  QueryCost cost;
  for (auto _ : state) {
    std::optional<Answer> answer;
    Mesh made;
    asked.add([&] { answer.emplace(now.ask({.region = kTaiwanWindow, .tolerance = tolerance})); });
    triangulated.add([&] { made = triangulate(answer->quadtree, 1); });
    state.SetIterationTime(asked.last() + triangulated.last());
    vertices = made.points.size();
    triangles = made.triangles.size();
    cost = answer->cost;
  }
  say(state, 1000 * (asked.by_processor() + triangulated.by_processor()), 80);
  state.counters["by_clock"] = 1000 * (asked.by_clock() + triangulated.by_clock());
  state.counters["range_ms"] = 1000 * asked.by_processor();
  state.counters["triangulate_ms"] = 1000 * triangulated.by_processor();
  state.counters["tolerance_m"] = tolerance.value;
  state.counters["vertices"] = static_cast<double>(vertices);
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["pages"] = static_cast<double>(cost.pages_read);
  state.counters["kB"] = static_cast<double>(cost.bytes_read) / 1000;
}
BENCHMARK(BM_Window4097_Warm)->Iterations(kTurns)->UseManualTime()->Unit(benchmark::kMillisecond);

/// The same window on two threads, against one: by the clock. Must: how many times as fast, at least.
void BM_TwoThreadsAgainstOne(benchmark::State& state) {
  const auto file = kept("taiwan_z13/taiwan.vrt");
  if (!file) return state.SkipWithError(kNoModels);
  const Snapshot one = Database::open(*file, {.cache_bytes = 0, .threads = 1}).snapshot();
  const Snapshot two = Database::open(*file, {.cache_bytes = 0, .threads = 2}).snapshot();
  const Metres tolerance = one.ask({.region = kTaiwanWindow, .budget = {.vertices = 2'000'000}}).quadtree.tolerance;
  Times by_one, by_two;
  for (auto _ : state) {
    by_one.add([&] {
      benchmark::DoNotOptimize(
          triangulate(one.ask({.region = kTaiwanWindow, .tolerance = tolerance}).quadtree, 1).points.data());
    });
    by_two.add([&] {
      benchmark::DoNotOptimize(
          triangulate(two.ask({.region = kTaiwanWindow, .tolerance = tolerance}).quadtree, 2).points.data());
    });
    state.SetIterationTime(by_two.last_by_clock());
  }
  say(state, by_one.by_clock() / by_two.by_clock(), 1.7);
  state.counters["one_ms"] = 1000 * by_one.by_clock();
  state.counters["two_ms"] = 1000 * by_two.by_clock();
}
BENCHMARK(BM_TwoThreadsAgainstOne)->Iterations(kTurns)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Pieces of the file that a window of 4097² reads; `near`, if gaps of up to 64 KiB are none. LMDB's own pages are not
/// counted.
void BM_RunsOfWindow4097(benchmark::State& state) {
  const auto file = kept("taiwan_z13/taiwan.vrt");
  if (!file) return state.SkipWithError(kNoModels);
  const Snapshot now = Database::open(*file, {.cache_bytes = 0, .threads = 1}).snapshot();
  const GridRect window = state.range(0) != 0 ? kTaiwanShifted : kTaiwanWindow;
  const Metres tolerance = now.ask({.region = window, .budget = {.vertices = 2'000'000}}).quadtree.tolerance;
  std::size_t runs = 0;
  for (auto _ : state) {
    const PageTrace trace;
    const Answer answer = now.ask({.region = window, .tolerance = tolerance});
    if (answer.cost.pages_read == 0 || trace.reads().size() < answer.cost.pages_read - 1) {
      return state.SkipWithError("pages were read unseen: the linker's --wrap no longer fits page_checksum");
    }
    runs = trace.runs(0);
    state.counters["near"] = static_cast<double>(trace.runs(64 << 10));
  }
  say(state, static_cast<double>(runs), 8);
}
BENCHMARK(BM_RunsOfWindow4097)->ArgName("shifted")->Arg(0)->Arg(1)->Iterations(1);

/// All of Taiwan at 50 m. Must: per cent of the database's pages.
void BM_PagesOfWholeTaiwan(benchmark::State& state) {
  const auto file = kept("taiwan_z13/taiwan.vrt");
  if (!file) return state.SkipWithError(kNoModels);
  const Snapshot now = Database::open(*file, {.cache_bytes = 0, .threads = 1}).snapshot();
  const StorageSummary storage = now.storage();
  QueryCost cost;
  std::size_t vertices = 0;
  for (auto _ : state) {
    const Answer answer = now.ask({.region = now.description().extent, .tolerance = Metres{50}});
    vertices = answer.quadtree.vertices.size();
    cost = answer.cost;
    benchmark::DoNotOptimize(triangulate(answer.quadtree, 1).triangles.data());
  }
  say(state, 100 * static_cast<double>(cost.bytes_read) / static_cast<double>(storage.file_bytes), 5);
  state.counters["pages"] = static_cast<double>(cost.pages_read);
  state.counters["all_pages"] = static_cast<double>(storage.pages);
  state.counters["vertices"] = static_cast<double>(vertices);
}
BENCHMARK(BM_PagesOfWholeTaiwan)->Iterations(5)->Unit(benchmark::kMillisecond);

// ---- growth -----------------------------------------------------------------------------------------------------

/// A virtual raster that repeats a real one of 1201² samples, as many times across as down.
fs::path repeated(const fs::path& original, int times) {
  const fs::path piece = kept_folder() / original.filename();  // virtual rasters may only name what lies beside them
  fs::copy_file(original, piece, fs::copy_options::skip_existing);
  const fs::path file = kept_folder() / fmt::format("repeated_{}.vrt", times);
  std::ofstream vrt(file);
  vrt << fmt::format(R"(<VRTDataset rasterXSize="{0}" rasterYSize="{0}"><SRS>EPSG:3035</SRS>)", 1200 * times + 1)
      << R"(<GeoTransform>0, 90, 0, 0, 0, -90</GeoTransform><VRTRasterBand dataType="Int16" band="1">)"
      << "<NoDataValue>-32767</NoDataValue>";  // as in the original
  for (int row = 0; row < times; ++row) {
    for (int col = 0; col < times; ++col) {
      vrt << fmt::format(
                 R"(<SimpleSource><SourceFilename relativeToVRT="1">{}</SourceFilename><SourceBand>1</SourceBand>)",
                 piece.filename().string())
          << R"(<SrcRect xOff="0" yOff="0" xSize="1201" ySize="1201"/>)"
          << fmt::format(R"(<DstRect xOff="{}" yOff="{}" xSize="1201" ySize="1201"/></SimpleSource>)", 1200 * col,
                         1200 * row);
    }
  }
  vrt << "</VRTRasterBand></VRTDataset>\n";
  return file;
}

/// One window, of a raster and of one a hundred times as large that it is a part of. Must: time over time.
void BM_HundredTimesTheGround(benchmark::State& state) {
  const auto piece = real_model("srtm3_S36E149.tif");
  if (!piece) return state.SkipWithError(kNoModels);
  const auto of = [&](int times) {
    return Database::open(kept_database(fmt::format("repeated_{}", times), [&] { return repeated(*piece, times); }),
                          {.cache_bytes = 0, .threads = 1})
        .snapshot();
  };
  const Snapshot small = of(1), large = of(10);
  constexpr GridRect kWindow{{64, 64}, {1088, 1088}};
  const Metres tolerance{static_cast<double>(state.range(0))};
  Times of_small, of_large;
  Mesh a, b;
  for (auto _ : state) {
    of_small.add([&] { a = mesh(small, kWindow, tolerance); });
    of_large.add([&] { b = mesh(large, kWindow, tolerance); });
    state.SetIterationTime(of_large.last());
  }
  if (a.points != b.points || a.heights != b.heights) return state.SkipWithError("two answers");
  say(state, of_large, of_small, 1.3);
  state.counters["vertices"] = static_cast<double>(b.points.size());
  state.counters["pages_small"] =
      static_cast<double>(small.ask({.region = kWindow, .tolerance = tolerance}).cost.pages_read);
  state.counters["pages_large"] =
      static_cast<double>(large.ask({.region = kWindow, .tolerance = tolerance}).cost.pages_read);
}
BENCHMARK(BM_HundredTimesTheGround)
    ->ArgName("tolerance_m")
    ->Arg(1)
    ->Arg(5)
    ->Arg(20)
    ->Iterations(kTurns)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

// ---- increments -------------------------------------------------------------------------------------------------

/// From 5 m to 4 m in one session, against all of 4 m. Must: time over time; `with_apply` counts the client's part,
/// too.
void BM_IncrementAgainstAnew(benchmark::State& state) {
  const auto file = kept(kSwiss);
  if (!file) return state.SkipWithError(kNoModels);
  const Snapshot now = Database::open(*file, {.threads = 1}).snapshot();
  Times step, anew, applied;
  std::size_t added = 0, all = 0;
  for (auto _ : state) {
    Session session(std::uint64_t{64} << 20);
    const RestrictedQuadtree client = session.next(now, kSwissWindow, Metres{5}).added.added;
    Difference difference;
    std::optional<Answer> answer;
    step.add([&] { difference = session.next(now, kSwissWindow, Metres{4}); });
    anew.add([&] { answer.emplace(now.ask({.region = kSwissWindow, .tolerance = Metres{4}})); });
    applied.add([&] { benchmark::DoNotOptimize(apply(client, difference).heights.data()); });
    state.SetIterationTime(step.last());
    added = difference.added.added.vertices.size();
    all = answer->quadtree.vertices.size();
  }
  say(state, step, anew, 0.6);
  state.counters["with_apply"] = (step.by_processor() + applied.by_processor()) / anew.by_processor();
  state.counters["anew_ms"] = 1000 * anew.by_processor();
  state.counters["added"] = static_cast<double>(added);
  state.counters["vertices"] = static_cast<double>(all);
}
BENCHMARK(BM_IncrementAgainstAnew)->Iterations(kTurns)->UseManualTime()->Unit(benchmark::kMillisecond);

// ---- hot, warm, cold --------------------------------------------------------------------------------------------

constexpr std::uint64_t kRoomForAll = std::uint64_t{1} << 30;

/// Takes a file that nobody has mapped out of the system's cache; returns what share of it is there still.
double drop(const fs::path& file) {
  const int handle = ::open(file.c_str(), O_RDONLY);
  if (handle < 0) return 1;
  const auto bytes = static_cast<std::size_t>(fs::file_size(file));
  ::fdatasync(handle);
  ::posix_fadvise(handle, 0, 0, POSIX_FADV_DONTNEED);
  void* map = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, handle, 0);
  double share = 1;
  if (map != MAP_FAILED) {
    std::vector<unsigned char> there((bytes + 4095) / 4096);
    if (::mincore(map, bytes, there.data()) == 0) {
      const auto resident = std::count_if(there.begin(), there.end(), [](unsigned char c) { return (c & 1) != 0; });
      share = static_cast<double>(resident) / static_cast<double>(there.size());
    }
    ::munmap(map, bytes);
  }
  ::close(handle);
  return share;
}

/// Asked again with room for every page; warm is BM_WindowSwiss_Warm. `pages_cached` says
/// whether that was of use.
void BM_WindowSwiss_Hot(benchmark::State& state) {
  const auto file = kept(kSwiss);
  if (!file) return state.SkipWithError(kNoModels);
  const Snapshot now = Database::open(*file, {.cache_bytes = kRoomForAll, .threads = 1}).snapshot();
  const Metres tolerance{static_cast<double>(state.range(0))};
  (void)mesh(now, kSwissWindow, tolerance);
  for (auto _ : state) benchmark::DoNotOptimize(mesh(now, kSwissWindow, tolerance).points.data());
  state.counters["pages_cached"] =
      static_cast<double>(now.ask({.region = kSwissWindow, .tolerance = tolerance}).cost.pages_cached);
}
BENCHMARK(BM_WindowSwiss_Hot)->ArgName("tolerance_m")->Arg(1)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

/// A question that uses kept pages: the same window with one sample asked for by name. Hot, or nothing kept.
void BM_WindowSwissWithPoint(benchmark::State& state) {
  const auto file = kept(kSwiss);
  if (!file) return state.SkipWithError(kNoModels);
  const Snapshot now =
      Database::open(*file, {.cache_bytes = state.range(1) != 0 ? kRoomForAll : 0, .threads = 1}).snapshot();
  const Question question{
      .region = kSwissWindow, .tolerance = Metres{static_cast<double>(state.range(0))}, .points = {kSwissWindow.first}};
  const auto work = [&] {
    const Answer answer = now.ask(question);
    benchmark::DoNotOptimize(triangulate(answer.quadtree, 1).triangles.data());
    return answer.cost.pages_cached;
  };
  std::uint64_t cached = work();
  for (auto _ : state) cached = work();
  state.counters["pages_cached"] = static_cast<double>(cached);
}
BENCHMARK(BM_WindowSwissWithPoint)
    ->ArgNames({"tolerance_m", "hot"})
    ->ArgsProduct({{1, 5, 20}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

/// The file is dropped from the system's cache, then opened, then asked: all of that is the time, by the clock.
/// `still_there` is the share of the file that the system kept; what lies below it, a virtual disk, may remember, too.
void BM_WindowSwiss_Cold(benchmark::State& state) {
  const auto file = kept(kSwiss);
  if (!file) return state.SkipWithError(kNoModels);
  const Metres tolerance{static_cast<double>(state.range(0))};
  Times opened, asked;
  double still_there = 0;
  for (auto _ : state) {
    still_there = std::max(still_there, drop(*file));
    std::optional<Snapshot> now;
    opened.add([&] { now.emplace(Database::open(*file, {.threads = 1}).snapshot()); });
    asked.add([&] { (void)mesh(*now, kSwissWindow, tolerance); });
    state.SetIterationTime(opened.last_by_clock() + asked.last_by_clock());
  }
  state.counters["open_ms"] = 1000 * opened.by_clock();
  state.counters["ask_ms"] = 1000 * asked.by_clock();
  state.counters["processor_ms"] = 1000 * (opened.by_processor() + asked.by_processor());
  state.counters["still_there"] = still_there;
}
BENCHMARK(BM_WindowSwiss_Cold)
    ->ArgName("tolerance_m")
    ->Arg(1)
    ->Arg(5)
    ->Arg(20)
    ->Iterations(kTurns)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace talus::bench
