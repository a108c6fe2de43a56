#include "app/truth.hpp"

#include <cmath>
#include <memory>

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
  InputOptions inputs;
  inputs.height_step = 2 * description.lossy_metres;  // heights are held against those the database rounded
  const auto raster =
      std::make_shared<Raster>(std::vector<std::filesystem::path>{against.begin(), against.end()}, inputs);
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
  // Joined otherwise, the same raster may count its samples from another corner.
  const std::int32_t east = theirs.first.col - ours.first.col, south = theirs.first.row - ours.first.row;
  return [raster, east, south](GridRect part) {
    SampleWindow window =
        raster->read({{part.first.col + east, part.first.row + south}, {part.last.col + east, part.last.row + south}});
    window.region = part;
    return window;
  };
}

}  // namespace talus::app
