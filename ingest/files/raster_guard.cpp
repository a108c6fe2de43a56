#include "ingest/files/raster_guard.hpp"

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

#include <cpl_conv.h>
#include <cpl_minixml.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal.h>

#include "engine/machine/fail.hpp"
#include "ingest/files/gdal_handles.hpp"
#include "ingest/files/gdal_scope.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

// Drivers of local elevation files. Drivers that fetch, run or unpack other things are not trusted.
constexpr std::array<const char*, 14> kDrivers{"GTiff",   "VRT", "SRTMHGT", "AAIGrid", "EHdr", "ENVI", "BT",
                                               "USGSDEM", "HFA", "DTED",    "PNG",     "GSAG", "GSBG", "GS7BG"};
constexpr std::string_view kFormats =
    "GeoTIFF, VRT, SRTM .hgt, Arc/Info ASCII grid, ESRI and ENVI raw, USGS DEM, BT, Erdas .img, DTED, PNG, Surfer "
    "grids";
// Endings of the files that GDAL opens with a raster: added to its name, or in place of its ending.
constexpr std::array<std::string_view, 6> kAppended{".aux.xml", ".msk", ".ovr", ".aux", ".hdr", ".wld"};
constexpr std::array<std::string_view, 14> kReplaced{".hdr", ".prj", ".qpj", ".wld", ".stx", ".sta", ".clr",
                                                     ".tab", ".aux", ".rrd", ".ige", ".imd", ".rpb", "_rpc.txt"};
constexpr std::uintmax_t kLargestVrt = 16u << 20;  // bytes; a source needs about 500
constexpr std::size_t kDeepestVrt = 4;             // virtual rasters in virtual rasters

struct FreeXml {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};

bool is_one_of(const char* name, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* n) { return EQUAL(name, n); });
}

bool lies_below(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

// Names that GDAL reads as addresses: /vsicurl/…, https://…, NETCDF:"…":z
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
    fail(Cause::unsupported, "{} is not a local file. Talus opens local raster files only: fetch or unpack it first",
         file.string());
  }
  if (file.empty() || error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory)
    fail(Cause::not_found, "there is no file {}", file.empty() ? "without a name" : file.string());
  if (error) fail(Cause::io, "cannot read {}: {}", file.string(), error.message());
  if (!fs::is_regular_file(real, error)) {
    fail(Cause::unsupported, "{} is {}, not a raster file", file.string(),
         fs::is_directory(real, error) ? "a folder" : "a device or a pipe");
  }
  if (real.string().starts_with("/vsi")) {
    fail(Cause::unsupported, "{}: GDAL does not read paths that begin with /vsi as files. Move the file",
         real.string());
  }
  if (!std::ifstream{real}) fail(Cause::io, "cannot read {}: {}", file.string(), std::strerror(errno));
  return real;
}

std::string upper(std::string_view text) {
  std::string all(text);
  std::transform(all.begin(), all.end(), all.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return all;
}

/// The existing files beside a raster that GDAL may open with it.
std::vector<fs::path> side_files_of(const fs::path& file) {
  std::vector<fs::path> sides;
  const auto add = [&](const std::string& side) {
    std::error_code error;
    if (side != file && fs::exists(fs::symlink_status(side, error)) && !fs::is_directory(side, error))
      sides.emplace_back(side);
  };
  const auto add_both = [&](const std::string& stem, std::string_view ending) {
    add(stem + std::string(ending));
    add(stem + upper(ending));
  };
  const std::string name = file.string(), ending = file.extension().string();
  const std::string stem = name.substr(0, name.size() - ending.size());
  for (const std::string_view appended : kAppended) add_both(name, appended);
  for (const std::string_view replaced : kReplaced) add_both(stem, replaced);
  if (ending.size() < 3) return sides;
  for (const char w : {'w', 'W'}) {  // world files: .tif has .tfw and .tifw
    add(stem + ending + w);
    add(stem + ending.substr(0, 2) + ending.back() + w);
  }
  return sides;
}

/// The variables of a file with several rasters. A name is the last part of GDAL's: NETCDF:"a.nc":height.
std::vector<std::string> variables_of(GDALDatasetH dataset) {
  std::vector<std::string> names;
  char** metadata = GDALGetMetadata(dataset, "SUBDATASETS");
  for (int i = 1; const char* name = CSLFetchNameValue(metadata, fmt::format("SUBDATASET_{}_NAME", i).c_str()); ++i) {
    const std::string_view whole = name;
    names.emplace_back(whole.substr(whole.rfind(':') + 1));
  }
  return names;
}

class Guard {
 public:
  explicit Guard(const InputOptions& options) : options_(options), drivers_(kDrivers.begin(), kDrivers.end()) {
    for (const std::string& name : options.allow_drivers) {
      GDALDriverH driver = GDALGetDriverByName(name.c_str());
      if (driver == nullptr) {
        fail(Cause::invalid_argument,
             "InputOptions::allow_drivers {}: GDAL has no such driver here (gdalinfo --formats lists all)", name);
      }
      drivers_.push_back(GDALGetDriverShortName(driver));
    }
    drivers_.push_back(nullptr);
  }

  // Null if no driver on the list knows the file.
  GDALDriverH driver_of(const fs::path& file) const {
    return GDALIdentifyDriverEx(file.c_str(), GDAL_OF_RASTER, drivers_.data(), nullptr);
  }

  AdmittedRaster admit(const fs::path& file) {
    const fs::path real = regular_file(file);
    note(real);
    const std::string driver = identify(real);
    seen_.insert(real);
    if (driver == "VRT") check_vrt(real);
    check_side_files(real);
    AdmittedRaster raster{real, driver, {}, open(real, driver, ""), interpolates_, voids_in_, alpha_in_, {}};
    if (raster.dataset) choose_variable(raster, file);
    return raster;
  }

  [[nodiscard]] std::vector<FileState> take_files() { return std::move(files_); }

 private:
  std::string identify(const fs::path& file) const {
    GDALDriverH driver = driver_of(file);
    if (driver == nullptr) {
      GDALDriverH other = GDALIdentifyDriverEx(file.c_str(), GDAL_OF_RASTER, nullptr, nullptr);
      const std::string name = other == nullptr ? "" : GDALGetDriverShortName(other);
      std::error_code error;
      std::string why = fmt::format("is not a raster Talus reads ({})", kFormats);
      if (name == "netCDF") why = "is a netCDF file, and a damaged one can crash the library that reads it";
      if (fs::file_size(file, error) == 0 && !error) why = "is empty";
      const std::string way =
          other == nullptr ? ""
                           : fmt::format(". If you trust the file, open it with InputOptions::allow_drivers {}", name);
      fail(Cause::unsupported, "{} {}{}", file.string(), why, way);
    }
    return GDALGetDriverShortName(driver);
  }

  // For the sources of a virtual raster and for masks, GDAL tries all drivers. The first that knows the file must be on
  // our list.
  void check_first_choice(const fs::path& file, const std::string& driver) const {
    GDALDriverH first = GDALIdentifyDriverEx(file.c_str(), GDAL_OF_RASTER, nullptr, nullptr);
    if (first != nullptr && GDALGetDriverShortName(first) != driver) {
      fail(Cause::unsupported,
           "{} looks like {} and like {}, so Talus does not open it. Convert it with gdal_translate", file.string(),
           driver, GDALGetDriverShortName(first));
    }
  }

  /// Opens a file that another one names; empty if it was seen before.
  AdmittedRaster admit_inner(const fs::path& file) {
    const fs::path real = regular_file(file);
    if (seen_.contains(real)) return {};
    AdmittedRaster inner = admit(real);
    check_first_choice(real, inner.driver);
    return inner;
  }

  /// Records which voids a source has. The virtual raster must have them, too.
  void note_voids(const AdmittedRaster& source, bool uses_mask) {
    GDALDatasetH dataset = source.dataset.get();
    for (int i = 1; dataset != nullptr && i <= GDALGetRasterCount(dataset); ++i) {
      GDALRasterBandH band = GDALGetRasterBand(dataset, i);
      const int flags = GDALGetMaskFlags(band);
      const bool is_alpha = GDALGetRasterColorInterpretation(band) == GCI_AlphaBand;
      const bool is_masked = is_alpha || ((flags & GMF_ALL_VALID) == 0 && flags != GMF_NODATA);
      if (is_masked || (flags & GMF_ALL_VALID) == 0) voids_in_ = source.file.string();
      if (is_masked && !uses_mask) alpha_in_ = source.file.string();
    }
  }

  // GDAL opens files beside a raster without being asked, and masks and overviews with any driver.
  void check_side_files(const fs::path& file) {
    for (const fs::path& side : side_files_of(file)) {
      const fs::path real = regular_file(side);
      if (!may_lead_to(real, file.parent_path(), options_)) {
        fail(Cause::unsupported,
             "{} is a link to {}, outside its folder. To read it, add InputOptions::allow_outside {}", side.string(),
             real.string(), real.parent_path().string());
      }
      note(real);
      const std::string ending = upper(side.extension().string());
      if (ending == ".MSK" || ending == ".OVR") admit_inner(side);
    }
  }

  // The metadata may name an overview file anywhere.
  DatasetOwner open(const fs::path& file, const std::string& driver, const std::string& variable) {
    if (is_of_hdf5(driver)) quiet_hdf5();
    const std::array<const char*, 2> only{driver.c_str(), nullptr};
    DatasetOwner dataset{
        GDALOpenEx(name_to_open(file, driver, variable).c_str(), GDAL_OF_RASTER, only.data(), nullptr, nullptr)};
    if (dataset && GDALGetMetadataItem(dataset.get(), "OVERVIEW_FILE", "OVERVIEWS") != nullptr) {
      fail(Cause::unsupported,
           "{} names a separate overview file, which Talus does not open. Copy the raster with gdal_translate first",
           file.string());
    }
    if (dataset) {
      const CPLStringList behind{GDALGetFileList(dataset.get())};
      for (int i = 0; i < behind.Count(); ++i) note(behind[i]);
    }
    return dataset;
  }

  /// Chooses the raster of a file that holds several.
  void choose_variable(AdmittedRaster& raster, const fs::path& named) {
    const std::vector<std::string> variables = variables_of(raster.dataset.get());
    const bool has_bands = GDALGetRasterCount(raster.dataset.get()) > 0;
    if (options_.variable.empty()) {
      if (has_bands || variables.empty()) return;
      fail(Cause::unsupported, "{} holds several rasters: {}. Choose one with InputOptions::variable", named.string(),
           fmt::join(variables, ", "));
    }
    if (std::find(variables.begin(), variables.end(), options_.variable) == variables.end()) {
      if (has_bands && variables.empty()) return;  // the name is for other inputs
      fail(Cause::invalid_argument, "{} has no variable {}; it has {}", named.string(), options_.variable,
           variables.empty() ? "none" : fmt::format("{}", fmt::join(variables, ", ")));
    }
    raster.variable = options_.variable;
    raster.dataset = open(raster.file, raster.driver, raster.variable);
  }

  // Records a file that GDAL reads with the admitted one: a header, a world file, statistics.
  void note(const fs::path& file) {
    std::error_code error;
    const fs::path real = fs::canonical(file, error);
    if (!error && fs::is_regular_file(real, error) && noted_.insert(real).second) files_.push_back(state_of(real));
  }

  void check_vrt(const fs::path& vrt) {
    if (open_.size() >= kDeepestVrt) {
      fail(Cause::unsupported, "{} is a virtual raster nested {} deep; Talus reads at most {}", vrt.string(),
           open_.size() + 1, kDeepestVrt);
    }
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(vrt, error);
    if (error || bytes > kLargestVrt) {
      fail(Cause::unsupported, "{} is a virtual raster larger than {} bytes, the most that Talus reads", vrt.string(),
           kLargestVrt);
    }
    GdalScope gdal;
    const std::unique_ptr<CPLXMLNode, FreeXml> xml{CPLParseXMLFile(vrt.c_str())};
    if (!xml) fail(Cause::io, "cannot read {}{}", vrt.string(), gdal.reason());
    open_.push_back(vrt);
    std::size_t roots = 0;
    for (const CPLXMLNode* node = xml.get(); node != nullptr; node = node->psNext) {
      if (node->eType != CXT_Element || node->pszValue[0] == '?') continue;
      if (!EQUAL(node->pszValue, "VRTDataset") || ++roots > 1) refuse(vrt, node->pszValue);
      check_dataset(vrt, *node);
    }
    open_.pop_back();
  }

  // Unknown elements are refused: a new GDAL may bring new ones.
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
    const char* resampling = CPLGetXMLValue(&source, "resampling", "nearest");
    interpolates_ |= !is_one_of(resampling, {"near", "nearest"});
    for (const CPLXMLNode* node = source.psChild; node != nullptr; node = node->psNext) {
      if (EQUAL(node->pszValue, "SourceFilename")) {
        const char* uses_mask = CPLGetXMLValue(&source, "UseMaskBand", "false");
        note_voids(check_source_name(vrt, *node), CPLTestBool(uses_mask) != 0);
      } else if (node->eType == CXT_Element && EQUAL(node->pszValue, "OpenOptions")) {
        refuse(vrt, node->pszValue);
      }
    }
  }

  AdmittedRaster check_source_name(const fs::path& vrt, const CPLXMLNode& element) {
    const CPLXMLNode* text = nullptr;
    for (const CPLXMLNode* node = element.psChild; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Attribute) continue;
      if (node->eType != CXT_Text || text != nullptr) refuse(vrt, "SourceFilename with more than a name");
      text = node;
    }
    if (text == nullptr) refuse(vrt, "SourceFilename without a name");
    const fs::path name = text->pszValue;
    if (is_address(name.string()))
      fail(Cause::unsupported, "{} has the source {}, which is not a local file", vrt.string(), name.string());
    const bool beside = std::atoi(CPLGetXMLValue(&element, "relativeToVRT", "0")) != 0;  // as GDAL parses it
    const fs::path real = regular_file(beside ? vrt.parent_path() / name : name);
    if (!may_lead_to(real, vrt.parent_path(), options_)) {
      fail(Cause::unsupported,
           "{} has the source {}, outside its folder. To read it, add InputOptions::allow_outside {}", vrt.string(),
           real.string(), real.parent_path().string());
    }
    if (std::find(open_.begin(), open_.end(), real) != open_.end())
      fail(Cause::unsupported, "{} is a source of itself", real.string());
    return admit_inner(real);
  }

  [[noreturn]] static void refuse(const fs::path& vrt, std::string_view what) {
    fail(Cause::unsupported,
         "{} is a virtual raster with {}; Talus reads only bands of simple or complex sources. Copy it with "
         "gdal_translate first",
         vrt.string(), what);
  }

  const InputOptions& options_;
  std::vector<const char*> drivers_;  // allowed to open files; ends in null
  std::set<fs::path> seen_, noted_;
  std::vector<FileState> files_;  // in the order they were found
  bool interpolates_ = false;
  std::string voids_in_, alpha_in_;
  std::vector<fs::path> open_;  // the virtual rasters around the current file, outermost first
};

}  // namespace

AdmittedRaster admit_raster(const fs::path& file, const InputOptions& options) {
  GdalScope gdal;
  Guard guard{options};
  AdmittedRaster admitted = guard.admit(file);
  admitted.files = guard.take_files();
  return admitted;
}

bool looks_like_raster(const fs::path& file, const InputOptions& options) {
  GdalScope gdal;
  std::error_code error;
  return fs::is_regular_file(file, error) && Guard{options}.driver_of(file) != nullptr;
}

bool may_lead_to(const fs::path& file, const fs::path& folder, const InputOptions& options) {
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  if (error) return false;
  const auto is_below = [&](const fs::path& allowed) {
    const fs::path place = fs::canonical(allowed.empty() ? "." : allowed, error);
    return !error && lies_below(real, place);
  };
  return is_below(folder) || std::any_of(options.allow_outside.begin(), options.allow_outside.end(), is_below);
}

bool is_of_hdf5(const std::string& driver) {
  return is_one_of(driver.c_str(), {"netCDF", "HDF5", "HDF5Image", "BAG", "KEA"});
}

std::string name_to_open(const fs::path& file, const std::string& driver, const std::string& variable) {
  if (variable.empty()) return file.string();
  return fmt::format("{}:\"{}\":{}", upper(driver), file.string(), variable);
}

}  // namespace talus
