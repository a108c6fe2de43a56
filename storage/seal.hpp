#pragma once
// The seal: a digest over every byte of a finished file, at its end. See PageWriter::finish and check_seal.

#include <cstddef>
#include <filesystem>
#include <optional>

namespace talus {

inline constexpr std::size_t kSealBytes = 32;

/// Overwrites with zeros what no table uses, and appends the seal. Nobody else may have the file open.
void put_seal(const std::filesystem::path& file);
/// Removes the seal, if any, so that the file can be written again.
void break_seal(const std::filesystem::path& file);

}  // namespace talus
