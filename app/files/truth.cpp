#include "app/files/truth.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "ingest/raster/plain_reader.hpp"

namespace talus::app {

std::string name_of(const std::vector<std::string>& against) {
  return against.size() == 1 ? against.front() : fmt::format("{} and {} more", against.front(), against.size() - 1);
}

namespace {

[[noreturn]] void refuse(const std::string& difference) {
  throw Failure(Cause::invalid_argument, difference + "; name the raster that the database was made from");
}

}  // namespace

SampleReader open_truth(const std::vector<std::string>& against, const InputOptions& inputs,
                        const Description& description, const std::string& database) {
  const auto raster = std::make_shared<PlainReader>(std::vector<std::filesystem::path>{against.begin(), against.end()},
                                                    inputs, description, database);
  const GridRect ours = description.extent, theirs = raster->extent();
  if (ours.cols() != theirs.cols() || ours.rows() != theirs.rows())
    refuse(fmt::format("{} has {} x {} samples, and {} has {} x {}", database, ours.cols(), ours.rows(),
                       name_of(against), theirs.cols(), theirs.rows()));
  if (!(ours == theirs)) refuse(fmt::format("{} does not lie where {} does", name_of(against), database));
  return [raster](GridRect part) { return raster->read(part); };
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
      const double rounding =
          d.lossy.value / d.metres_per_unit + 4 * std::numeric_limits<double>::epsilon() * std::abs(there);
      if (is_kept == is_there && (!is_kept || std::abs(kept - there) <= rounding)) return;
      const auto text = [](bool is_data, double height) {
        return is_data ? fmt::format("{}", height) : std::string("no data");
      };
      refuse(fmt::format("{} has {} at column {}, row {}, and {} has {}", database, text(is_kept, kept), p.col, p.row,
                         name, text(is_there, there)));
    };
    if (d.finest_tolerance.value > 0) {
      const RestrictedQuadtree finest = now.ask({.region = part}).quadtree;
      std::size_t i = 0;
      finest.vertices.for_each([&](GridPoint p) {
        const double kept = finest.heights[i++];
        if (window.valid[window.index(p)] != 0) require_same(p, true, kept);  // the database fills voids itself
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
