#include "ingest/raster_guard.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <cpl_minixml.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal.h>

#include "ingest/gdal_handles.hpp"
#include "ingest/gdal_scope.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

// Local files that hold elevation. Drivers that fetch, run or bundle other things stay out.
constexpr std::array<const char*, 15> kDrivers{"GTiff", "VRT",  "SRTMHGT", "AAIGrid", "EHdr", "ENVI", "BT",   "USGSDEM",
                                               "HFA",   "DTED", "netCDF",  "PNG",     "GSAG", "GSBG", "GS7BG"};
constexpr std::string_view kFormats =
    "GeoTIFF, VRT, SRTM .hgt, Arc/Info ASCII grid, ESRI and ENVI raw, USGS DEM, BT, Erdas .img, DTED, "
    "netCDF, PNG, Surfer grids";
constexpr std::uintmax_t kLargestVrt = 16u << 20;  // bytes; a source takes about 500
constexpr std::size_t kDeepestVrt = 4;             // virtual rasters within virtual rasters

struct FreeXml {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};

bool is_one_of(const char* name, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* n) { return EQUAL(name, n); });
}

bool lies_below(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

// Addresses GDAL would understand and we do not want: /vsicurl/…, https://…, NETCDF:"…":z
bool is_address(const std::string& name) {
  const auto colon = name.find(':');
  const auto is_word = [](char c) { return c == '_' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'z'); };
  return name.starts_with("/vsi") || name.starts_with('<') || name.find("://") != std::string::npos ||
         (colon != std::string::npos && colon > 1 &&
          std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(colon), is_word));
}

fs::path regular_file(const fs::path& file) {
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  if (error && is_address(file.string())) {
    throw Failure(Cause::unsupported,
                  fmt::format("{} is not a local file; Talus opens plain raster files only, so fetch or unpack "
                              "it first",
                              file.string()));
  }
  if (file.empty() || error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) {
    throw Failure(Cause::not_found,
                  fmt::format("there is no file {}", file.empty() ? "without a name" : file.string()));
  }
  if (error) throw Failure(Cause::io, fmt::format("cannot look at {}: {}", file.string(), error.message()));
  if (!fs::is_regular_file(real, error)) {
    throw Failure(Cause::unsupported, fmt::format("{} is {}, not a raster file", file.string(),
                                                  fs::is_directory(real, error) ? "a folder" : "a device or a pipe"));
  }
  if (real.string().starts_with("/vsi")) {
    throw Failure(Cause::unsupported, fmt::format("{} lies where GDAL sees a virtual file system", real.string()));
  }
  if (!std::ifstream{real}) {
    throw Failure(Cause::io, fmt::format("cannot read {}: {}", file.string(), std::strerror(errno)));
  }
  return real;
}

class Guard {
 public:
  explicit Guard(const std::vector<std::string>& allow_drivers) : drivers_(kDrivers.begin(), kDrivers.end()) {
    for (const std::string& name : allow_drivers) {
      GDALDriverH driver = GDALGetDriverByName(name.c_str());
      if (driver == nullptr) {
        throw Failure(
            Cause::invalid_argument,
            fmt::format("--allow-driver {}: GDAL has no such driver here (gdalinfo --formats lists them)", name));
      }
      drivers_.push_back(GDALGetDriverShortName(driver));
    }
    drivers_.push_back(nullptr);
  }

  // Null where no driver on the list knows the file.
  GDALDriverH driver_of(const fs::path& file) const {
    return GDALIdentifyDriverEx(file.c_str(), GDAL_OF_RASTER, drivers_.data(), nullptr);
  }

  AdmittedRaster admit(const fs::path& file) {
    const fs::path real = regular_file(file);
    note(real);
    const std::string driver = identify(real);
    seen_.insert(real);
    if (driver == "VRT") check_vrt(real);
    return {real, driver, check_side_files(real, driver)};
  }

  [[nodiscard]] std::vector<FileState> take_files() { return std::move(files_); }

 private:
  std::string identify(const fs::path& file) const {
    GDALDriverH driver = driver_of(file);
    if (driver == nullptr) {
      GDALDriverH other = GDALIdentifyDriverEx(file.c_str(), GDAL_OF_RASTER, nullptr, nullptr);
      const std::string way =
          other == nullptr ? ""
                           : fmt::format("; --allow-driver {} takes it nevertheless", GDALGetDriverShortName(other));
      throw Failure(Cause::unsupported,
                    fmt::format("{} is not a raster Talus reads ({}){}", file.string(), kFormats, way));
    }
    return GDALGetDriverShortName(driver);
  }

  // Where a virtual raster opens its sources, or GDAL a mask, every driver may answer: the first that
  // knows the file must be the one on our list.
  void check_first_choice(const fs::path& file, const std::string& driver) const {
    GDALDriverH first = GDALIdentifyDriverEx(file.c_str(), GDAL_OF_RASTER, nullptr, nullptr);
    if (first != nullptr && GDALGetDriverShortName(first) != driver) {
      throw Failure(Cause::unsupported,
                    fmt::format("{} looks like {} and like {}; Talus does not open what could be two things",
                                file.string(), driver, GDALGetDriverShortName(first)));
    }
  }

  void admit_inner(const fs::path& file) {
    const fs::path real = regular_file(file);
    if (seen_.contains(real)) return;
    check_first_choice(real, admit(real).driver);
  }

  // GDAL opens masks and overviews beside a file with any driver, and an overview file that the
  // metadata names from anywhere.
  DatasetOwner check_side_files(const fs::path& file, const std::string& driver) {
    for (const char* ending : {".msk", ".MSK", ".ovr", ".OVR"}) {
      const fs::path side = file.string() + ending;
      if (std::error_code error; fs::exists(side, error)) admit_inner(side);
    }
    const std::array<const char*, 2> only{driver.c_str(), nullptr};
    DatasetOwner dataset{GDALOpenEx(file.c_str(), GDAL_OF_RASTER, only.data(), nullptr, nullptr)};
    if (dataset && GDALGetMetadataItem(dataset.get(), "OVERVIEW_FILE", "OVERVIEWS") != nullptr) {
      throw Failure(Cause::unsupported,
                    fmt::format("{} names a separate overview file, which Talus does not follow; copy it with "
                                "gdal_translate first",
                                file.string()));
    }
    if (dataset) {
      const CPLStringList behind{GDALGetFileList(dataset.get())};
      for (int i = 0; i < behind.Count(); ++i) note(behind[i]);
    }
    return dataset;
  }

  // Files that GDAL reads beside those that are admitted: headers, world files, statistics.
  void note(const fs::path& file) {
    std::error_code error;
    const fs::path real = fs::canonical(file, error);
    if (!error && fs::is_regular_file(real, error) && noted_.insert(real).second) files_.push_back(state_of(real));
  }

  void check_vrt(const fs::path& vrt) {
    if (open_.size() >= kDeepestVrt) {
      throw Failure(Cause::unsupported, fmt::format("{} is a virtual raster nested {} deep; {} is the most Talus "
                                                    "follows",
                                                    vrt.string(), open_.size() + 1, kDeepestVrt));
    }
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(vrt, error);
    if (error || bytes > kLargestVrt) {
      throw Failure(Cause::unsupported,
                    fmt::format("{} is a virtual raster of more than {} bytes", vrt.string(), kLargestVrt));
    }
    GdalScope gdal;
    const std::unique_ptr<CPLXMLNode, FreeXml> xml{CPLParseXMLFile(vrt.c_str())};
    if (!xml) throw Failure(Cause::io, fmt::format("cannot read {}{}", vrt.string(), gdal.reason()));
    open_.push_back(vrt);
    std::size_t roots = 0;
    for (const CPLXMLNode* node = xml.get(); node != nullptr; node = node->psNext) {
      if (node->eType != CXT_Element || node->pszValue[0] == '?') continue;
      if (!EQUAL(node->pszValue, "VRTDataset") || ++roots > 1) refuse(vrt, node->pszValue);
      check_dataset(vrt, *node);
    }
    open_.pop_back();
  }

  // Everything that is not known to be harmless is refused: new kinds of element come with new GDALs.
  void check_dataset(const fs::path& vrt, const CPLXMLNode& dataset) {
    for (const CPLXMLNode* node = dataset.psChild; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Attribute && is_one_of(node->pszValue, {"rasterXSize", "rasterYSize"})) continue;
      if (node->eType == CXT_Comment || node->eType == CXT_Text) continue;
      if (node->eType == CXT_Element) {
        if (is_one_of(node->pszValue,
                      {"SRS", "GeoTransform", "Metadata", "OverviewList", "BlockXSize", "BlockYSize"})) {
          continue;
        }
        if (EQUAL(node->pszValue, "VRTRasterBand")) {
          check_band(vrt, *node);
          continue;
        }
        if (EQUAL(node->pszValue, "MaskBand")) {
          check_mask(vrt, *node);
          continue;
        }
      }
      refuse(vrt, node->pszValue);
    }
  }

  void check_mask(const fs::path& vrt, const CPLXMLNode& mask) {
    for (const CPLXMLNode* node = mask.psChild; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Comment) continue;
      if (node->eType != CXT_Element || !EQUAL(node->pszValue, "VRTRasterBand")) refuse(vrt, node->pszValue);
      check_band(vrt, *node);
    }
  }

  void check_band(const fs::path& vrt, const CPLXMLNode& band) {
    for (const CPLXMLNode* node = band.psChild; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Comment || node->eType == CXT_Text) continue;
      if (node->eType == CXT_Attribute) {
        if (is_one_of(node->pszValue, {"dataType", "band", "blockXSize", "blockYSize"})) continue;
        const char* value = node->psChild ? node->psChild->pszValue : "";
        if (EQUAL(node->pszValue, "subClass") && EQUAL(value, "VRTSourcedRasterBand")) continue;
        refuse(vrt, EQUAL(node->pszValue, "subClass") ? value : node->pszValue);
      }
      if (is_one_of(node->pszValue,
                    {"Description", "UnitType", "Offset", "Scale", "CategoryNames", "ColorInterp", "ColorTable",
                     "Metadata", "NoDataValue", "HideNoDataValue", "Histograms", "GDALRasterAttributeTable"})) {
        continue;
      }
      if (is_one_of(node->pszValue, {"SimpleSource", "ComplexSource"})) {
        check_source(vrt, *node);
      } else if (EQUAL(node->pszValue, "MaskBand")) {
        check_mask(vrt, *node);
      } else {
        refuse(vrt, node->pszValue);
      }
    }
  }

  void check_source(const fs::path& vrt, const CPLXMLNode& source) {
    for (const CPLXMLNode* node = source.psChild; node != nullptr; node = node->psNext) {
      if (EQUAL(node->pszValue, "SourceFilename")) {
        check_source_name(vrt, *node);
      } else if (node->eType == CXT_Element && EQUAL(node->pszValue, "OpenOptions")) {
        refuse(vrt, node->pszValue);
      }
    }
  }

  void check_source_name(const fs::path& vrt, const CPLXMLNode& element) {
    const CPLXMLNode* text = nullptr;
    for (const CPLXMLNode* node = element.psChild; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Attribute) continue;
      if (node->eType != CXT_Text || text != nullptr) refuse(vrt, "SourceFilename with more than a name");
      text = node;
    }
    if (text == nullptr) refuse(vrt, "SourceFilename without a name");
    const fs::path name = text->pszValue;
    if (is_address(name.string())) {
      throw Failure(Cause::unsupported,
                    fmt::format("{} has the source {}, which is not a local file", vrt.string(), name.string()));
    }
    const bool beside = std::atoi(CPLGetXMLValue(&element, "relativeToVRT", "0")) != 0;  // as GDAL reads it
    const fs::path real = regular_file(beside ? vrt.parent_path() / name : name);
    if (!lies_below(real, vrt.parent_path())) {
      throw Failure(Cause::unsupported,
                    fmt::format("{} has the source {}, which lies outside its folder; put the sources below the "
                                "virtual raster",
                                vrt.string(), real.string()));
    }
    if (std::find(open_.begin(), open_.end(), real) != open_.end()) {
      throw Failure(Cause::unsupported, fmt::format("{} is a source of itself", real.string()));
    }
    admit_inner(real);
  }

  [[noreturn]] static void refuse(const fs::path& vrt, std::string_view what) {
    throw Failure(Cause::unsupported,
                  fmt::format("{} is a virtual raster with {}; Talus takes plain bands of simple or complex sources "
                              "only, so copy it with gdal_translate first",
                              vrt.string(), what));
  }

  std::vector<const char*> drivers_;  // that may open files; ends in null
  std::set<fs::path> seen_, noted_;
  std::vector<FileState> files_;  // what was noted, in order
  std::vector<fs::path> open_;  // the virtual rasters we are inside of, outermost first
};

}  // namespace

AdmittedRaster admit_raster(const fs::path& file, const std::vector<std::string>& allow_drivers) {
  GdalScope gdal;
  Guard guard{allow_drivers};
  AdmittedRaster admitted = guard.admit(file);
  admitted.files = guard.take_files();
  return admitted;
}

bool looks_like_raster(const fs::path& file, const std::vector<std::string>& allow_drivers) {
  GdalScope gdal;
  std::error_code error;
  return fs::is_regular_file(file, error) && Guard{allow_drivers}.driver_of(file) != nullptr;
}

}  // namespace talus
