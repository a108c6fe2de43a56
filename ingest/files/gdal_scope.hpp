#pragma once
// GDAL, kept to this thread and this scope.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <cpl_error.h>

namespace talus {

/// While one lives, GDAL on this thread is quiet and does not look around in folders; what the host
/// had set returns at its end. The first one registers GDAL's drivers.
class GdalScope {
 public:
  GdalScope();
  ~GdalScope();
  GdalScope(const GdalScope&) = delete;
  GdalScope& operator=(const GdalScope&) = delete;

  /// ": " and GDAL's own words for the last thing that failed in this scope; empty if it said nothing.
  [[nodiscard]] std::string reason() const;

 private:
  struct Setting {
    const char* name;
    const char* value;
  };
  static constexpr std::array<Setting, 2> kSettings{{
      {"GDAL_DISABLE_READDIR_ON_OPEN", "TRUE"},  // side files are asked for by name, never listed
      {"GDAL_VRT_ENABLE_PYTHON", "NO"},
  }};
  static void CPL_STDCALL remember(CPLErr severity, CPLErrorNum number, const char* words);

  std::array<std::optional<std::string>, kSettings.size()> before_;
  std::array<char, 400> words_{};  // fixed: the handler runs inside C frames and must not throw
};

/// HDF5, which reads newer netCDF files, prints pages of what it looked for in vain: no more on this thread.
void quiet_hdf5();

/// While it lives, GDAL keeps at most so many bytes of decoded blocks; what the host had set returns.
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
