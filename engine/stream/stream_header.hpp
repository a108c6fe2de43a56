#pragma once
// What a stream says of itself before any vertex: docs/format/rqt-v1.md, section 2.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/stream/stream_bytes.hpp"
#include "talus/stream.hpp"

namespace talus {

inline constexpr std::uint32_t kStreamVersion = 1;

/// What the numbers stand for that heights are coded as.
enum class CodeKind : std::uint32_t {
  whole = 0,    ///< of the height step
  floats = 1,   ///< bits of 32-bit floats, in the order of their values
  doubles = 2,  ///< the same of 64 bits
  quanta = 3    ///< multiples of the quantum
};

struct StreamHeader {
  Description description;
  RestrictedQuadtree quadtree;  ///< all but its vertices, heights and covers; their window is `window`
  GridRect window{{0, 0}, {-1, -1}};
  bool is_increment = false, has_covers = false, has_loose = false, is_wide = false;
  Metres from;
  std::uint64_t vertices = 0;
  std::size_t parts = 0;
  CodeKind kind = CodeKind::whole;
  std::uint64_t base = 0;  ///< digest of what an increment goes on from
  std::size_t bytes = 0;   ///< its own
  std::uint64_t seal = 0;  ///< its checksum, which seeds the first part's

  [[nodiscard]] int root() const { return static_cast<int>(parts) - 1; }
  /// Of the quadtree of the parts up to this one.
  [[nodiscard]] Metres bound(std::size_t part) const;
};

/// fails  invalid_argument: texts too long
void put_header(StreamWriter& out, const StreamHeader& header);

/// Whether these may be the first bytes of a stream; a few are enough.
[[nodiscard]] bool begins_as_stream(std::span<const std::byte> bytes);

/// Nothing, if bytes are missing.
/// fails  corrupt, unsupported: as decode_stream
[[nodiscard]] std::optional<StreamHeader> take_header(std::span<const std::byte> bytes, const StreamLimits& limits);

/// Of vertices and heights: an increment's base is recognised by it.
[[nodiscard]] std::uint64_t digest_of(const RestrictedQuadtree& quadtree);

}  // namespace talus
