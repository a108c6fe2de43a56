// Steps: choose windows, read their truth, choose tolerances by counting vertices, measure them from coarse to fine,
// find the tolerance for a time limit, draw maps.

#include "talus/accuracy.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "engine/geo/ground.hpp"
#include "engine/machine/fail.hpp"
#include "engine/machine/parallel.hpp"
#include "engine/stream/stream_codec.hpp"
#include "query/accuracy/accuracy_windows.hpp"
#include "query/accuracy/cold_file.hpp"
#include "query/accuracy/true_error.hpp"
#include "query/pages/stopwatch.hpp"

namespace talus {
namespace {

// A finer step is left out if its vertices are nearly all of the finest answer's, or if it adds few and most are there;
// a coarser one if it needs few more than the border.
constexpr double kHardlyLess = 0.98, kHardlyGained = 0.01, kMost = 0.8, kHardlyMore = 1.1;
constexpr std::size_t kMostSteps = 18;
constexpr int kTries = 4;                           // questions to find the tolerance for a time limit
constexpr double kNearlyTheSame = 1.25;             // ratio of the times of neighbouring steps
constexpr int kColdRounds = 3;                      // if there is one window; with several, the median is over windows
constexpr int kLeastRounds = 5, kMostRounds = 101;  // rounds of warm answers
constexpr double kRoundsSeconds = 2;                // enough, after the least number of rounds
constexpr std::int32_t kLeastWindow = 17, kMostWindow = 4097;
constexpr std::int32_t kMapSide = 700, kMapsSide = 342;  // cells: a single map, and each of several

// To estimate the time left: the time for a tolerance, as a multiple of the time to count its vertices; and its share
// before the warm rounds. Measured on windows of 1025 × 1025 samples of Taiwan.
constexpr double kTimesCounting = 20, kFirstShare = 0.8;

template <class T>
T median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The index of the median.
std::size_t median_place(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order[order.size() / 2];
}

/// The n-th of 1, 2, 5, 10, …, also for negative n. The double nearest to the decimal: 0.2 is 0.2.
double round_number(int step) {
  constexpr double kDigits[] = {1, 2, 5};
  const int decade = step >= 0 ? step / 3 : -((2 - step) / 3);
  const double digit = kDigits[step - 3 * decade];
  return decade >= 0 ? digit * std::pow(10, decade) : digit / std::pow(10, -decade);
}
/// The n of the largest round number below `number`, which is above 0.
int round_step_below(double number) {
  int step = 3 * static_cast<int>(std::floor(std::log10(number))) + 3;
  while (round_number(step) >= number) --step;
  return step;
}

/// Rounds up to two digits.
double two_digits(double number) {
  const int decade = static_cast<int>(std::floor(std::log10(number))) - 1;
  const double scale = std::pow(10, std::abs(decade));
  const double digits = std::ceil((decade >= 0 ? number / scale : number * scale) * (1 - 1e-12));
  return decade >= 0 ? digits * scale : digits / scale;
}

SampleWindow part_of(const SampleWindow& whole, GridRect part) {
  SampleWindow window{part, {}, {}};
  const auto cols = static_cast<std::ptrdiff_t>(part.cols());
  for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
    const auto at = static_cast<std::ptrdiff_t>(whole.index({part.first.col, row}));
    window.values.insert(window.values.end(), whole.values.begin() + at, whole.values.begin() + at + cols);
    window.valid.insert(window.valid.end(), whole.valid.begin() + at, whole.valid.begin() + at + cols);
  }
  return window;
}

class Study {
 public:
  Study(const std::filesystem::path& file, const AccuracyOptions& options) : file_(file), options_(options) {
    require_sense();
    const auto started = std::chrono::steady_clock::now();
    const Snapshot now = open().snapshot();
    description_ = report.description = now.description();
    report.threads = threads_or_all(options.threads);
    if (const auto& r = options.region;
        r && (r->cols() < 1 || r->rows() < 1 || !description_.extent.contains(r->first) ||
              !description_.extent.contains(r->last))) {
      throw Failure(Cause::invalid_argument, "the region to measure is empty or reaches beyond the extent");
    }
    AskedWindows asked =
        windows_of(now, options.region.value_or(description_.extent), options.region.has_value(), options.window);
    report.windows = std::move(asked.windows);
    report.is_whole = asked.is_whole;
    report.places = asked.places;
    report.places_with_terrain = asked.places_with_terrain;
    report.terrain = asked.terrain;
    tell("reading the samples");
    read_truth(now);
    tell("choosing tolerances");
    choose_steps(now);
    estimate_work(std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
  }

  AccuracyReport report;

  void measure_all() {
    {
      static_cast<void>(open());  // closed at once, so that the file is not mapped
      drop_from_memory(file_);
      report.share_in_memory = share_in_memory(file_);
    }
    for (const Step& step : steps_) report.points.push_back(measure(step.tolerance, kFirstShare * work(step)));
    std::vector<AccuracyPoint*> all;
    double again = 0;
    for (AccuracyPoint& point : report.points) all.push_back(&point);
    for (const Step& step : steps_) again += (1 - kFirstShare) * work(step);
    measure_warm(all, again);
    advise();
    if (report.has_truth && options_.maps) {
      const AccuracyPoint& shown = report.points[report.advice.point.value_or(report.points.size() / 2)];
      report.map_tolerance = options_.map_tolerance.value_or(shown.tolerance);
      draw_maps();
    }
    report.open_seconds = median(opening_);
    if (options_.progress) options_.progress(1, "done");
  }

 private:
  struct Step {
    Metres tolerance;
    double seconds;  ///< time to count its vertices
  };

  void require_sense() const {
    for (const Metres tolerance : options_.tolerances) {
      if (!(tolerance.value >= 0) || !std::isfinite(tolerance.value))
        refuse("a tolerance of {} m: expected a finite number, 0 or more", tolerance.value);
    }
    if (options_.window && (*options_.window < kLeastWindow || *options_.window > kMostWindow))
      refuse("a window of {} samples a side: expected {} to {}", *options_.window, kLeastWindow, kMostWindow);
  }

  /// Opens without a cache of pages: a viewer seldom asks for the same place again.
  [[nodiscard]] Database open() const { return Database::open(file_, {.cache_bytes = 0, .threads = options_.threads}); }

  void tell(const std::string& stage) const {
    if (options_.progress) options_.progress(all_ > 0 ? std::min(done_ / all_, 0.999) : 0, stage.c_str());
  }
  void read_truth(const Snapshot& now) {
    report.has_truth = options_.truth || description_.finest_tolerance.value == 0;
    if (!report.has_truth) return;
    for (const GridRect& window : report.windows)
      truth_.push_back(options_.truth ? options_.truth(window) : now.samples(window));
  }

  [[nodiscard]] std::uint64_t vertices_at(const Snapshot& now, Metres tolerance) const {
    std::uint64_t vertices = 0;
    for (const GridRect& window : report.windows)
      vertices += now.ask({.region = window, .tolerance = tolerance}).quadtree.vertices.size();
    return vertices;
  }

  std::uint64_t add_step(const Snapshot& now, Metres tolerance) {
    std::uint64_t vertices = 0;
    double seconds = 0;
    {
      const Stopwatch stopwatch(seconds);
      vertices = vertices_at(now, tolerance);
    }
    steps_.push_back({tolerance, seconds});
    return vertices;
  }

  void choose_steps(const Snapshot& now) {
    if (!options_.tolerances.empty()) {
      std::vector<Metres> falling = options_.tolerances;
      std::sort(falling.begin(), falling.end(), std::greater<>());
      falling.erase(std::unique(falling.begin(), falling.end()), falling.end());
      for (const Metres tolerance : falling) add_step(now, tolerance);
      return;
    }
    std::uint64_t finest = 0;
    double largest = 0;
    for (const GridRect& window : report.windows) {
      const RestrictedQuadtree all = now.ask({.region = window, .tolerance = Metres{0}}).quadtree;
      finest += all.vertices.size();
      for (const double error : all.level_errors) {
        if (std::isfinite(error)) largest = std::max(largest, error);
      }
    }
    // Beside voids, errors may exceed the range of heights.
    largest =
        std::min(largest, (description_.maximum_height - description_.minimum_height) * description_.metres_per_unit);
    // Below this tolerance, all answers are equal.
    const double floor = std::max(description_.lossy.value, description_.finest_tolerance.value);
    if (!(largest > floor)) {
      add_step(now, Metres{floor});
      return;
    }
    const std::uint64_t border = vertices_at(now, Metres{std::numeric_limits<double>::infinity()});
    double before = 0;
    for (int step = round_step_below(largest); steps_.size() < kMostSteps; --step) {
      const double tolerance = std::max(round_number(step), floor);
      const auto vertices = static_cast<double>(add_step(now, Metres{tolerance}));
      // Keep only the last step that needs little more than the border.
      if (steps_.size() == 2 && vertices <= kHardlyMore * static_cast<double>(border)) steps_.erase(steps_.begin());
      const double all = static_cast<double>(finest);
      if (tolerance <= floor || vertices >= kHardlyLess * all) return;
      if (before >= kMost * all && vertices - before <= kHardlyGained * all) {
        steps_.pop_back();
        return;
      }
      before = vertices;
    }
  }

  /// Estimated seconds to measure a tolerance.
  [[nodiscard]] static double work(const Step& step) { return kTimesCounting * step.seconds; }

  void estimate_work(double seconds_so_far) {
    double most = 0;
    all_ = done_ = seconds_so_far;
    for (const Step& step : steps_) {
      all_ += work(step);
      most = std::max(most, work(step));
    }
    all_ += most;  // advice and maps
  }

  /// Asks and measures the time.
  Mesh timed_answer(const Snapshot& now, GridRect window, Metres tolerance, Answer& answer, double& seconds) const {
    const Stopwatch stopwatch(seconds);
    answer = now.ask({.region = window, .tolerance = tolerance});
    return triangulate(answer.quadtree, options_.threads);
  }

  /// Times of warm answers at a tolerance, by window.
  using Rounds = std::vector<std::vector<double>>;

  /// Measures all but warm times. `share` is the work done by then.
  AccuracyPoint measure(Metres tolerance, double share) {
    const std::string stage = fmt::format("asking at {} m", tolerance.value);
    std::vector<double> cold;
    std::vector<std::uint64_t> vertices, triangles, bytes;
    ErrorDistribution errors;
    AccuracyPoint point;
    point.tolerance = tolerance;
    for (std::size_t w = 0; w < report.windows.size(); ++w) {
      tell(stage);
      Answer answer;
      Mesh mesh;
      for (int i = 0; i < (report.windows.size() > 1 ? 1 : kColdRounds); ++i) {
        answer = {};
        mesh = {};
        cold.push_back(cold_answer(w, tolerance, answer, mesh));
      }
      vertices.push_back(mesh.points.size());
      triangles.push_back(mesh.triangles.size());
      point.bound = std::max(point.bound, answer.quadtree.bound);
      if (report.has_truth) errors += true_error(mesh, description_, truth_of(w)).errors;
      mesh = {};
      bytes.push_back(encode({description_, std::move(answer.quadtree)}, {.threads = options_.threads}).size());
      done_ += share / static_cast<double>(report.windows.size());
    }
    point.cold_seconds = median(std::move(cold));
    point.most_vertices = *std::max_element(vertices.begin(), vertices.end());
    point.vertices = median(std::move(vertices));
    point.triangles = median(std::move(triangles));
    point.bytes = median(std::move(bytes));
    if (report.has_truth) {
      point.errors = {errors.samples(), Metres{errors.largest()}, Metres{errors.rms()}, Metres{errors.within(0.95)}};
    }
    return point;
  }

  double cold_answer(std::size_t window, Metres tolerance, Answer& answer, Mesh& mesh) {
    drop_from_memory(file_);
    double opening = 0, seconds = 0;
    const Database database = [&] {
      const Stopwatch stopwatch(opening);
      return open();
    }();
    opening_.push_back(opening);
    mesh = timed_answer(database.snapshot(), report.windows[window], tolerance, answer, seconds);
    return seconds;
  }

  void warm_round(const Snapshot& now, Metres tolerance, Rounds& rounds) const {
    rounds.resize(report.windows.size());
    for (std::size_t w = 0; w < report.windows.size(); ++w) {
      Answer answer;
      double seconds = 0;
      static_cast<void>(timed_answer(now, report.windows[w], tolerance, answer, seconds));
      rounds[w].push_back(seconds);
    }
  }

  static void settle_warm(AccuracyPoint& point, const Rounds& rounds) {
    std::vector<double> windows;
    for (const std::vector<double>& seconds : rounds) windows.push_back(median(seconds));
    point.typical_window = median_place(windows);
    point.warm_seconds = windows[point.typical_window];
    std::vector<double> rising = rounds[point.typical_window];
    std::sort(rising.begin(), rising.end());
    point.warm_low_seconds = rising[rising.size() / 4];
    point.warm_high_seconds = rising[rising.size() - 1 - rising.size() / 4];
  }

  /// Measures warm times in rounds over all points, until the times are steady.
  void measure_warm(std::span<AccuracyPoint* const> points, double share) {
    std::vector<Rounds> rounds(points.size());
    const Snapshot now = open().snapshot();
    for (const GridRect& window : report.windows)
      static_cast<void>(
          now.ask({.region = window, .tolerance = points.back()->tolerance}));  // reads the file into memory
    double seconds = 0;
    for (int round = 0; round < kLeastRounds || (round < kMostRounds && seconds < kRoundsSeconds); ++round) {
      const Stopwatch stopwatch(seconds);
      for (std::size_t i = 0; i < points.size(); ++i) {
        tell("asking again");
        warm_round(now, points[i]->tolerance, rounds[i]);
        if (round < kLeastRounds) done_ += share / static_cast<double>(kLeastRounds * points.size());
      }
    }
    for (std::size_t i = 0; i < points.size(); ++i) settle_warm(*points[i], rounds[i]);
  }

  /// Measures a point together with its neighbours, because the processor's caches matter.
  AccuracyPoint measure_between(AccuracyPoint coarse, Metres tolerance, AccuracyPoint fine) {
    AccuracyPoint point = measure(tolerance, 0);
    AccuracyPoint* const points[] = {&coarse, &point, &fine};
    measure_warm(points, 0);
    return point;
  }

  [[nodiscard]] SampleReader truth_of(std::size_t window) const {
    return [this, window](GridRect part) { return part_of(truth_[window], part); };
  }

  /// Seconds for a point: its own time, or that of a finer point if that was faster.
  [[nodiscard]] double seconds_for(std::size_t point) const {
    double seconds = report.points[point].warm_seconds;
    for (std::size_t i = point; i < report.points.size(); ++i)
      seconds = std::min(seconds, report.points[i].warm_seconds);
    return seconds;
  }

  /// Finds the tolerance for the time limit between the two points around it: first by a straight line in logarithms,
  /// then by halving. If the two take nearly the same time, the difference is noise, and the coarser one is the advice.
  void advise() {
    AccuracyAdvice& advice = report.advice;
    std::vector<AccuracyPoint>& points = report.points;
    if (!options_.limit_seconds) {
      advice.point = (points.size() - 1) / 2;
      advice.is_finest = points.size() == 1;
      advice.limit_seconds = two_digits(points[*advice.point].warm_seconds);
      return;
    }
    advice.limit_seconds = *options_.limit_seconds;
    std::size_t over = 0;
    while (over < points.size() && seconds_for(over) <= advice.limit_seconds) ++over;
    if (over == 0) return;
    advice.point = over - 1;
    advice.is_finest = over == points.size();
    if (advice.is_finest) return;

    const AccuracyPoint coarse = points[over - 1], fine = points[over];
    if (!(fine.tolerance.value > 0)) return;
    const double least = seconds_for(over - 1), most = seconds_for(over);
    if (most < kNearlyTheSame * least) return;
    const double share = std::log(advice.limit_seconds / least) / std::log(most / least);
    double tolerance =
        coarse.tolerance.value * std::pow(fine.tolerance.value / coarse.tolerance.value, std::clamp(share, 0.0, 1.0));
    double within = coarse.tolerance.value, over_it = fine.tolerance.value;
    std::optional<AccuracyPoint> best;
    for (int i = 0; i < kTries; ++i) {
      tolerance = two_digits(tolerance);
      if (!(tolerance < within && tolerance > over_it)) break;
      AccuracyPoint tried = measure_between(coarse, Metres{tolerance}, fine);
      const bool is_within = tried.warm_seconds <= advice.limit_seconds;
      (is_within ? within : over_it) = tolerance;
      if (is_within) best = std::move(tried);
      tolerance = std::sqrt(within * over_it);
    }
    if (!best) return;
    points.insert(points.begin() + static_cast<std::ptrdiff_t>(over), *std::move(best));
    advice.point = over;
  }

  void draw_maps() {
    const Snapshot now = open().snapshot();
    const Ground ground(description_.crs);
    for (std::size_t w = 0; w < report.windows.size(); ++w) {
      tell("drawing maps");
      const Mesh mesh = triangulate(now.ask({.region = report.windows[w], .tolerance = report.map_tolerance}).quadtree,
                                    options_.threads);
      report.maps.push_back(map_of(mesh, w, ground));
    }
  }

  [[nodiscard]] ErrorMap map_of(const Mesh& mesh, std::size_t w, const Ground& ground) const {
    const GridRect& window = report.windows[w];
    const std::int64_t side = report.windows.size() == 1 ? kMapSide : kMapsSide;
    ErrorMap map;
    map.window = w;
    map.step = static_cast<std::int32_t>((std::max(window.cols(), window.rows()) + side - 1) / side);
    map.cols = static_cast<std::int32_t>((window.cols() + map.step - 1) / map.step);
    map.rows = static_cast<std::int32_t>((window.rows() + map.step - 1) / map.step);
    const auto cells = static_cast<std::size_t>(map.cols) * static_cast<std::size_t>(map.rows);
    map.error_m.assign(cells, std::numeric_limits<float>::quiet_NaN());
    map.height_m.assign(cells, std::numeric_limits<float>::quiet_NaN());
    const auto cell = [&](GridPoint p) {
      const auto col = (std::int64_t{p.col} - window.first.col) / map.step,
                 row = (std::int64_t{p.row} - window.first.row) / map.step;
      return static_cast<std::size_t>(row * map.cols + col);
    };
    static_cast<void>(true_error(mesh, description_, truth_of(w), [&](GridPoint p, double metres) {
      float& error = map.error_m[cell(p)];
      if (!(std::abs(metres) <= std::abs(error))) error = static_cast<float>(metres);
    }));
    std::vector<double> sums(cells, 0);
    std::vector<std::int32_t> counts(cells, 0);
    std::size_t i = 0;
    for (std::int32_t row = window.first.row; row <= window.last.row; ++row) {
      for (std::int64_t col = window.first.col; col <= window.last.col; ++col, ++i) {
        if (!truth_[w].valid[i]) continue;
        const std::size_t at = cell({static_cast<std::int32_t>(col), row});
        sums[at] += truth_[w].values[i] * description_.metres_per_unit;
        ++counts[at];
      }
    }
    for (std::size_t at = 0; at < cells; ++at) {
      if (counts[at] > 0) map.height_m[at] = static_cast<float>(sums[at] / counts[at]);
    }
    const GridMapping& m = description_.mapping;
    const double x = (m.x(window.first.col) + m.x(window.last.col)) / 2,
                 y = (m.y(window.first.row) + m.y(window.last.row)) / 2;
    map.width = Metres{ground.metres({m.x(window.first.col), y}, {m.x(window.last.col), y})};
    map.height = Metres{ground.metres({x, m.y(window.first.row)}, {x, m.y(window.last.row)})};
    return map;
  }

  std::filesystem::path file_;
  const AccuracyOptions& options_;
  Description description_;
  std::vector<SampleWindow> truth_;  ///< one per window
  std::vector<Step> steps_;
  std::vector<double> opening_;
  double done_ = 0, all_ = 0;  ///< seconds, estimated
};

}  // namespace

AccuracyReport measure_accuracy(const std::filesystem::path& database, const AccuracyOptions& options) {
  return within_memory([&] {
    Study study(database, options);
    study.measure_all();
    return std::move(study.report);
  });
}

}  // namespace talus
