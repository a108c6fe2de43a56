#pragma once
// A look at a file's outer structure before LMDB maps it.

#include <filesystem>

namespace talus {

/// Throws `corrupt` unless the file's headers and size fit together and, where its trees are small, every
/// pointer in them stays inside.
void refuse_unsound(const std::filesystem::path& file);

}  // namespace talus
