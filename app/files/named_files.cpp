#include "app/files/named_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "app/terminal/report.hpp"
#include "talus/failure.hpp"

namespace talus::app {
namespace {

using namespace std::string_view_literals;

struct Content {
  std::size_t at;
  std::string_view bytes, name;
};

constexpr std::string_view kDatabase = "a database", kStream = "an .rqt file";
// The first bytes of files. Their letters may be lower case.
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

/// What a file is; empty where that is not known.
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

}  // namespace

void require_database(const std::string& file) {
  const std::string_view content = content_of(file);
  if (content.empty() || content == kDatabase) return;
  std::string remedy = "name a database; talus ingest makes one from rasters";
  if (content == kStream) {
    remedy = "talus info, convert and merge read it";
  } else if (is_raster(content)) {
    std::filesystem::path database = file;
    database.replace_extension(".talus");
    remedy = fmt::format("make one from it first: talus ingest {} {}", quoted(file), quoted(database.string()));
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
  std::string remedy = "name an .rqt file; talus query writes them";
  if (content == kDatabase) {
    remedy = fmt::format("make one from it first: talus query {} --tolerance M -o answer.rqt", quoted(file));
  } else if (is_raster(content)) {
    remedy = "make a database with talus ingest, then an .rqt file with talus query";
  }
  throw Failure(Cause::corrupt, fmt::format("{} is {}, not an .rqt file; {}", file, content, remedy), file);
}

RestrictedQuadtree answer_of(Stream& stream, const std::string& file) {
  if (auto* answer = std::get_if<RestrictedQuadtree>(&stream.content)) return std::move(*answer);
  const auto& increment = std::get<Increment>(stream.content);
  throw Failure(Cause::invalid_argument,
                fmt::format("{} is an increment from {} m to {} m, not an answer; merge it into one first", file,
                            increment.from.value, increment.added.tolerance.value),
                file);
}

}  // namespace talus::app
