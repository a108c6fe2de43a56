#pragma once
// What accuracy costs: answers at many tolerances, timed, counted and held against every sample.

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
  std::optional<GridRect> region;  ///< what it is about, within the extent; empty: all of it
  std::optional<std::int32_t>
      window;  ///< samples a side, 17 to 4097: ask through windows of this size, whatever the region's
  std::vector<Metres> tolerances;        ///< finite, 0 or more; empty: see AccuracyReport::points
  std::optional<double> budget_seconds;  ///< of the advice, above 0; empty: what the tolerance amid the others takes
  std::optional<Metres> map_tolerance;   ///< of the maps; empty: the advised one
  bool maps = true;
  /// What errors are measured against; empty: the database's own samples, or nothing if it did not keep them all.
  SampleReader truth;
  int threads = 0;  ///< of an answer; 0: one a core, see OpenOptions
  /// Told now and then what share of the work is done, and what is being done; may throw to end it.
  std::function<void(double fraction, const char* stage)> progress;
};

/// Distances between surface and samples, over all valid samples under the surface: of several windows those of all.
struct AccuracyErrors {
  std::uint64_t samples = 0;
  Metres largest;
  Metres rms;
  Metres percentile_95;  ///< 95 % of the samples lie within it; never too small, at most one part in 256 too large
};

/// One tolerance. Of several windows counts and times are medians, each for itself.
struct AccuracyPoint {
  Metres tolerance;
  Metres bound;  ///< what the answer promises, see RestrictedQuadtree::bound; of several the largest
  std::uint64_t vertices = 0, triangles = 0;  ///< of the mesh
  std::uint64_t bytes = 0;                    ///< as a stream with the profile `balanced`
  std::uint64_t most_vertices = 0;            ///< no window has more
  /// From the question to the mesh, in a program that has answered before: the file as far out of memory as the system
  /// lets go, and just opened. Of one window the median of three.
  double cold_seconds = 0;
  /// The same with the file in memory and nothing decoded. Of each window the median of five to 101, taken in rounds
  /// over all tolerances, so that what else the machine does spoils none of them alone.
  double warm_seconds = 0;
  /// The middle half of the typical window's answers took between these
  double warm_low_seconds = 0, warm_high_seconds = 0;
  std::size_t typical_window = 0;        ///< whose warm time is the median
  std::optional<AccuracyErrors> errors;  ///< nothing without a truth
};

/// The least tolerance that an amount of time buys, found by asking. Where no time was given, the tolerance amid the
/// measured ones, which does not waver with the machine, and what it takes.
struct AccuracyAdvice {
  double budget_seconds = 0;
  std::optional<std::size_t> point;  ///< which of the points; nothing: the coarsest takes longer
  bool is_finest = false;            ///< it is the finest of all
};

/// Where one window's error sits. Cells of step × step samples, row by row from the north.
struct ErrorMap {
  std::size_t window = 0;  ///< its number
  std::int32_t step = 1, cols = 0, rows = 0;
  std::vector<float> error_m;   ///< of the sample that is farthest: surface less sample; NaN: nothing under the surface
  std::vector<float> height_m;  ///< mean of valid samples; NaN: none
  double width_m = 0,
         height_on_ground_m = 0;  ///< of the window through its middle; `cols` and `rows` may reach a step beyond
};

struct AccuracyReport {
  Description description;
  std::vector<GridRect> windows;  ///< asked about, each by itself
  bool is_whole = true;           ///< there is one window, and it is the region
  std::uint64_t places = 1;       ///< windows that stand in the region side by side, and were looked at
  std::uint64_t places_with_terrain =
      1;  ///< of these, those in which `terrain` needs more than a vertex in 128 samples
  Metres terrain;
  int threads = 1;
  double open_seconds = 0;  ///< of a cold file: median
  std::optional<double>
      share_in_memory;  ///< of the file, right after the system was asked to drop it; nothing: not told
  bool has_truth = false;
  /// Falling tolerance. Without tolerances of the caller's: 1, 2, 5, 10 … from where the first vertices are needed that
  /// the border does not need, down to where hardly one is left to win; and the advised one.
  std::vector<AccuracyPoint> points;
  AccuracyAdvice advice;
  Metres map_tolerance;
  std::vector<ErrorMap> maps;  ///< one a window, if there is a truth
};

/// Asks, again and again. A region of at most 2049 × 2049 samples is asked about as it is, and if it was named one of
/// up to 4097 × 4097; a larger one through at most nine windows of 1025 × 1025, as a viewer asks, spread over those
/// that are not flat. Opens the file anew for each cold answer, so the caller must not have it open.
///
/// fails  as Database::open; invalid_argument: a region outside the extent or without a triangle, a tolerance or window
/// out
///        of range
/// cost   memory: the windows' samples at nine bytes, and one answer. Time: per tolerance and window about ten answers
[[nodiscard]] AccuracyReport measure_accuracy(const std::filesystem::path& database,
                                              const AccuracyOptions& options = {});

}  // namespace talus
