#include "app/accuracy/error_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "query/rasters/png_bytes.hpp"

namespace talus::app {
namespace {

constexpr double kText = 11, kTitle = 13;
constexpr double kTypicalSlope = 0.6;  // the 90th percentile of slopes is drawn like this

struct Colour {
  double r, g, b;
};
constexpr Colour kVoid{205, 207, 210};
constexpr int kSide = 3;  // classes to either side of the middle one
/// Orange: the surface is far below the ground; white: at it; purple: far above. The colour-blind can read these.
constexpr std::array<Colour, 2 * kSide + 1> kClasses{
    {{179, 88, 6}, {241, 163, 64}, {254, 224, 182}, {247, 247, 247}, {216, 218, 235}, {153, 142, 195}, {84, 39, 136}}};

/// Classes end at the limit and at a half, a quarter and an eighth of it.
std::size_t class_of(double error, double limit) {
  int away = 0;
  for (double end = limit / 8; away < kSide && std::abs(error) > end; end *= 2) ++away;
  return static_cast<std::size_t>(kSide + (error < 0 ? -away : away));
}

double slope_percentile(std::vector<double> slopes, double share) {
  if (slopes.empty()) return 0;
  const auto at = slopes.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(slopes.size() - 1));
  std::nth_element(slopes.begin(), at, slopes.end());
  return *at;
}

/// Shades of relief, 1 on level ground; the light comes from the north-west.
std::vector<double> shades(const ErrorMap& map) {
  const auto at = [&](int col, int row) {
    return map
        .height_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.cols) + static_cast<std::size_t>(col)];
  };
  const double cell_x = map.width.value / std::max(map.cols, 1), cell_y = map.height.value / std::max(map.rows, 1);
  std::vector<double> east, north, slopes;
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      const int w = std::max(col - 1, 0), e = std::min(col + 1, map.cols - 1), n = std::max(row - 1, 0),
                s = std::min(row + 1, map.rows - 1);
      const double dx = e > w ? (at(e, row) - at(w, row)) / ((e - w) * cell_x) : 0;
      const double dy = s > n ? (at(col, n) - at(col, s)) / ((s - n) * cell_y) : 0;
      const bool known = std::isfinite(dx) && std::isfinite(dy);
      east.push_back(known ? dx : 0);
      north.push_back(known ? dy : 0);
      if (known) slopes.push_back(std::hypot(dx, dy));
    }
  }
  const double typical = slope_percentile(std::move(slopes), 0.9),
               exaggeration = typical > 0 ? kTypicalSlope / typical : 1;
  std::vector<double> shades;
  for (std::size_t i = 0; i < east.size(); ++i) {
    const double x = east[i] * exaggeration, y = north[i] * exaggeration;
    const double light = (1 + 0.7071 * (x - y)) / std::sqrt(1 + x * x + y * y);  // 1 on level ground
    shades.push_back(std::clamp(0.3 + 0.7 * light, 0.35, 1.1));
  }
  return shades;
}

std::vector<std::uint8_t> painted(const ErrorMap& map, double limit) {
  const std::vector<double> shade = shades(map);
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < map.error_m.size(); ++i) {
    const bool is_void = std::isnan(map.error_m[i]);
    const Colour c = is_void ? kVoid : kClasses[class_of(map.error_m[i], limit)];
    for (const double channel : {c.r, c.g, c.b}) {
      rgb.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(channel * (is_void ? 1 : shade[i]), 0.0, 255.0))));
    }
  }
  return rgb;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kLetters[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string box_of(Box b, const char* style) {
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}/>", b.x, b.y, b.width,
                     b.height, style);
}

/// The largest box with these proportions in the middle of another box.
Box fitted(Box box, double width, double height) {
  const double scale = std::min(box.width / width, box.height / height);
  const Box in{0, 0, width * scale, height * scale};
  return {box.x + (box.width - in.width) / 2, box.y + (box.height - in.height) / 2, in.width, in.height};
}

std::string panel(const ErrorMap& map, double limit, Box box) {
  const std::vector<std::byte> png = png_bytes(painted(map, limit), map.cols, map.rows);
  return fmt::format(
             "<image x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\" "
             "href=\"data:image/png;base64,{}\"/>\n",
             box.x, box.y, box.width, box.height, base64(png)) +
         box_of(box, "fill=\"none\" stroke=\"#777\"");
}

std::string numbered(std::size_t number, Box panel) {
  return box_of({panel.x, panel.y, number > 9 ? 22.0 : 15.0, 15}, "fill=\"#fff\" fill-opacity=\"0.85\"") +
         svg_text(panel.x + 4, panel.y + 12, fmt::format("{}", number), kText, "start", "font-weight=\"bold\"");
}

/// A bar of a round length, at most a third of the width.
std::string scale_bar(double x, double y, double metres_shown, double pixels) {
  double length = std::pow(10, std::floor(std::log10(metres_shown / 3)));
  for (const double factor : {5.0, 2.0}) {
    if (length * factor <= metres_shown / 3) {
      length *= factor;
      break;
    }
  }
  const double width = pixels * length / metres_shown;
  return fmt::format("<path d=\"M{:.1f} {:.1f}v5h{:.1f}v-5\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.4\"/>", x,
                     y, width) +
         svg_text(x + width + 6, y + 6,
                  length >= 1000 ? fmt::format("{:g} km", length / 1000) : fmt::format("{:g} m", length), kText);
}

/// Swatches from below to above, and the numbers between them.
std::string legend(double limit, double x, double y, bool has_voids) {
  constexpr double kSwatch = 46, kHeight = 12;
  std::string group;
  for (std::size_t i = 0; i < kClasses.size(); ++i) {
    const Colour c = kClasses[i];
    group += box_of({x + kSwatch * static_cast<double>(i), y, kSwatch, kHeight},
                    fmt::format("fill=\"rgb({},{},{})\" stroke=\"#999\"", c.r, c.g, c.b).c_str());
  }
  const auto number = [&](double at, double value) {
    return svg_text(x + kSwatch * at, y + kHeight + 13,
                    value < 0 ? fmt::format("−{:.3g}", -value) : fmt::format("{:.3g}", value), 10, "middle");
  };
  for (int i = 0; i <= kSide; ++i) {
    const double value = limit / std::pow(2, i < kSide ? i : kSide);
    group += number(i, -value) + number(2 * kSide + 1 - i, value);
  }
  const double right = x + kSwatch * static_cast<double>(kClasses.size());
  group += svg_text(right + 24, y + kHeight + 13, "m", 10);
  group += svg_text(x, y - 5, "surface below the ground", 10) + svg_text(right, y - 5, "above", 10, "end");
  if (has_voids) {
    group += box_of({right + 44, y, 20, kHeight},
                    fmt::format("fill=\"rgb({},{},{})\" stroke=\"#999\"", kVoid.r, kVoid.g, kVoid.b).c_str()) +
             svg_text(right + 70, y + 10, "no data", 10);
  }
  return group;
}

/// The extent with the windows in it.
std::string locator(const AccuracyReport& report, Box box) {
  const GridRect& e = report.description.extent;
  const ErrorMap& map = report.maps.front();
  const GridRect& w = report.windows.front();
  const double aspect = map.height.value / static_cast<double>(std::max<std::int64_t>(w.rows() - 1, 1)) /
                        (map.width.value / static_cast<double>(std::max<std::int64_t>(w.cols() - 1, 1)));
  const double cols = static_cast<double>(std::max<std::int64_t>(e.cols() - 1, 1)),
               rows = static_cast<double>(std::max<std::int64_t>(e.rows() - 1, 1));
  Box whole = fitted(box, cols, rows * aspect);
  whole.y = box.y;
  std::string group = box_of(whole, "fill=\"#f4f4f4\" stroke=\"#777\"");
  for (const ErrorMap& m : report.maps) {
    const GridRect& r = report.windows[m.window];
    const Box place{whole.x + whole.width * (r.first.col - e.first.col) / cols,
                    whole.y + whole.height * (r.first.row - e.first.row) / rows,
                    whole.width * static_cast<double>(r.cols() - 1) / cols,
                    whole.height * static_cast<double>(r.rows() - 1) / rows};
    group += box_of(place, "fill=\"#998ec3\" stroke=\"#542788\"");
    const bool left = place.x + place.width + 12 > whole.x + whole.width;
    group += svg_text(left ? place.x - 2 : place.x + place.width + 2, place.y + place.height / 2 + 4,
                      fmt::format("{}", m.window + 1), 10, left ? "end" : "start");
  }
  return group;
}

}  // namespace

std::string drawn_maps(const AccuracyReport& report, Box box) {
  if (report.maps.empty()) return "";
  double limit = report.map_tolerance.value;
  bool has_voids = false;
  for (const ErrorMap& map : report.maps) {
    for (const float error : map.error_m) {
      has_voids = has_voids || std::isnan(error);
      if (report.map_tolerance.value == 0 && std::isfinite(error)) limit = std::max<double>(limit, std::abs(error));
    }
  }
  std::string group = "<g>\n" + svg_text(box.x, box.y + 15, fmt::format("Error at {:g} m", report.map_tolerance.value),
                                         kTitle, "start", "font-weight=\"bold\"");
  if (report.maps.front().step > 1) {
    group += svg_text(box.x, box.y + 31,
                      fmt::format("each pixel shows the largest error of {0} × {0} samples", report.maps.front().step),
                      10, "start", "fill=\"#555\"");
  }
  constexpr double kHead = 40, kFoot = 78;
  Box room{box.x, box.y + kHead, box.width, box.height - kHead - kFoot};
  const std::size_t count = report.maps.size();
  if (count > 1) {
    const double side = std::clamp(box.width * 0.2, 70.0, 150.0);
    group += locator(report, {room.x, room.y, side, room.height});
    room.x += side + 16;
    room.width -= side + 16;
  }
  const auto across = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const std::size_t down = (count + across - 1) / across;
  constexpr double kGap = 4;
  // All panels are as large as the largest map.
  double width_m = 1e-9, height_m = 1e-9;
  for (const ErrorMap& map : report.maps) {
    width_m = std::max(width_m, map.width.value);
    height_m = std::max(height_m, map.height.value);
  }
  const Box slot =
      fitted({0, 0, room.width / static_cast<double>(across) - kGap, room.height / static_cast<double>(down) - kGap},
             width_m, height_m);
  Box first;
  double bottom = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const ErrorMap& map = report.maps[i];
    const Box at{room.x + (slot.width + kGap) * static_cast<double>(i % across),
                 room.y + (slot.height + kGap) * static_cast<double>(i / across),
                 slot.width * std::max(map.width.value, 1e-9) / width_m,
                 slot.height * std::max(map.height.value, 1e-9) / height_m};
    if (i == 0) first = at;
    bottom = std::max(bottom, at.y + at.height);
    group += panel(map, limit, at) + (count > 1 ? numbered(i + 1, at) : "");
  }
  group += limit > 0 ? legend(limit, room.x + 14, bottom + 26, has_voids)
                     : svg_text(room.x, bottom + 36, "the error is 0 everywhere", kText);
  if (report.maps.front().width.value > 0)
    group += scale_bar(room.x + 14, bottom + 66, report.maps.front().width.value, first.width);
  return group + "</g>\n";
}

}  // namespace talus::app
