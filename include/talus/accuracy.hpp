#pragma once
// What accuracy costs: answers at many tolerances, with their time, size and true error.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "talus/database.hpp"
#include "talus/units.hpp"

namespace talus {

struct AccuracyOptions {
  std::optional<GridRect> region;       ///< part of the extent; empty: all of it
  std::optional<std::int32_t> window;   ///< side of the windows in samples, 17 to 4097; empty: see measure_accuracy
  std::vector<Metres> tolerances;       ///< finite, >= 0; empty: see AccuracyReport::points
  std::optional<double> limit_seconds;  ///< time limit for the advice, > 0; empty: time of the middle tolerance
  std::optional<Metres> map_tolerance;  ///< tolerance of the maps; empty: the advised one
  bool maps = true;
  /// The heights that errors are measured against; empty: the database's samples. It may not have kept all of them:
  /// then nothing is measured.
  SampleReader truth;
  int threads = 0;  ///< threads of an answer; 0: one a core, see OpenOptions
  /// Called now and then with the share of the work that is done (0 to 1) and its stage. May throw to stop the work.
  std::function<void(double fraction, const char* stage)> progress;
};

/// Distances between the surface and all valid samples under it; of all windows together.
struct AccuracyErrors {
  std::uint64_t samples = 0;
  Metres largest;
  Metres rms;
  Metres percentile_95;  ///< 95 % of the samples lie within it; at most 1/256 too large, never too small
};

/// One tolerance. With several windows, each count and each time is its own median.
struct AccuracyPoint {
  Metres tolerance;
  Metres bound;                               ///< RestrictedQuadtree::bound; the largest of all windows
  std::uint64_t vertices = 0, triangles = 0;  ///< size of the mesh
  std::uint64_t bytes = 0;                    ///< as a stream with the profile `balanced`
  std::uint64_t most_vertices = 0;            ///< the most of any window
  /// Seconds from question to mesh: the database just opened, its file dropped from memory as far as the system does
  /// that. One window: the median of three.
  double cold_seconds = 0;
  /// The same with the file in memory and an empty cache. Each window: the median of 5 to 101 answers, asked in
  /// rounds over all tolerances, so that a busy moment of the machine affects all of them alike.
  double warm_seconds = 0;
  /// Quartiles of warm_seconds in the typical window.
  double warm_low_seconds = 0, warm_high_seconds = 0;
  std::size_t typical_window = 0;        ///< the window whose warm time is the median
  std::optional<AccuracyErrors> errors;  ///< empty without a truth
};

/// The smallest tolerance within the time limit, measured. Without a limit: the tolerance in the middle of the
/// measured ones, which is the same on every machine, and its time.
struct AccuracyAdvice {
  double limit_seconds = 0;
  std::optional<std::size_t> point;  ///< index into AccuracyReport::points; empty: the coarsest takes longer
  bool is_finest = false;            ///< `point` is the finest of all
};

/// A map of the errors in one window. Cells of step × step samples, row by row from the north.
struct ErrorMap {
  std::size_t window = 0;  ///< index into AccuracyReport::windows
  std::int32_t step = 1, cols = 0, rows = 0;
  std::vector<float> error_m;   ///< surface minus sample, at the worst sample of each cell; NaN: no surface
  std::vector<float> height_m;  ///< mean of valid samples; NaN: none
  Metres width, height;         ///< size of the window on the ground, measured through its middle
};

struct AccuracyReport {
  Description description;
  std::vector<GridRect> windows;          ///< asked about one by one
  bool is_whole = true;                   ///< one window, equal to the region
  std::uint64_t places = 1;               ///< how many windows fit into the region side by side
  std::uint64_t places_with_terrain = 1;  ///< windows that need more than one vertex in 128 samples at `terrain`
  Metres terrain;
  int threads = 1;
  double open_seconds = 0;                ///< time to open a cold file: median
  std::optional<double> share_in_memory;  ///< part of the file in memory after the drop, 0 to 1; empty: not known
  bool has_truth = false;
  /// Falling tolerances, with the advised one. By default 1, 2, 5, 10 …, from the first that needs vertices inside the
  /// border down to where a finer one hardly adds any.
  std::vector<AccuracyPoint> points;
  AccuracyAdvice advice;
  Metres map_tolerance;
  std::vector<ErrorMap> maps;  ///< one a window; empty without a truth
};

/// Measures answers at many tolerances. A region of at most 2049 × 2049 samples (4097 × 4097 if the caller named it) is
/// one window. A larger one is measured in at most nine windows of 1025 × 1025, spread over the terrain that is not
/// flat. The file is opened anew for each cold answer, so close it before.
///
/// fails  as Database::open; invalid_argument: a region outside the extent or without a triangle; a tolerance or window
///        out of range
/// cost   about ten answers for each tolerance and window. Memory: 9 bytes a sample of the windows, and one answer
[[nodiscard]] AccuracyReport measure_accuracy(const std::filesystem::path& database,
                                              const AccuracyOptions& options = {});

}  // namespace talus
