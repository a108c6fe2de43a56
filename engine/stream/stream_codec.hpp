#pragma once
// An answer or an increment, and the bytes it becomes: docs/format/rqt-v1.md.

#include <cstddef>
#include <span>
#include <vector>

#include "talus/stream.hpp"

namespace talus {

/// decode(encode(x)) is x, heights bit for bit. Pure: the same stream gives the same bytes anywhere, whatever the
/// threads.
/// fails  invalid_argument: a quadtree whose heights, covers or level errors do not fit it; an increment without its
///        base, or that does not fit it
[[nodiscard]] std::vector<std::byte> encode(const Stream& stream, const StreamOptions& options = {},
                                            const RestrictedQuadtree* base = nullptr);

/// fails  corrupt, with the byte where it shows: anything the bytes of a stream cannot be, bytes that are missing or
///        left over; unsupported: another version, more than the limits allow; invalid_argument: an increment that does
///        not go on from `base`
[[nodiscard]] Stream decode_stream(std::span<const std::byte> bytes, const StreamLimits& limits = {},
                                   const RestrictedQuadtree* base = nullptr, int threads = 0);

/// As read_stream_info, of bytes.
[[nodiscard]] StreamInfo stream_info(std::span<const std::byte> bytes, const StreamLimits& limits = {});

/// What the whole parts at the front of cut bytes hold.
struct StreamPrefix {
  Stream stream;
  std::size_t parts = 0, parts_in_all = 0, bytes = 0;  ///< `bytes` were used
};

/// fails  as decode_stream, but for bytes that are missing behind the first part
[[nodiscard]] StreamPrefix decode_stream_prefix(std::span<const std::byte> bytes, const StreamLimits& limits = {},
                                                const RestrictedQuadtree* base = nullptr);

}  // namespace talus
