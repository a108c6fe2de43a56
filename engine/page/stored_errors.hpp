#pragma once
// Errors of a page that do not follow from its heights, as bytes.
//
// A saturated error is at least that of each of its children and, beside data, the distance of the vertex from the
// middle of its ends. Many stored errors are exactly the largest of these. What they are more is a Rice code; side
// midpoints and centres of each spacing have their own parameter, and perhaps a flag a vertex that says whether it is
// more at all (docs/format/v3.md, 7.2). No vertex waits for another one of its spacing and kind.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/dense/square_bits.hpp"
#include "engine/page/page.hpp"

namespace talus {

/// How a page has its errors: which are implied, in which arithmetic, and what the others are.
enum class ErrorForm : std::uint8_t { none = 0, finest = 1, whole = 2, exact = 3, dense = 4, dense_and_codes = 5 };

/// The vertices of pages whose errors are stored, and their bytes.
class StoredErrors {
 public:
  StoredErrors();
  ~StoredErrors();
  StoredErrors(StoredErrors&&) noexcept;
  StoredErrors& operator=(StoredErrors&&) noexcept;

  /// Lists the vertices of a page in this form. The page has its grid and voids. Other calls are for this page.
  void list(const Page& page, ErrorForm form);
  /// Where their heights are: in the square of a dense page, in the grid of another one.
  void places(std::vector<std::uint16_t>& found) const;

  /// Appends the errors `all` to `out`, and copies them to the page, which is as get() expects it.
  void put(const std::vector<ErrorCode>& all, Page& page, const CodeDistance& distance, std::vector<std::byte>& out);
  /// The same for a dense page: the errors are in the square, as eighths or as coded(code).
  void put(DenseSquares& squares, CodesOfEighths codes, std::vector<std::byte>& out);

  /// Reads what put() wrote.
  ///
  /// page     has the heights, and the errors that follow from them; codes are 0
  /// returns  whether these are such bytes, and all of them
  [[nodiscard]] bool get(std::span<const std::byte> bytes, Page& page, const CodeDistance& distance) const;
  [[nodiscard]] bool get(std::span<const std::byte> bytes, DenseSquares& squares, CodesOfEighths codes) const;

 private:
  struct Lists;
  std::unique_ptr<Lists> lists_;
};

}  // namespace talus
