#pragma once
// The header of a database: what ingest writes and query reads. docs/format/v1.md has the fields.

#include <cstddef>
#include <span>
#include <vector>

#include "talus/description.hpp"

namespace talus {

inline constexpr int kFormatVersion = 1;

struct Manifest {
  Description description;
  int bands = 1;      ///< see page_layout.hpp
  bool exact = true;  ///< stored errors carry no rounding margin, see HeightField
};

/// Text that lasts: one JSON object, numbers as they round-trip.
[[nodiscard]] std::vector<std::byte> encode(const Manifest& manifest);

/// fails  corrupt: not such an object, or values no database has; unsupported: another version or page layout
[[nodiscard]] Manifest decode_manifest(std::span<const std::byte> bytes);

}  // namespace talus
