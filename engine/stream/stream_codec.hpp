#pragma once
// Encodes an answer or an increment as bytes, and decodes it. docs/format/rqt-v1.md.

#include <cstddef>
#include <span>
#include <vector>

#include "talus/stream.hpp"

namespace talus {

/// Encodes a stream. Decoding gives the same stream, with the same bits of all heights. The bytes depend neither on the
/// machine nor on the number of threads.
/// fails  invalid_argument: heights, covers or level errors that do not fit the quadtree; an increment without a base,
///        or with a base that does not fit
[[nodiscard]] std::vector<std::byte> encode(const Stream& stream, const StreamOptions& options = {},
                                            const RestrictedQuadtree* base = nullptr);

/// fails  corrupt, with the byte: damaged, missing or additional bytes; unsupported: another version, or more than the
///        limits allow; invalid_argument: the increment does not continue `base`
[[nodiscard]] Stream decode_stream(std::span<const std::byte> bytes, const StreamLimits& limits = {},
                                   const RestrictedQuadtree* base = nullptr, int threads = 0);

/// Same as read_stream_info, for bytes in memory.
[[nodiscard]] StreamInfo stream_info(std::span<const std::byte> bytes, const StreamLimits& limits = {});

/// The answer in the whole parts of a stream whose end is missing.
struct StreamPrefix {
  Stream stream;
  std::size_t parts = 0, parts_in_all = 0, bytes = 0;  ///< bytes: used bytes
};

/// fails  as decode_stream, except for bytes that are missing after the first part
[[nodiscard]] StreamPrefix decode_stream_prefix(std::span<const std::byte> bytes, const StreamLimits& limits = {},
                                                const RestrictedQuadtree* base = nullptr);

}  // namespace talus
