#pragma once
// Turns the names on the command line into files.

#include <filesystem>
#include <string>
#include <vector>

#include "talus/ingest.hpp"

namespace talus {

struct InputList {
  std::vector<std::filesystem::path> files;  ///< in the order named; within a folder by name
  std::vector<std::string> notes;            ///< sentences about files that were left out
};

/// Lists the files that names stand for.
///
/// - A file stands for itself. Named twice, it counts where it is named last.
/// - A folder stands for the rasters in it, and with InputOptions::recursive in its subfolders. Virtual rasters are
///   left out if there are other rasters, because they would bring the same data again.
/// - A file in a folder that has a raster's name but cannot be opened is a failure. So is a symbolic link out of the
///   folder, unless InputOptions::allow_outside allows it. InputOptions::skip_broken leaves both out, with a note.
/// - "@list.txt" stands for the files and folders in the list, one a line, relative to the list's folder; lines that
///   begin with # are comments.
///
/// fails  not_found, io; unsupported: a file that cannot be opened; invalid_argument: no name, an empty list or folder
[[nodiscard]] InputList list_inputs(const std::vector<std::filesystem::path>& named, const InputOptions& options);

}  // namespace talus
