// Draws a mesh. Step by step: the mesh is rasterized to subpixels with heights and slopes; the slopes choose the
// exaggeration; tint and light give the colour; edges are drawn last.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "query/rasters/png_bytes.hpp"
#include "query/rasters/raster_writers.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr double kLongSide = 1600;  // pixels: the most; the least is half of it
constexpr int kSub = 2;             // subpixels per side of a pixel
constexpr double kLineWidth = 1.1;  // pixels
constexpr double kLineOpacity = 0.5;
constexpr double kFadeFrom = 7, kFadeTo = 2.5;  // pixels: triangles with shorter legs fade, then vanish
constexpr double kTypicalSlope = 0.75;          // the 90th percentile of slopes after exaggeration
constexpr double kOcean = -200;                 // metres: with data this deep, 0 is sea level

struct Colour {
  float r = 0, g = 0, b = 0;
  friend Colour operator*(Colour c, float f) { return {c.r * f, c.g * f, c.b * f}; }
  friend Colour operator+(Colour c, Colour d) { return {c.r + d.r, c.g + d.g, c.b + d.b}; }
};
Colour mix(Colour from, Colour to, float share) { return from * (1 - share) + to * share; }

constexpr Colour kVoid{210, 212, 214}, kLine{38, 32, 30}, kShade{66, 70, 104}, kSunlit{255, 250, 232};

struct Stop {
  float at;
  Colour colour;
};
constexpr std::array<Stop, 8> kLand{{{0.00F, {128, 168, 120}},
                                     {0.14F, {160, 190, 132}},
                                     {0.30F, {200, 208, 150}},
                                     {0.46F, {224, 208, 158}},
                                     {0.62F, {205, 171, 126}},
                                     {0.78F, {172, 138, 110}},
                                     {0.90F, {204, 192, 182}},
                                     {1.00F, {250, 250, 250}}}};
constexpr std::array<Stop, 3> kSea{{{0.0F, {58, 96, 150}}, {0.6F, {112, 160, 196}}, {1.0F, {182, 214, 226}}}};

template <std::size_t N>
Colour along(const std::array<Stop, N>& ramp, float at) {
  for (std::size_t i = 1; i < N; ++i) {
    if (at <= ramp[i].at)
      return mix(ramp[i - 1].colour, ramp[i].colour, (at - ramp[i - 1].at) / (ramp[i].at - ramp[i - 1].at));
  }
  return ramp.back().colour;
}

float smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return static_cast<float>(t * t * (3 - 2 * t));
}

// Sides of a cell on the ground, up to a common factor, which the exaggeration removes.
struct CellSides {
  double across = 1, down = 1;
};

CellSides cell_sides(const Description& description, GridRect region) {
  CellSides sides{description.mapping.dx, -description.mapping.dy};
  if (description.crs.is_geographic) {
    const double south = description.mapping.y(region.last.row), north = description.mapping.y(region.first.row);
    const double latitude = std::clamp((south + north) / 2, -85.0, 85.0);
    sides.across *= std::cos(latitude * std::numbers::pi / 180);
  }
  return sides;
}

// The pixels of samples: x = (col - first col) · per_col, from the left edge.
struct Canvas {
  GridRect region;
  double per_col = 1, per_row = 1;
  int width = 1, height = 1;

  Canvas(GridRect r, CellSides cell) : region(r) {
    const double cols = std::max<double>(1, static_cast<double>(r.cols() - 1));
    const double rows = std::max<double>(1, static_cast<double>(r.rows() - 1));
    const bool wide = cols * cell.across >= rows * cell.down;
    const double cells = wide ? cols : rows;
    // A cell has a whole number of pixels, or a pixel a whole number of cells, along the longer side.
    const double scale = cells <= kLongSide ? std::floor(kLongSide / cells) : 1 / std::ceil(cells / kLongSide);
    per_col = wide ? scale : scale * cell.across / cell.down;
    per_row = wide ? scale * cell.down / cell.across : scale;
    width = std::max(1, static_cast<int>(std::lround(cols * per_col)));
    height = std::max(1, static_cast<int>(std::lround(rows * per_row)));
    per_col = width / cols;
    per_row = height / rows;
  }
  [[nodiscard]] double x(Place p) const { return (p.col - region.first.col) * per_col; }
  [[nodiscard]] double y(Place p) const { return (p.row - region.first.row) * per_row; }
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] std::size_t at(int px, int py) const {
    return static_cast<std::size_t>(py) * static_cast<std::size_t>(width) + static_cast<std::size_t>(px);
  }
};

struct Slope {
  float east = 0, north = 0;
};

// The slope at each vertex, for smooth shading: the mean over its triangles, weighted by their area on the canvas.
std::vector<Slope> vertex_slopes(const Mesh& mesh, CellSides cell) {
  std::vector<Slope> slopes(mesh.size());
  std::vector<float> areas(mesh.size(), 0);
  for (const auto& triangle : mesh.triangles) {
    const Place a = mesh.place(triangle[0]), b = mesh.place(triangle[1]), c = mesh.place(triangle[2]);
    const double bx = (b.col - a.col) * cell.across, by = -(b.row - a.row) * cell.down;
    const double cx = (c.col - a.col) * cell.across, cy = -(c.row - a.row) * cell.down;
    const double bz = mesh.heights[triangle[1]] - mesh.heights[triangle[0]];
    const double cz = mesh.heights[triangle[2]] - mesh.heights[triangle[0]];
    const double area = bx * cy - by * cx;
    if (area == 0) continue;
    for (const std::uint32_t id : triangle) {
      slopes[id].east += static_cast<float>(bz * cy - cz * by);
      slopes[id].north += static_cast<float>(cz * bx - bz * cx);
      areas[id] += static_cast<float>(area);
    }
  }
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    if (areas[i] != 0) slopes[i] = {slopes[i].east / areas[i], slopes[i].north / areas[i]};
  }
  return slopes;
}

struct Relief {
  std::vector<float> height, east, north;  // sums over the subpixels of a pixel
  std::vector<std::uint8_t> count;         // subpixels under the mesh
  explicit Relief(std::size_t pixels) : height(pixels), east(pixels), north(pixels), count(pixels) {}
};

void lay_triangle(const Mesh& mesh, const std::vector<Slope>& slopes, const std::array<std::uint32_t, 3>& ids,
                  const Canvas& canvas, Relief& relief) {
  std::array<double, 3> x{}, y{};
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = canvas.x(mesh.place(ids[i])) * kSub - 0.5;  // subpixel centres are whole numbers
    y[i] = canvas.y(mesh.place(ids[i])) * kSub - 0.5;
  }
  const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  if (area == 0) return;
  const auto [left, right] = std::minmax({x[0], x[1], x[2]});
  const auto [top, bottom] = std::minmax({y[0], y[1], y[2]});
  const int first_x = std::max(0, static_cast<int>(std::ceil(left)));
  const int last_x = std::min(canvas.width * kSub - 1, static_cast<int>(std::floor(right)));
  const int first_y = std::max(0, static_cast<int>(std::ceil(top)));
  const int last_y = std::min(canvas.height * kSub - 1, static_cast<int>(std::floor(bottom)));
  for (int sy = first_y; sy <= last_y; ++sy) {
    for (int sx = first_x; sx <= last_x; ++sx) {
      const double w1 = ((sx - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (sy - y[0])) / area;
      const double w2 = ((x[1] - x[0]) * (sy - y[0]) - (sx - x[0]) * (y[1] - y[0])) / area;
      const double w0 = 1 - w1 - w2;
      if (w0 < -1e-9 || w1 < -1e-9 || w2 < -1e-9) continue;
      const std::size_t at = canvas.at(sx / kSub, sy / kSub);
      if (relief.count[at] == 255) continue;
      const auto blend = [&](double a, double b, double c) { return static_cast<float>(w0 * a + w1 * b + w2 * c); };
      relief.height[at] += blend(mesh.heights[ids[0]], mesh.heights[ids[1]], mesh.heights[ids[2]]);
      relief.east[at] += blend(slopes[ids[0]].east, slopes[ids[1]].east, slopes[ids[2]].east);
      relief.north[at] += blend(slopes[ids[0]].north, slopes[ids[1]].north, slopes[ids[2]].north);
      ++relief.count[at];
    }
  }
}

Relief relief_of(const Mesh& mesh, const Canvas& canvas, CellSides cell) {
  const std::vector<Slope> slopes = vertex_slopes(mesh, cell);
  Relief relief{canvas.pixels()};
  for (const auto& triangle : mesh.triangles) lay_triangle(mesh, slopes, triangle, canvas, relief);
  return relief;
}

// The value that a fraction of the values is below; 0 if there are none.
float percentile(std::vector<float>& values, double fraction) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Light {
  float exaggeration = 1, lowest = 0, highest = 1;
  bool sea = false;
};

Light light_for(const Relief& relief, double metres_per_unit) {
  std::vector<float> slopes, heights;
  for (std::size_t i = 0; i < relief.count.size(); ++i) {
    if (relief.count[i] == 0) continue;
    const auto n = static_cast<float>(relief.count[i]);
    slopes.push_back(std::hypot(relief.east[i], relief.north[i]) / n);
    heights.push_back(relief.height[i] / n);
  }
  Light light;
  const float typical = percentile(slopes, 0.9);
  if (typical > 0) light.exaggeration = static_cast<float>(kTypicalSlope) / typical;
  light.lowest = percentile(heights, 0.002);
  light.highest = std::max(percentile(heights, 0.998), light.lowest + 1e-3F);
  light.sea = light.lowest * metres_per_unit < kOcean;
  return light;
}

Colour tint(const Light& light, float height) {
  if (light.sea && height < 0) return along(kSea, std::clamp(1 - height / light.lowest, 0.0F, 1.0F));
  const float floor = light.sea ? 0.0F : light.lowest;
  return along(kLand, std::clamp((height - floor) / std::max(light.highest - floor, 1e-3F), 0.0F, 1.0F));
}

// Most light comes from the north-west, some from the west and the north, so that ridges along the light's direction
// stay visible.
Colour lit(Colour ground, float east, float north) {
  const auto from = [&](float to_east, float to_north) {
    const float level = 0.70710678F;  // 45° above the horizon
    return (level - level * (east * to_east + north * to_north)) / std::sqrt(1 + east * east + north * north) / level;
  };
  const float light = 0.7F * from(-0.70710678F, 0.70710678F) + 0.15F * from(-1, 0) + 0.15F * from(0, 1);
  if (light >= 1) return mix(ground, kSunlit, std::min(0.6F, 1.5F * (light - 1)));
  const float dark = 1 - std::max(light, 0.0F);
  const Colour shaded{ground.r * kShade.r / 255, ground.g * kShade.g / 255, ground.b * kShade.b / 255};
  return mix(ground, shaded, 0.95F * dark);
}

// Raises the share of each pixel that lines cover. A line drawn twice covers no more than once.
void draw_line(const Canvas& canvas, Place from, Place to, float strength, std::vector<float>& cover) {
  const double x0 = canvas.x(from) - 0.5, y0 = canvas.y(from) - 0.5;
  const double dx = canvas.x(to) - 0.5 - x0, dy = canvas.y(to) - 0.5 - y0;
  const double length = std::hypot(dx, dy);
  if (length == 0) return;
  const bool flat = std::abs(dx) >= std::abs(dy);
  const double along0 = flat ? x0 : y0, run = flat ? dx : dy, across0 = flat ? y0 : x0, rise = (flat ? dy : dx) / run;
  const int along_end = (flat ? canvas.width : canvas.height) - 1,
            across_end = (flat ? canvas.height : canvas.width) - 1;
  const int first = std::max(0, static_cast<int>(std::lround(std::min(along0, along0 + run))));
  const int last = std::min(along_end, static_cast<int>(std::lround(std::max(along0, along0 + run))));
  for (int a = first; a <= last; ++a) {
    const double middle = across0 + (a - along0) * rise;
    for (int c = static_cast<int>(std::floor(middle)) - 1; c <= static_cast<int>(std::floor(middle)) + 2; ++c) {
      if (c < 0 || c > across_end) continue;
      const double distance = std::abs(c - middle) * std::abs(run) / length;
      const double share = std::clamp(kLineWidth / 2 + 0.5 - distance, 0.0, 1.0);
      float& pixel = cover[flat ? canvas.at(a, c) : canvas.at(c, a)];
      pixel = std::max(pixel, static_cast<float>(share) * strength);
    }
  }
}

std::vector<float> lines_of(const Mesh& mesh, const Canvas& canvas) {
  std::vector<float> cover(canvas.pixels(), 0);
  for (const auto& triangle : mesh.triangles) {
    const Place a = mesh.place(triangle[0]), b = mesh.place(triangle[1]), c = mesh.place(triangle[2]);
    const double area = (canvas.x(b) - canvas.x(a)) * (canvas.y(c) - canvas.y(a)) -
                        (canvas.x(c) - canvas.x(a)) * (canvas.y(b) - canvas.y(a));
    const float strength =
        smooth_step(kFadeTo, kFadeFrom, std::sqrt(std::abs(area)));  // length of the legs if they were equal
    if (strength == 0) continue;
    draw_line(canvas, a, b, strength, cover);
    draw_line(canvas, b, c, strength, cover);
    draw_line(canvas, c, a, strength, cover);
  }
  return cover;
}

std::vector<std::uint8_t> paint(const Mesh& mesh, const Description& description, const Canvas& canvas,
                                CellSides cell) {
  const Relief relief = relief_of(mesh, canvas, cell);
  const Light light = light_for(relief, description.metres_per_unit);
  const std::vector<float> lines = lines_of(mesh, canvas);
  std::vector<std::uint8_t> rgb(canvas.pixels() * 3);
  for (std::size_t i = 0; i < canvas.pixels(); ++i) {
    Colour colour = kVoid;
    if (relief.count[i] > 0) {
      const auto n = static_cast<float>(relief.count[i]);
      const Colour ground = lit(tint(light, relief.height[i] / n), relief.east[i] / n * light.exaggeration,
                                relief.north[i] / n * light.exaggeration);
      colour = mix(kVoid, ground, std::min(n / (kSub * kSub), 1.0F));
    }
    colour = mix(colour, kLine, lines[i] * static_cast<float>(kLineOpacity));
    const std::array<float, 3> channels{colour.r, colour.g, colour.b};
    for (std::size_t c = 0; c < 3; ++c) {
      rgb[3 * i + c] = static_cast<std::uint8_t>(std::lround(std::clamp(channels[c], 0.0F, 255.0F)));
    }
  }
  return rgb;
}

}  // namespace

void write_png(const Mesh& mesh, const Description& description, OutputFile& out) {
  const CellSides cell = cell_sides(description, mesh.region);
  const Canvas canvas{mesh.region, cell};
  const std::vector<std::byte> picture = png_bytes(paint(mesh, description, canvas, cell), canvas.width, canvas.height);
  out.write(picture.data(), picture.size());
}

}  // namespace talus
