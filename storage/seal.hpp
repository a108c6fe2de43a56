#pragma once
// A digest over every byte of a finished file, at its end: see PageWriter::finish and check_seal.

#include <cstddef>
#include <filesystem>
#include <optional>

namespace talus {

inline constexpr std::size_t kSealBytes = 32;

/// Appends it. The file is closed by all others.
void put_seal(const std::filesystem::path& file);
/// Cuts it off, if there is one, so that the file can be written again.
void break_seal(const std::filesystem::path& file);

}  // namespace talus
