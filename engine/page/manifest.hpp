#pragma once
// The header of a database. docs/format/v3.md has its fields.

#include <cstddef>
#include <span>
#include <vector>

#include "engine/page/page_layout.hpp"
#include "talus/description.hpp"

namespace talus {

inline constexpr int kFormatVersion = 3;

struct Manifest {
  Description description;
  int bands = kFewestBands;      ///< see page_layout.hpp
  std::uint32_t generation = 0;  ///< number of updates
  /// Generations of the coarsest band's pages, in the order of pages_of_band. Those of other pages are in child
  /// entries.
  std::vector<std::uint32_t> top_generations;
};

/// One JSON object as text; numbers are read back bit for bit.
[[nodiscard]] std::vector<std::byte> encode(const Manifest& manifest);

/// fails  corrupt: not such an object, or impossible values; unsupported: another version or page layout
[[nodiscard]] Manifest decode_manifest(std::span<const std::byte> bytes);

/// The same for the provenance. It has its own position of the header table, because ten thousand sources make it long
/// and only `info` reads it.
[[nodiscard]] std::vector<std::byte> encode(const Provenance& provenance);
[[nodiscard]] Provenance decode_provenance(std::span<const std::byte> bytes);

/// Positions of the header table.
inline constexpr std::uint64_t kManifestPosition = 0, kPlanPosition = 1, kProvenancePosition = 2;

}  // namespace talus
