#pragma once
// Checks a file's structure before LMDB maps it.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace talus {

/// fails  corrupt: headers and size contradict each other; a pointer leads outside (small trees only)
void refuse_unsound(const std::filesystem::path& file);

struct FileRange {
  std::uint64_t first = 0, bytes = 0;
};
/// What no table uses: free pages, the gaps of branch and leaf pages, and the rests of pages behind large values. LMDB
/// leaves there what it wrote before.
/// fails  corrupt
[[nodiscard]] std::vector<FileRange> unused_ranges(const std::filesystem::path& file);

}  // namespace talus
