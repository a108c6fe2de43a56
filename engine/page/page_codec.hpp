#pragma once
// Pages as bytes. docs/format has the bytes; engine/dense, stored_errors, page_voids and number_coder code the parts.

#include <cstddef>
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

  /// decode(encode(page)) is the page, heights bit for bit, except heights that the page drops or that are void and not
  /// needed by a triangle. An error is implied only if the heights give exactly its code; other errors of a dense page
  /// are rounded up to eighths. The same page always has the same bytes.
  ///
  /// page      has heights and errors; not in the dense form
  /// distance  from height codes to metres, as in decode
  /// cost      about 8 ns a sample
  [[nodiscard]] std::vector<std::byte> encode(const Page& page, const CodeDistance& distance);

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

/// Decodes pages one after the other, reusing its memory.
class PageDecoder {
 public:
  PageDecoder();
  ~PageDecoder();
  PageDecoder(PageDecoder&&) noexcept;
  PageDecoder& operator=(PageDecoder&&) noexcept;

  /// The page, valid until the next call.
  ///
  /// fails  corrupt: bytes that cannot be a page of this id and extent. Memory never exceeds that of a page of
  ///        kPageSide² samples
  /// cost   a dense page about 1.2 ns a sample with AVX-512, 1.5 with AVX2, 4 without; others about 4 ns
  [[nodiscard]] const Page& decode(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                   std::span<const std::byte> bytes);
  /// The page without errors, unchecked. If heights were dropped, it has the errors that say which.
  [[nodiscard]] const Page& decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                           std::span<const std::byte> bytes);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace talus
