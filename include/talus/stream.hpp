#pragma once
// Answers and increments as files: docs/format/rqt-v0.md.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <variant>

#include "talus/description.hpp"
#include "talus/increment.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// An answer or an increment, with what a reader must know of the database to make a mesh of it.
struct Stream {
  /// Extent, mapping, CRS, vertical unit, height step, extremes, weight and losses. The rest is not kept.
  Description description;
  std::variant<RestrictedQuadtree, Increment> content;
};

struct StreamLimits {
  /// Of the vertex mask of what is read: one bit a sample of the region, however few vertices stand in it.
  std::uint64_t mask_bytes = std::uint64_t{1} << 30;
};

/// Written beside `file`, then renamed.
/// fails  invalid_argument: a name that does not end in .rqt; io, full
void write_stream(const Stream& stream, const std::filesystem::path& file);

/// The same, bit for bit.
/// fails  not_found, io; corrupt, with the byte where it shows; unsupported: another version, or a region whose mask is
///        larger than allowed
[[nodiscard]] Stream read_stream(const std::filesystem::path& file, const StreamLimits& limits = {});

/// Whether a name says that a file is one.
[[nodiscard]] bool is_stream_file(const std::filesystem::path& file);

}  // namespace talus
