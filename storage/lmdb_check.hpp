#pragma once
// Checks a file's structure before LMDB maps it.

#include <filesystem>

namespace talus {

/// fails  corrupt: headers and size contradict each other; a pointer leads outside (small trees only)
void refuse_unsound(const std::filesystem::path& file);

}  // namespace talus
