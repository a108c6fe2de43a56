#include "query/surface/heights.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <vector>

#include "engine/geo/longitude.hpp"
#include "engine/machine/fail.hpp"

namespace talus {
namespace {

/// Calls code_at(place) for the places within the extent along the curve, so that each page is found once, and each
/// place is near the one before.
template <class CodeAt>
void by_page(const StoredPages& pages, std::span<const Position> points, std::span<std::optional<double>> out,
             CodeAt&& code_at) {
  assert(points.size() == out.size());
  const Description& description = pages.manifest().description;
  const Longitudes longitudes = pages.longitudes();
  const auto place_of = [&](Position p) {
    return grid_place(description.mapping, longitudes.among(p, description.extent));
  };
  struct Asked {
    std::uint64_t at;  ///< position of its cell on the curve
    std::size_t point;
    Place place;
  };
  std::vector<Asked> order;
  order.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    out[i].reset();
    const Place p = place_of(points[i]);
    if (!contains(description.extent, p)) continue;
    const GridPoint corner{static_cast<std::int32_t>(std::floor(p.col)), static_cast<std::int32_t>(std::floor(p.row))};
    order.push_back({curve_position({0, corner.col, corner.row}), i, p});
  }
  std::sort(order.begin(), order.end(), [](const Asked& a, const Asked& b) { return a.at < b.at; });
  for (const Asked& asked : order) {
    const std::optional<double> code = code_at(asked.place);
    if (code) out[asked.point] = description.step.value(*code);
  }
}

template <class Ask>
QueryCost timed(const StoredPages& pages, Ask&& ask) {
  const auto started = std::chrono::steady_clock::now();
  QueryCost cost = pages.cost_of_header();
  ask(cost);
  cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return cost;
}

class Samples {
 public:
  Samples(const StoredPages& pages, QueryCost& cost) : nearby_(pages, cost) {}

  /// The interpolated height code.
  [[nodiscard]] std::optional<double> between(Place p) {
    const double west = std::floor(p.col), north = std::floor(p.row);
    const double right = p.col - west, down = p.row - north;
    const GridPoint corner{static_cast<std::int32_t>(west), static_cast<std::int32_t>(north)};
    const std::optional<double> upper = on_row(corner, right);
    if (down == 0 || !upper) return upper;
    const std::optional<double> lower = on_row({corner.col, corner.row + 1}, right);
    if (!lower) return lower;
    return *upper + (*lower - *upper) * down;
  }

 private:
  [[nodiscard]] std::optional<double> on_row(GridPoint p, double right) {
    const std::optional<double> here = sample(p);
    if (right == 0 || !here) return here;
    const std::optional<double> next = sample({p.col + 1, p.row});
    if (!next) return next;
    return *here + (*next - *here) * right;
  }
  [[nodiscard]] std::optional<double> sample(GridPoint p) {
    const Page* page = nearby_.page(page_of(p, 0));
    if (page == nullptr) return std::nullopt;
    const std::size_t i = page->index(p);
    if (!page->is_data(i)) return std::nullopt;
    return page->height(i);
  }

  NearbyPages nearby_;
};

}  // namespace

QueryCost sampled_heights(const StoredPages& pages, std::span<const Position> points,
                          std::span<std::optional<double>> out) {
  const Description& description = pages.manifest().description;
  if (description.finest_tolerance.value > 0) {
    fail(Cause::unsupported,
         "the database keeps only the vertices for tolerances of {} m and more, so it has no samples to interpolate. "
         "Ask for the heights of a surface at that tolerance or more",
         description.finest_tolerance.value);
  }
  return timed(pages, [&](QueryCost& cost) {
    Samples samples(pages, cost);
    by_page(pages, points, out, [&](Place p) { return samples.between(p); });
  });
}

QueryCost surface_heights(const StoredPages& pages, const ExtentBorder& border, Metres tolerance,
                          std::span<const Position> points, std::span<std::optional<double>> out) {
  return timed(pages, [&](QueryCost& cost) {
    Surface surface(pages, border, tolerance, cost);
    by_page(pages, points, out, [&](Place p) { return surface.height(p); });
  });
}

}  // namespace talus
