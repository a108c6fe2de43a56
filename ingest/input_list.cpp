#include "ingest/input_list.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "ingest/lines.hpp"
#include "ingest/raster_guard.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = 64 << 10;  // bytes of a list's line
constexpr std::size_t kMostFiles = 1'000'000;   // that one list names

// Files GDAL opens beside a raster; some look like rasters themselves.
bool is_side_file(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  constexpr std::string_view kEndings[] = {".msk", ".ovr", ".aux", ".rrd", ".xml", ".hdr", ".prj", ".tfw"};
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

bool is_virtual(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".vrt" || ending == ".VRT";
}

std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kSpelledOut = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kSpelledOut); ++i) text += (i ? ", " : "") + names[i];
  if (names.size() > kSpelledOut) text += fmt::format(" and {} more", names.size() - kSpelledOut);
  return text;
}

void add_folder(const fs::path& folder, const std::vector<std::string>& allow_drivers, InputList& list) {
  std::vector<fs::path> rasters, virtuals;
  std::vector<std::string> others, left_out;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  for (; !error && entries != fs::directory_iterator{}; entries.increment(error)) {
    const fs::path& file = entries->path();
    if (file.filename().string().starts_with('.') || entries->is_directory() || is_side_file(file)) continue;
    if (!looks_like_raster(file, allow_drivers)) {
      others.push_back(file.filename().string());
    } else {
      (is_virtual(file) ? virtuals : rasters).push_back(file);
    }
  }
  if (error) throw Failure(Cause::io, fmt::format("cannot list folder {}: {}", folder.string(), error.message()));
  if (rasters.empty()) std::swap(rasters, virtuals);
  if (rasters.empty()) {
    throw Failure(Cause::invalid_argument, fmt::format("there is no raster in folder {}", folder.string()));
  }
  std::sort(rasters.begin(), rasters.end());
  list.files.insert(list.files.end(), rasters.begin(), rasters.end());

  for (const fs::path& file : virtuals) left_out.push_back(file.filename().string());
  std::sort(others.begin(), others.end());
  std::sort(left_out.begin(), left_out.end());
  if (!left_out.empty()) {
    list.notes.push_back(
        fmt::format("{}: of its rasters {} stay out, being virtual ones beside real ones; name one to "
                    "take it",
                    folder.string(), some_of(left_out)));
  }
  if (!others.empty()) {
    list.notes.push_back(fmt::format("{}: {} no raster Talus reads: {}", folder.string(),
                                     others.size() == 1 ? "one file is" : fmt::format("{} files are", others.size()),
                                     some_of(others)));
  }
}

void add(const fs::path& named, const std::vector<std::string>& allow_drivers, InputList& list) {
  if (std::error_code error; fs::is_directory(named, error)) {
    add_folder(named, allow_drivers, list);
  } else {
    list.files.push_back(named);
  }
}

void add_list(const fs::path& file, const std::vector<std::string>& allow_drivers, InputList& list) {
  Lines lines{file, "list", kLongestLine};
  const std::size_t before = list.files.size();
  for (std::string line; lines.next(line);) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!line.empty() && is_blank(line.back())) line.pop_back();
    line.erase(line.begin(), std::find_if_not(line.begin(), line.end(), is_blank));
    if (line.empty() || line.front() == '#') continue;
    if (line.front() == '@' || line.find('\0') != std::string::npos) {
      throw Failure(Cause::invalid_argument,
                    fmt::format("list {} has the line {}: expected the name of a file or a "
                                "folder",
                                file.string(), line.substr(0, line.find('\0'))),
                    file);
    }
    if (list.files.size() - before >= kMostFiles) {
      throw Failure(Cause::invalid_argument,
                    fmt::format("list {} names more than {} files; name folders instead", file.string(), kMostFiles),
                    file);
    }
    add(file.parent_path() / line, allow_drivers, list);
  }
  if (list.files.size() == before) {
    throw Failure(Cause::invalid_argument, fmt::format("list {} names no file", file.string()), file);
  }
}

void keep_the_last_of_each(InputList& list) {
  std::set<fs::path> seen;
  std::vector<fs::path> kept;
  std::vector<std::string> twice;
  for (auto file = list.files.rbegin(); file != list.files.rend(); ++file) {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(*file, error);
    if (seen.insert(error ? *file : real).second) {
      kept.push_back(*file);
    } else {
      twice.push_back(file->string());
    }
  }
  std::reverse(kept.begin(), kept.end());
  list.files = std::move(kept);
  if (!twice.empty()) list.notes.push_back(fmt::format("named more than once, taken once: {}", some_of(twice)));
}

}  // namespace

InputList list_inputs(const std::vector<fs::path>& named, const std::vector<std::string>& allow_drivers) {
  InputList list;
  for (const fs::path& name : named) {
    if (name.native().starts_with('@')) {
      add_list(name.native().substr(1), allow_drivers, list);
    } else {
      add(name, allow_drivers, list);
    }
  }
  if (list.files.empty()) throw Failure(Cause::invalid_argument, "no input is named");
  keep_the_last_of_each(list);
  return list;
}

}  // namespace talus
