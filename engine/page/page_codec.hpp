#pragma once
// Pages as bytes. docs/format has the bytes; engine/dense, stored_errors, page_voids and number_coder code the parts.

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/page/page.hpp"

namespace talus {

/// Encodes pages one after the other, reusing its memory.
class PageEncoder {
 public:
  PageEncoder();
  ~PageEncoder();
  PageEncoder(PageEncoder&&) noexcept;
  PageEncoder& operator=(PageEncoder&&) noexcept;

  /// decode(encode(page)) is the page, heights bit for bit, except heights that are void and not needed by a triangle. An
  /// error is implied only if the heights give exactly its code; other errors of a dense page are rounded up to eighths.
  /// The same page always has the same bytes.
  ///
  /// page      has heights and errors; not in the dense form
  /// above     whether the reader has the page above it, a page of band 1 with all its heights. Then those that both have
  ///           are not stored again. Only for pages of band 0
  /// distance  from height codes to metres, as in decode
  /// cost      about 8 ns a sample
  [[nodiscard]] std::vector<std::byte> encode(const Page& page, const CodeDistance& distance, bool above = false);
  /// A page of band 0 or 1 without its heights and errors: they are those of its tile's slice, which has this digest.
  [[nodiscard]] std::vector<std::byte> encode_in_slice(const Page& page, std::uint64_t digest);

  /// Approximate sizes of the parts of the last page in bits. For measurements.
  struct Parts {
    double heights = 0, errors = 0, voids = 0, children = 0;
  };
  [[nodiscard]] Parts parts() const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

/// The same for a single page.
[[nodiscard]] std::vector<std::byte> encode(const Page& page, const CodeDistance& distance);

/// Decodes pages one after the other, reusing its memory. Most pages of band 0 need heights of the page above, and pages in
/// a slice need that: the decoder keeps the heights of the last page of band 1, and the last slice.
class PageDecoder {
 public:
  PageDecoder();
  ~PageDecoder();
  PageDecoder(PageDecoder&&) noexcept;
  PageDecoder& operator=(PageDecoder&&) noexcept;

  enum class Content { page, slice };
  /// The bytes of a page, or of the slice of the tile of a page of band 1; empty: there is none.
  using BytesOf = std::function<std::span<const std::byte>(PageId, Content)>;

  /// The page, valid until the next call.
  ///
  /// other  called for the page above or the slice, if that is needed and another one was the last
  /// fails  corrupt: bytes that cannot be a page of this id and extent. Memory never exceeds that of a page of
  ///        kPageSide² samples
  /// cost   a dense page about 1.2 ns a sample with AVX-512, 1.5 with AVX2, 4 without; others about 4 ns
  [[nodiscard]] const Page& decode(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                   std::span<const std::byte> bytes, const BytesOf& other = {});
  /// The page without errors, unchecked.
  [[nodiscard]] const Page& decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                           std::span<const std::byte> bytes, const BytesOf& other = {});

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace talus
