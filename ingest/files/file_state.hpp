#pragma once
// What the system says of a file without reading it.

#include <cstdint>
#include <filesystem>

namespace talus {

/// A file as it was at one moment. If all of it is the same later, nobody wrote to the file in between.
struct FileState {
  std::filesystem::path file;  ///< absolute
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;  ///< since 1970; the second also moves when somebody sets the first
  std::uint64_t device = 0, inode = 0;
  friend bool operator==(const FileState&, const FileState&) = default;
};

/// fails  not_found, io
[[nodiscard]] FileState state_of(const std::filesystem::path& file);

}  // namespace talus
