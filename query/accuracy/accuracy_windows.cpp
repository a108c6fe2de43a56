#include "query/accuracy/accuracy_windows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "engine/page/page_layout.hpp"

namespace talus {
namespace {

constexpr std::int32_t kWindow = 1025;                      // samples per side
constexpr std::int64_t kWhole = std::int64_t{2049} * 2049;  // samples: a larger region gets windows
constexpr std::int64_t kWholeNamed =
    std::int64_t{4097} * 4097;  // the same for a named region, and the most samples in all windows
constexpr std::int64_t kMostWindows = 9;
constexpr double kMostPlaces = 1024;  // examined
constexpr double kTerrainShare =
    0.03;  // share of all samples: a tolerance that needs as many vertices separates terrain from flat sea
constexpr std::int64_t kFlatSamples = 128;  // places with at most one vertex per so many samples are flat

struct Span {
  std::int32_t first, last;
};

/// Windows side by side in a line of samples, at multiples of their width where one fits. If there are too many, every
/// n-th.
std::vector<Span> spans(std::int32_t first, std::int32_t last, std::int32_t cells) {
  if (std::int64_t{last} - first <= cells) return {{first, last}};
  std::int64_t at = static_cast<std::int64_t>(std::ceil(static_cast<double>(first) / cells)) * cells;
  if (at + cells > last) at = first;
  std::vector<Span> found;
  for (; at + cells <= last; at += cells)
    found.push_back({static_cast<std::int32_t>(at), static_cast<std::int32_t>(at + cells)});
  return found;
}

template <class T>
std::vector<T> every(const std::vector<T>& all, std::size_t nth) {
  std::vector<T> some;
  for (std::size_t i = nth / 2; i < all.size(); i += nth) some.push_back(all[i]);
  return some.empty() ? all : some;
}

/// Places along a curve that keeps neighbours together, so that every n-th of them are spread evenly.
std::vector<GridRect> places_in(GridRect region, std::int32_t side) {
  std::vector<Span> cols = spans(region.first.col, region.last.col, side - 1);
  std::vector<Span> rows = spans(region.first.row, region.last.row, side - 1);
  const double many = static_cast<double>(cols.size()) * static_cast<double>(rows.size()) / kMostPlaces;
  if (many > 1) {
    const auto nth = static_cast<std::size_t>(std::ceil(std::sqrt(many)));
    cols = every(cols, nth);
    rows = every(rows, nth);
  }
  std::vector<std::pair<std::uint64_t, GridRect>> ordered;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < cols.size(); ++x) {
      const PageId place{0, static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
      ordered.push_back({curve_position(place), {{cols[x].first, rows[y].first}, {cols[x].last, rows[y].last}}});
    }
  }
  std::sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<GridRect> places;
  for (const auto& [position, place] : ordered) places.push_back(place);
  return places;
}

/// The largest tolerance that still selects kTerrainShare of all samples.
Metres terrain_of(const Snapshot& now) {
  const Description& d = now.description();
  const double valid = static_cast<double>(d.extent.samples()) - static_cast<double>(d.void_samples);
  double terrain = 0;
  for (const auto& [tolerance, vertices] : now.provenance().vertices_above) {
    if (static_cast<double>(vertices) >= kTerrainShare * valid) terrain = std::max(terrain, tolerance);
  }
  return Metres{terrain};
}

}  // namespace

AskedWindows windows_of(const Snapshot& now, GridRect region, bool is_named, std::optional<std::int32_t> side) {
  const auto has_triangles = [&](GridRect part) {
    return !triangulate(
                now.ask({.region = part, .tolerance = Metres{std::numeric_limits<double>::infinity()}}).quadtree)
                .triangles.empty();
  };
  const auto nothing = [&] {
    const char* why = region.cols() == 1 || region.rows() == 1 ? "it is one sample wide or high"
                                                               : "it has no three neighbouring valid samples";
    return Failure(Cause::invalid_argument,
                   fmt::format("nothing to measure: no answer for the region has a triangle, because {}", why));
  };
  AskedWindows asked;
  if (!side && region.samples() <= (is_named ? kWholeNamed : kWhole)) {
    if (!has_triangles(region)) throw nothing();
    asked.windows = {region};
    return asked;
  }

  const std::int32_t width = side.value_or(kWindow);
  const std::vector<GridRect> places = places_in(region, width);
  asked.is_whole = false;
  asked.places = places.size();
  asked.terrain = terrain_of(now);
  std::vector<GridRect> with_terrain, with_data;
  for (const GridRect& place : places) {
    const Answer answer = now.ask({.region = place, .tolerance = asked.terrain});
    const std::uint64_t needed = answer.quadtree.vertices.size() - answer.border_vertices;
    if (needed > 4 + static_cast<std::uint64_t>(place.samples() / kFlatSamples)) with_terrain.push_back(place);
  }
  asked.places_with_terrain = with_terrain.size();
  if (with_terrain.empty()) std::copy_if(places.begin(), places.end(), std::back_inserter(with_data), has_triangles);
  const std::vector<GridRect>& from = with_terrain.empty() ? with_data : with_terrain;
  if (from.empty()) throw nothing();
  const std::int64_t room = kWholeNamed / (std::int64_t{width} * width);
  const auto count =
      std::min<std::size_t>(static_cast<std::size_t>(std::clamp<std::int64_t>(room, 1, kMostWindows)), from.size());
  for (std::size_t i = 0; i < count; ++i) asked.windows.push_back(from[(2 * i + 1) * from.size() / (2 * count)]);
  return asked;
}

}  // namespace talus
