#pragma once
// Files that are to be read from the disk again.

#include <filesystem>
#include <optional>

namespace talus {

/// Asks the system to give up what it holds of a file in memory. It may decline: of what some process has mapped, of
/// what is not yet on the disk, on file systems that live in memory. What the disk itself keeps is not touched. fails
/// never: a file that cannot be opened is left alone
void drop_from_memory(const std::filesystem::path& file) noexcept;

/// How much of a file the system holds in memory, 0 to 1; nothing where it does not tell.
[[nodiscard]] std::optional<double> share_in_memory(const std::filesystem::path& file);

}  // namespace talus
