#pragma once
// Checks Arc/Info ASCII grids, of which GDAL accepts damaged ones.

#include <filesystem>
#include <string>

namespace talus {

/// Checks that the grid has as many numbers as its header says. GDAL reads a word that is not a number as 0, and fills
/// in for missing numbers.
///
/// fails  unsupported: too few or too many numbers, or a word that is not a number; io
/// cost   reads the file once
void require_whole_ascii_grid(const std::filesystem::path& file, const std::string& name, int cols, int rows);

}  // namespace talus
