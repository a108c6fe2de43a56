#include "app/truth.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "talus/ingest.hpp"

namespace talus::app {
namespace {

constexpr double kSamePlace = 1e-3;  // of a cell: formats round their origins

/// Where two grids put their first and last samples.
bool is_same_place(const Description& ours, const Description& theirs) {
  const auto near = [](double a, double b, double cell) { return std::abs(a - b) <= kSamePlace * std::abs(cell); };
  const GridMapping &m = ours.mapping, &n = theirs.mapping;
  const GridRect &e = ours.extent, &f = theirs.extent;
  return near(m.x(e.first.col), n.x(f.first.col), m.dx) && near(m.y(e.first.row), n.y(f.first.row), m.dy) &&
         near(m.x(e.last.col), n.x(f.last.col), m.dx) && near(m.y(e.last.row), n.y(f.last.row), m.dy);
}

}  // namespace

std::string name_of(const std::vector<std::string>& against) {
  return against.size() == 1 ? against.front() : fmt::format("{} and {} more", against.front(), against.size() - 1);
}

SampleReader open_truth(const std::vector<std::string>& against, const Description& description,
                        const std::string& database) {
  const auto raster =
      std::make_shared<Raster>(std::vector<std::filesystem::path>{against.begin(), against.end()}, InputOptions{});
  const GridRect ours = description.extent, theirs = raster->description().extent;
  if (ours.cols() != theirs.cols() || ours.rows() != theirs.rows()) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} has {} x {} samples and {} has {} x {}: not the raster this database was made from",
                              database, ours.cols(), ours.rows(), name_of(against), theirs.cols(), theirs.rows()));
  }
  if (!is_same_place(description, raster->description())) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} lies elsewhere than {}: not the raster this database was made from", name_of(against),
                              database));
  }
  if (!same_crs(description.crs_wkt, raster->description().crs_wkt)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{} has another CRS than {}, or one of them has none: not the raster this database was made from",
                              name_of(against), database));
  }
  // Joined otherwise, the same raster may count its samples from another corner.
  const std::int32_t east = theirs.first.col - ours.first.col, south = theirs.first.row - ours.first.row;
  return [raster, east, south](GridRect part) {
    SampleWindow window =
        raster->read({{part.first.col + east, part.first.row + south}, {part.last.col + east, part.last.row + south}});
    window.region = part;
    return window;
  };
}

SampleReader of_same_heights(SampleReader truth, const std::vector<std::string>& against, const std::string& database) {
  return [truth = std::move(truth), name = name_of(against), database](GridRect part) {
    SampleWindow window = truth(part);
    const Snapshot now = Database::open(database).snapshot();
    const Description& d = now.description();
    const auto require_same = [&](GridPoint p, bool is_kept, double kept) {
      const std::size_t at = window.index(p);
      const bool is_there = window.valid[at] != 0;
      const double there = window.values[at];
      const double rounding = d.lossy_metres / d.metres_per_unit + 4 * std::numeric_limits<double>::epsilon() * std::abs(there);
      if (is_kept == is_there && (!is_kept || std::abs(kept - there) <= rounding)) return;
      const auto text = [](bool is_data, double height) { return is_data ? fmt::format("{}", height) : std::string("no data"); };
      throw Failure(Cause::invalid_argument,
                    fmt::format("{} has {} at column {}, row {}, where {} has {}: not the raster this database was made from",
                                database, text(is_kept, kept), p.col, p.row, name, text(is_there, there)));
    };
    if (d.finest_tolerance > 0) {
      const RestrictedQuadtree finest = now.range(part, Metres{0}).quadtree;
      std::size_t i = 0;
      finest.vertices.for_each([&](GridPoint p) {
        const double kept = finest.heights[i++];
        if (window.valid[window.index(p)] != 0) require_same(p, true, kept);  // fills of voids are the database's own
      });
      return window;
    }
    const SampleWindow stored = now.samples(part);
    for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
      for (std::int32_t col = part.first.col; col <= part.last.col; ++col) {
        const std::size_t at = stored.index({col, row});
        require_same({col, row}, stored.valid[at] != 0, stored.values[at]);
      }
    }
    return window;
  };
}

}  // namespace talus::app
