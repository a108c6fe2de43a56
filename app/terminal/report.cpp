#include "app/terminal/report.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus::app {

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return;
  const int code = errno;
  throw Failure(code == ENOSPC ? Cause::full : Cause::io,
                fmt::format("cannot write to standard output: {}", std::strerror(code)));
}

std::string Table::text() const {
  std::size_t width = 0;
  for (const auto& [name, value] : lines_) width = std::max(width, name.size());
  std::string text;
  for (const auto& [name, value] : lines_) text += fmt::format("{:<{}}  {}\n", name, width, value);
  return text;
}

std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (const auto& line : lines) {
    widths.resize(std::max(widths.size(), line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string text;
  for (const auto& line : lines) {
    text += line.size() == 1 ? line.front() : fmt::format("{:<{}}", line.front(), widths.front());
    for (std::size_t i = 1; i < line.size(); ++i) text += fmt::format("  {:>{}}", line[i], widths[i]);
    text += '\n';
  }
  return text;
}

void print(const Json& object) { print(object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"); }
void print(const Table& table) { print(table.text()); }

std::string counted(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, ",");
  return text;
}

std::string sized(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> kUnits{"bytes", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 1000 && unit + 1 < kUnits.size(); ++unit) value /= 1000;
  return unit == 0 ? fmt::format("{} bytes", bytes) : fmt::format("{:.3g} {}", value, kUnits[unit]);
}

std::string file_size(std::uint64_t bytes, GridRect extent) {
  return fmt::format("{}, {:.2f} bits a sample", sized(bytes),
                     8.0 * static_cast<double>(bytes) / static_cast<double>(extent.samples()));
}

std::string timed(double seconds) {
  return seconds < 1 ? fmt::format("{:.3g} ms", seconds * 1000) : fmt::format("{:.3g} s", seconds);
}

std::string metres(double value) { return std::isinf(value) ? "infinite" : fmt::format("{} m", value); }

std::string rounded(double value) { return fmt::format("{:.7g}", value); }

std::string quoted(const std::string& word) {
  if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:=@%") ==
      std::string::npos)
    return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

Json bounds(const Description& d, GridRect region) {
  return Json::array({d.mapping.x(region.first.col), d.mapping.y(region.last.row), d.mapping.x(region.last.col),
                      d.mapping.y(region.first.row)});
}

std::string bounds_text(const Description& d, GridRect region) {
  return fmt::format("x {} to {}, y {} to {} ({} x {} samples)", d.mapping.x(region.first.col),
                     d.mapping.x(region.last.col), d.mapping.y(region.last.row), d.mapping.y(region.first.row),
                     region.cols(), region.rows());
}

std::string clipped_text(const Rectangle& r) {
  return fmt::format("the rectangle {},{},{},{} reaches beyond the raster and was cut", r.xmin, r.ymin, r.xmax, r.ymax);
}

void add_rectangle(Json& object, const Rectangle& asked, bool is_clipped) {
  object["asked"] = Json::array({asked.xmin, asked.ymin, asked.xmax, asked.ymax});
  object["clipped"] = is_clipped;
}

std::string bound_text(const Description& d, Metres bound) {
  // Nanometres that decimal heights add are in the JSON.
  const std::string text = std::isinf(bound.value) ? metres(bound.value) : fmt::format("{:.9g} m", bound.value);
  if (d.error_metric == ErrorMetric::perpendicular)
    return text + " at right angles to the triangles, more along the vertical";
  return text;
}

std::string heights_text(Metres quantum) {
  return quantum.value > 0 ? fmt::format("multiples of {} m", quantum.value) : "exact";
}

std::string why_coarser(const Description& d, Metres tolerance) {
  const double finest = std::max(d.lossy.value, d.finest_tolerance.value);
  if (tolerance.value >= finest) return "";
  return d.finest_tolerance.value > 0 ? fmt::format("ingest kept only the vertices for {} m", finest)
                                      : fmt::format("ingest rounded heights by up to {} m", finest);
}

void add_bound(Json& object, const Description& d, Metres tolerance, Metres bound) {
  object["tolerance"] = tolerance.value;
  object["bound"] = bound.value;
  object["error_metric"] = name_of(d.error_metric);
}

void add_bound(Table& table, const Description& d, Metres tolerance, Metres bound) {
  table.add("tolerance", metres(tolerance.value));
  table.add("bound", bound_text(d, bound));
}

std::string mesh_text(std::uint64_t vertices, std::uint64_t triangles) {
  return fmt::format("{} vertices, {} triangles", counted(vertices), counted(triangles));
}

void add_cost(Json& object, const QueryCost& cost, double seconds) {
  object["pages_read"] = cost.pages_read;
  object["bytes_read"] = cost.bytes_read;
  object["seconds"] = seconds;
}

void add_cost(Table& table, const QueryCost& cost, double seconds) {
  table.add("read", fmt::format("{} pages, {}", counted(cost.pages_read), sized(cost.bytes_read)));
  table.add("time", timed(seconds));
}

}  // namespace talus::app
