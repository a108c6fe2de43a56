#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/dense/kernels.hpp"
#include "engine/page/corner_numbers.hpp"
#include "engine/page/page_codec.hpp"
#include "engine/page/page_parts.hpp"
#include "engine/page/whole_bytes.hpp"

namespace talus {
namespace {

void put_head(const PageHead& head, const PageGrid& grid, std::vector<std::byte>& out) {
  put(out, kPageVersion);
  put(out, static_cast<std::uint8_t>(head.coding));
  put(out, static_cast<std::uint8_t>(head.flags));
  put(out, static_cast<std::uint8_t>(head.errors));
  put(out, static_cast<std::uint8_t>(grid.cols));
  put(out, static_cast<std::uint8_t>(grid.rows));
  put(out, static_cast<std::uint16_t>(head.width));
  put(out, static_cast<std::uint64_t>(head.base));
  put(out, static_cast<std::uint32_t>(head.height_bytes));
  put(out, static_cast<std::uint32_t>(head.error_bytes));
}

void put_children(const std::vector<ChildEntry>& children, NumberWriter& out) {
  const auto bits = [](float f) { return std::int64_t{std::bit_cast<std::int32_t>(f)}; };
  ChildEntry last;
  for (const ChildEntry& child : children) {
    out.put(child.present ? 1 : 0, kChildrenFrom);
    if (!child.present) continue;
    out.put(zigzag(std::int64_t{child.largest} - last.largest), kChildrenFrom + 1);
    out.put(zigzag(bits(child.lowest) - bits(last.lowest)), kChildrenFrom + 2);
    out.put(zigzag(bits(child.highest) - bits(last.highest)), kChildrenFrom + 3);
    out.put(zigzag(std::int64_t{child.generation} - last.generation), kChildrenFrom + 4);
    last = child;
  }
}

}  // namespace

struct PageEncoder::Scratch : PageWorkspace {
  std::vector<std::int64_t> numbers;  ///< of the page's grid, less the base
  std::vector<std::byte> heights, errors;
  NumberWriter out;
  DenseSquares dense;

  /// Copies the page as the reader has it when it reads errors.
  void begin(const Page& given) {
    page.id = given.id;
    page.bands = given.bands;
    page.grid = given.grid;
    page.valid = given.valid;
    page.heights = given.heights;
    page.eighths.clear();
    page.distances.clear();
    page.errors.assign(given.grid.size(), 0);
    out.clear();
    heights.clear();
    errors.clear();
  }

  /// Chooses coding, base and width, and leaves the numbers in `numbers`. Returns whether they are narrow.
  bool choose_numbers(const Page& given, PageHead& head);
  void put_voids_and_children(const Page& given, PageHead& head);
  void put_heights(const PageHead& head);
  template <class T>
  void put_square(std::vector<T>& square, DenseNumbers<T>& coder, bool corners_above);

  /// Whether the dense form has exactly the given errors; stored ones rounded up to eighths if errors count so.
  bool dense_errors_follow(const Page& given, const CodeDistance& distance);
  ErrorForm find_implied(const Page& given, const PageHead& head, bool is_narrow, const CodeDistance& distance);
  bool gives_errors_of(const Page& given, ErrorForm form, const CodeDistance& distance);
  [[nodiscard]] bool is_exact(const Page& given) const;
};

PageEncoder::PageEncoder() : scratch_(std::make_unique<Scratch>()) {}
PageEncoder::~PageEncoder() = default;
PageEncoder::PageEncoder(PageEncoder&&) noexcept = default;
PageEncoder& PageEncoder::operator=(PageEncoder&&) noexcept = default;

std::vector<std::byte> encode(const Page& page, const CodeDistance& distance) {
  return PageEncoder().encode(page, distance);
}

// ---- heights -----------------------------------------------------------------------------------------

bool PageEncoder::Scratch::choose_numbers(const Page& given, PageHead& head) {
  const std::size_t n = given.grid.size();
  head.coding = choose_coding(given.heights, needed);
  numbers.resize(n);
  numbers_of(given.heights, needed, head.coding, numbers);
  std::int64_t lowest = std::numeric_limits<std::int64_t>::max(), highest = std::numeric_limits<std::int64_t>::min();
  for (std::size_t i = 0; i < n; ++i) {
    if (!needed.empty() && needed[i] == 0) continue;
    lowest = std::min(lowest, numbers[i]);
    highest = std::max(highest, numbers[i]);
  }
  if (lowest > highest) lowest = highest = 0;
  const std::uint64_t span = static_cast<std::uint64_t>(highest) - static_cast<std::uint64_t>(lowest);
  head.width = span < 1u << 16 ? 2 : span < std::uint64_t{1} << 32 ? 4 : 8;
  head.base = static_cast<std::int64_t>(static_cast<std::uint64_t>(lowest) + span / 2 + (span & 1));
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_needed = needed.empty() || needed[i] != 0;
    numbers[i] =
        is_needed
            ? static_cast<std::int64_t>(static_cast<std::uint64_t>(numbers[i]) - static_cast<std::uint64_t>(head.base))
            : 0;
  }
  return span < kNarrow;
}

template <class T>
void PageEncoder::Scratch::put_square(std::vector<T>& square, DenseNumbers<T>& coder, bool corners_above) {
  const SquareBits* stored_in_square = stored_samples();
  square.assign(kSquare, 0);
  Placement(page.grid).into_square(numbers, square);
  if (stored_in_square != nullptr) {
    // Corners that are not stored have the numbers beside them, which cost the fewest bits.
    for (int row = 0; row < kPageSide; row += kChildrenAcross) {
      for (int col = 0; col < kPageSide; col += kChildrenAcross) {
        const auto at = static_cast<std::size_t>(row * kPageSide + col);
        if (talus::has(*stored_in_square, col, row) || at == 0) continue;
        square[at] = square[col > 0 ? at - kChildrenAcross : at - kChildrenAcross * kPageSide];
      }
    }
  }
  if (corners_above) {
    put(heights, check_of_corner_numbers(std::span<const T>(square)));
  } else {
    put_corner_numbers(std::span<const T>(square), heights);
  }
  coder.put(square, stored_in_square, heights);
}

void PageEncoder::Scratch::put_heights(const PageHead& head) {
  with_square(head.width, [&](auto& square, auto& coder) { put_square(square, coder, head.has(kCornersAbove)); });
}

void PageEncoder::Scratch::put_voids_and_children(const Page& given, PageHead& head) {
  const auto flag = [&](bool is_set, unsigned which) { head.flags |= is_set ? which : 0; };
  flag(!given.valid.empty(), kHasVoids);
  flag(!given.covers.empty(), kHasCovers);
  flag(!given.children.empty(), kHasChildren);
  if (!given.valid.empty()) put_voids(given.grid, given.valid, kVoidsFrom, out);
  if (!given.covers.empty()) {
    flag(put_covers(given.id, given.bands, given.grid, given.valid, given.covers, kCoversFrom, out),
         kInnerCoversFollow);
  }
  if (!given.children.empty()) put_children(given.children, out);
}

// ---- errors ------------------------------------------------------------------------------------------

bool PageEncoder::Scratch::gives_errors_of(const Page& given, ErrorForm form, const CodeDistance& distance) {
  errors_of.imply(form, whole_square, page);
  for (std::size_t i = 0; i < given.errors.size(); ++i) {
    if (!page.has_distance(i)) continue;
    // The same as error_code(metres) == code, without the search.
    const double metres = distance.metres(page.distance_of(i));
    const ErrorCode code = given.errors[i];
    if (!(metres <= error_of(code)) || (code > 0 && metres <= error_of(static_cast<ErrorCode>(code - 1)))) return false;
  }
  return true;
}

/// Call it when page.eighths has the implied errors.
bool PageEncoder::Scratch::dense_errors_follow(const Page& given, const CodeDistance& distance) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int16_t>::max();
  std::transform(narrow_square.begin(), narrow_square.end(), dense.numbers,
                 [](std::uint16_t v) { return static_cast<std::int16_t>(v); });
  detail::eighths_kernel(instruction_set()).compute(dense.numbers, dense.errors, heights_in_eighths);
  bool all_follow = true;
  for_each_sample(given.grid, [&](std::size_t i, GridPoint p) {
    if (!given.is_own(p)) return;
    const auto at = static_cast<std::int32_t>(page.in_square(i));
    std::int16_t& error = dense.errors.numbers[detail::SortedSquare::index_of(at % kPageSide, at / kPageSide)];
    if (page.has_distance(i)) {
      all_follow = all_follow && error == page.eighths[i];
    } else if (!distance.is_whole()) {
      error = coded(given.errors[i]);
    } else {
      const std::int32_t stored_error = distance.eighths(error_of(given.errors[i]));
      all_follow = all_follow && stored_error <= kMost;
      error = static_cast<std::int16_t>(std::min(stored_error, kMost));
    }
  });
  return all_follow;
}

bool PageEncoder::Scratch::is_exact(const Page& given) const {
  BitRange bits;
  for (std::size_t i = 0; i < given.heights.size(); ++i) {
    if (needed.empty() || needed[i] != 0) bits.take(given.heights[i]);
  }
  return bits.interpolates_exactly(kChildrenAcross);
}

/// The first form that gives every error exactly as ingest computed it.
ErrorForm PageEncoder::Scratch::find_implied(const Page& given, const PageHead& head, bool is_narrow,
                                             const CodeDistance& distance) {
  const auto fits = [&](ErrorForm form) { return gives_errors_of(given, form, distance); };
  if (given.id.band == 0 && !given.heights.empty()) {
    if (head.coding == Coding::whole && is_narrow) {
      copy_whole(head.width);
      if (fits(ErrorForm::whole)) {
        const bool may_be_dense = head.width == 2 && std::abs(head.base) <= kLargestDenseBase;
        if (!may_be_dense || !dense_errors_follow(given, distance)) return ErrorForm::whole;
        return distance.is_whole() ? ErrorForm::dense : ErrorForm::dense_and_codes;
      }
    } else if (is_exact(given) && fits(ErrorForm::exact)) {
      return ErrorForm::exact;
    }
    if (fits(ErrorForm::finest)) return ErrorForm::finest;
  }
  errors_of.imply(ErrorForm::none, whole_square, page);
  return ErrorForm::none;
}

// ---- the page ----------------------------------------------------------------------------------------

std::vector<std::byte> PageEncoder::encode(const Page& page, const CodeDistance& distance, bool above) {
  assert(!above || page.id.band == 0);
  Scratch& s = *scratch_;
  s.mark_needed(page);
  PageHead head;
  head.flags = above ? unsigned{kCornersAbove} : 0;
  const bool is_narrow = s.choose_numbers(page, head);
  s.begin(page);
  s.put_voids_and_children(page, head);
  s.put_heights(head);
  head.errors = s.find_implied(page, head, is_narrow, distance);
  s.stored.list(s.page, head.errors);
  if (head.errors >= ErrorForm::dense) {
    s.stored.put(s.dense, s.eighths_as_codes.in(distance), s.errors);
  } else {
    s.stored.put(page.errors, s.page, distance, s.errors);
  }
  head.height_bytes = s.heights.size();
  head.error_bytes = s.errors.size();
  std::vector<std::byte> bytes;
  bytes.reserve(kPageHead + head.height_bytes + head.error_bytes + page.grid.size() / 8);
  put_head(head, page.grid, bytes);
  bytes.insert(bytes.end(), s.heights.begin(), s.heights.end());
  bytes.insert(bytes.end(), s.errors.begin(), s.errors.end());
  if (head.has_numbers()) s.out.finish(bytes);
  return bytes;
}

std::vector<std::byte> PageEncoder::encode_in_slice(const Page& page, std::uint64_t digest) {
  Scratch& s = *scratch_;
  PageHead head;
  head.flags = kInSlice;
  head.base = static_cast<std::int64_t>(digest);
  s.out.clear();
  s.put_voids_and_children(page, head);
  std::vector<std::byte> bytes;
  put_head(head, page.grid, bytes);
  if (head.has_numbers()) s.out.finish(bytes);
  return bytes;
}

PageEncoder::Parts PageEncoder::parts() const {
  const Scratch& s = *scratch_;
  const auto bits = [](const std::vector<std::byte>& bytes) { return 8 * static_cast<double>(bytes.size()); };
  return {bits(s.heights), bits(s.errors), s.out.bits(kVoidsFrom, kChildrenFrom), s.out.bits(kChildrenFrom, kContexts)};
}

}  // namespace talus
