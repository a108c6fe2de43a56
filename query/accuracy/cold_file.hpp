#pragma once
// Drops files from memory, so that they are read from the disk again.

#include <filesystem>
#include <optional>

namespace talus {

/// Asks the system to drop a file from memory. It may decline for parts that a process has mapped, that are not yet on
/// the disk, or on file systems in memory. The disk's own cache stays.
/// fails  never: a file that cannot be opened is ignored
void drop_from_memory(const std::filesystem::path& file) noexcept;

/// The share of a file that the system holds in memory, 0 to 1; empty if the system does not say.
[[nodiscard]] std::optional<double> share_in_memory(const std::filesystem::path& file);

}  // namespace talus
