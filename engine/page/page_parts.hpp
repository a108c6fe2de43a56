#pragma once
// What writing and reading a page share: its head, its numbers, and the errors that follow from them.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "engine/dense/dense_numbers.hpp"
#include "engine/page/number_coder.hpp"
#include "engine/page/page.hpp"
#include "engine/page/page_errors.hpp"
#include "engine/page/page_numbers.hpp"
#include "engine/page/page_voids.hpp"
#include "engine/page/stored_errors.hpp"

namespace talus {

inline constexpr std::uint8_t kPageVersion = 3;
inline constexpr std::size_t kPageHead = 24;
inline constexpr std::size_t kChildrenOfPage = static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross;

enum PageFlag : std::uint8_t {
  kHasVoids = 1,
  kHasCovers = 2,
  kHasChildren = 4,
  kInnerCoversFollow = 8,
  kInSlice = 16,
  kCornersAbove = 32,
  kAllPageFlags = 63
};

/// The first bytes of a page.
struct PageHead {
  Coding coding = Coding::whole;
  unsigned flags = 0;
  ErrorForm errors = ErrorForm::none;
  unsigned width = 2;                             ///< bytes of a number: 2, 4 or 8
  std::int64_t base = 0;                          ///< of a page in a slice: the digest of that
  std::size_t height_bytes = 0, error_bytes = 0;  ///< of the parts after the head

  [[nodiscard]] bool has(PageFlag flag) const { return (flags & flag) != 0; }
  /// Whether a sequence of numbers follows.
  [[nodiscard]] bool has_numbers() const { return (flags & (kHasVoids | kHasCovers | kHasChildren)) != 0; }
};

// Contexts of the parts of a page in its sequence of numbers.
inline constexpr int kVoidsFrom = 0, kCoversFrom = kVoidsFrom + kVoidContexts,
                     kChildrenFrom = kCoversFrom + kCoverContexts;
static_assert(kChildrenFrom + 5 <= kContexts);

/// Of corner numbers that are not stored. They are the heights of the page above, and the check says whether it was that
/// page.
inline constexpr std::size_t kCornerCheckBytes = 4;

/// Numbers closer to the base than this: distances and slopes fit in 32 bits in eighths.
inline constexpr std::int64_t kNarrow = 1 << 24;

/// Doubles hold the sum of such a base and a number of 16 bits.
inline constexpr std::int64_t kLargestDenseBase = std::int64_t{1} << 51;

/// The position of a page's samples in its square.
struct Placement {
  explicit Placement(const PageGrid& grid)
      : cols(grid.cols),
        rows(grid.rows),
        col(grid.first.col & (kPageSide - 1)),
        row(grid.first.row & (kPageSide - 1)) {}
  std::int32_t cols, rows, col, row;
  [[nodiscard]] PresentRect present() const { return {col, col + cols, row, row + rows}; }
  /// visit(first sample of a row in the page's grid, the same in the square)
  template <class Visit>
  void for_each_row(Visit&& visit) const {
    for (std::int32_t r = 0; r < rows; ++r)
      visit(static_cast<std::size_t>(r) * static_cast<std::size_t>(cols),
            static_cast<std::size_t>((row + r) * kPageSide + col));
  }

  template <class From, class To>
  void into_square(const std::vector<From>& grid, std::vector<To>& square) const {
    for_each_row([&](std::size_t here, std::size_t there) {
      std::transform(grid.data() + here, grid.data() + here + cols, square.data() + there,
                     [](From v) { return static_cast<To>(v); });
    });
  }
  template <class T>
  void from_square(const std::vector<T>& square, std::vector<T>& grid) const {
    grid.resize(static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows));
    for_each_row([&](std::size_t here, std::size_t there) {
      std::copy(square.data() + there, square.data() + there + cols, grid.data() + here);
    });
  }
};

/// Errors that follow from heights, of a page that is not dense.
struct ErrorsOfHeights {
  std::optional<ImpliedErrors<std::int32_t>> whole;
  std::optional<ImpliedErrors<double>> exact;
  std::vector<double> square, distances;
  std::vector<std::int32_t> eighths;
  std::vector<std::uint8_t> valid;

  /// Fills page.eighths or page.distances, as the form says. `narrow`: for whole numbers, the numbers of the square.
  void imply(ErrorForm form, const std::vector<std::int32_t>& narrow, Page& page);
};

/// The codes of errors in eighths, in databases whose errors count as codes.
class EighthsAsCodes {
 public:
  /// Null if errors count in eighths. Valid until the next call.
  [[nodiscard]] CodesOfEighths in(const CodeDistance& distance);

 private:
  std::unique_ptr<std::remove_pointer_t<CodesOfEighths>> codes_;
  CodeDistance distance_;
};

/// What writing and reading both work in.
struct PageWorkspace {
  Page page;  ///< for writing: as the reader will have it
  std::vector<std::uint8_t> needed;
  SquareBits stored_bits{};
  std::vector<std::uint16_t> narrow_square;
  std::vector<std::uint32_t> wide_square;
  std::vector<std::uint64_t> widest_square;
  std::optional<DenseNumbers<std::uint16_t>> narrow_numbers;
  std::optional<DenseNumbers<std::uint32_t>> wide_numbers;
  std::optional<DenseNumbers<std::uint64_t>> widest_numbers;
  std::vector<std::int32_t> whole_square;  ///< for errors of whole numbers
  ErrorsOfHeights errors_of;
  StoredErrors stored;
  EighthsAsCodes eighths_as_codes;
  detail::SortedSquare heights_in_eighths;

  /// Marks in `needed` the samples whose heights are stored: valid ones, and corners of triangles with data. Empty: all.
  void mark_needed(const Page& of);
  /// The same in the square; null: all.
  [[nodiscard]] const SquareBits* stored_samples();
  /// visit(square, coder) with those of numbers of `width` bytes.
  template <class Visit>
  auto with_square(unsigned width, Visit&& visit) {
    if (width == 2) {
      narrow_square.resize(kSquare);
      return visit(narrow_square, of_narrow());
    }
    if (width == 4) {
      wide_square.resize(kSquare);
      if (!wide_numbers) wide_numbers.emplace();
      return visit(wide_square, *wide_numbers);
    }
    widest_square.resize(kSquare);
    if (!widest_numbers) widest_numbers.emplace();
    return visit(widest_square, *widest_numbers);
  }
  [[nodiscard]] DenseNumbers<std::uint16_t>& of_narrow() {
    if (!narrow_numbers) narrow_numbers.emplace();
    return *narrow_numbers;
  }
  /// Copies numbers of at most 4 bytes to whole_square.
  void copy_whole(unsigned width);
};

}  // namespace talus
