#pragma once
// An answer or an increment, and the bytes it becomes: docs/format/rqt-v0.md.

#include <cstddef>
#include <span>
#include <vector>

#include "talus/stream.hpp"

namespace talus {

inline constexpr std::uint32_t kStreamVersion = 0;

/// decode(encode(x)) is x, heights bit for bit. Pure: the same stream gives the same bytes anywhere.
/// fails  invalid_argument: a quadtree whose heights, covers or level errors do not fit it
[[nodiscard]] std::vector<std::byte> encode(const Stream& stream);

/// fails  corrupt, with the byte where it shows: anything the bytes of a stream cannot be, bytes that are missing or left
///        over; unsupported: another version, a mask larger than allowed
[[nodiscard]] Stream decode_stream(std::span<const std::byte> bytes, const StreamLimits& limits = {});

/// What the whole parts at the front of cut bytes hold: of an answer a restricted quadtree with the bound its last part
/// states, which increments do not fit unless it is all of it.
struct StreamPrefix {
  Stream stream;
  std::size_t parts = 0, parts_in_all = 0, bytes = 0;  ///< `bytes` were used
};

/// fails  as decode_stream, but for bytes that are missing behind the first part
[[nodiscard]] StreamPrefix decode_stream_prefix(std::span<const std::byte> bytes, const StreamLimits& limits = {});

}  // namespace talus
