#pragma once
// Which files may be opened at all.

#include <filesystem>
#include <string>
#include <vector>

#include "ingest/file_state.hpp"
#include "ingest/gdal_handles.hpp"

namespace talus {

/// Says yes to a raster file before GDAL believes it, so that opening it touches nothing but local
/// files the caller can see: no network, no archive, no program, no file elsewhere.
///
/// A virtual raster (VRT) is accepted when it is plain bands of simple or complex sources, each a
/// regular file below the virtual raster's own folder and acceptable itself. Side files that GDAL
/// opens on its own (masks, overviews) are held to the same rule.
struct AdmittedRaster {
  std::filesystem::path file;  ///< absolute, symbolic links resolved: what is to be opened
  std::string driver;          ///< the one GDAL driver to open it with
  DatasetOwner dataset;        ///< opened to be looked at; null where GDAL could not
  /// All files it is read from, itself first: sources of virtual rasters, headers, masks, world files.
  std::vector<FileState> files = {};
};

/// allow_drivers  GDAL drivers the user vouches for, beyond the list
/// fails  not_found; unsupported: no local file, a driver not on the list, a virtual raster that
///        reaches out; invalid_argument: no such driver; io
[[nodiscard]] AdmittedRaster admit_raster(const std::filesystem::path& file,
                                          const std::vector<std::string>& allow_drivers = {});

/// A file that a driver on the list knows by its first bytes; what else it is, admit_raster tells.
[[nodiscard]] bool looks_like_raster(const std::filesystem::path& file,
                                     const std::vector<std::string>& allow_drivers = {});

}  // namespace talus
