#include "app/files/named_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "talus/failure.hpp"
#include "talus/stream.hpp"

namespace talus::app {
namespace {

using namespace std::string_view_literals;

struct Content {
  std::size_t at;
  std::string_view bytes, name;
};

constexpr std::string_view kDatabase = "a database", kStream = "an .rqt file";
// What files begin with. Letters of the texts among them may be small.
constexpr std::array<Content, 28> kContents{{{16, "\xDE\xC0\xEF\xBE"sv, kDatabase},
                                             {0, "TALUSRQT"sv, kStream},
                                             {0, "II*\0"sv, "a GeoTIFF"},
                                             {0, "MM\0*"sv, "a GeoTIFF"},
                                             {0, "II+\0"sv, "a GeoTIFF"},
                                             {0, "MM\0+"sv, "a GeoTIFF"},
                                             {0, "\x89PNG"sv, "a PNG"},
                                             {0, "\xFF\xD8\xFF"sv, "a JPEG"},
                                             {4, "jP  \r\n\x87\n"sv, "a JPEG 2000"},
                                             {0, "\x89HDF\r\n\x1A\n"sv, "a netCDF-4 or HDF5 file"},
                                             {0, "CDF\x01"sv, "a netCDF file"},
                                             {0, "CDF\x02"sv, "a netCDF file"},
                                             {0, "CDF\x05"sv, "a netCDF file"},
                                             {0, "EHFA_HEADER_TAG"sv, "an Erdas .img"},
                                             {0, "UHL1"sv, "a DTED file"},
                                             {0, "DSAA"sv, "a Surfer grid"},
                                             {0, "DSBB"sv, "a Surfer grid"},
                                             {0, "DSRB"sv, "a Surfer grid"},
                                             {0, "binterr"sv, "a BT file"},
                                             {0, "<VRTDATASET"sv, "a virtual raster (VRT)"},
                                             {0, "NCOLS"sv, "an ASCII grid"},
                                             {0, "NROWS"sv, "an ASCII grid"},
                                             {0, "ENVI"sv, "an ENVI header"},
                                             {0, "PK\x03\x04"sv, "a .zip archive"},
                                             {0, "\x1F\x8B"sv, "a .gz archive"},
                                             {0, "PLY\n"sv, "a .ply mesh"},
                                             {0, "GLTF"sv, "a .glb mesh"},
                                             {0, "{"sv, "a JSON file"}}};

bool begins(std::string_view bytes, const Content& content) {
  if (bytes.size() < content.at + content.bytes.size()) return false;
  return std::equal(content.bytes.begin(), content.bytes.end(), bytes.begin() + static_cast<std::ptrdiff_t>(content.at),
                    [](char expected, char found) {
                      return expected == found || (found >= 'a' && found <= 'z' && expected == found - 'a' + 'A');
                    });
}

/// Empty where it is not known, or not a file.
std::string_view content_of(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  std::array<char, 32> room{};
  std::ifstream in(file, std::ios::binary);
  in.read(room.data(), room.size());
  std::string_view bytes(room.data(), static_cast<std::size_t>(in.gcount()));
  for (const Content& content : kContents) {
    if (begins(bytes, content)) return content.name;
  }
  bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  if (begins(bytes, {0, "NCOLS"sv, ""}) || begins(bytes, {0, "NROWS"sv, ""})) return "an ASCII grid";
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".hgt") return "an SRTM tile";
  if (ending == ".bil" || ending == ".flt") return "a raw raster";
  return {};
}

bool is_raster(std::string_view content) {
  return !content.ends_with("archive") && !content.ends_with("mesh") && content != "a JSON file";
}

/// A word of a shell.
std::string quoted(const std::string& word) {
  if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:=@%") ==
      std::string::npos)
    return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

void require_database(const std::string& file) {
  const std::string_view content = content_of(file);
  if (content.empty() || content == kDatabase) return;
  std::string remedy = "name a database, which talus ingest makes of rasters";
  if (content == kStream) {
    remedy = "talus convert and merge read it, and talus info says what it holds";
  } else if (is_raster(content)) {
    std::filesystem::path database = file;
    database.replace_extension(".talus");
    remedy = fmt::format("make one of it first: talus ingest {} {}", quoted(file), quoted(database.string()));
  }
  throw Failure(Cause::corrupt, fmt::format("{} is {}, not a database; {}", file, content, remedy), file);
}

Database open_database(const std::string& file, const OpenOptions& options) {
  require_database(file);
  return Database::open(file, options);
}

bool holds_stream(const std::string& file) {
  const std::string_view content = content_of(file);
  return content == kStream || (content != kDatabase && is_stream_file(file));
}

void require_stream(const std::string& file) {
  const std::string_view content = content_of(file);
  if (content.empty() || content == kStream) return;
  std::string remedy = "name an .rqt file, which talus query writes";
  if (content == kDatabase) {
    remedy = fmt::format("make one of it first: talus query {} --tolerance M -o answer.rqt", quoted(file));
  } else if (is_raster(content)) {
    remedy = "talus ingest makes a database of it, and talus query makes .rqt files of that";
  }
  throw Failure(Cause::corrupt, fmt::format("{} is {}, not an .rqt file; {}", file, content, remedy), file);
}

}  // namespace talus::app
