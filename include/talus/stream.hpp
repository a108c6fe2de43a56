#pragma once
// Streams: answers and increments as .rqt files. Format: docs/format/rqt-v1.md.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "talus/description.hpp"
#include "talus/increment.hpp"
#include "talus/quadtree.hpp"

namespace talus {

/// An answer or an increment, and what a reader needs of the database to make a mesh.
struct Stream {
  /// Extent, mapping, CRS, vertical unit, height step, minimum, maximum, void weight, losses. Other fields are default.
  Description description;
  std::variant<RestrictedQuadtree, Increment> content;
};

struct StreamOptions {
  int threads = 0;  ///< 0: one a core. The bytes do not depend on it
  /// Stripes of each level, which different threads can read at once. A stripe costs some bytes. 0: one for each 65,536
  /// vertices.
  int stripes = 0;
};

/// The most that reading a stream may use. The header states the size of the answer, and a hostile file can lie.
struct StreamLimits {
  /// Bytes of the vertex mask, at one and a half bits a sample of the region. Reading uses up to three times as much.
  std::uint64_t mask_bytes = std::uint64_t{1} << 30;
  /// Number of vertices. A few bytes can stand for many.
  std::uint64_t vertices = std::uint64_t{1} << 30;
  /// The same two limits for each byte of a whole file, except for increments. Any file may use 64 MiB and a million
  /// vertices. Real answers need a quarter of these limits, coarse ones of whole countries included.
  std::uint64_t mask_bytes_a_byte = 8192, vertices_a_byte = 1024;
};

/// Writes a stream. The file appears whole or not at all: it is written under another name and then renamed.
///
/// base     for an increment: the answer before it, which reading needs too. For an answer: null
/// fails    invalid_argument: the name does not end in .rqt; an increment with another base or none; io, full
void write_stream(const Stream& stream, const std::filesystem::path& file, const StreamOptions& options = {},
                  const RestrictedQuadtree* base = nullptr);

/// Reads a stream. The result equals what was written, bit for bit.
///
/// base     the same as for write_stream
/// fails    not_found, io; corrupt, with the position in bytes; unsupported: another version or coding, errors that are
///          not exact, or more than the limits allow; invalid_argument: an increment without its base
[[nodiscard]] Stream read_stream(const std::filesystem::path& file, const StreamLimits& limits = {},
                                 const RestrictedQuadtree* base = nullptr, int threads = 0);

/// Reads a stream while it arrives. After each whole part, an answer's vertices so far are a restricted quadtree with
/// the bound that the part states. Threads: one at a time.
class StreamDecoder {
 public:
  /// base  see write_stream; keep it as long as the decoder
  explicit StreamDecoder(const StreamLimits& limits = {}, const RestrictedQuadtree* base = nullptr, int threads = 0);
  ~StreamDecoder();
  StreamDecoder(const StreamDecoder&) = delete;
  StreamDecoder& operator=(const StreamDecoder&) = delete;

  /// Adds the next bytes and decodes the parts that are then whole.
  /// fails  as read_stream, except for missing bytes
  void add(std::span<const std::byte> bytes);
  [[nodiscard]] std::size_t parts() const;         ///< parts decoded so far
  [[nodiscard]] std::size_t parts_in_all() const;  ///< parts of the stream; 0: not known yet
  [[nodiscard]] std::size_t bytes() const;         ///< bytes decoded so far
  [[nodiscard]] std::uint64_t vertices() const;    ///< vertices decoded so far
  [[nodiscard]] Metres bound() const;              ///< bound of the parts so far; needs at least one part

  /// The answer or increment so far; needs at least one part. Increments can follow a whole answer only.
  /// fails  corrupt: the vertices are not a restricted quadtree; a partial answer whose border is not constrained
  [[nodiscard]] Stream stream() const;
  /// Checks that the stream is complete.
  /// fails  corrupt: bytes are missing
  void require_whole() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One part of a stream.
struct StreamPart {
  std::uint64_t vertices = 0;
  std::uint64_t bytes = 0;
  Metres bound;  ///< bound of all parts up to this one
};

/// A stream without its vertices: the header and the list of parts.
struct StreamInfo {
  Description description;
  GridRect region{{0, 0}, {-1, -1}};
  Origin origin;
  bool is_increment = false;
  Metres from, tolerance, bound;  ///< `from` is for increments
  std::uint64_t vertices = 0, bytes = 0, header_bytes = 0;
  std::vector<StreamPart> parts;
};

/// Reads the header and the sizes of all parts and checks their checksums. It decodes no vertices.
/// fails  as read_stream; it needs no base
[[nodiscard]] StreamInfo read_stream_info(const std::filesystem::path& file, const StreamLimits& limits = {});

/// Whether the name of a file ends in .rqt.
[[nodiscard]] bool is_stream_file(const std::filesystem::path& file);

}  // namespace talus
