#pragma once
// The header of a database: what ingest writes and query reads. docs/format/v2.md has the fields.

#include <cstddef>
#include <span>
#include <vector>

#include "engine/page/page_layout.hpp"
#include "talus/description.hpp"

namespace talus {

inline constexpr int kFormatVersion = 2;

struct Manifest {
  Description description;
  int bands = kFewestBands;      ///< see page_layout.hpp
  std::uint32_t generation = 0;  ///< updates so far
  /// Generations of the pages of the coarsest band, in curve order (pages_of_band); those of others their parents know.
  std::vector<std::uint32_t> top_generations;
};

/// Text that lasts: one JSON object, numbers as they round-trip.
[[nodiscard]] std::vector<std::byte> encode(const Manifest& manifest);

/// fails  corrupt: not such an object, or values no database has; unsupported: another version or page layout
[[nodiscard]] Manifest decode_manifest(std::span<const std::byte> bytes);

/// The same for what only `info` reads. It stands at its own position of the header table: with ten thousand sources it
/// is no longer short.
[[nodiscard]] std::vector<std::byte> encode(const Provenance& provenance);
[[nodiscard]] Provenance decode_provenance(std::span<const std::byte> bytes);

/// Positions of the header table.
inline constexpr std::uint64_t kManifestPosition = 0, kPlanPosition = 1, kProvenancePosition = 2;

}  // namespace talus
