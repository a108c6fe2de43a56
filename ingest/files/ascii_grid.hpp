#pragma once
// Grids written as text, which GDAL reads however they are written.

#include <filesystem>
#include <string>

namespace talus {

/// GDAL makes 0 of a word that is no number and of numbers that are missing, and shifts the rest: an Arc/Info ASCII
/// grid must have as many numbers as its header says.
///
/// fails  unsupported: too few or too many, or a word that is none; io
/// cost   one reading of the file
void require_whole_ascii_grid(const std::filesystem::path& file, const std::string& name, int cols, int rows);

}  // namespace talus
