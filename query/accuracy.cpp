// The plan: choose windows, read their truth, count what tolerances select, then measure tolerance by tolerance, coarse
// first; find the tolerance that a budget buys by asking; at last, the maps.

#include "talus/accuracy.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "engine/parallel.hpp"
#include "engine/stream_codec.hpp"
#include "query/accuracy_windows.hpp"
#include "query/cold_file.hpp"
#include "query/ground.hpp"
#include "query/stopwatch.hpp"
#include "query/true_error.hpp"

namespace talus {
namespace {

constexpr double kHardlyMore = 0.98;  // of the finest answer's vertices: finer steps have nothing to show
constexpr std::size_t kMostSteps = 18;
constexpr double kUsualBudget = 0.01;  // seconds
constexpr int kTries = 4;              // for a budget
constexpr double kWarmSeconds = 0.4;   // that repeating a warm answer may take, between kLeast and kMost times
constexpr int kLeastRepeats = 3, kMostRepeats = 9;
constexpr std::int32_t kLeastWindow = 17, kMostWindow = 4097;
constexpr std::int32_t kMapSide = 700, kMapsSide = 342;  // cells of one map alone, of one of several

// What a measurement takes, in seconds, for the share that is done; measured on windows of 1025 × 1025 of Taiwan.
constexpr double kPerWindow = 0.02, kPerVertex = 1.2e-6, kPerJudgedSample = 60e-9;

template <class T>
T median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The place of the median.
std::size_t median_place(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order[order.size() / 2];
}

/// 1, 2 and 5 times a power of ten, counted: 0 is 1, 1 is 2, 2 is 5, 3 is 10. As decimals are read, so that 0.2 is 0.2.
double round_number(int step) {
  constexpr double kDigits[] = {1, 2, 5};
  const int decade = step >= 0 ? step / 3 : -((2 - step) / 3);
  const double digit = kDigits[step - 3 * decade];
  return decade >= 0 ? digit * std::pow(10, decade) : digit / std::pow(10, -decade);
}
/// The largest below a number above 0.
int round_step_below(double number) {
  int step = 3 * static_cast<int>(std::floor(std::log10(number))) + 3;
  while (round_number(step) >= number) --step;
  return step;
}

/// Two digits, upward.
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
    const Snapshot now = open().snapshot();
    description_ = report.description = now.description();
    report.threads = threads_or_all(options.threads);
    AskedWindows asked = windows_of(now, options.region.value_or(description_.extent), options.region.has_value(), options.window);
    report.windows = std::move(asked.windows);
    report.is_whole = asked.is_whole;
    report.places = asked.places;
    report.places_with_terrain = asked.places_with_terrain;
    report.terrain = asked.terrain;
    tell("reading the samples");
    read_truth(now);
    tell("choosing tolerances");
    choose_steps(now);
    drop_from_memory(file_);
  }

  AccuracyReport report;

  void measure_all() {
    {
      static_cast<void>(open());  // and closed, so that nothing of the file is mapped
      drop_from_memory(file_);
      report.share_in_memory = share_in_memory(file_);
    }
    for (const Step& step : steps_) {
      report.points.push_back(measure(step.tolerance));
      done_ += work(step.vertices);
    }
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
    std::uint64_t vertices;  ///< of all windows
  };

  void require_sense() const {
    for (const Metres tolerance : options_.tolerances) {
      if (!(tolerance.value >= 0) || !std::isfinite(tolerance.value))
        throw Failure(Cause::invalid_argument, fmt::format("a tolerance of {} m: expected 0 or more, finite", tolerance.value));
    }
    if (options_.window && (*options_.window < kLeastWindow || *options_.window > kMostWindow)) {
      throw Failure(Cause::invalid_argument, fmt::format("a window of {} samples a side: expected {} to {}", *options_.window,
                                                         kLeastWindow, kMostWindow));
    }
  }

  /// Without decoded pages to find: a viewer seldom asks for the place it has just asked for.
  [[nodiscard]] Database open() const { return Database::open(file_, {.cache_bytes = 0, .threads = options_.threads}); }

  void tell(const char* stage) {
    if (options_.progress) options_.progress(all_ > 0 ? std::min(done_ / all_, 0.999) : 0, stage);
  }
  [[nodiscard]] double work(std::uint64_t vertices) const {
    return kPerWindow * static_cast<double>(report.windows.size()) + kPerVertex * static_cast<double>(vertices) +
           (report.has_truth ? kPerJudgedSample * static_cast<double>(samples()) : 0);
  }
  [[nodiscard]] std::int64_t samples() const {
    std::int64_t sum = 0;
    for (const GridRect& window : report.windows) sum += window.samples();
    return sum;
  }

  void read_truth(const Snapshot& now) {
    report.has_truth = options_.truth || description_.finest_tolerance == 0;
    if (!report.has_truth) return;
    for (const GridRect& window : report.windows)
      truth_.push_back(options_.truth ? options_.truth(window) : now.samples(window));
  }

  [[nodiscard]] std::uint64_t vertices_at(const Snapshot& now, Metres tolerance) const {
    std::uint64_t vertices = 0;
    for (const GridRect& window : report.windows) vertices += now.range(window, tolerance).quadtree.vertices.size();
    return vertices;
  }

  void choose_steps(const Snapshot& now) {
    if (!options_.tolerances.empty()) {
      std::vector<Metres> falling = options_.tolerances;
      std::sort(falling.begin(), falling.end(), std::greater<>());
      falling.erase(std::unique(falling.begin(), falling.end()), falling.end());
      for (const Metres tolerance : falling) steps_.push_back({tolerance, vertices_at(now, tolerance)});
    } else {
      std::uint64_t finest = 0;
      double largest = 0;
      for (const GridRect& window : report.windows) {
        const RestrictedQuadtree all = now.range(window, Metres{0}).quadtree;
        finest += all.vertices.size();
        for (const double error : all.level_errors) {
          if (std::isfinite(error)) largest = std::max(largest, error);
        }
      }
      // Below these answers are all the same.
      const double floor = std::max(description_.lossy_metres, description_.finest_tolerance);
      if (!(largest > floor)) steps_.push_back({Metres{floor}, finest});
      for (int step = largest > floor ? round_step_below(largest) : 0; largest > floor && steps_.size() < kMostSteps; --step) {
        const double tolerance = std::max(round_number(step), floor);
        steps_.push_back({Metres{tolerance}, vertices_at(now, Metres{tolerance})});
        if (tolerance <= floor || static_cast<double>(steps_.back().vertices) >= kHardlyMore * static_cast<double>(finest)) break;
      }
    }
    double largest_work = 0;
    for (const Step& step : steps_) {
      all_ += work(step.vertices);
      largest_work = std::max(largest_work, work(step.vertices));
    }
    all_ += largest_work;  // for the advice and maps, about
  }

  /// What time an answer's mesh takes.
  Mesh timed_answer(const Snapshot& now, GridRect window, Metres tolerance, Answer& answer, double& seconds) const {
    const Stopwatch stopwatch(seconds);
    answer = now.range(window, tolerance);
    return triangulate(answer.quadtree, options_.threads);
  }

  AccuracyPoint measure(Metres tolerance) {
    const std::string stage = fmt::format("asking at {} m", tolerance.value);
    std::vector<double> cold, warm;
    std::vector<std::uint64_t> vertices, triangles, bytes;
    ErrorDistribution errors;
    AccuracyPoint point;
    point.tolerance = tolerance;
    const double before = done_;
    for (std::size_t w = 0; w < report.windows.size(); ++w) {
      tell(stage.c_str());
      Answer answer;
      Mesh mesh;
      {
        drop_from_memory(file_);
        double opening = 0;
        const Database database = [&] {
          const Stopwatch stopwatch(opening);
          return open();
        }();
        opening_.push_back(opening);
        const Snapshot now = database.snapshot();
        double seconds = 0;
        mesh = timed_answer(now, report.windows[w], tolerance, answer, seconds);
        cold.push_back(seconds);
        std::vector<double> repeated;
        const int repeats = std::clamp(static_cast<int>(kWarmSeconds / std::max(seconds, 1e-6)), kLeastRepeats, kMostRepeats);
        for (int i = 0; i < repeats; ++i) {
          double again = 0;
          mesh = timed_answer(now, report.windows[w], tolerance, answer, again);
          repeated.push_back(again);
        }
        warm.push_back(median(std::move(repeated)));
      }
      vertices.push_back(mesh.points.size());
      triangles.push_back(mesh.triangles.size());
      point.bound = std::max(point.bound, answer.quadtree.bound);
      if (report.has_truth) errors += true_error(mesh, description_, truth_of(w)).errors;
      mesh = Mesh{};
      bytes.push_back(encode({description_, std::move(answer.quadtree)}, {.threads = options_.threads}).size());
      done_ += work(vertices.back()) / static_cast<double>(report.windows.size());
    }
    done_ = before;
    point.typical_window = median_place(warm);
    point.cold_seconds = median(std::move(cold));
    point.warm_seconds = median(std::move(warm));
    point.most_vertices = *std::max_element(vertices.begin(), vertices.end());
    point.vertices = median(std::move(vertices));
    point.triangles = median(std::move(triangles));
    point.bytes = median(std::move(bytes));
    if (report.has_truth) {
      point.errors = {errors.samples(), Metres{errors.largest()}, Metres{errors.rms()}, Metres{errors.within(0.95)}};
    }
    return point;
  }

  [[nodiscard]] SampleReader truth_of(std::size_t window) const {
    return [this, window](GridRect part) { return part_of(truth_[window], part); };
  }

  /// Ten milliseconds if the measured times bracket them, else the round time nearest to their middle.
  [[nodiscard]] double usual_budget() const {
    const double least = report.points.front().warm_seconds, most = report.points.back().warm_seconds;
    if (least <= kUsualBudget && kUsualBudget < most) return kUsualBudget;
    const double middle = std::sqrt(least * std::max(most, least));
    for (const int step : {round_step_below(middle), round_step_below(middle) + 1}) {
      if (round_number(step) >= least && round_number(step) < most) return round_number(step);
    }
    return two_digits(middle);
  }

  /// Between the two points that bracket the budget a straight line in logarithms says where to ask first.
  void advise() {
    AccuracyAdvice& advice = report.advice;
    advice.budget_seconds = options_.budget_seconds.value_or(usual_budget());
    std::vector<AccuracyPoint>& points = report.points;
    const auto over = std::find_if(points.begin(), points.end(),
                                   [&](const AccuracyPoint& p) { return p.warm_seconds > advice.budget_seconds; });
    if (over == points.begin()) return;
    advice.point = static_cast<std::size_t>(over - points.begin()) - 1;
    advice.is_finest = over == points.end();
    if (advice.is_finest) return;

    const AccuracyPoint coarse = points[*advice.point], fine = *over;
    if (!(fine.tolerance.value > 0)) return;
    const double share = std::log(advice.budget_seconds / coarse.warm_seconds) / std::log(fine.warm_seconds / coarse.warm_seconds);
    double tolerance = coarse.tolerance.value * std::pow(fine.tolerance.value / coarse.tolerance.value, std::clamp(share, 0.0, 1.0));
    for (int i = 0; i < kTries; ++i) {
      tolerance = std::max(two_digits(tolerance), fine.tolerance.value);
      if (tolerance >= coarse.tolerance.value || tolerance == fine.tolerance.value) return;
      const AccuracyPoint tried = measure(Metres{tolerance});
      const auto place = std::find_if(points.begin(), points.end(), [&](const AccuracyPoint& p) { return p.tolerance < tried.tolerance; });
      const auto at = points.insert(place, tried);
      if (tried.warm_seconds <= advice.budget_seconds) {
        advice.point = static_cast<std::size_t>(at - points.begin());
        return;
      }
      tolerance = std::sqrt(tolerance * coarse.tolerance.value);
    }
  }

  void draw_maps() {
    const Snapshot now = open().snapshot();
    const Ground ground(description_.crs_wkt);
    for (std::size_t w = 0; w < report.windows.size(); ++w) {
      tell("drawing maps");
      const Mesh mesh = triangulate(now.range(report.windows[w], report.map_tolerance).quadtree, options_.threads);
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
      const auto col = (std::int64_t{p.col} - window.first.col) / map.step, row = (std::int64_t{p.row} - window.first.row) / map.step;
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
    const double x = (m.x(window.first.col) + m.x(window.last.col)) / 2, y = (m.y(window.first.row) + m.y(window.last.row)) / 2;
    map.width_m = ground.metres({m.x(window.first.col), y}, {m.x(window.last.col), y});
    map.height_on_ground_m = ground.metres({x, m.y(window.first.row)}, {x, m.y(window.last.row)});
    return map;
  }

  std::filesystem::path file_;
  const AccuracyOptions& options_;
  Description description_;
  std::vector<SampleWindow> truth_;  ///< by window
  std::vector<Step> steps_;
  std::vector<double> opening_;
  double done_ = 0, all_ = 0;  ///< seconds, as estimated
};

}  // namespace

AccuracyReport measure_accuracy(const std::filesystem::path& database, const AccuracyOptions& options) {
  Study study(database, options);
  study.measure_all();
  return std::move(study.report);
}

}  // namespace talus
