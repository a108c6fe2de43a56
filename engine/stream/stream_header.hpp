#pragma once
// Writes, reads and checks the header of a stream. docs/format/rqt-v1.md, section 2.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/stream/stream_bytes.hpp"
#include "talus/stream.hpp"

namespace talus {

inline constexpr std::uint32_t kStreamVersion = 1;

/// The meaning of a height's code, which is a whole number.
enum class CodeKind : std::uint32_t {
  whole = 0,    ///< number of height steps
  floats = 1,   ///< bits of a 32-bit float, changed so that codes rise with values
  doubles = 2,  ///< the same for 64 bits
  quanta = 3    ///< multiple of the quantum
};

struct StreamHeader {
  Description description;
  RestrictedQuadtree quadtree;  ///< without vertices, heights and covers; the vertices lie in `window`
  GridRect window{{0, 0}, {-1, -1}};
  bool is_increment = false, has_covers = false, has_loose = false, is_wide = false;
  Metres from;
  std::uint64_t vertices = 0;
  std::size_t parts = 0;
  CodeKind kind = CodeKind::whole;
  std::uint64_t base = 0;  ///< digest of the answer that an increment continues
  std::size_t bytes = 0;   ///< length of the header
  std::uint64_t seal = 0;  ///< checksum of the header, and seed of the first part's checksum

  [[nodiscard]] int root() const { return static_cast<int>(parts) - 1; }
  /// The bound of the quadtree of all parts up to this one.
  [[nodiscard]] Metres bound(std::size_t part) const;
};

/// fails  invalid_argument: a text is too long
void put_header(StreamWriter& out, const StreamHeader& header);

/// Whether a stream may begin with these bytes. Any number of bytes may be checked.
[[nodiscard]] bool begins_as_stream(std::span<const std::byte> bytes);

/// Reads a header; empty if bytes are missing.
/// fails  corrupt, unsupported: as decode_stream
[[nodiscard]] std::optional<StreamHeader> take_header(std::span<const std::byte> bytes, const StreamLimits& limits);

/// A digest of vertices and heights, which identifies the base of an increment.
[[nodiscard]] std::uint64_t digest_of(const RestrictedQuadtree& quadtree);

}  // namespace talus
