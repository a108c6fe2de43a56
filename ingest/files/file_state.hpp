#pragma once
// Size and times of a file.

#include <cstdint>
#include <filesystem>

namespace talus {

/// A file at one moment. If a later state is equal, nobody wrote to the file in between.
struct FileState {
  std::filesystem::path file;  ///< absolute
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;  ///< since 1970; changed_ns also moves when somebody sets modified_ns
  std::uint64_t device = 0, inode = 0;
  friend bool operator==(const FileState&, const FileState&) = default;
};

/// fails  not_found, io
[[nodiscard]] FileState state_of(const std::filesystem::path& file);

}  // namespace talus
