#pragma once
// Curves over two logarithmic axes, in an SVG.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace talus::app {

/// A place in the picture, in pixels.
struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};

struct Axis {
  std::string title;
  std::function<std::string(double)> label;  ///< a number with its unit: "20 ms"
};

struct Curve {
  std::string name;
  std::string colour;
  char mark = 'o';  ///< at each point: o circle, s square, t triangle, d diamond, - none
  bool is_dashed = false;
  std::vector<std::pair<double, double>> points;  ///< only those that are finite and above 0 are drawn
};

struct Chart {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves;
  struct Note {
    double x = 0, y = 0;
    std::string text;
  };
  std::optional<Note> note;  ///< a ring around a point, and text beside it
};

/// An SVG group. Each axis has at least two labels, and no two overlap.
[[nodiscard]] std::string drawn(const Chart& chart, Box box);

/// A whole file.
[[nodiscard]] std::string svg_document(double width, double height, const std::string& body);

/// Text for XML; letters that XML does not allow become blanks.
[[nodiscard]] std::string xml(std::string_view text);

/// A line of text. `anchor` start, middle or end.
[[nodiscard]] std::string svg_text(double x, double y, std::string_view text, double size, const char* anchor = "start",
                                   const char* more = "");

/// About so many pixels.
[[nodiscard]] double text_width(std::string_view text, double size);

// Labels of axes: 0.5 m, 20 ms, 1.5 MB, 20,000.
[[nodiscard]] std::string metres_label(double metres);
[[nodiscard]] std::string seconds_label(double seconds);
[[nodiscard]] std::string bytes_label(double bytes);
[[nodiscard]] std::string count_label(double count);

}  // namespace talus::app
