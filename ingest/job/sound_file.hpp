#pragma once
// What is copied must be whole.

#include <filesystem>

namespace talus {

/// Every byte is as it was sealed, and the file's trees hold together. Otherwise a copy would seal the damage anew.
/// fails  corrupt; not_found, io
/// cost   reads the file
void require_sound_file(const std::filesystem::path& database);

}  // namespace talus
