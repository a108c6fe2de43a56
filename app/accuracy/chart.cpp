#include "app/accuracy/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "app/terminal/report.hpp"

namespace talus::app {
namespace {

constexpr double kText = 11, kTitle = 13;                                             // pixels, of letters
constexpr double kGap = 8;                                                            // between two labels
constexpr double kLeft = 66, kRight = 16, kTop = 26, kLegendLine = 17, kBottom = 44;  // around the plot
constexpr const char* kInk = "#222";

bool is_drawable(const std::pair<double, double>& p) {
  return p.first > 0 && p.second > 0 && std::isfinite(p.first) && std::isfinite(p.second);
}

/// A logarithmic axis from `least` to `most`.
struct Scale {
  double least = 1, most = 10;
  double from = 0, to = 1;  // pixels; `to` may be above

  [[nodiscard]] double at(double value) const {
    return from + (to - from) * std::log(value / least) / std::log(most / least);
  }
  [[nodiscard]] bool holds(double value) const { return value >= least * (1 - 1e-9) && value <= most * (1 + 1e-9); }
};

/// Reaches a little beyond the numbers, and over at least one decade, so that it has two labels.
Scale scale_of(double least, double most, double from, double to) {
  double low = std::log10(least) - 0.07, high = std::log10(most) + 0.07;
  const double lacking = 1 - (high - low);
  if (lacking > 0) {
    low -= lacking / 2;
    high += lacking / 2;
  }
  return {std::pow(10, low), std::pow(10, high), from, to};
}

double decade(int exponent) { return exponent >= 0 ? std::pow(10, exponent) : 1 / std::pow(10, -exponent); }

/// Labels of an axis: digits times powers of ten, at every `nth` decade.
std::vector<double> numbers(const Scale& scale, const std::vector<int>& digits, int nth) {
  std::vector<double> found;
  const int first = static_cast<int>(std::floor(std::log10(scale.least))),
            last = static_cast<int>(std::ceil(std::log10(scale.most)));
  for (int exponent = first; exponent <= last; ++exponent) {
    if ((exponent % nth + nth) % nth != 0) continue;
    for (const int digit : digits) {
      const double number = exponent >= 0 ? digit * decade(exponent) : digit / decade(-exponent);
      if (scale.holds(number)) found.push_back(number);
    }
  }
  return found;
}

/// As many labels as fit. `extent` is the length of a label along the axis.
template <class Extent>
std::vector<double> labelled(const Scale& scale, Extent&& extent) {
  struct Choice {
    std::vector<int> digits;
    int nth;
  };
  std::vector<double> found;
  for (const Choice& choice : {Choice{{1, 2, 5}, 1}, {{1, 3}, 1}, {{1}, 1}, {{1}, 2}, {{1}, 3}, {{1}, 6}}) {
    found = numbers(scale, choice.digits, choice.nth);
    bool fits = true;
    for (std::size_t i = 1; i < found.size(); ++i) {
      const double apart = std::abs(scale.at(found[i]) - scale.at(found[i - 1]));
      fits = fits && apart >= (extent(found[i]) + extent(found[i - 1])) / 2 + kGap;
    }
    if (fits) break;
  }
  return found;
}

std::string mark_at(char mark, double x, double y, const std::string& colour) {
  switch (mark) {
    case 'o': return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\" fill=\"{}\"/>", x, y, colour);
    case 's':
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"5.6\" height=\"5.6\" fill=\"{}\"/>", x - 2.8, y - 2.8,
                         colour);
    case 't': return fmt::format("<path d=\"M{:.1f} {:.1f}l3.6 6.4h-7.2z\" fill=\"{}\"/>", x, y - 4, colour);
    case 'd':
      return fmt::format("<path d=\"M{:.1f} {:.1f}l3.6 3.6l-3.6 3.6l-3.6 -3.6z\" fill=\"#fff\" stroke=\"{}\"/>", x,
                         y - 3.6, colour);
    default: return "";
  }
}

std::string line(double x0, double y0, double x1, double y1, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0, y0, x1, y1, style);
}

std::string stroke(const Curve& curve) {
  return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-linejoin=\"round\"{}", curve.colour,
                     curve.is_dashed ? " stroke-dasharray=\"6 4\"" : "");
}

/// The names of the curves. Returns the number of lines, and the group.
std::pair<int, std::string> legend(const std::vector<Curve>& curves, double x, double y, double width) {
  std::string group;
  double at = x;
  int lines = 1;
  for (const Curve& curve : curves) {
    const double takes = 30 + text_width(curve.name, kText) + 16;
    if (at > x && at + takes - 16 > x + width) {
      at = x;
      ++lines;
    }
    const double middle = y + kLegendLine * (lines - 0.5);
    group += fmt::format("<path d=\"M{:.1f} {:.1f}h24\" {}/>", at, middle, stroke(curve)) +
             mark_at(curve.mark, at + 12, middle, curve.colour) + svg_text(at + 30, middle + 4, curve.name, kText);
    at += takes;
  }
  return {lines, group};
}

std::string grid(const Scale& x, const Scale& y, const Chart& chart, const Box& plot) {
  const char *faint = "stroke=\"#eee\"", *clear = "stroke=\"#d4d4d4\"", *edge = "stroke=\"#888\"";
  const double bottom = plot.y + plot.height, right = plot.x + plot.width;
  std::string group;
  const std::vector<int> all_digits{1, 2, 3, 4, 5, 6, 7, 8, 9};
  for (const double v : numbers(x, all_digits, 1)) group += line(x.at(v), plot.y, x.at(v), bottom, faint);
  for (const double v : numbers(y, all_digits, 1)) group += line(plot.x, y.at(v), right, y.at(v), faint);
  for (const double v : labelled(x, [&](double n) { return text_width(chart.x.label(n), kText); })) {
    group += line(x.at(v), plot.y, x.at(v), bottom + 4, clear) +
             svg_text(x.at(v), bottom + 17, chart.x.label(v), kText, "middle");
  }
  for (const double v : labelled(y, [](double) { return kText; })) {
    group += line(plot.x - 4, y.at(v), right, y.at(v), clear) +
             svg_text(plot.x - 8, y.at(v) + 4, chart.y.label(v), kText, "end");
  }
  group += line(plot.x, bottom, right, bottom, edge) + line(plot.x, plot.y, plot.x, bottom, edge);
  group += svg_text(plot.x + plot.width / 2, bottom + 36, chart.x.title, kText, "middle", "fill=\"#555\"");
  return group;
}

/// Above the point and to its right, where falling curves leave room; to its left where there is none.
std::string drawn_note(const Chart::Note& note, const Scale& x, const Scale& y, const Box& plot) {
  const double px = x.at(note.x), py = y.at(note.y);
  const bool fits = px + 12 + text_width(note.text, kText) < plot.x + plot.width;
  const double tx = fits ? px + 12 : plot.x + plot.width - 4, ty = std::max(py - 12, plot.y + kText + 2);
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"7\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.4\"/>",
                     px, py, kInk) +
         svg_text(tx, ty, note.text, kText, fits ? "start" : "end",
                  "font-weight=\"bold\" stroke=\"#fff\" stroke-width=\"4\" stroke-linejoin=\"round\" "
                  "paint-order=\"stroke\"");
}

}  // namespace

std::string drawn(const Chart& chart, Box box) {
  std::string group =
      "<g>\n" + svg_text(box.x + kLeft, box.y + 15, chart.title, kTitle, "start", "font-weight=\"bold\"") + "\n";
  constexpr double kNone = std::numeric_limits<double>::infinity();
  double left = kNone, right = 0, low = kNone, high = 0;
  std::vector<Curve> curves;
  for (Curve curve : chart.curves) {
    std::erase_if(curve.points, [](const auto& p) { return !is_drawable(p); });
    if (curve.points.empty()) continue;
    for (const auto& [x, y] : curve.points) {
      left = std::min(left, x);
      right = std::max(right, x);
      low = std::min(low, y);
      high = std::max(high, y);
    }
    curves.push_back(std::move(curve));
  }
  if (curves.empty()) {
    return group + svg_text(box.x + kLeft, box.y + 50, "all errors are 0", kText) + "</g>\n";
  }
  const auto [lines, names] = legend(curves, box.x + kLeft, box.y + kTop - 2, box.width - kLeft - kRight);
  const double top = kTop + lines * kLegendLine + 8;
  const Box plot{box.x + kLeft, box.y + top, box.width - kLeft - kRight, box.height - top - kBottom};
  const Scale x = scale_of(left, right, plot.x, plot.x + plot.width),
              y = scale_of(low, high, plot.y + plot.height, plot.y);
  group += names + "\n" + grid(x, y, chart, plot);
  for (const Curve& curve : curves) {
    std::string path;
    for (const auto& [px, py] : curve.points)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x.at(px), y.at(py));
    group += fmt::format("<path d=\"{}\" {}/>\n", path, stroke(curve));
    for (const auto& [px, py] : curve.points) group += mark_at(curve.mark, x.at(px), y.at(py), curve.colour);
    group += "\n";
  }
  if (chart.note && is_drawable({chart.note->x, chart.note->y}) && x.holds(chart.note->x) && y.holds(chart.note->y))
    group += drawn_note(*chart.note, x, y, plot);
  return group + "</g>\n";
}

std::string svg_document(double width, double height, const std::string& body) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" fill=\"{2}\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{3}</svg>\n",
      width, height, kInk, body);
}

std::string xml(std::string_view text) {
  std::string escaped;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto byte = static_cast<unsigned char>(c);
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else if (byte < 0x20)
      escaped += ' ';
    else if (byte < 0x80)
      escaped += c;
    else {
      // UTF-8 stays; other bytes of a file name become blanks.
      const std::size_t more = byte >= 0xf0 && byte < 0xf5   ? 3
                               : byte >= 0xe0 && byte < 0xf0 ? 2
                               : byte >= 0xc2 && byte < 0xe0 ? 1
                                                             : 0;
      bool is_whole = more > 0 && i + more < text.size();
      for (std::size_t k = 1; is_whole && k <= more; ++k)
        is_whole = (static_cast<unsigned char>(text[i + k]) & 0xc0u) == 0x80;
      if (is_whole) {
        escaped += text.substr(i, more + 1);
        i += more;
      } else {
        escaped += ' ';
      }
    }
  }
  return escaped;
}

std::string svg_text(double x, double y, std::string_view text, double size, const char* anchor, const char* more) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:g}\" text-anchor=\"{}\" {}>{}</text>", x, y, size,
                     anchor, more, xml(text));
}

double text_width(std::string_view text, double size) {
  const auto letters =
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80; });
  return 0.56 * size * static_cast<double>(letters);
}

std::string metres_label(double v) {
  if (v < 0.9999e-3) return fmt::format("{:g} mm", v * 1000);
  return v >= 9999 ? fmt::format("{:g} km", v / 1000) : fmt::format("{:g} m", v);
}

std::string seconds_label(double v) {
  if (v < 0.9999e-3) return fmt::format("{:g} µs", v * 1e6);
  return v < 0.9999 ? fmt::format("{:g} ms", v * 1e3) : fmt::format("{:g} s", v);
}

std::string bytes_label(double v) {
  constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (; v >= 999.9 && unit + 1 < std::size(kUnits); ++unit) v /= 1000;
  return fmt::format("{:g} {}", v, kUnits[unit]);
}

std::string count_label(double v) {
  return v >= 999'999 ? fmt::format("{:g} million", v / 1e6) : counted(static_cast<std::uint64_t>(std::llround(v)));
}

}  // namespace talus::app
