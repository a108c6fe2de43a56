#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "engine/geo/ground.hpp"
#include "query/accuracy/true_error.hpp"
#include "query/snapshot_view.hpp"
#include "query/verify/verify_computed.hpp"
#include "query/verify/verify_findings.hpp"
#include "query/verify/verify_pages.hpp"
#include "query/verify/verify_slices.hpp"
#include "talus/database.hpp"

namespace talus {
namespace {

CellsOfRow cells_of_rows(const Description& d) {
  return [ground = Ground(d.crs), m = d.mapping](std::int32_t row) {
    const double x = m.x(0), y = m.y(row), up = std::abs(m.dy) / 2;
    return std::array{ground.metres({x, y}, {x + m.dx, y}), ground.metres({x, y - up}, {x, y + up})};
  };
}

/// Reports progress from 0 to 1.
class Telling {
 public:
  Telling(const VerifyOptions& options, std::uint64_t steps)
      : options_(options), steps_(std::max<std::uint64_t>(steps, 1)) {}
  void step(const char* stage, std::uint64_t steps = 1) {
    done_ += steps;
    if (options_.progress)
      options_.progress(std::min(0.999, static_cast<double>(done_) / static_cast<double>(steps_)), stage);
  }

 private:
  const VerifyOptions& options_;
  std::uint64_t steps_, done_ = 0;
};

class Verification {
 public:
  Verification(const StoredPages& pages, const VerifyOptions& options) : pages_(pages), options_(options) {}

  VerifyReport report;

  void run() {
    structure();
    if (options_.truth && !report.is_damaged()) compare_samples();
    if (options_.truth && !report.is_damaged() && report.finding_count == 0) measure();
    if (options_.progress) options_.progress(1, "done");
  }

 private:
  static constexpr std::uint64_t kStepsATile = 65;

  /// Checks the database against itself.
  void structure() {
    for (const std::string& sentence : check_structure(pages_.file())) findings_.everywhere(sentence);
    if (report.is_damaged()) return;  // not safe to read further
    if (const std::string seal = check_seal(pages_.file()); !seal.empty()) findings_.of_file(seal);
    const std::uint64_t before = findings_.count();
    DecodedPages decoded(pages_);
    const CheckedPages of_band_1 = check_pages(pages_, decoded, findings_, report, [&] { telling_.step("pages"); });
    const TileTotals totals = check_tiles(pages_, decoded, of_band_1, findings_, report,
                                          [&] { telling_.step("samples, errors and records", kStepsATile); });
    // Damaged pages would cause false findings here.
    if (findings_.count() == before) {
      check_slices(pages_, decoded, of_band_1, findings_);
      check_header(totals);
      check_coarse(pages_, decoded, findings_);
    }
    if (findings_.count() == before) check_answers();
  }

  /// Compares the header with all tiles.
  void check_header(const TileTotals& totals) {
    const Description& d = description_;
    const std::uint64_t voids = static_cast<std::uint64_t>(extent_.samples()) - totals.valid_samples;
    if (d.void_samples != voids)
      findings_.everywhere(fmt::format("header: it says {} void samples, but there are {}", d.void_samples, voids));
    if (totals.valid_samples > 0 && (d.minimum_height != totals.lowest || d.maximum_height != totals.highest)) {
      findings_.everywhere(fmt::format("header: it says heights from {} to {}, but they are from {} to {}",
                                       d.minimum_height, d.maximum_height, totals.lowest, totals.highest));
    }
    try {
      check_provenance(totals);
    } catch (const Failure& f) {
      if (f.cause() != Cause::corrupt) throw;
      findings_.of_file(f.what());
    }
  }

  /// Answers do not need provenance, but estimates of an answer's size do.
  void check_provenance(const TileTotals& totals) {
    const std::uint32_t generation = pages_.manifest().generation;
    for (const std::uint64_t position : {kManifestPosition, kPlanPosition, kProvenancePosition}) {
      const auto stored = pages_.transaction().find({kHeaderTable, position});
      if (!stored) {
        findings_.of_file(fmt::format("header: part {} is missing", position));
      } else if (stored->generation != generation) {
        findings_.of_file(fmt::format("header: part {} was written by update {}, but the header says {}", position,
                                      stored->generation, generation));
      } else if (position == kProvenancePosition) {
        const Provenance said = decode_provenance(stored->content);
        if (said.generation != generation)
          findings_.of_file(
              fmt::format("provenance: it says {} updates, but the header says {}", said.generation, generation));
        // Updates append their counts to those of earlier versions.
        const std::size_t counts = said.vertices_above.size();
        bool is_same = counts >= kErrorRungs;
        for (std::size_t i = 0; is_same && i < kErrorRungs; ++i)
          is_same = said.vertices_above[counts - kErrorRungs + i] == std::pair{error_rung(i), totals.errors[i]};
        if (!is_same) findings_.of_file("provenance: its counts of vertices differ from those in the records");
      }
    }
    vertices_above_ = totals.errors;
  }

  /// Asks at 0 and at 1, 2, 5 … m: for the whole raster if its answer is small, else in squares. A tolerance that
  /// selects as many vertices of fine levels as the one before selects the same ones, so it is skipped.
  void check_answers() {
    for (std::size_t rung = 0; rung < kErrorRungs; ++rung) {
      const double tolerance = error_rung(rung);
      telling_.step("answers", 1);
      if (rung > 0 && (tolerance < description_.finest_tolerance.value ||
                       (vertices_above_[rung] > 0 && vertices_above_[rung] == vertices_above_[rung - 1])))
        continue;
      const bool is_small = extent_.samples() <= kSquare * kSquare ||
                            (extent_.samples() <= kMostMask && vertices_above_[rung] <= kMostVertices);
      const std::int64_t side = is_small ? std::int64_t{kMaxExtent} : kSquare;
      for (std::int64_t row = extent_.first.row; row == extent_.first.row || row < extent_.last.row; row += side) {
        for (std::int64_t col = extent_.first.col; col == extent_.first.col || col < extent_.last.col; col += side) {
          check_answer({{static_cast<std::int32_t>(col), static_cast<std::int32_t>(row)},
                        {static_cast<std::int32_t>(std::min<std::int64_t>(col + side, extent_.last.col)),
                         static_cast<std::int32_t>(std::min<std::int64_t>(row + side, extent_.last.row))}},
                       tolerance);
        }
      }
    }
  }
  void check_answer(GridRect region, double tolerance) {
    ++report.answers;
    try {
      static_cast<void>(triangulate(range_query(pages_, region, Metres{tolerance}).quadtree));
    } catch (const Failure& f) {
      if (f.cause() != Cause::corrupt) throw;
      findings_.in(region, fmt::format("no answer at {} m: {}", tolerance, f.what()));
    }
  }

  /// Compares strips that are as high as a page.
  void compare_samples() {
    for (std::int32_t row = extent_.first.row; row <= extent_.last.row; row += kPageSide) {
      const GridRect strip{{extent_.first.col, row},
                           {extent_.last.col, std::min(row + kPageSide - 1, extent_.last.row)}};
      const SampleWindow expected = options_.truth(strip);
      compare(stored_samples(pages_, strip), expected);
      telling_.step("samples against the source", static_cast<std::uint64_t>(extent_.cols() / kPageSide + 1));
    }
  }

  void measure() {
    if (options_.tolerance) return true_error_of(*options_.tolerance);
    const double finest = description_.finest_tolerance.value;
    if (finest == 0) return;
    // The database does not keep all samples.
    true_error_of(Metres{finest});
    constexpr double kRounding = 1e-9;  // metres: the rounding of the surface's heights
    if (report.true_error->value > finest * (1 + 1e-12) + kRounding) {
      findings_.difference(fmt::format("the finest answer is {} m off, but the database promises {} m",
                                       report.true_error->value, finest));
    }
  }

  void true_error_of(Metres tolerance) {
    const Mesh mesh = triangulate(range_query(pages_, extent_, tolerance).quadtree);
    const Description& d = description_;
    const bool tilted = d.error_metric == ErrorMetric::perpendicular;
    const TrueError error = true_error(mesh, d, options_.truth, {}, tilted ? cells_of_rows(d) : CellsOfRow());
    report.true_error = Metres{error.largest_m};
    if (tilted) report.perpendicular_error = Metres{error.largest_perpendicular_m};
    report.vertices = mesh.points.size();
    report.triangles = mesh.triangles.size();
    report.covered_samples = error.covered;
    report.uncovered_samples = error.uncovered;
    report.stray_samples = error.stray;
    if (error.uncovered > 0)
      findings_.difference(fmt::format("{} samples that the mesh must cover lie under no triangle", error.uncovered));
  }

  /// Whether a source's sample is stored bit for bit, or within the loss of a height step.
  [[nodiscard]] bool is_stored_as(double stored, double source) const {
    const Description& d = description_;
    if (is_same(stored, source)) return true;
    // The rounding of a multiple of the step, if that is a decimal.
    const double arithmetic = 4 * std::numeric_limits<double>::epsilon() * std::abs(source);
    return d.lossy.value > 0 && std::abs(stored - source) <= d.lossy.value / d.metres_per_unit + arithmetic;
  }

  void compare(const StoredSamples& samples, const SampleWindow& expected) {
    const SampleWindow& stored = samples.window;
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      ++report.samples;
      const bool data = expected.valid[i] != 0;
      const bool dropped = !samples.dropped.empty() && samples.dropped[i] != 0;
      if (data == (stored.valid[i] != 0) && (!data || dropped || is_stored_as(stored.values[i], expected.values[i])))
        continue;
      const auto cols = static_cast<std::size_t>(stored.region.cols());
      const auto text = [](bool valid, double v) { return valid ? fmt::format("{}", v) : std::string("void"); };
      findings_.difference(fmt::format("sample at column {}, row {}: the database has {}, but the source has {}",
                                       stored.region.first.col + static_cast<std::int64_t>(i % cols),
                                       stored.region.first.row + static_cast<std::int64_t>(i / cols),
                                       text(stored.valid[i] != 0, stored.values[i]), text(data, expected.values[i])));
    }
  }

  static constexpr std::int64_t kSquare = 2048, kMostMask = std::int64_t{1} << 30;  ///< samples per side, and in all
  static constexpr std::uint64_t kMostVertices = 4'000'000;

  const StoredPages& pages_;
  const VerifyOptions& options_;
  const Description& description_ = pages_.manifest().description;
  GridRect extent_ = description_.extent;
  // In pages read, a tile is as much work as 65 pages; answers and comparing with a truth are as much again.
  Telling telling_{options_, (options_.truth ? 4 : 3) * tiles_in(extent_) * kStepsATile};
  ErrorHistogram vertices_above_{};
  Findings findings_{report, description_};
};

}  // namespace

VerifyReport verify(const Snapshot& snapshot, const VerifyOptions& options) {
  return within_memory([&] {
    Verification v(pages_of(snapshot), options);
    v.run();
    return std::move(v.report);
  });
}

VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth) {
  return verify(snapshot, VerifyOptions{.truth = truth, .tolerance = {}, .progress = {}});
}

VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth, Metres tolerance) {
  return verify(snapshot, VerifyOptions{.truth = truth, .tolerance = tolerance, .progress = {}});
}

}  // namespace talus
