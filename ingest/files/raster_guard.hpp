#pragma once
// Decides which raster files may be opened.

#include <filesystem>
#include <string>

#include "ingest/files/file_state.hpp"
#include "ingest/files/gdal_handles.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// A raster file that is safe to open: that touches only local files the caller can see, no network, no archive, no
/// program.
///
/// A virtual raster (VRT) is admitted if it has only bands of simple or complex sources. Each source is a regular file
/// below the virtual raster's folder or below one of InputOptions::allow_outside, and is admitted itself. Side files
/// (metadata, headers, masks, overviews) follow the same rule. netCDF must be allowed by name: damaged files crash its
/// library or use any amount of memory.
struct AdmittedRaster {
  std::filesystem::path file;  ///< absolute, symbolic links resolved
  std::string driver;          ///< the GDAL driver to open it with
  std::string variable;        ///< the raster to read in a file with several; empty: the only one
  DatasetOwner dataset;        ///< open for a first look; null if GDAL could not
  bool interpolates = false;   ///< a virtual raster that interpolates its sources
  std::string voids_in;        ///< a source of a virtual raster with a void value, a mask or alpha; empty: none
  std::string alpha_in;        ///< a source with a mask or alpha that the virtual raster does not use; empty: none
  /// All files that it is read from, itself first: sources of virtual rasters, headers, masks, world files.
  std::vector<FileState> files = {};
};

/// fails  not_found; unsupported: not a local file, a driver not on the list, a virtual raster with other sources,
///        several variables and none chosen; invalid_argument: no such driver, no such variable; io
[[nodiscard]] AdmittedRaster admit_raster(const std::filesystem::path& file, const InputOptions& options);

/// Whether a driver on the list knows the file by its first bytes. It may still be refused by admit_raster.
[[nodiscard]] bool looks_like_raster(const std::filesystem::path& file, const InputOptions& options);

/// Whether a file lies below `folder` or a folder that the user allows; symbolic links are followed.
[[nodiscard]] bool may_lead_to(const std::filesystem::path& file, const std::filesystem::path& folder,
                               const InputOptions& options);

/// Whether a driver uses HDF5, see quiet_hdf5.
[[nodiscard]] bool is_of_hdf5(const std::string& driver);

/// The name by which GDAL opens an admitted raster.
[[nodiscard]] std::string name_to_open(const std::filesystem::path& file, const std::string& driver,
                                       const std::string& variable);

}  // namespace talus
