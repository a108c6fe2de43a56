#pragma once
// The samples of the inputs, to compare a database with. GDAL is asked cell by cell in doubles. The code is independent
// of ingest's (raster_facts, raster_source, placement, source), so that it does not repeat ingest's mistakes.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "talus/description.hpp"
#include "talus/ingest.hpp"

namespace talus {

/// Inputs on a database's grid. A cell is void if its band's mask says so, if an alpha band is 0, if it is NaN, or if
/// its band declares no void value and InputOptions::nodata lists it. Its height is number · scale + offset, or the
/// decoded colour (InputOptions::decode). Later inputs lie over earlier ones, except where they are void. Longitudes a
/// full turn apart are the same.
class PlainReader {
 public:
  /// fails  as list_inputs and admit_raster; invalid_argument: an input in another CRS, or not on the database's grid
  ///        because it was resampled; io
  PlainReader(const std::vector<std::filesystem::path>& inputs, const InputOptions& rules, const Description& database,
              const std::string& database_name);
  ~PlainReader();
  PlainReader(PlainReader&&) noexcept;
  PlainReader& operator=(PlainReader&&) noexcept;

  /// The rectangle of all inputs on the database's grid, at most a full turn wide.
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
