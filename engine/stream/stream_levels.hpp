#pragma once
// Encodes and decodes the parts of a stream, which have the vertices by level. docs/format/rqt-v1.md, sections 3 to 6.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/stream/height_codes.hpp"
#include "engine/stream/level_symbols.hpp"
#include "engine/stream/level_walk.hpp"
#include "engine/stream/stream_covers.hpp"

namespace talus {

/// Vertices that are known before their level is coded, by half of the level: those of the border, of a base, and
/// scattered ones.
template <class Code>
class KnownLevels {
 public:
  explicit KnownLevels(int root) : levels_(static_cast<std::size_t>(root) + 1) {}
  /// Adds a vertex. The order does not matter, but sort() must follow.
  void insert(GridPoint p, Code height);
  void sort();
  /// half 0: centres, 1: side midpoints. All vertices of the root's level are in half 1.
  [[nodiscard]] const KnownVertices<Code>& at(int shift, std::size_t half) const {
    return levels_[static_cast<std::size_t>(shift)][half];
  }
  [[nodiscard]] std::size_t size(int shift) const { return at(shift, 0).points.size() + at(shift, 1).points.size(); }

 private:
  std::vector<std::array<KnownVertices<Code>, 2>> levels_;
};

/// The bytes of one part, without its length, vertices and checksum.
struct EncodedPart {
  std::uint64_t vertices = 0;
  std::vector<std::byte> payload;
};

/// quadtree  content of the stream; codes: its heights
/// base      the answer that an increment continues; base_codes: its heights
template <class Code>
[[nodiscard]] std::vector<EncodedPart> encode_parts(const StreamHeader& header, const RestrictedQuadtree& quadtree,
                                                    std::span<const Code> codes, const RestrictedQuadtree* base,
                                                    std::span<const Code> base_codes, const StreamOptions& options);

/// Decodes parts one after the other.
template <class Code>
class PartsDecoder {
 public:
  /// header, base  must live as long as the decoder
  PartsDecoder(const StreamHeader& header, const RestrictedQuadtree* base, std::span<const Code> base_codes,
               int threads);
  ~PartsDecoder();
  PartsDecoder(const PartsDecoder&) = delete;
  PartsDecoder& operator=(const PartsDecoder&) = delete;

  /// fails  corrupt
  void take(std::span<const std::byte> payload, std::uint64_t vertices);
  [[nodiscard]] std::uint64_t vertices() const { return found_; }
  /// The quadtree of the parts so far: that of the header, with vertices, heights and covers.
  /// fails  corrupt: the vertices of an answer are not a restricted quadtree
  [[nodiscard]] RestrictedQuadtree quadtree() const;

 private:
  void take_first(std::span<const std::byte> payload, std::uint64_t vertices);
  void take_level(std::span<const std::byte> payload, std::uint64_t vertices);
  void take_covers(std::span<const std::byte> bytes, std::span<const GridPoint> points);

  const StreamHeader& header_;
  const RestrictedQuadtree* base_;
  int threads_;
  HeightCoding coding_;
  LevelDecoder<Code> decoder_;
  KnownLevels<Code> known_;
  LevelVertices<Code> so_far_;
  std::size_t taken_ = 0;
  std::uint64_t found_ = 0;
  bool may_have_gaps_ = false;  ///< some vertices may lack a parent
  CoverCoder cover_coder_;
  std::vector<std::pair<GridPoint, std::uint8_t>> covers_;  ///< covers other than 15
};

extern template class PartsDecoder<std::int32_t>;
extern template class PartsDecoder<std::int64_t>;

}  // namespace talus
