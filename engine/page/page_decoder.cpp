#include <bit>
#include <cmath>

#include "engine/dense/kernels.hpp"
#include "engine/machine/fail.hpp"
#include "engine/page/corner_numbers.hpp"
#include "engine/page/digest.hpp"
#include "engine/page/page_codec.hpp"
#include "engine/page/page_parts.hpp"
#include "engine/page/tile_slice.hpp"
#include "engine/page/whole_bytes.hpp"
#include "engine/quadtree/border.hpp"

namespace talus {
namespace {

constexpr const char* kWrongErrors = "its errors have too few or too many bits, or one is larger than any possible one";

std::int64_t plus(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

bool get_children(std::vector<ChildEntry>& children, NumberReader& in) {
  const auto added = [&](float to, int context) {
    const std::int64_t bits = plus(std::bit_cast<std::int32_t>(to), unzigzag(in.get(context)));
    return std::bit_cast<float>(static_cast<std::int32_t>(bits));
  };
  children.assign(kChildrenOfPage, {});
  ChildEntry last;
  bool possible = true;
  for (ChildEntry& child : children) {
    const std::uint64_t present = in.get(kChildrenFrom);
    possible = possible && present <= 1;
    if (present != 1) continue;
    const std::int64_t largest = plus(last.largest, unzigzag(in.get(kChildrenFrom + 1)));
    possible = possible && largest >= 0 && largest <= kAlwaysSelected;
    child = {true, static_cast<ErrorCode>(possible ? largest : 0), added(last.lowest, kChildrenFrom + 2),
             added(last.highest, kChildrenFrom + 3),
             static_cast<std::uint32_t>(plus(last.generation, unzigzag(in.get(kChildrenFrom + 4))))};
    last = child;
  }
  return possible;
}

}  // namespace

/// Heights of the last page of band 1, by the places of its square.
struct HeightsAbove {
  PageId id{-1, 0, 0};
  std::vector<double> heights = std::vector<double>(kSquare);
  SquareBits known{};  ///< data

  void take(const Page& page) {
    id = page.id;
    known = data_samples(page);
    Placement(page.grid).into_square(page.heights, heights);
  }
};

/// The last slice.
struct SliceInHand {
  SliceCoder coder;
  TileId tile;
  std::uint64_t digest = 0;
  const TileSlice* slice = nullptr;  ///< null: none
};

struct PageDecoder::Scratch : PageWorkspace {
  HeightsAbove above;
  std::optional<SliceInHand> slice_in_hand;
  bool is_decoded = false;  ///< the page, and `above` has not taken it yet
  bool corners_differ = false;
  NumberReader in;
  PageHead head;
  std::span<const std::byte> height_bytes, error_bytes;

  [[noreturn]] void corrupt(const char* what) const {
    fail(Cause::corrupt, "corrupt: page {}/{} of band {}: {}", page.id.x, page.id.y, page.id.band, what);
  }

  void begin(PageId id, GridRect extent, int bands);
  void get_head(std::span<const std::byte> bytes, const CodeDistance& distance);
  /// Everything except errors that follow from heights or are stored after them.
  void get_most(GridRect extent, const CodeDistance& distance, const BytesOf& other);
  void get_heights();
  void get_from_slice(GridRect extent, const CodeDistance& distance, const BytesOf& other);
  template <class T>
  void get_square(std::span<T> square, DenseNumbers<T>& coder);
  /// Takes the corners of a page of band 0 from the page above. Returns the bytes that were read; 0: it is another page.
  template <class T>
  std::size_t take_corner_numbers(std::span<T> square);
  void decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                      std::span<const std::byte> bytes, const BytesOf& other);
  /// Reads the page above for its heights.
  void read_above(PageId id, GridRect extent, int bands, const CodeDistance& distance, const BytesOf& other);
  template <class T>
  void heights_of(const std::vector<T>& square);
  void get_dense_errors(const CodeDistance& distance);
  void get_other_errors(const CodeDistance& distance);
};

PageDecoder::PageDecoder() : scratch_(std::make_unique<Scratch>()) {}
PageDecoder::~PageDecoder() = default;
PageDecoder::PageDecoder(PageDecoder&&) noexcept = default;
PageDecoder& PageDecoder::operator=(PageDecoder&&) noexcept = default;

void PageDecoder::Scratch::begin(PageId id, GridRect extent, int bands) {
  page.id = id;
  page.bands = bands;
  page.grid = page_grid(id, extent);
  page.is_dense = false;
  page.in_slice.clear();
  page.heights.clear();
  page.errors.clear();
  page.coded.clear();
  page.eighths.clear();
  page.distances.clear();
  page.valid.clear();
  page.covers.clear();
  page.children.clear();
}

void PageDecoder::Scratch::get_head(std::span<const std::byte> bytes, const CodeDistance& distance) {
  if (bytes.size() < kPageHead) corrupt("it ends too early");
  const auto byte = [&](std::size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  if (byte(0) != kPageVersion) corrupt("its version is unknown");
  if (byte(1) >= kCodings) corrupt("its coding of heights is unknown");
  head.coding = static_cast<Coding>(byte(1));
  head.flags = byte(2);
  if ((head.flags & ~unsigned{kAllPageFlags}) != 0 ||
      ((head.has(kHasVoids) || head.has(kInnerCoversFollow)) && !head.has(kHasCovers)))
    corrupt("its flags contradict each other");
  if (head.has(kHasChildren) != (page.id.band > 0)) corrupt("child entries are missing, or a page of band 0 has some");
  if (head.has(kCornersAbove) && (page.id.band > 0 || head.has(kInSlice)))
    corrupt("its heights cannot be those of the page above");
  if (head.has(kInSlice) && (page.id.band > 1 || page.id.band == page.bands - 1 || distance.is_whole()))
    corrupt("it cannot be in a slice");
  head.width = static_cast<unsigned>(whole_at(bytes, 6, 2));
  if (head.width != 2 && head.width != 4 && head.width != 8) corrupt("its numbers have an unknown width");
  head.base = static_cast<std::int64_t>(whole_at(bytes, 8, 8));
  const bool is_implied = byte(3) != 0, is_of_whole = byte(3) == 2 || byte(3) >= 4;
  head.errors = static_cast<ErrorForm>(byte(3));
  if (byte(3) > 5 || (is_implied && (page.id.band > 0 || page.grid.size() == 0 || head.has(kInSlice))) ||
      (is_of_whole && (head.coding != Coding::whole || head.width > 4)) ||
      (byte(3) >= 4 && (distance.is_whole() != (head.errors == ErrorForm::dense) || head.width != 2 ||
                        head.base > kLargestDenseBase || head.base < -kLargestDenseBase)))
    corrupt("its form of errors is impossible");
  if (byte(4) != static_cast<unsigned>(page.grid.cols) || byte(5) != static_cast<unsigned>(page.grid.rows))
    corrupt("its size does not match the extent");
  head.height_bytes = whole_at(bytes, 16, 4);
  head.error_bytes = whole_at(bytes, 20, 4);
  const std::size_t rest = bytes.size() - kPageHead;
  if (head.height_bytes > rest || head.error_bytes > rest - head.height_bytes) corrupt("it is shorter than its parts");
  if (head.has(kInSlice) &&
      (head.coding != Coding::whole || head.width != 2 || head.height_bytes + head.error_bytes > 0))
    corrupt("it is in a slice, but has heights or errors");
  height_bytes = bytes.subspan(kPageHead, head.height_bytes);
  error_bytes = bytes.subspan(kPageHead + head.height_bytes, head.error_bytes);
  const auto numbers = bytes.subspan(kPageHead + head.height_bytes + head.error_bytes);
  if (!head.has_numbers() && !numbers.empty()) corrupt("bytes follow it");
  if (head.has_numbers()) in.start(numbers);
}

void PageDecoder::Scratch::get_most(GridRect extent, const CodeDistance& distance, const BytesOf& other) {
  const std::size_t n = page.grid.size();
  page.is_dense = head.errors >= ErrorForm::dense;
  page.base = head.base;
  if (head.has(kHasVoids)) {
    page.valid.resize(n);
    get_voids(page.grid, page.valid, kVoidsFrom, in);
  }
  if (head.has(kHasCovers)) {
    page.covers.resize(n);
    if (!get_covers(page.id, page.bands, page.grid, page.valid, head.has(kInnerCoversFollow), page.covers, kCoversFrom,
                    in))
      corrupt("the triangles around a vertex are impossible");
  }
  if (head.has(kHasChildren) && !get_children(page.children, in)) corrupt("its child entries are wrong");
  mark_needed(page);
  head.has(kInSlice) ? get_from_slice(extent, distance, other) : get_heights();
}

void PageDecoder::Scratch::get_from_slice(GridRect extent, const CodeDistance& distance, const BytesOf& other) {
  if (!slice_in_hand) slice_in_hand.emplace();
  SliceInHand& from = *slice_in_hand;
  const TileId tile = tile_with(page.id);
  const auto digest = static_cast<std::uint64_t>(head.base);
  if (from.slice == nullptr || !(from.tile == tile) || from.digest != digest) {
    from.slice = nullptr;
    const auto bytes = other ? other({1, tile.x, tile.y}, Content::slice) : std::span<const std::byte>();
    if (bytes.empty()) corrupt("the slice of its tile is missing");
    if (digest_of(bytes) != digest) corrupt("it was written beside another slice");
    const TileSlice& slice = from.coder.decode(tile, extent, distance, bytes);
    if (slice.above == kNoSlice) corrupt("the slice of its tile holds nothing");
    from.tile = tile, from.digest = digest, from.slice = &slice;
  }
  const TileSlice& slice = *from.slice;
  page.heights.assign(page.grid.size(), 0);
  page.errors.assign(page.grid.size(), 0);
  page.in_slice.assign(1, SquareBits{});
  for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
    const std::uint32_t place = place_in_tile(p);
    if (spacing(p) >= kBlockSide) {
      page.heights[i] = slice.posts[place / kTileSide / kBlockSide * kTileBlocks + place % kTileSide / kBlockSide];
    } else if (from.coder.has(place)) {
      page.heights[i] = from.coder.height_at(place);
      const std::int32_t error = from.coder.error_at(place);
      if (page.is_own(p) && error > slice.above) page.errors[i] = static_cast<ErrorCode>(error);
    } else {
      const bool is_needed = needed.empty() || needed[i] != 0;
      if (is_needed && page.is_own(p) && is_near_border(p, extent)) corrupt("a height near the border is missing");
      return;
    }
    insert(page.in_slice.front(), page.in_square(i));
  });
}

template <class T>
std::size_t PageDecoder::Scratch::take_corner_numbers(std::span<T> square) {
  const auto col_above = static_cast<std::size_t>(page.id.x & (kChildrenAcross - 1)) * kCornersAcross;
  const auto row_above = static_cast<std::size_t>(page.id.y & (kChildrenAcross - 1)) * kCornersAcross;
  const SquareBits data = data_samples(page);
  std::array<double, kCornersAcross * kCornersAcross> heights{};
  std::array<std::int64_t, heights.size()> numbers{};
  std::array<std::uint8_t, heights.size()> known{};
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const std::size_t col = i % kCornersAcross, row = i / kCornersAcross;
    const std::size_t at = (row_above + row) * kPageSide + col_above + col;
    const bool is_data = has(data, static_cast<int>(col * kChildrenAcross), static_cast<int>(row * kChildrenAcross));
    known[i] = is_data && has(above.known, at) ? 1 : 0;
    heights[i] = above.heights[at];
  }
  numbers_of(heights, known, head.coding, numbers);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const std::size_t at = (i / kCornersAcross * kPageSide + i % kCornersAcross) * kChildrenAcross;
    if (known[i] != 0) {
      square[at] = static_cast<T>(static_cast<std::uint64_t>(numbers[i]) - static_cast<std::uint64_t>(head.base));
    } else {  // the number beside it
      square[at] = i == 0                    ? T{0}
                   : i % kCornersAcross == 0 ? square[at - kChildrenAcross * kPageSide]
                                             : square[at - kChildrenAcross];
    }
  }
  if (height_bytes.size() < kCornerCheckBytes) return 0;
  const bool is_right =
      whole_at(height_bytes, 0, kCornerCheckBytes) == check_of_corner_numbers(std::span<const T>(square));
  return is_right ? kCornerCheckBytes : 0;
}

template <class T>
void PageDecoder::Scratch::get_square(std::span<T> square, DenseNumbers<T>& coder) {
  const bool are_above = head.has(kCornersAbove);
  const std::size_t corners = are_above ? take_corner_numbers(square) : get_corner_numbers(height_bytes, square);
  corners_differ = are_above && corners == 0;
  if (corners_differ) return;
  if (corners == 0 || !coder.get(height_bytes.subspan(corners), stored_samples(), square))
    corrupt("its heights have too few or too many bits");
}

template <class T>
void PageDecoder::Scratch::heights_of(const std::vector<T>& square) {
  page.heights.resize(page.grid.size());
  using Wide = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
  std::array<Wide, kPageSide> row;
  const auto cols = static_cast<std::size_t>(page.grid.cols);
  Placement(page.grid).for_each_row([&](std::size_t here, std::size_t there) {
    std::transform(square.data() + there, square.data() + there + cols, row.begin(),
                   [](T v) { return static_cast<Wide>(static_cast<std::make_signed_t<T>>(v)); });
    talus::heights_of(head.base, std::span<const Wide>(row.data(), cols), head.coding, page.heights.data() + here);
  });
  if (head.coding < Coding::float_bits) return;
  for (std::size_t i = 0; i < page.heights.size(); ++i) {
    if (std::isfinite(page.heights[i])) continue;
    if (needed.empty() || needed[i] != 0) corrupt("a height is not a finite number");
    page.heights[i] = 0;  // a void that nothing needs, predicted from bits of both signs
  }
}

void PageDecoder::Scratch::get_heights() {
  if (page.is_dense) {
    page.squares.resize(1);
    // Signed and unsigned numbers of one width may share memory.
    auto* numbers = reinterpret_cast<std::uint16_t*>(page.squares.front().numbers);
    return get_square(std::span(numbers, kSquare), of_narrow());
  }
  with_square(head.width, [&](auto& square, auto& coder) {
    get_square(std::span(square), coder);
    heights_of(square);
  });
}

void PageDecoder::Scratch::get_dense_errors(const CodeDistance& distance) {
  DenseSquares& squares = page.squares.front();
  detail::eighths_kernel(instruction_set()).compute(squares.numbers, squares.errors, heights_in_eighths);
  const CodesOfEighths codes = eighths_as_codes.in(distance);
  stored.list(page, head.errors);
  if (!stored.get(error_bytes, squares, codes)) corrupt(kWrongErrors);
  if (codes != nullptr) stored.places(page.coded);
}

void PageDecoder::Scratch::get_other_errors(const CodeDistance& distance) {
  if (head.errors == ErrorForm::whole) copy_whole(head.width);
  errors_of.imply(head.errors, whole_square, page);
  if (page.is_sliced()) return;
  page.errors.assign(page.grid.size(), 0);
  stored.list(page, head.errors);
  if (!stored.get(error_bytes, page, distance)) corrupt(kWrongErrors);
}

void PageDecoder::Scratch::decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                          std::span<const std::byte> bytes, const BytesOf& other) {
  begin(id, extent, bands);
  get_head(bytes, distance);
  get_most(extent, distance, other);
}

void PageDecoder::Scratch::read_above(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                      const BytesOf& other) {
  const PageId parent = parent_page(id);
  const std::span<const std::byte> bytes = other ? other(parent, Content::page) : std::span<const std::byte>();
  page.id = id;
  if (bytes.empty()) corrupt("the page above it is missing");
  decode_heights(parent, extent, bands, distance, bytes, {});
  if (page.is_sliced()) corrupt("the page above it has no heights of its own");
  above.take(page);
}

const Page& PageDecoder::decode_heights(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                        std::span<const std::byte> bytes, const BytesOf& other) {
  Scratch& s = *scratch_;
  const bool needs_above = bytes.size() >= kPageHead && (std::to_integer<unsigned>(bytes[2]) & kCornersAbove) != 0;
  if (needs_above && id.band == 0) {
    const PageId parent = parent_page(id);
    const bool was_last = s.is_decoded && s.page.id == parent;
    if (was_last) s.above.take(s.page);
    s.is_decoded = false;
    if (!(s.above.id == parent)) s.read_above(id, extent, bands, distance, other);
    s.decode_heights(id, extent, bands, distance, bytes, other);
    if (s.corners_differ) {  // perhaps it was the page above in another snapshot
      s.read_above(id, extent, bands, distance, other);
      s.decode_heights(id, extent, bands, distance, bytes, other);
    }
    if (s.corners_differ) s.corrupt("it was written beside another page above it");
    return s.page;
  }
  s.is_decoded = false;
  s.decode_heights(id, extent, bands, distance, bytes, other);
  s.is_decoded = true;
  return s.page;
}

const Page& PageDecoder::decode(PageId id, GridRect extent, int bands, const CodeDistance& distance,
                                std::span<const std::byte> bytes, const BytesOf& other) {
  Scratch& s = *scratch_;
  static_cast<void>(decode_heights(id, extent, bands, distance, bytes, other));
  s.page.is_dense ? s.get_dense_errors(distance) : s.get_other_errors(distance);
  if (s.head.has_numbers() && !s.in.is_intact()) s.corrupt("it has too few or too many bits");
  return s.page;
}

}  // namespace talus
