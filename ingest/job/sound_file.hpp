#pragma once
// Checks a file before it is copied.

#include <filesystem>

namespace talus {

/// The file matches its seal, and its trees are sound. Otherwise a copy would seal the damage again.
/// fails  corrupt; not_found, io
/// cost   reads the file
void require_sound_file(const std::filesystem::path& database);

}  // namespace talus
