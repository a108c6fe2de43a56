#pragma once
// Answers and increments as files: docs/format/rqt-v1.md.

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

/// An answer or an increment, with what a reader must know of the database to make a mesh of it.
struct Stream {
  /// Extent, mapping, CRS, vertical unit, height step, extremes, weight and losses. The rest is not kept.
  Description description;
  std::variant<RestrictedQuadtree, Increment> content;
};

struct StreamOptions {
  int threads = 0;  ///< 0: one a core. Changes nothing but the time
  /// Each level is cut into as many stripes, which several threads can read at once; a stripe costs some bytes. 0: one for
  /// each 65,536 vertices.
  int stripes = 0;
};

/// What a stream may take to read. Its header says how large it will be, and anybody may have written that.
struct StreamLimits {
  /// Most bytes of the vertex mask: one and a half bits a sample of the region, however few vertices stand in it.
  /// Reading takes up to three times as much.
  std::uint64_t mask_bytes = std::uint64_t{1} << 30;
  /// Most vertices: a few bytes may stand for many.
  std::uint64_t vertices = std::uint64_t{1} << 30;
  /// The same for each byte of a file that is read as a whole and is no increment, whose region its base bounds. A file
  /// of any size may take 64 MiB and a million vertices. Real answers, coarse ones of whole countries too, need a
  /// quarter of this.
  std::uint64_t mask_bytes_a_byte = 8192, vertices_a_byte = 1024;
};

/// Written beside `file`, then renamed.
///
/// base     of an increment: the answer that it goes on from, without which it cannot be read either. Else null
/// fails    invalid_argument: a name that does not end in .rqt; an increment that does not fit its base, or has none;
///          io, full
void write_stream(const Stream& stream, const std::filesystem::path& file, const StreamOptions& options = {},
                  const RestrictedQuadtree* base = nullptr);

/// The same, bit for bit.
///
/// base     as it was written with
/// fails    not_found, io; corrupt, with the byte where it shows; unsupported: another version, another coding of its
///          parts, errors other than exact ones, or more than the limits allow; invalid_argument: an increment without the answer that it goes on from
[[nodiscard]] Stream read_stream(const std::filesystem::path& file, const StreamLimits& limits = {},
                                 const RestrictedQuadtree* base = nullptr, int threads = 0);

/// Reads a stream as it arrives. Once a part is whole, what has come so far is of an answer a restricted quadtree with
/// the bound that part states. Threads: one at a time.
class StreamDecoder {
 public:
  /// base  must stay
  explicit StreamDecoder(const StreamLimits& limits = {}, const RestrictedQuadtree* base = nullptr, int threads = 0);
  ~StreamDecoder();
  StreamDecoder(const StreamDecoder&) = delete;
  StreamDecoder& operator=(const StreamDecoder&) = delete;

  /// The next bytes. Parts that they make whole are decoded.
  /// fails  as read_stream, but for bytes that are missing
  void add(std::span<const std::byte> bytes);
  [[nodiscard]] std::size_t parts() const;         ///< decoded so far
  [[nodiscard]] std::size_t parts_in_all() const;  ///< 0: not known yet
  [[nodiscard]] std::size_t bytes() const;         ///< used so far
  [[nodiscard]] std::uint64_t vertices() const;    ///< so far
  [[nodiscard]] Metres bound() const;              ///< of the parts so far; at least one

  /// Of the parts so far, at least one. What is not all of an answer is no answer that increments fit.
  /// fails  corrupt: vertices that are no restricted quadtree; a cut answer whose border is not constrained
  [[nodiscard]] Stream stream() const;
  /// fails  corrupt: bytes are missing
  void require_whole() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What a stream says of one of its parts.
struct StreamPart {
  std::uint64_t vertices = 0;
  std::uint64_t bytes = 0;
  Metres bound;  ///< of all parts up to this one
};

/// What a stream says of itself.
struct StreamInfo {
  Description description;
  GridRect region{{0, 0}, {-1, -1}};
  Origin origin;
  bool is_increment = false;
  Metres from, tolerance, bound;  ///< from: of an increment
  std::uint64_t vertices = 0, bytes = 0, header_bytes = 0;
  std::vector<StreamPart> parts;
};

/// Reads the header and what parts say of themselves, and checks their checksums; decodes nothing.
/// fails  as read_stream, without a base
[[nodiscard]] StreamInfo read_stream_info(const std::filesystem::path& file, const StreamLimits& limits = {});

/// Whether a name says that a file is one.
[[nodiscard]] bool is_stream_file(const std::filesystem::path& file);

}  // namespace talus
