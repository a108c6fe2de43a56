#pragma once
// From what the command line names to files.

#include <filesystem>
#include <string>
#include <vector>

#include "talus/ingest.hpp"

namespace talus {

struct InputList {
  std::vector<std::filesystem::path> files;  ///< in the order they were named; those of a folder by name
  std::vector<std::string> notes;            ///< what was left out
};

/// Files stand for themselves. A folder stands for the rasters directly in it, or with InputOptions::recursive for
/// those in its subfolders, too; where it holds both rasters and virtual rasters, for the former, because the latter
/// would bring the same data again. A file in a folder whose ending is that of a raster, and that cannot be opened, is
/// a tile that would be missing: it is a failure, or left out and said so with InputOptions::skip_broken. So is a
/// symbolic link out of the folder that InputOptions::allow_outside does not cover. "@list.txt" stands for the
/// files and folders it names, one a line, relative to its own folder; lines that begin with # are comments. A file
/// named twice counts where it is named last.
///
/// fails  not_found, io; unsupported: a tile that cannot be opened; invalid_argument: nothing named, a list or a folder
///        with nothing in it
[[nodiscard]] InputList list_inputs(const std::vector<std::filesystem::path>& named, const InputOptions& options);

}  // namespace talus
