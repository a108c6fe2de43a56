#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>

#include "engine/triangulation.hpp"
#include "query/ground.hpp"
#include "query/snapshot_view.hpp"
#include "query/true_error.hpp"
#include "talus/database.hpp"

namespace talus {
namespace {

CellsOfRow cells_of_rows(const Description& d) {
  return [ground = Ground(d.crs_wkt), m = d.mapping](std::int32_t row) {
    const double x = m.x(0), y = m.y(row), up = std::abs(m.dy) / 2;
    return std::array{ground.metres({x, y}, {x + m.dx, y}), ground.metres({x, y - up}, {x, y + up})};
  };
}

class Verification {
 public:
  explicit Verification(const StoredPages& pages) : pages_(pages), extent_(pages.manifest().description.extent) {}

  VerifyReport report;

  /// Everything a page says, against its own content and the pages below it.
  void structure() {
    for (const std::string& sentence : check_structure(pages_.file())) find(sentence);
    if (const std::string sentence = check_seal(pages_.file()); !sentence.empty()) find(sentence);
    if (report.finding_count > 0) return;  // not safe to follow
    const int bands = pages_.manifest().bands;
    for (int band = 0; band < bands; ++band) {
      Entries entries;
      pages_.transaction().for_each(band, [&](std::uint64_t position) { visit(page_at(band, position), entries); });
      for (const auto& [position, entry] : below_) {
        if (band == 0) break;
        const PageId parent = parent_page(page_at(band - 1, position));
        if (!entries.contains(curve_position(parent)))
          find(fmt::format("{}: the page above it is missing", name(page_at(band - 1, position))));
      }
      below_ = std::move(entries);
    }
    if (below_.empty()) find("no page of the coarsest band");
  }

  /// Strip by strip, the height of a page each.
  void samples(const SampleReader& truth) {
    for (std::int32_t row = extent_.first.row; row <= extent_.last.row; row += kPageSide) {
      const GridRect strip{{extent_.first.col, row},
                           {extent_.last.col, std::min(row + kPageSide - 1, extent_.last.row)}};
      const SampleWindow expected = truth(strip);
      StoredSamples stored;
      try {
        stored = stored_samples(pages_, strip);
      } catch (const Failure& f) {
        find(f.what());
        continue;
      }
      compare(stored, expected);
    }
  }

  /// Of a database that did not keep all samples.
  void finest_answer(const SampleReader& truth) {
    const double finest = pages_.manifest().description.finest_tolerance;
    true_error_of(Metres{finest}, truth);
    constexpr double kRounding = 1e-9;  // metres, of the surface's arithmetic
    if (report.true_error->value > finest * (1 + 1e-12) + kRounding)
      find(fmt::format("the finest answer is {} m off, the database promises {} m", report.true_error->value, finest));
  }

  void true_error_of(Metres tolerance, const SampleReader& truth) {
    const Mesh mesh = triangulate(range_query(pages_, extent_, tolerance).quadtree);
    const Description& d = pages_.manifest().description;
    const bool tilted = d.error_metric == ErrorMetric::perpendicular;
    const TrueError error = true_error(mesh, d, truth, {}, tilted ? cells_of_rows(d) : CellsOfRow());
    report.true_error = Metres{error.largest_m};
    if (tilted) report.perpendicular_error = Metres{error.largest_perpendicular_m};
    report.vertices = mesh.points.size();
    report.triangles = mesh.triangles.size();
    report.covered_samples = error.covered;
    report.uncovered_samples = error.uncovered;
    report.stray_samples = error.stray;
    if (error.uncovered > 0) find(fmt::format("{} covered samples lie under no triangle", error.uncovered));
  }

 private:
  using Entries = std::unordered_map<std::uint64_t, ChildEntry>;
  static constexpr std::size_t kSpelledOut = 20;

  void find(std::string sentence) {
    ++report.finding_count;
    if (report.findings.size() < kSpelledOut) report.findings.push_back(std::move(sentence));
  }
  static std::string name(PageId id) { return fmt::format("page {}/{} of band {}", id.x, id.y, id.band); }

  void visit(PageId id, Entries& entries) {
    ++report.pages;
    if (!overlap(page_square(id), extent_)) return find(fmt::format("{}: outside the extent", name(id)));
    QueryCost unused;
    try {
      std::uint32_t generation = 0;
      ChildEntry entry = check(pages_.get(id, decoder_, unused, &generation));
      entry.generation = generation;
      entries.emplace(curve_position(id), entry);
    } catch (const Failure& f) {
      find(f.what());
      entries.emplace(curve_position(id), ChildEntry{});  // there, if broken
    }
  }

  /// What the page above should say of this one.
  ChildEntry check(const Page& page) {
    ChildEntry entry = range_of(page, pages_.manifest().description.step);
    for (std::int32_t row = 0; row < page.grid.rows; ++row) {
      for (std::int32_t col = 0; col < page.grid.cols; ++col) {
        const GridPoint p = page.grid.at(col, row);
        if (!page.is_own(p)) continue;
        const ErrorCode own = page.error(page.index(col, row), pages_.distance());
        entry.largest = std::max(entry.largest, own);
        check_parents(page, p, own);
      }
    }
    for (std::size_t i = 0; i < page.children.size(); ++i) {
      const PageId below = child_page(page.id, i);
      const auto found = below_.find(curve_position(below));
      const ChildEntry& said = page.children[i];
      if ((found != below_.end()) != said.present) {
        find(fmt::format("{}: {}", name(below), said.present ? "missing" : "unknown to the page above it"));
      } else if (said.present && said.largest != found->second.largest) {
        find(fmt::format("{}: largest error {} m, the page above it says {} m", name(below),
                         error_of(found->second.largest), error_of(said.largest)));
      } else if (said.present && said.generation != found->second.generation) {
        find(fmt::format("{}: written by update {}, the page above it says {}", name(below), found->second.generation,
                         said.generation));
      } else if (said.present && !is_range_of(said, found->second)) {
        find(fmt::format("{}: heights {} to {}, the page above it says {} to {}", name(below), found->second.lowest,
                         found->second.highest, said.lowest, said.highest));
      }
      if (said.present) entry = joined(entry, said);
    }
    return entry;
  }

  /// The range is that of all samples, and some may not be there any more.
  [[nodiscard]] bool is_range_of(const ChildEntry& said, const ChildEntry& found) const {
    if (pages_.manifest().description.finest_tolerance > 0)
      return said.lowest <= found.lowest && said.highest >= found.highest;
    return said.lowest == found.lowest && said.highest == found.highest;
  }

  /// Parents in the same page; those beyond it are held by the answer's true error.
  void check_parents(const Page& page, GridPoint p, ErrorCode own) {
    if (spacing(p) == kRootSpacing) return;
    const PageGrid& g = page.grid;
    for (const GridPoint parent : diamond(p).apexes) {
      const std::int32_t col = (parent.col >> g.shift) - g.first.col, row = (parent.row >> g.shift) - g.first.row;
      if (col < 0 || row < 0 || col >= g.cols || row >= g.rows || !page.is_own(parent)) continue;
      const ErrorCode above = page.error(page.index(col, row), pages_.distance());
      if (above < own) {
        find(fmt::format("{}: error {} m at column {}, row {} is below {} m of a vertex that depends on it",
                         name(page.id), error_of(above), parent.col, parent.row, error_of(own)));
      }
    }
  }

  /// Bit for bit, or within what ingest has rounded by.
  [[nodiscard]] bool is_stored_as(double stored, double source) const {
    const Description& d = pages_.manifest().description;
    if (std::bit_cast<std::uint64_t>(stored) == std::bit_cast<std::uint64_t>(source)) return true;
    // Of a multiple of the step, which decimals are not quite.
    const double arithmetic = 4 * std::numeric_limits<double>::epsilon() * std::abs(source);
    return d.lossy_metres > 0 && std::abs(stored - source) <= d.lossy_metres / d.metres_per_unit + arithmetic;
  }

  void compare(const StoredSamples& samples, const SampleWindow& expected) {
    const SampleWindow& stored = samples.window;
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      ++report.samples;
      const bool data = expected.valid[i] != 0;
      const bool dropped = !samples.dropped.empty() && samples.dropped[i] != 0;
      if (data == (stored.valid[i] != 0) && (!data || dropped || is_stored_as(stored.values[i], expected.values[i]))) continue;
      const auto cols = static_cast<std::size_t>(stored.region.cols());
      const auto text = [](bool valid, double v) { return valid ? fmt::format("{}", v) : std::string("void"); };
      find(fmt::format("sample at column {}, row {}: {} is stored, the source has {}",
                       stored.region.first.col + static_cast<std::int64_t>(i % cols),
                       stored.region.first.row + static_cast<std::int64_t>(i / cols),
                       text(stored.valid[i] != 0, stored.values[i]), text(data, expected.values[i])));
    }
  }

  const StoredPages& pages_;
  GridRect extent_;
  PageDecoder decoder_;
  Entries below_;
};

}  // namespace

VerifyReport verify(const Snapshot& snapshot) {
  Verification v(pages_of(snapshot));
  v.structure();
  return v.report;
}

VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth) {
  Verification v(pages_of(snapshot));
  v.structure();
  if (v.report.finding_count == 0) v.samples(truth);
  const double finest = snapshot.description().finest_tolerance;
  if (v.report.finding_count == 0 && finest > 0) v.finest_answer(truth);
  return v.report;
}

VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth, Metres tolerance) {
  Verification v(pages_of(snapshot));
  v.structure();
  if (v.report.finding_count == 0) v.samples(truth);
  if (v.report.finding_count == 0) v.true_error_of(tolerance, truth);
  return v.report;
}

}  // namespace talus
