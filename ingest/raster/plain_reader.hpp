#pragma once
// The samples of rasters, asked of GDAL cell by cell in doubles, to hold a database against. Ingest's decoding of
// bands, masks, alpha, nodata, scale and position (raster_facts, raster_source, placement, source) is not used here:
// what it takes for right would be right by itself.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "talus/description.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// Inputs on a database's grid. A cell is void where its band's mask says so, where any alpha band is 0, where it is
/// NaN or, in a band that declares no void value, one of InputOptions::nodata. Its height is number · scale + offset,
/// or what InputOptions::decode makes of its colours. A later input covers an earlier one; a void covers nothing.
/// Longitudes that are a full turn apart are the same.
class PlainReader {
 public:
  /// fails  as list_inputs and admit_raster; invalid_argument: an input that is not on the database's grid, for
  /// instance
  ///        because it was resampled, or that is in another CRS; io
  PlainReader(const std::vector<std::filesystem::path>& inputs, const InputOptions& rules, const Description& database,
              const std::string& database_name);
  ~PlainReader();
  PlainReader(PlainReader&&) noexcept;
  PlainReader& operator=(PlainReader&&) noexcept;

  /// All samples of all inputs, in the database's columns and rows; no more columns than a full turn has.
  [[nodiscard]] GridRect extent() const;
  /// fails  io: a file that cannot be read
  /// cost   one row of a file at a time
  [[nodiscard]] SampleWindow read(GridRect part) const;

 private:
  struct Opened;
  void settle_extent(GridRect database);
  std::unique_ptr<Opened> opened_;
};

}  // namespace talus
