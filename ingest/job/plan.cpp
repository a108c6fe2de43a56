#include "ingest/job/plan.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "engine/page/manifest.hpp"

namespace talus {

namespace {

/// The options that change the content, besides the inputs: each as field and value.
std::string typed(const IngestOptions& options) {
  const InputOptions& in = options.inputs;
  std::string text;
  if (options.finest_tolerance.value != 0)
    text += fmt::format(", IngestOptions::finest_tolerance {}", options.finest_tolerance.value);
  if (options.error_metric != ErrorMetric::vertical)
    text += fmt::format(", IngestOptions::error_metric {}", name_of(options.error_metric));
  if (options.void_weight != 1) text += fmt::format(", IngestOptions::void_weight {}", options.void_weight);
  if (!in.srs.empty()) text += fmt::format(", InputOptions::srs {}", in.srs);
  if (in.band != 0) text += fmt::format(", InputOptions::band {}", in.band);
  if (!in.variable.empty()) text += fmt::format(", InputOptions::variable {}", in.variable);
  for (const double value : in.nodata) text += fmt::format(", InputOptions::nodata {}", value);
  if (in.decode != ColourCode::none)
    text += fmt::format(", InputOptions::decode {}", in.decode == ColourCode::terrarium ? "terrarium" : "terrain-rgb");
  if (in.vertical_unit) text += fmt::format(", InputOptions::vertical_unit {}", name_of(*in.vertical_unit));
  if (in.priority_resolution) text += ", InputOptions::priority_resolution";
  if (!in.target_srs.empty()) text += fmt::format(", InputOptions::target_srs {}", in.target_srs);
  if (in.target_dx != 0) text += fmt::format(", InputOptions::target_dx {},{}", in.target_dx, in.target_dy);
  if (in.resampling) text += fmt::format(", InputOptions::resampling {}", name_of(*in.resampling));
  if (in.height_step.value != 0) text += fmt::format(", InputOptions::height_step {}", in.height_step.value);
  return text;
}

// A file name may contain line breaks.
std::string escaped(const std::string& name) {
  std::string text;
  for (const char c : name) text += c == '\n' ? "\\n" : c == '\\' ? "\\\\" : std::string(1, c);
  return text;
}
std::string unescaped(const std::string& text) {
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_escape = text[i] == '\\' && i + 1 < text.size();
    name += !is_escape ? text[i] : text[++i] == 'n' ? '\n' : text[i];
  }
  return name;
}

constexpr const char* kFile = "file ";

std::string line_of(const DigestedFile& f) {
  const FileState& s = f.state;
  return fmt::format("{}{} {} {} {} {} {} {:016x} {}\n", kFile, s.bytes, s.modified_ns, s.changed_ns, s.device, s.inode,
                     f.is_young ? 1 : 0, f.digest, escaped(s.file.string()));
}

/// The plan without the lines about files.
std::string asked(const std::string& plan) {
  std::string text, line;
  for (std::istringstream in(plan); std::getline(in, line);) {
    if (!line.starts_with(kFile)) text += line + '\n';
  }
  return text;
}

}  // namespace

std::string plan_of(const Source& source, const InputFiles& files, const Description& d, const IngestOptions& options) {
  std::string text = fmt::format("talus format {}\noptions{}\n", kFormatVersion, typed(options));
  text += fmt::format("extent {} {} {} {}\nmapping {} {} {} {}\n", d.extent.first.col, d.extent.first.row,
                      d.extent.last.col, d.extent.last.row, d.mapping.x0, d.mapping.y0, d.mapping.dx, d.mapping.dy);
  text += fmt::format("step {} {} {} {}\nunit {} {}\ncrs {}\n", d.step.scale, d.step.divisor, d.step.offset,
                      d.step.integer, d.vertical_unit, d.metres_per_unit, escaped(d.crs_wkt));
  for (const InputFile& input : source.inputs()) text += fmt::format("input {}\n", escaped(input.name));
  for (const DigestedFile& file : files.files()) text += line_of(file);
  return text;
}

std::string plan_of_update(const std::filesystem::path& database, const Source& source) {
  const std::vector<InputFile>& inputs = source.inputs();
  std::string text =
      fmt::format("update of {} with {}", escaped(database.filename().string()), escaped(inputs.front().name));
  if (inputs.size() > 1) text += fmt::format(" and {} more", inputs.size() - 1);
  return text + '\n';
}

bool is_plan_of_ingest(const std::string& plan) { return plan.starts_with("talus format "); }

std::string title_of(const std::string& plan) { return plan.substr(0, plan.find('\n')); }

std::vector<DigestedFile> files_of(const std::string& plan) {
  std::vector<DigestedFile> files;
  std::string line;
  for (std::istringstream in(plan); std::getline(in, line);) {
    if (!line.starts_with(kFile)) continue;
    std::istringstream fields(line.substr(std::string(kFile).size()));
    DigestedFile f;
    int young = 0;
    std::string digest, name;
    fields >> f.state.bytes >> f.state.modified_ns >> f.state.changed_ns >> f.state.device >> f.state.inode >> young >>
        digest;
    if (!fields || !std::getline(fields >> std::ws, name)) return {};
    f.is_young = young != 0;
    f.digest = std::strtoull(digest.c_str(), nullptr, 16);
    f.state.file = unescaped(name);
    files.push_back(std::move(f));
  }
  return files;
}

std::string difference_of(const std::string& then, const std::string& now) {
  const std::vector<DigestedFile> before = files_of(then), after = files_of(now);
  const auto is_alike = [](const DigestedFile& a, const DigestedFile& b) {
    return a.state.file.filename() == b.state.file.filename();
  };
  for (std::size_t i = 0; i < before.size() && i < after.size(); ++i) {
    if (!is_alike(before[i], after[i])) break;
    if (const std::string what = difference_of(before[i], after[i]); !what.empty())
      return fmt::format("{} {}", after[i].state.file.string(), what);
  }
  const auto lacks = [&](const std::vector<DigestedFile>& files, const DigestedFile& f) {
    return std::none_of(files.begin(), files.end(), [&](const DigestedFile& other) { return is_alike(f, other); });
  };
  const auto gone = std::find_if(before.begin(), before.end(), [&](const auto& f) { return lacks(after, f); });
  if (gone != before.end()) return fmt::format("{} is missing from the inputs", gone->state.file.string());
  const auto come = std::find_if(after.begin(), after.end(), [&](const auto& f) { return lacks(before, f); });
  if (come != after.end()) return fmt::format("{} is a new input", come->state.file.string());
  if (asked(then) != asked(now) || before.size() != after.size())
    return "the options or the order of the inputs differ";
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!is_alike(before[i], after[i])) return "the order of the inputs differs";
  }
  return "";
}

std::string made_by(const IngestOptions& options) { return "talus " TALUS_VERSION + typed(options); }

}  // namespace talus
