#pragma once
// Which files may be opened at all.

#include <filesystem>
#include <string>

#include "ingest/files/file_state.hpp"
#include "ingest/files/gdal_handles.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// Says yes to a raster file before GDAL believes it, so that opening it touches nothing but local
/// files the caller can see: no network, no archive, no program, no file elsewhere.
///
/// A virtual raster (VRT) is accepted when it is plain bands of simple or complex sources, each a regular file below
/// the virtual raster's own folder, or below one of InputOptions::allow_outside, and acceptable itself. Side files that
/// GDAL opens on its own (metadata, headers, masks, overviews) are held to the same rule.
///
/// netCDF is not on the list of drivers: damaged files crash its library or take any amount of memory.
struct AdmittedRaster {
  std::filesystem::path file;  ///< absolute, symbolic links resolved: what is to be opened
  std::string driver;          ///< the one GDAL driver to open it with
  std::string variable;        ///< of a file that holds several rasters; empty: the file holds one
  DatasetOwner dataset;        ///< opened to be looked at; null where GDAL could not
  bool interpolates = false;   ///< a virtual raster that resamples its sources otherwise than by the nearest sample
  std::string voids_in;        ///< a source of a virtual raster with a void value, a mask or alpha; empty: none has
  std::string alpha_in;        ///< one with a mask or alpha that the virtual raster does not ask for; empty: none
  /// All files it is read from, itself first: sources of virtual rasters, headers, masks, world files.
  std::vector<FileState> files = {};
};

/// fails  not_found; unsupported: no local file, a driver not on the list, a virtual raster that reaches out, several
///        variables and none chosen; invalid_argument: no such driver, no such variable; io
[[nodiscard]] AdmittedRaster admit_raster(const std::filesystem::path& file, const InputOptions& options);

/// A file that a driver on the list knows by its first bytes; what else it is, admit_raster tells.
[[nodiscard]] bool looks_like_raster(const std::filesystem::path& file, const InputOptions& options);

/// Whether a file lies below a folder or one of those the user allows; symbolic links count by what they lead to.
[[nodiscard]] bool may_lead_to(const std::filesystem::path& file, const std::filesystem::path& folder,
                               const InputOptions& options);

/// Whether a driver reads by way of HDF5, see quiet_hdf5.
[[nodiscard]] bool is_of_hdf5(const std::string& driver);

/// What GDAL opens an admitted raster by.
[[nodiscard]] std::string name_to_open(const std::filesystem::path& file, const std::string& driver,
                                       const std::string& variable);

}  // namespace talus
