#pragma once
// GDAL's settings for one thread and one scope.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <cpl_error.h>

namespace talus {

/// While it lives, GDAL prints nothing on this thread and does not list folders; its end restores the host's settings.
/// The first one registers GDAL's drivers.
class GdalScope {
 public:
  GdalScope();
  ~GdalScope();
  GdalScope(const GdalScope&) = delete;
  GdalScope& operator=(const GdalScope&) = delete;

  /// ": " and GDAL's message for the last failure in this scope; empty if there was none.
  [[nodiscard]] std::string reason() const;

 private:
  struct Setting {
    const char* name;
    const char* value;
  };
  static constexpr std::array<Setting, 2> kSettings{{
      {"GDAL_DISABLE_READDIR_ON_OPEN", "TRUE"},  // side files are found by name
      {"GDAL_VRT_ENABLE_PYTHON", "NO"},
  }};
  static void CPL_STDCALL remember(CPLErr severity, CPLErrorNum number, const char* words);

  std::array<std::optional<std::string>, kSettings.size()> before_;
  std::array<char, 400> words_{};  // fixed: the handler runs inside C frames and must not throw
};

/// Stops HDF5, which reads newer netCDF files, from printing its failures on this thread.
void quiet_hdf5();

/// While it lives, GDAL's block cache holds at most `bytes`; its end restores the host's limit.
class RasterCache {
 public:
  explicit RasterCache(std::uint64_t bytes);
  ~RasterCache();
  RasterCache(const RasterCache&) = delete;
  RasterCache& operator=(const RasterCache&) = delete;

 private:
  std::int64_t before_;
};

}  // namespace talus
