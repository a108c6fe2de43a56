#include "tests/support/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <type_traits>
#include <unordered_map>

namespace talus::support {
namespace {

__extension__ using Wide = __int128;

constexpr long double nanometre = 1e-9L;
constexpr std::size_t spelled_out = 8;

std::string name(GridPoint p) { return "(" + std::to_string(p.col) + ", " + std::to_string(p.row) + ")"; }

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {  // b > 0
  return a / b - (a % b < 0 ? 1 : 0);
}
std::int64_t ceil_divide(std::int64_t a, std::int64_t b) { return -floor_divide(-a, b); }

struct Place {
  std::int64_t x = 0, y = 0;  ///< east and south
};

/// Which side of a directed edge a point is on: >= 0 to its left, seen from above with north up. The value is
/// twice the area of the triangle the three points make; it changes by `per_x` a step east.
struct Edge {
  Place from;
  std::int64_t per_x, per_y;
  Edge(Place a, Place b) : from(a), per_x(b.y - a.y), per_y(a.x - b.x) {}
  [[nodiscard]] std::int64_t at(std::int64_t x, std::int64_t y) const {
    return per_x * (x - from.x) + per_y * (y - from.y);
  }
};

/// A counter-clockwise triangle; edge i is opposite corner i, so `edges[i].at` weighs corner i.
struct Triangle {
  std::array<Place, 3> corners;
  std::array<Edge, 3> edges;
  std::int64_t area2;
  explicit Triangle(const std::array<Place, 3>& c)
      : corners(c), edges{Edge(c[1], c[2]), Edge(c[2], c[0]), Edge(c[0], c[1])}, area2(edges[0].at(c[0].x, c[0].y)) {}

  [[nodiscard]] std::pair<std::int64_t, std::int64_t> rows() const {
    const auto [low, high] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
    return {low, high};
  }
  /// Columns of a row that lie in the closed triangle; first > second where there is none.
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> span(std::int64_t y) const {
    std::int64_t low = std::min({corners[0].x, corners[1].x, corners[2].x});
    std::int64_t high = std::max({corners[0].x, corners[1].x, corners[2].x});
    for (const Edge& edge : edges) {
      const std::int64_t at_low = edge.at(low, y);
      if (edge.per_x > 0 && at_low < 0) low += ceil_divide(-at_low, edge.per_x);
      if (edge.per_x == 0 && at_low < 0) return {1, 0};
      if (edge.per_x < 0) {
        if (at_low < 0) return {1, 0};
        high = std::min(high, low + floor_divide(at_low, -edge.per_x));
      }
    }
    return {low, high};
  }
};

/// The finest triangles of a region: two a unit cell, cut from one corner of even col + row to the other.
/// `upper` is the one that holds the cell's northern side. Which are valid, and how often each was covered.
class FinestTriangles {
 public:
  FinestTriangles(const Terrain& raster, GridRect region)
      : first_{region.first.col, region.first.row},
        cols_(region.cols() - 1),
        rows_(region.rows() - 1),
        valid_(static_cast<std::size_t>(std::max<std::int64_t>(0, 2 * cols_ * rows_))),
        covers_(valid_.size()) {
    for (std::int64_t y = first_.y; y < first_.y + rows_; ++y) {
      for (std::int64_t x = first_.x; x < first_.x + cols_; ++x) {
        for (const bool upper : {true, false}) {
          bool all = true;
          for (const Place& c : corners(x, y, upper)) {
            all = all && raster.is_valid(static_cast<int>(c.x), static_cast<int>(c.y));
          }
          valid_[index(x, y, upper)] = all ? 1 : 0;
        }
      }
    }
  }

  static bool falls(std::int64_t x, std::int64_t y) { return ((x + y) & 1) == 0; }  // the cut runs to the south-east
  static std::array<Place, 3> corners(std::int64_t x, std::int64_t y, bool upper) {
    if (falls(x, y)) return {Place{x, y}, Place{x + 1, y + 1}, upper ? Place{x + 1, y} : Place{x, y + 1}};
    return {Place{x + 1, y}, Place{x, y + 1}, upper ? Place{x, y} : Place{x + 1, y + 1}};
  }
  [[nodiscard]] std::size_t index(std::int64_t x, std::int64_t y, bool upper) const {
    return static_cast<std::size_t>(2 * ((y - first_.y) * cols_ + (x - first_.x)) + (upper ? 0 : 1));
  }
  /// The one that holds a point of the plane which lies on none of their sides; none outside the region.
  [[nodiscard]] std::size_t holding(double px, double py) const {
    const auto x = static_cast<std::int64_t>(std::floor(px)), y = static_cast<std::int64_t>(std::floor(py));
    if (x < first_.x || y < first_.y || x >= first_.x + cols_ || y >= first_.y + rows_) return none;
    const double dx = px - static_cast<double>(x), dy = py - static_cast<double>(y);
    return index(x, y, falls(x, y) ? dx > dy : dx + dy < 1);
  }
  static constexpr std::size_t none = ~std::size_t{0};

  struct Held {
    std::int64_t all = 0, valid = 0;
  };
  /// Covers those whose centroids lie in the triangle, and counts them. Thirds of cells are the unit: the
  /// centroid of an upper one lies in row 3y + 1, at 3x + 2 if the cut falls, else at 3x + 1; of a lower one
  /// in row 3y + 2, the other way round.
  Held cover(const Triangle& triangle) {
    std::array<Place, 3> thirds = triangle.corners;
    for (Place& c : thirds) c = {3 * c.x, 3 * c.y};
    const Triangle scaled(thirds);
    Held held;
    const auto [top, bottom] = triangle.rows();
    for (std::int64_t y = top; y < bottom; ++y) {
      for (const bool upper : {true, false}) {
        const auto [low, high] = scaled.span(3 * y + (upper ? 1 : 2));
        for (std::int64_t x = floor_divide(low, 3); x <= floor_divide(high, 3); ++x) {
          const std::int64_t centroid = 3 * x + (falls(x, y) == upper ? 2 : 1);
          if (centroid < low || centroid > high) continue;
          const std::size_t i = index(x, y, upper);
          covers_[i] = static_cast<std::uint8_t>(std::min(covers_[i] + 1, 255));
          ++held.all;
          held.valid += valid_[i];
        }
      }
    }
    return held;
  }

  [[nodiscard]] std::size_t size() const { return valid_.size(); }
  [[nodiscard]] bool valid(std::size_t i) const { return valid_[i] != 0; }
  [[nodiscard]] int covers(std::size_t i) const { return covers_[i]; }
  [[nodiscard]] bool all_valid() const { return std::find(valid_.begin(), valid_.end(), 0) == valid_.end(); }

 private:
  Place first_;
  std::int64_t cols_, rows_;
  std::vector<std::uint8_t> valid_, covers_;
};

/// How many binary digits after the point all numbers need; -1 if more than 20, or if they are too large to
/// be computed with exactly.
class BinaryDigits {
 public:
  void see(double value) {
    if (!std::isfinite(value) || std::abs(value) > 0x1p40) digits_ = -1;
    while (digits_ >= 0 && std::ldexp(value, digits_) != std::floor(std::ldexp(value, digits_))) {
      digits_ = digits_ < 20 ? digits_ + 1 : -1;
    }
    largest_ = std::max(largest_, std::abs(value));
  }
  [[nodiscard]] int digits() const { return digits_; }
  [[nodiscard]] double largest() const { return largest_; }

 private:
  int digits_ = 0;
  double largest_ = 0;
};

class Judge {
 public:
  Judge(const Mesh& mesh, const Terrain& raster, double metres_per_unit, double tolerance, const OracleOptions& options)
      : mesh_(mesh),
        raster_(raster),
        region_(mesh.region),
        unit_(metres_per_unit),
        tolerance_(tolerance),
        options_(options),
        finest_(raster, mesh.region),
        seen_(static_cast<std::size_t>(std::max<std::int64_t>(0, region_.samples()))) {}

  OracleReport judge() {
    find_covered();
    check_points();
    if (report_.bad_indices != 0 || report_.outside_points != 0) return report_;
    choose_arithmetic();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) check_triangle(t);
    check_coverage();
    check_edges();
    return report_;
  }

 private:
  enum : std::uint8_t { covered = 1, in_mesh = 2, vertex = 4 };

  std::size_t sample(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>((y - region_.first.row) * region_.cols() + (x - region_.first.col));
  }
  std::size_t in_raster(std::int64_t x, std::int64_t y) const {
    return raster_.index(static_cast<int>(x), static_cast<int>(y));
  }
  Place place(std::uint32_t point) const { return {mesh_.points[point].col, mesh_.points[point].row}; }
  void find(std::uint64_t& count, const std::string& sentence) {
    if (++count == 1 && report_.findings.size() < spelled_out) report_.findings.push_back(sentence);
  }
  std::string name_of(std::size_t t) const {
    std::string text = "triangle " + std::to_string(t);
    for (const std::uint32_t corner : mesh_.triangles[t]) text += " " + name(mesh_.points[corner]);
    return text;
  }

  void find_covered() {
    for (std::int64_t y = region_.first.row; y < region_.last.row; ++y) {
      for (std::int64_t x = region_.first.col; x < region_.last.col; ++x) {
        for (const bool upper : {true, false}) {
          if (!finest_.valid(finest_.index(x, y, upper))) continue;
          ++report_.finest_triangles;
          for (const Place& c : FinestTriangles::corners(x, y, upper)) seen_[sample(c.x, c.y)] |= covered;
        }
      }
    }
    for (const std::uint8_t flags : seen_) report_.covered_samples += flags & covered;
  }

  void check_points() {
    std::vector<std::uint8_t> used(mesh_.points.size());
    for (const auto& triangle : mesh_.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (corner >= mesh_.points.size()) {
          find(report_.bad_indices, "a triangle names point " + std::to_string(corner));
        } else {
          used[corner] = 1;
        }
      }
    }
    if (mesh_.heights.size() != mesh_.points.size()) find(report_.bad_indices, "not one height for each point");
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      const GridPoint p = mesh_.points[i];
      if (!region_.contains(p)) {
        find(report_.outside_points, "point " + name(p) + " lies outside the region");
        continue;
      }
      std::uint8_t& flags = seen_[sample(p.col, p.row)];
      if ((flags & vertex) != 0) find(report_.duplicate_points, "two points at " + name(p));
      flags |= vertex;
      if (used[i] == 0) find(report_.orphan_points, "point " + name(p) + " is in no triangle");
      if (!options_.heights_are_source || i >= mesh_.heights.size()) continue;
      const std::size_t source = in_raster(p.col, p.row);
      if (raster_.valid[source] != 0 && !(mesh_.heights[i] == raster_.values[source])) {
        std::ostringstream text;
        text.precision(17);
        text << "point " << name(p) << " has height " << mesh_.heights[i] << ", its sample " << raster_.values[source];
        find(report_.wrong_heights, text.str());
      }
    }
  }

  /// Integers if every height is a multiple of one binary fraction; then an error is a whole number over
  /// twice the triangle's area, and that, for right triangles of the bisection, a power of two: the
  /// quotient is exact in a long double too.
  void choose_arithmetic() {
    BinaryDigits digits;
    for (const double height : mesh_.heights) digits.see(height);
    for (std::int64_t y = region_.first.row; y <= region_.last.row; ++y) {
      for (std::int64_t x = region_.first.col; x <= region_.last.col; ++x) {
        if (raster_.valid[in_raster(x, y)] != 0) digits.see(raster_.values[in_raster(x, y)]);
      }
    }
    digits_ = std::max(0, digits.digits());
    report_.exact = digits.digits() >= 0 && unit_ == 1;
    const double widest = static_cast<double>(region_.cols()) * static_cast<double>(region_.rows());
    narrow_ = digits.digits() >= 0 && widest * std::ldexp(digits.largest() + 1, digits_) < 0x1p58;
    whole_ = digits.digits() >= 0;
  }

  void check_triangle(std::size_t t) {
    std::array<std::uint32_t, 3> ids = mesh_.triangles[t];
    Triangle triangle({place(ids[0]), place(ids[1]), place(ids[2])});
    if (triangle.area2 == 0) {
      find(report_.degenerate, name_of(t) + " has no area");
      return;
    }
    if (triangle.area2 < 0) {
      find(report_.flipped, name_of(t) + " is clockwise");
      std::swap(ids[1], ids[2]);
      triangle = Triangle({place(ids[0]), place(ids[1]), place(ids[2])});
    }
    area2_ += triangle.area2;
    check_ground(t, triangle);
    const std::array<double, 3> heights{mesh_.heights[ids[0]], mesh_.heights[ids[1]], mesh_.heights[ids[2]]};
    if (narrow_) {
      check_surface<std::int64_t>(t, triangle, heights);
    } else if (whole_) {
      check_surface<Wide>(t, triangle, heights);
    } else {
      check_surface<long double>(t, triangle, heights);
    }
  }

  void check_ground(std::size_t t, const Triangle& triangle) {
    const auto held = finest_.cover(triangle);
    if (held.valid == 0) find(report_.idle_triangles, name_of(t) + " holds no data");
    if (held.valid == 0 || held.valid == held.all) return;
    ++report_.mixed_triangles;
    if (options_.cell_width_m <= 0) return;
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      const Place a = triangle.corners[static_cast<std::size_t>(i)];
      const Place b = triangle.corners[static_cast<std::size_t>((i + 1) % 3)];
      longest = std::max(longest, std::hypot(static_cast<double>(b.x - a.x) * options_.cell_width_m,
                                             static_cast<double>(b.y - a.y) * options_.cell_height_m));
    }
    if (longest * options_.void_weight > tolerance_ * (1 + 1e-12) + 1e-9) {
      find(report_.coarse_outline, name_of(t) + " mixes data and void over " + std::to_string(longest) + " m");
    }
  }

  template <class Number>
  Number number(double height) const {
    if constexpr (std::is_same_v<Number, long double>)
      return height;
    else
      return static_cast<Number>(static_cast<std::int64_t>(std::ldexp(height, digits_)));
  }

  template <class Number>
  void check_surface(std::size_t t, const Triangle& triangle, const std::array<double, 3>& corner_heights) {
    std::array<Number, 3> h;
    for (std::size_t i = 0; i < 3; ++i) h[i] = number<Number>(corner_heights[i]);
    const auto area2 = static_cast<Number>(triangle.area2);
    Number largest = -1;
    Place where;
    const auto [top, bottom] = triangle.rows();
    for (std::int64_t y = top; y <= bottom; ++y) {
      const auto [low, high] = triangle.span(y);
      for (std::int64_t x = low; x <= high; ++x) {
        std::uint8_t& flags = seen_[sample(x, y)];
        flags |= in_mesh;
        if (raster_.valid[in_raster(x, y)] == 0) continue;
        Number off = number<Number>(raster_.values[in_raster(x, y)]) * area2;
        for (std::size_t i = 0; i < 3; ++i) off -= static_cast<Number>(triangle.edges[i].at(x, y)) * h[i];
        if (off < 0) off = -off;
        if (off > largest || !(off == off)) largest = off, where = {x, y};
      }
    }
    if (largest == Number{-1}) return;
    note_error(t,
               std::ldexp(static_cast<long double>(largest) / static_cast<long double>(triangle.area2),
                          std::is_same_v<Number, long double> ? 0 : -digits_) *
                   static_cast<long double>(unit_),
               where);
  }

  void note_error(std::size_t t, long double error, Place where) {
    const GridPoint p{static_cast<std::int32_t>(where.x), static_cast<std::int32_t>(where.y)};
    if (!(error <= worst_)) {
      worst_ = error;
      report_.largest_error = static_cast<double>(error);
      report_.worst_sample = p;
    }
    const long double slack = report_.exact ? 0 : nanometre;
    if (!(error <= static_cast<long double>(tolerance_) + slack)) {
      std::ostringstream text;
      text.precision(17);
      text << "sample " << name(p) << " lies " << static_cast<double>(error) << " m from " << name_of(t);
      find(report_.triangles_over, text.str());
    }
  }

  void check_coverage() {
    for (std::int64_t y = region_.first.row; y <= region_.last.row; ++y) {
      for (std::int64_t x = region_.first.col; x <= region_.last.col; ++x) {
        if ((seen_[sample(x, y)] & (covered | in_mesh)) != covered) continue;
        find(report_.uncovered_samples, "sample (" + std::to_string(x) + ", " + std::to_string(y) + ") is not covered");
      }
    }
    for (std::int64_t y = region_.first.row; y < region_.last.row; ++y) {
      for (std::int64_t x = region_.first.col; x < region_.last.col; ++x) {
        for (const bool upper : {true, false}) {
          const std::size_t i = finest_.index(x, y, upper);
          const auto half = [&] {
            return std::string(upper ? "upper" : "lower") + " half of cell (" + std::to_string(x) + ", " +
                   std::to_string(y) + ")";
          };
          if (finest_.valid(i) && finest_.covers(i) == 0) find(report_.uncovered_triangles, half() + " is not covered");
          if (finest_.covers(i) > 1) find(report_.overlapped_triangles, half() + " is covered twice");
        }
      }
    }
    const std::int64_t wanted =
        2 * std::max<std::int64_t>(0, region_.cols() - 1) * std::max<std::int64_t>(0, region_.rows() - 1);
    report_.area_wrong = finest_.all_valid() && area2_ != wanted;
    if (report_.area_wrong) {
      report_.findings.push_back("twice the area is " + std::to_string(area2_) + ", not " + std::to_string(wanted));
    }
  }

  struct Use {
    std::uint32_t high;
    bool rising;  ///< from the lower to the higher point number
  };

  /// Edges gathered by their lower point: a list of few for each.
  void check_edges() {
    std::vector<std::uint64_t> begin(mesh_.points.size() + 1);
    const auto each_edge = [&](auto&& visit) {
      for (const auto& triangle : mesh_.triangles) {
        for (std::size_t i = 0; i < 3; ++i) visit(triangle[i], triangle[(i + 1) % 3]);
      }
    };
    each_edge([&](std::uint32_t a, std::uint32_t b) { ++begin[std::min(a, b)]; });
    std::exclusive_scan(begin.begin(), begin.end(), begin.begin(), std::uint64_t{0});
    std::vector<Use> uses(3 * mesh_.triangles.size());
    std::vector<std::uint64_t> next = begin;
    each_edge([&](std::uint32_t a, std::uint32_t b) { uses[next[std::min(a, b)]++] = {std::max(a, b), a < b}; });

    for (std::uint32_t low = 0; low < mesh_.points.size(); ++low) {
      const auto first = uses.begin() + static_cast<std::ptrdiff_t>(begin[low]);
      const auto last = uses.begin() + static_cast<std::ptrdiff_t>(begin[low + 1]);
      std::sort(first, last, [](const Use& a, const Use& b) { return a.high < b.high; });
      for (auto at = first; at != last;) {
        const auto end = std::find_if(at, last, [&](const Use& use) { return use.high != at->high; });
        check_edge(low, *at, end - at, std::count_if(at, end, [](const Use& use) { return use.rising; }));
        at = end;
      }
    }
  }

  void check_edge(std::uint32_t low, Use use, std::ptrdiff_t count, std::ptrdiff_t rising) {
    const Place a = place(use.rising ? low : use.high), b = place(use.rising ? use.high : low);
    const auto described = [&] { return "edge " + name(mesh_.points[low]) + " " + name(mesh_.points[use.high]); };
    const Place way{b.x - a.x, b.y - a.y};
    const std::int64_t steps = std::gcd(way.x, way.y);
    for (std::int64_t i = 1; i < steps; ++i) {
      const Place p{a.x + way.x / steps * i, a.y + way.y / steps * i};
      if ((seen_[sample(p.x, p.y)] & vertex) == 0) continue;
      find(report_.t_junctions,
           described() + " runs through point (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ")");
    }
    if (count > 2 || (count == 2 && rising != 1)) {
      find(report_.overused_edges,
           described() + " is used " + std::to_string(count) + " times, " + std::to_string(rising) + " one way");
    }
    if (count == 1 && !on_border(a, b) && !on_outline(a, way, steps)) {
      find(report_.stray_edges, described() + " is used once, inside the mesh");
    }
  }

  bool on_border(Place a, Place b) const {
    return (a.x == b.x && (a.x == region_.first.col || a.x == region_.last.col)) ||
           (a.y == b.y && (a.y == region_.first.row || a.y == region_.last.row));
  }

  /// Is all that lies right of the edge, and touches it, free of the mesh and of data?
  bool on_outline(Place a, Place way, std::int64_t steps) const {
    if (finest_.all_valid()) return false;
    const double dx = static_cast<double>(way.x / steps), dy = static_cast<double>(way.y / steps);
    if (std::abs(dx) > 1 || std::abs(dy) > 1) return false;  // no side of finest triangles runs that way
    for (std::int64_t i = 0; i < steps; ++i) {
      const double along = static_cast<double>(i) + 0.5;
      const std::size_t beyond = finest_.holding(static_cast<double>(a.x) + along * dx - 0.25 * dy,
                                                 static_cast<double>(a.y) + along * dy + 0.25 * dx);
      if (beyond != FinestTriangles::none && (finest_.covers(beyond) != 0 || finest_.valid(beyond))) return false;
    }
    return true;
  }

  const Mesh& mesh_;
  const Terrain& raster_;
  const GridRect region_;
  const double unit_, tolerance_;
  const OracleOptions options_;
  FinestTriangles finest_;
  std::vector<std::uint8_t> seen_;
  OracleReport report_;
  long double worst_ = 0;
  std::int64_t area2_ = 0;
  int digits_ = 0;
  bool narrow_ = false, whole_ = false;
};

}  // namespace

bool OracleReport::sound() const { return findings.empty(); }

std::string OracleReport::summary() const {
  std::ostringstream text;
  text.precision(17);
  text << "largest error " << largest_error << " m at " << name(worst_sample) << (exact ? " (exact)" : "") << ", "
       << covered_samples << " covered samples, " << finest_triangles << " valid finest triangles, " << mixed_triangles
       << " mixed triangles";
  const std::pair<const char*, std::uint64_t> counts[] = {{"triangles over the tolerance", triangles_over},
                                                          {"uncovered samples", uncovered_samples},
                                                          {"wrong heights", wrong_heights},
                                                          {"uncovered finest triangles", uncovered_triangles},
                                                          {"overlapped finest triangles", overlapped_triangles},
                                                          {"triangles without data", idle_triangles},
                                                          {"outline triangles too long", coarse_outline},
                                                          {"flipped", flipped},
                                                          {"degenerate", degenerate},
                                                          {"overused edges", overused_edges},
                                                          {"stray edges", stray_edges},
                                                          {"T-junctions", t_junctions},
                                                          {"duplicate points", duplicate_points},
                                                          {"orphan points", orphan_points},
                                                          {"points outside", outside_points},
                                                          {"bad indices", bad_indices}};
  for (const auto& [what, count] : counts) {
    if (count != 0) text << "; " << count << " " << what;
  }
  for (const std::string& finding : findings) text << "\n  " << finding;
  return text.str();
}

OracleReport check_mesh(const Mesh& mesh, const Terrain& raster, double metres_per_unit, double tolerance,
                        const OracleOptions& options) {
  return Judge(mesh, raster, metres_per_unit, tolerance, options).judge();
}

bool is_covered(const Terrain& raster, GridRect region, GridPoint p) {
  const GridRect around{{std::max(p.col - 1, region.first.col), std::max(p.row - 1, region.first.row)},
                        {std::min(p.col + 1, region.last.col), std::min(p.row + 1, region.last.row)}};
  const FinestTriangles finest(raster, around);
  for (std::int64_t y = around.first.row; y < around.last.row; ++y) {
    for (std::int64_t x = around.first.col; x < around.last.col; ++x) {
      for (const bool upper : {true, false}) {
        if (!finest.valid(finest.index(x, y, upper))) continue;
        for (const Place& c : FinestTriangles::corners(x, y, upper)) {
          if (c.x == p.col && c.y == p.row) return true;
        }
      }
    }
  }
  return false;
}

Mesh join(const Mesh& a, const Mesh& b, GridRect region) {
  Mesh joined = a;
  joined.region = region;
  const auto key = [](GridPoint p) {
    return std::uint64_t{static_cast<std::uint32_t>(p.col)} << 32 | static_cast<std::uint32_t>(p.row);
  };
  // A point is one only if its height is: where two meshes disagree about a height there is a crack.
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  for (std::uint32_t i = 0; i < a.points.size(); ++i) known.emplace(key(a.points[i]), i);
  std::vector<std::uint32_t> now(b.points.size());
  for (std::uint32_t i = 0; i < b.points.size(); ++i) {
    const auto found = known.find(key(b.points[i]));
    if (found != known.end() && a.heights[found->second] == b.heights[i]) {
      now[i] = found->second;
      continue;
    }
    now[i] = static_cast<std::uint32_t>(joined.points.size());
    joined.points.push_back(b.points[i]);
    joined.heights.push_back(b.heights[i]);
  }
  for (auto triangle : b.triangles) {
    for (std::uint32_t& corner : triangle) corner = now[corner];
    joined.triangles.push_back(triangle);
  }
  return joined;
}

}  // namespace talus::support
