#pragma once
// Real terrain, where it is at hand: the folder TALUS_DEM_DIR, and a model from a Debian package.

#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/raster_file.hpp"

namespace talus::support {

/// A model's file, or nothing and why. "jacksboro" is made on the spot, in `scratch`, of a Debian package's
/// file; every other name is one in TALUS_DEM_DIR.
struct RealModel {
  std::optional<std::filesystem::path> file;
  std::string why_not;
};
[[nodiscard]] RealModel real_model(const std::string& name, const TempFolder& scratch);

}  // namespace talus::support
