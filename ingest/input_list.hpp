#pragma once
// From what the command line names to files.

#include <filesystem>
#include <string>
#include <vector>

namespace talus {

struct InputList {
  std::vector<std::filesystem::path> files;  ///< in the order they were named; those of a folder by name
  std::vector<std::string> notes;            ///< what was left out
};

/// Files stand for themselves. A folder stands for the rasters directly in it; where it holds both rasters and
/// virtual rasters, for the former, because the latter would bring the same data again. "@list.txt" stands for the
/// files and folders it names, one a line, relative to its own folder; lines that begin with # are comments. A file
/// named twice counts where it is named last.
///
/// fails  not_found, io; invalid_argument: nothing named, a list or a folder with nothing in it
[[nodiscard]] InputList list_inputs(const std::vector<std::filesystem::path>& named,
                                    const std::vector<std::string>& allow_drivers);

}  // namespace talus
