#include "ingest/files/input_list.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "ingest/files/lines.hpp"
#include "ingest/files/raster_guard.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = 64 << 10;  // most bytes in a line of a list
constexpr std::size_t kMostFiles = 1'000'000;   // most files in a list

std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

template <std::size_t N>
bool is_one_of(const std::string& ending, const std::array<std::string_view, N>& endings) {
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

// Files that belong to a raster beside them; some look like rasters.
bool is_side_file(const fs::path& file) {
  constexpr std::array<std::string_view, 8> kEndings{".msk", ".ovr", ".aux", ".rrd", ".xml", ".hdr", ".prj", ".tfw"};
  return is_one_of(ending_of(file), kEndings);
}

bool is_virtual(const fs::path& file) { return ending_of(file) == ".vrt"; }

bool is_packed(const fs::path& file) {
  constexpr std::array<std::string_view, 7> kEndings{".gz", ".zip", ".bz2", ".xz", ".zst", ".7z", ".tgz"};
  return is_one_of(ending_of(file), kEndings);
}

/// Whether the name is that of a raster. If such a file were left out, the answer would have a hole.
bool is_called_raster(const fs::path& file) {
  constexpr std::array<std::string_view, 32> kEndings{
      ".tif", ".tiff", ".gtiff", ".vrt", ".hgt",  ".asc", ".agr",  ".grd", ".flt", ".bil", ".bip",
      ".bsq", ".img",  ".bt",    ".dem", ".ddf",  ".dt0", ".dt1",  ".dt2", ".nc",  ".nc4", ".cdf",
      ".png", ".xyz",  ".jp2",   ".ecw", ".grib", ".grb", ".grb2", ".h5",  ".bag", ".adf"};
  return is_one_of(ending_of(file), kEndings);
}

/// An archive of a raster that is not unpacked beside it.
bool is_packed_raster(const fs::path& file) {
  if (!is_packed(file)) return false;
  const fs::path inside = fs::path(file).replace_extension();
  std::error_code error;
  if (fs::exists(inside, error)) return false;
  if (is_called_raster(inside)) return true;
  if (ending_of(file) != ".zip") return false;
  for (const char* ending : {".hgt", ".tif", ".tiff", ".asc", ".bil", ".dem", ".img", ".flt", ".xyz"}) {
    if (fs::exists(inside.string() + ending, error)) return false;
  }
  return true;
}

/// Why a file with a raster's name cannot be read; empty if it can.
std::string why_broken(const fs::path& file, const InputOptions& options) {
  if (is_packed_raster(file)) {
    return fmt::format("{} is an archive; unpack it first ({})", file.string(),
                       ending_of(file) == ".gz"    ? "gunzip"
                       : ending_of(file) == ".zip" ? "unzip"
                                                   : "tar, 7z or the like");
  }
  try {
    static_cast<void>(admit_raster(file, options));
  } catch (const Failure& f) {
    return f.what();
  }
  return "";
}

std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kSpelledOut = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kSpelledOut); ++i) text += (i ? ", " : "") + names[i];
  if (names.size() > kSpelledOut) text += fmt::format(" and {} more", names.size() - kSpelledOut);
  return text;
}

struct Folder {
  std::vector<fs::path> rasters, virtuals, broken;
  std::vector<std::string> others;  ///< neither rasters nor named like one
  std::size_t subfolders = 0;       ///< not searched
};

void require_inside(const fs::path& link, const fs::path& folder, const InputOptions& options) {
  if (may_lead_to(link, folder, options)) return;
  std::error_code error;
  const fs::path target = fs::weakly_canonical(link, error);
  fail_in(link, Cause::unsupported,
          "{} is a link to {}, outside its folder. To read it, add InputOptions::allow_outside {}", link.string(),
          target.string(), target.parent_path().string());
}

/// top  the folder that was named; links may lead anywhere below it
void look_into(const fs::path& folder, const fs::path& top, const InputOptions& options, Folder& found) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator{}; at.increment(error))
    entries.push_back(at->path());
  if (error) fail_in(folder, Cause::io, "cannot list folder {}: {}", folder.string(), error.message());
  std::sort(entries.begin(), entries.end());
  for (const fs::path& file : entries) {
    if (file.filename().string().starts_with('.') || is_side_file(file)) continue;
    const bool is_link = fs::is_symlink(file, error);
    if (fs::is_directory(file, error)) {
      if (options.recursive && !is_link) {  // a link to a folder may lead in a circle
        look_into(file, top, options, found);
      } else {
        ++found.subfolders;
      }
      continue;
    }
    if (!is_called_raster(file) && !is_packed_raster(file) && !looks_like_raster(file, options)) {
      found.others.push_back(file.filename().string());
      continue;
    }
    if (is_link && fs::exists(file, error)) require_inside(file, top, options);
    const bool is_raster = !is_packed_raster(file) && looks_like_raster(file, options);
    (!is_raster ? found.broken : is_virtual(file) ? found.virtuals : found.rasters).push_back(file);
  }
}

void leave_out_broken(const Folder& found, const fs::path& folder, const InputOptions& options, InputList& list) {
  if (found.broken.empty()) return;
  if (!options.skip_broken) {
    const std::size_t more = found.broken.size() - 1;
    fail_in(found.broken.front(), Cause::unsupported, "{}{}. Leave {} out with InputOptions::skip_broken",
            why_broken(found.broken.front(), options),
            more == 0 ? "" : fmt::format("; {} more in {} cannot be read either", more, folder.string()),
            more == 0 ? "it" : "them");
  }
  for (const fs::path& file : found.broken) list.notes.push_back("left out: " + why_broken(file, options));
}

std::string subfolders(std::size_t count) {
  return fmt::format("{} not searched; InputOptions::recursive searches {}",
                     count == 1 ? "1 subfolder was" : fmt::format("{} subfolders were", count),
                     count == 1 ? "it" : "them");
}

void add_folder(const fs::path& folder, const InputOptions& options, InputList& list) {
  Folder found;
  look_into(folder, folder, options, found);
  leave_out_broken(found, folder, options, list);
  if (found.rasters.empty()) std::swap(found.rasters, found.virtuals);
  if (found.rasters.empty()) {
    fail_in(folder, Cause::invalid_argument, "there is no raster in folder {}{}", folder.string(),
            found.subfolders == 0 ? "" : "; " + subfolders(found.subfolders));
  }
  list.files.insert(list.files.end(), found.rasters.begin(), found.rasters.end());

  std::vector<std::string> left_out;
  for (const fs::path& file : found.virtuals) left_out.push_back(file.filename().string());
  if (!left_out.empty()) {
    list.notes.push_back(fmt::format("{}: left out {}: virtual rasters beside other rasters. Name one to read it",
                                     folder.string(), some_of(left_out)));
  }
  if (!found.others.empty()) {
    list.notes.push_back(fmt::format("{}: left out {} that Talus does not read: {}", folder.string(),
                                     found.others.size() == 1 ? "1 file" : fmt::format("{} files", found.others.size()),
                                     some_of(found.others)));
  }
  if (found.subfolders > 0) list.notes.push_back(folder.string() + ": " + subfolders(found.subfolders));
}

void add(const fs::path& named, const InputOptions& options, InputList& list) {
  if (std::error_code error; fs::is_directory(named, error)) {
    add_folder(named, options, list);
  } else {
    list.files.push_back(named);
  }
}

void add_list(const fs::path& file, const InputOptions& options, InputList& list) {
  Lines lines{file, "list", kLongestLine};
  const std::size_t before = list.files.size();
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // written by some editors
  bool is_first = true;
  for (std::string line; lines.next(line);) {
    if (is_first && (line.starts_with("\xff\xfe") || line.starts_with("\xfe\xff")))
      fail_in(file, Cause::invalid_argument, "list {} is written in UTF-16; save it as UTF-8", file.string());
    if (std::exchange(is_first, false) && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!line.empty() && is_blank(line.back())) line.pop_back();
    line.erase(line.begin(), std::find_if_not(line.begin(), line.end(), is_blank));
    if (line.empty() || line.front() == '#') continue;
    if (line.front() == '@' || line.find('\0') != std::string::npos) {
      fail_in(file, Cause::invalid_argument, "list {} has the line {}: expected the name of a file or a folder",
              file.string(), line.substr(0, line.find('\0')));
    }
    if (list.files.size() - before >= kMostFiles) {
      fail_in(file, Cause::invalid_argument, "list {} names more than {} files; name folders instead", file.string(),
              kMostFiles);
    }
    add(file.parent_path() / line, options, list);
  }
  if (list.files.size() == before) fail_in(file, Cause::invalid_argument, "list {} names no file", file.string());
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
  if (!twice.empty()) list.notes.push_back(fmt::format("named more than once, read once: {}", some_of(twice)));
}

}  // namespace

InputList list_inputs(const std::vector<fs::path>& named, const InputOptions& options) {
  InputList list;
  for (const fs::path& name : named) {
    if (name.native().starts_with('@')) {
      add_list(name.native().substr(1), options, list);
    } else {
      add(name, options, list);
    }
  }
  if (list.files.empty()) throw Failure(Cause::invalid_argument, "no input is named");
  keep_the_last_of_each(list);
  return list;
}

}  // namespace talus
