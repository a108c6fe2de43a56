#include "app/accuracy/accuracy_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/accuracy/chart.hpp"
#include "app/accuracy/error_map.hpp"

namespace talus::app {
namespace {

constexpr double kHardlySlower = 1.5;  // than the recommended answer: time then does not decide

std::string metres3(Metres m) { return fmt::format("{:.3g} m", m.value); }
std::string exactly(Metres m) { return fmt::format("{} m", m.value); }

/// A time on the command line; below a second in milliseconds.
std::string limit_text(double seconds) {
  return seconds < 0.9999 ? fmt::format("{:g} ms", seconds * 1000) : fmt::format("{:g} s", seconds);
}

const AccuracyPoint* advised(const AccuracyReport& report) {
  return report.advice.point ? &report.points[*report.advice.point] : nullptr;
}

/// A point to compare the recommended one with: half its tolerance or less, and slower; else twice its tolerance or
/// more, and faster. The times must differ by more than they vary.
const AccuracyPoint* compared(const AccuracyReport& report) {
  const AccuracyPoint* const point = advised(report);
  if (point == nullptr) return nullptr;
  for (const AccuracyPoint& p : report.points) {
    if (p.tolerance.value <= point->tolerance.value / 2 && p.warm_seconds > point->warm_high_seconds) return &p;
  }
  for (auto p = report.points.rbegin(); p != report.points.rend(); ++p) {
    if (p->tolerance.value >= 2 * point->tolerance.value && p->warm_seconds < point->warm_low_seconds) return &*p;
  }
  return nullptr;
}

std::string what_it_is(const AccuracyReport& report, const AccuracyPoint& p) {
  std::string text =
      fmt::format("{} warm, {} cold, {} vertices{}, {} as a stream", timed(p.warm_seconds), timed(p.cold_seconds),
                  counted(p.vertices), report.is_whole ? "" : fmt::format(" (at most {})", counted(p.most_vertices)),
                  sized(p.bytes));
  if (p.errors) {
    text += fmt::format("; largest error {}, 95 % of the samples within {}, root mean square {}",
                        metres3(p.errors->largest), metres3(p.errors->percentile_95), metres3(p.errors->rms));
  }
  return exactly(p.tolerance) + ": " + text;
}

std::string bbox_of(const Description& d, GridRect w) {
  return fmt::format("{},{},{},{}", d.mapping.x(w.first.col), d.mapping.y(w.last.row), d.mapping.x(w.last.col),
                     d.mapping.y(w.first.row));
}

/// The recommended query as a command.
std::string command(const AccuracyReport& report, const AccuracyNames& names) {
  std::string text;
  for (const std::string& word : advised_query(report, names)) text += " " + quoted(word);
  return text.empty() ? text : "talus" + text;
}

std::string followed_text(const AccuracyNames& names) {
  if (!names.followed_seconds) return "";
  return fmt::format("this command took {} just now; a new process also pays for fresh memory",
                     timed(*names.followed_seconds));
}

std::string question_text(const AccuracyReport& report) {
  const GridRect& w = report.windows.front();
  if (report.is_whole) return "a rectangle, " + bounds_text(report.description, w);
  const std::string places =
      report.places_with_terrain > 0
          ? fmt::format("the {} of {} places where {} needs more than one vertex for 128 samples",
                        counted(report.places_with_terrain), counted(report.places), exactly(report.terrain))
          : fmt::format("{} places, all of them flat", counted(report.places));
  return fmt::format("{} {} of {} x {} samples, spread over {}; counts and times are medians", report.windows.size(),
                     report.windows.size() == 1 ? "window" : "windows", w.cols(), w.rows(), places);
}

std::string truth_text(const AccuracyReport& report, const AccuracyNames& names) {
  if (!report.has_truth) return "none";
  std::string text = names.truth.empty() ? "the database's own samples" : names.truth;
  if (const auto& errors = report.points.front().errors)
    text += fmt::format(", {} of them under the coarsest mesh{}", counted(errors->samples),
                        report.windows.size() > 1 ? " in all windows" : "");
  return text;
}

std::string cold_text(const AccuracyReport& report) {
  std::string text = "the same, after the system was asked to drop the file from memory";
  if (!report.share_in_memory) {
    text += "; it does not say whether it did";
  } else if (*report.share_in_memory > 0.01) {
    text += fmt::format("; it kept {:.0f} %, so a cold disk takes longer", 100 * *report.share_in_memory);
  } else {
    text += "; it did, but the disk may have a cache of its own";
  }
  return text +
         fmt::format(". Opening takes {} more. {}", timed(report.open_seconds),
                     report.windows.size() == 1 ? "Median of three" : "Measured once for each window and tolerance");
}

constexpr const char* kWarm =
    "from question to mesh, with the file in memory but not decoded, in a process that has answered before; the median "
    "of five to 101 answers, and the range of the middle half. A new process such as talus query takes longer";

}  // namespace

std::vector<std::string> caveats(const AccuracyReport& report, const AccuracyNames& names) {
  std::vector<std::string> sentences;
  const Description& d = report.description;
  if (!report.has_truth) {
    sentences.push_back(
        fmt::format("the database keeps only the vertices for {} m and coarser, so that errors are not known without "
                    "--against DEM",
                    d.finest_tolerance.value));
  }
  if (d.error_metric == ErrorMetric::perpendicular)
    sentences.push_back(
        "the database measures tolerances at right angles to the triangles; the errors here are along the vertical");
  if (d.lossy.value > 0 && report.has_truth) {
    sentences.push_back(fmt::format("ingest rounded heights by up to {} m, and bounds include it{}", d.lossy.value,
                                    names.truth.empty()
                                        ? "; the errors here are against the rounded heights, --against DEM measures "
                                          "them against the source"
                                        : ""));
  }
  const auto is_upside_down = [](const AccuracyPoint& p) { return p.cold_seconds < p.warm_seconds; };
  if (std::any_of(report.points.begin(), report.points.end(), is_upside_down)) {
    sentences.push_back(
        "some cold answers were faster than warm ones: the file is small, the disk is fast, or the machine is busy");
  }
  if (report.points.back().vertices == report.points.front().vertices && report.points.size() > 1)
    sentences.push_back("all tolerances have the same answer");
  return sentences;
}

namespace {

// ---- the table -----------------------------------------------------------------------------------------------

std::vector<std::vector<std::string>> rows_of(const AccuracyReport& report) {
  std::vector<std::vector<std::string>> rows{{"tolerance"}};
  std::vector<std::string>& head = rows.front();
  if (report.has_truth) head.insert(head.end(), {"largest", "95 %", "RMS"});
  head.insert(head.end(), {"vertices", "triangles", "stream", "warm", "middle half", "cold"});
  for (const AccuracyPoint& p : report.points) {
    std::vector<std::string> row{exactly(p.tolerance)};
    if (p.errors)
      row.insert(row.end(), {metres3(p.errors->largest), metres3(p.errors->percentile_95), metres3(p.errors->rms)});
    row.insert(row.end(),
               {counted(p.vertices), counted(p.triangles), sized(p.bytes), timed(p.warm_seconds),
                fmt::format("{} to {}", timed(p.warm_low_seconds), timed(p.warm_high_seconds)), timed(p.cold_seconds)});
    rows.push_back(std::move(row));
  }
  return rows;
}

// ---- the pictures --------------------------------------------------------------------------------------------

std::vector<Curve> curves_over(const AccuracyReport& report, double (*cost)(const AccuracyPoint&)) {
  Curve tolerance{"tolerance", "#8c8c8c", 'd', false, {}}, largest{"largest error", "#0072B2", 'o', false, {}};
  Curve most{"95 % within", "#009E73", 's', false, {}}, rms{"RMS", "#D55E00", 't', false, {}};
  for (const AccuracyPoint& p : report.points) {
    tolerance.points.emplace_back(cost(p), p.tolerance.value);
    if (!p.errors) continue;
    largest.points.emplace_back(cost(p), p.errors->largest.value);
    most.points.emplace_back(cost(p), p.errors->percentile_95.value);
    rms.points.emplace_back(cost(p), p.errors->rms.value);
  }
  return {tolerance, largest, most, rms};
}

std::optional<Chart::Note> note_of(const AccuracyReport& report, double (*cost)(const AccuracyPoint&),
                                   std::string (*label)(double)) {
  const AccuracyPoint* const p = advised(report);
  if (p == nullptr) return {};
  return Chart::Note{cost(*p), p->tolerance.value, exactly(p->tolerance) + ", " + label(cost(*p))};
}

Chart cost_chart(const AccuracyReport& report, const char* title, Axis x, double (*cost)(const AccuracyPoint&),
                 std::string (*label)(double)) {
  return {title, std::move(x), {"metres", metres_label}, curves_over(report, cost), note_of(report, cost, label)};
}

Chart time_chart(const AccuracyReport& report) {
  Chart chart = cost_chart(
      report, "Error against time", {"time of an answer, warm", seconds_label},
      [](const AccuracyPoint& p) { return p.warm_seconds; }, [](double v) { return timed(v); });
  Curve cold{"tolerance, cold", "#8c8c8c", '-', true, {}};
  for (const AccuracyPoint& p : report.points) cold.points.emplace_back(p.cold_seconds, p.tolerance.value);
  chart.curves.push_back(std::move(cold));
  return chart;
}

Chart bytes_chart(const AccuracyReport& report) {
  return cost_chart(
      report, "Error against bytes", {"size of an answer as a stream", bytes_label},
      [](const AccuracyPoint& p) { return static_cast<double>(p.bytes); },
      [](double v) { return sized(static_cast<std::uint64_t>(v)); });
}

Chart vertices_chart(const AccuracyReport& report) {
  return cost_chart(
      report, "Error against vertices", {"vertices of an answer", count_label},
      [](const AccuracyPoint& p) { return static_cast<double>(p.vertices); },
      [](double v) { return counted(static_cast<std::uint64_t>(v)) + " vertices"; });
}

/// Lines of words, at most so many pixels wide.
std::vector<std::string> wrapped(const std::string& text, double size, double width) {
  std::vector<std::string> lines{""};
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, end - from),
                      longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (text_width(longer, size) > width && !lines.back().empty())
      lines.push_back(word);
    else
      lines.back() = longer;
    from = end + 1;
  }
  return lines;
}

std::string paragraph(const std::string& text, double x, double& y, double size, double width, const char* style = "") {
  std::string group;
  for (const std::string& line : wrapped(text, size, width)) {
    group += svg_text(x, y, line, size, "start", style) + "\n";
    y += size * 1.4;
  }
  return group;
}

}  // namespace

bool is_beyond_bound(const AccuracyReport& report, const AccuracyPoint& point) {
  if (!point.errors || report.description.error_metric != ErrorMetric::vertical) return false;
  // doubles are rounded
  return point.errors->largest.value > point.bound.value * (1 + 1e-12) + 1e-9;
}

std::string recommendation(const AccuracyReport& report) {
  const AccuracyAdvice& advice = report.advice;
  const AccuracyPoint *const point = advised(report), *const other = compared(report);
  if (point == nullptr) {
    const AccuracyPoint& coarsest = report.points.front();
    return fmt::format("{} is too short: {}, the coarsest tolerance here, takes {}.", limit_text(advice.limit_seconds),
                       exactly(coarsest.tolerance), timed(coarsest.warm_seconds));
  }
  const bool is_ample = advice.is_finest && advice.limit_seconds > 1.1 * point->warm_seconds;
  std::string text =
      is_ample ? fmt::format("{} is more than enough: {}, the finest tolerance here, takes {}",
                             limit_text(advice.limit_seconds), exactly(point->tolerance), timed(point->warm_seconds))
               : fmt::format("For {} you can have {}", limit_text(advice.limit_seconds), exactly(point->tolerance));
  if (other != nullptr) text += fmt::format("; {} takes {}", exactly(other->tolerance), timed(other->warm_seconds));
  text += ".";
  const AccuracyPoint& finest = report.points.back();
  if (&finest != point && finest.warm_seconds < kHardlySlower * point->warm_seconds) {
    text += fmt::format(" Even {}, the finest here, takes only {}: choose by vertices and bytes, not by time.",
                        exactly(finest.tolerance), timed(finest.warm_seconds));
  }
  return text;
}

std::vector<std::string> advised_query(const AccuracyReport& report, const AccuracyNames& names) {
  const AccuracyPoint* const p = advised(report);
  if (p == nullptr) return {};
  return {"query", names.database, "--tolerance", fmt::format("{}", p->tolerance.value),
          "--bbox=" + bbox_of(report.description, report.windows[p->typical_window])};
}

std::string accuracy_text(const AccuracyReport& report, const AccuracyNames& names) {
  Table table;
  table.add("question", question_text(report));
  table.add("truth", truth_text(report, names));
  table.add("warm", kWarm);
  table.add("cold", cold_text(report));
  table.add("threads", fmt::format("{}", report.threads));
  std::string text = table.text() + "\n" + aligned(rows_of(report)) + "\n" + recommendation(report) + "\n";
  for (const AccuracyPoint* p : {advised(report), compared(report)}) {
    if (p != nullptr) text += "  " + what_it_is(report, *p) + "\n";
  }
  if (const std::string follow = command(report, names); !follow.empty()) text += "  " + follow + "\n";
  if (const std::string took = followed_text(names); !took.empty()) text += "  " + took + "\n";
  return text;
}

Json accuracy_json(const AccuracyReport& report, const AccuracyNames& names) {
  const auto point_json = [&](const AccuracyPoint& p) {
    Json json{{"tolerance", p.tolerance.value},
              {"bound", p.bound.value},
              {"vertices", p.vertices},
              {"most_vertices", p.most_vertices},
              {"triangles", p.triangles},
              {"bytes", p.bytes},
              {"warm_seconds", p.warm_seconds},
              {"cold_seconds", p.cold_seconds},
              {"warm_quartiles_seconds", {p.warm_low_seconds, p.warm_high_seconds}}};
    if (p.errors) {
      json["largest_error"] = p.errors->largest.value;
      json["percentile_95_error"] = p.errors->percentile_95.value;
      json["rms_error"] = p.errors->rms.value;
      json["samples"] = p.errors->samples;
      json["beyond_bound"] = is_beyond_bound(report, p);
    }
    return json;
  };
  Json windows = Json::array(), points = Json::array();
  for (const GridRect& w : report.windows)
    windows.push_back({{"bbox", bounds(report.description, w)}, {"cols", w.cols()}, {"rows", w.rows()}});
  for (const AccuracyPoint& p : report.points) points.push_back(point_json(p));
  Json advice{{"budget_seconds", report.advice.limit_seconds}, {"text", recommendation(report)}};
  if (const AccuracyPoint* const p = advised(report)) {
    advice["tolerance"] = p->tolerance.value;
    advice["seconds"] = p->warm_seconds;
    advice["vertices"] = p->most_vertices;
    advice["is_finest"] = report.advice.is_finest;
    advice["bbox"] = bounds(report.description, report.windows[p->typical_window]);
    advice["command"] = command(report, names);
    advice["command_seconds"] = names.followed_seconds ? Json(*names.followed_seconds) : Json();
  }
  Json json{{"database", names.database},
            {"windows", windows},
            {"is_whole_region", report.is_whole},
            {"places", report.places},
            {"places_with_terrain", report.places_with_terrain},
            {"truth", !report.has_truth ? Json() : Json(names.truth.empty() ? "samples" : names.truth)},
            {"threads", report.threads},
            {"open_seconds", report.open_seconds},
            {"share_in_memory", report.share_in_memory ? Json(*report.share_in_memory) : Json()},
            {"points", points},
            {"recommendation", advice},
            {"notes", caveats(report, names)}};
  if (!report.maps.empty()) json["map_tolerance"] = report.map_tolerance.value;
  return json;
}

std::string accuracy_svg(const AccuracyReport& report, const AccuracyNames& names) {
  constexpr double kWidth = 1180, kMargin = 20, kChartHeight = 380, kColumn = (kWidth - 3 * kMargin) / 2;
  double y = 38;
  std::string body =
      svg_text(kMargin, y, "What accuracy costs: " + names.database, 20, "start", "font-weight=\"bold\"") + "\n";
  y += 26;
  body += paragraph(recommendation(report), kMargin, y, 14, kWidth - 2 * kMargin);
  y += 2;
  body += paragraph("Measured: " + question_text(report) + ".", kMargin, y, 11, kWidth - 2 * kMargin, "fill=\"#555\"");
  for (const std::string& sentence : caveats(report, names))
    body += paragraph("Note: " + sentence + ".", kMargin, y, 11, kWidth - 2 * kMargin, "fill=\"#555\"");
  y += 10;
  const double right = 2 * kMargin + kColumn, below = y + kChartHeight + 16;
  body += drawn(time_chart(report), {kMargin, y, kColumn, kChartHeight}) +
          drawn(bytes_chart(report), {right, y, kColumn, kChartHeight});
  const double height = report.maps.empty() ? kChartHeight : 490;
  body += drawn(vertices_chart(report), {kMargin, below, kColumn, kChartHeight}) +
          drawn_maps(report, {right + 20, below, kColumn - 20, height});
  y = below + kChartHeight + 20;
  double note = y;
  body += paragraph("Warm: " + std::string(kWarm) + ".", kMargin, note, 11, kColumn, "fill=\"#555\"");
  body += paragraph("Cold: " + cold_text(report) + ".", kMargin, note, 11, kColumn, "fill=\"#555\"");
  if (report.has_truth)
    body += paragraph("Errors against " + truth_text(report, names) + ".", kMargin, note, 11, kColumn, "fill=\"#555\"");
  return svg_document(kWidth, std::max(note, below + height) + 10, body);
}

namespace {

std::string html_table(const AccuracyReport& report) {
  std::string table = "<table>\n";
  const auto rows = rows_of(report);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool is_advised = i > 0 && report.advice.point == i - 1;
    table += is_advised ? "<tr class=\"advised\">" : "<tr>";
    for (const std::string& cell : rows[i]) table += fmt::format("<{0}>{1}</{0}>", i == 0 ? "th" : "td", xml(cell));
    table += "</tr>\n";
  }
  return table + "</table>\n";
}

/// How the figures were measured.
std::string html_terms(const AccuracyReport& report, const AccuracyNames& names) {
  std::string terms = "<dl>\n";
  const auto add = [&](const char* term, const std::string& text) {
    terms += fmt::format("<dt>{}</dt><dd>{}</dd>\n", term, xml(text));
  };
  add("Question", question_text(report) + ".");
  add("Errors", report.has_truth
                    ? "Distance of a sample from the surface along the vertical, against " + truth_text(report, names) +
                          ". Largest; the distance that 95 % keep, at most 1/256 too large; root mean square."
                    : std::string("Not known."));
  add("Warm", std::string(kWarm) + ".");
  add("Cold", cold_text(report) + ".");
  add("Threads", fmt::format("{}, for answers of a million samples or more.", report.threads));
  for (const std::string& sentence : caveats(report, names)) add("Note", sentence + ".");
  return terms + "</dl>\n";
}

}  // namespace

std::string accuracy_html(const AccuracyReport& report, const AccuracyNames& names) {
  const auto chart = [](const Chart& c) {
    return "<figure>" + svg_document(580, 380, drawn(c, {0, 0, 580, 380})) + "</figure>\n";
  };
  std::string advice = "<p class=\"advice\">" + xml(recommendation(report)) + "</p>\n<ul>\n";
  for (const AccuracyPoint* p : {advised(report), compared(report)}) {
    if (p != nullptr) advice += "<li>" + xml(what_it_is(report, *p)) + "</li>\n";
  }
  advice += "</ul>\n";
  if (const std::string follow = command(report, names); !follow.empty()) advice += "<pre>" + xml(follow) + "</pre>\n";
  if (const std::string took = followed_text(names); !took.empty()) advice += "<p>" + xml(took) + "</p>\n";
  std::string maps;
  if (!report.maps.empty()) {
    const bool several = report.maps.size() > 1;
    const double height = several ? 880
                                  : 60 +
                                        std::min(900.0, 880 * report.maps.front().height.value /
                                                            std::max(report.maps.front().width.value, 1e-9)) +
                                        70;
    maps = "<figure>" + svg_document(1000, height, drawn_maps(report, {10, 0, 980, height})) + "</figure>\n";
  }
  return fmt::format(R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<title>What accuracy costs: {0}</title>
<style>
body {{ font: 15px/1.5 Helvetica, Arial, "Liberation Sans", sans-serif; color: #222; max-width: 1180px; margin: 2em auto; padding: 0 1em; }}
.advice {{ font-size: 1.3em; font-weight: bold; margin-bottom: 0; }}
.charts {{ display: flex; flex-wrap: wrap; gap: 8px; }}
figure {{ margin: 0; }}
svg {{ max-width: 100%; height: auto; }}
table {{ border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums; }}
th, td {{ text-align: right; padding: 2px 14px; border-bottom: 1px solid #ddd; }}
.advised td {{ background: #eef3fa; font-weight: bold; }}
pre {{ background: #f4f4f4; padding: 6px 10px; white-space: pre-wrap; }}
dt {{ font-weight: bold; }}
dd {{ margin: 0 0 .4em 0; }}
</style>
</head>
<body>
<h1>What accuracy costs: {0}</h1>
{1}<div class="charts">
{2}</div>
{3}<h2>Measurements</h2>
{4}<h2>How they were made</h2>
{5}</body>
</html>
)",
                     xml(names.database), advice,
                     chart(time_chart(report)) + chart(bytes_chart(report)) + chart(vertices_chart(report)), maps,
                     html_table(report), html_terms(report, names));
}

}  // namespace talus::app
