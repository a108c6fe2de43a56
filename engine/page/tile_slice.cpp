#include "engine/page/tile_slice.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "engine/machine/fail.hpp"
#include "engine/page/page_numbers.hpp"
#include "engine/page/whole_bytes.hpp"

namespace talus {
namespace {

constexpr std::uint8_t kVersion = 3;
constexpr std::size_t kHead = 20, kShortest = 8;
/// Numbers are within this of the base.
constexpr std::int64_t kMostNumber = (std::int64_t{1} << 31) - 1;
constexpr int kMostShift = 40;  ///< more than any bend has bits
enum Flag : std::uint8_t { kHasCovers = 1, kErrorsMayBeLess = 2, kSomeAreNotAbove = 4, kAllFlags = 7 };

constexpr int kWords = kTileSide / 64;
constexpr std::size_t kPlaces = static_cast<std::size_t>(kTileSide) * kTileSide;
constexpr int kLevels = kTileLevels, kClasses = 5, kSources = 3;
constexpr int kErrorLevels = kBandLevels + 1;  ///< spacings 1, 2, 4, and those of band 1

// Contexts of numbers.
constexpr int kOfPosts = 0, kOfHeights = 1, kOfErrors = kOfHeights + 2 * kLevels * kClasses,
              kOfEighths = kOfErrors + 2 * kErrorLevels * kSources, kOfCovers = kOfEighths + kErrorLevels,
              kOfAbove = kOfCovers + 2;
static_assert(kOfAbove < kContexts);

std::vector<std::byte> head_of(std::int32_t above) {
  std::vector<std::byte> bytes;
  put(bytes, kVersion);
  put(bytes, std::uint8_t{0});
  put(bytes, std::uint16_t{0});
  put(bytes, static_cast<std::uint32_t>(above));
  return bytes;
}

/// A grid point whose parents are vertices of the slice.
struct Candidate {
  std::uint32_t place;
  std::uint8_t level;                ///< log2 of the spacing
  bool is_side;                      ///< a side midpoint, not a centre
  std::uint32_t ends[2], apexes[2];  ///< places of the diamond's corners
  bool has_end[2], has_apex[2];      ///< they are vertices, or have spacing 64 and more
};

/// The row of bits, with bit c at column c + by, or c − by; columns from beyond the tile are 1.
void shift_east(const std::uint64_t* row, int by, std::uint64_t* to) {
  for (int w = 0; w < kWords; ++w) to[w] = row[w] << by | (w > 0 ? row[w - 1] : ~std::uint64_t{0}) >> (64 - by);
}
void shift_west(const std::uint64_t* row, int by, std::uint64_t* to) {
  for (int w = 0; w < kWords; ++w)
    to[w] = row[w] >> by | (w + 1 < kWords ? row[w + 1] : ~std::uint64_t{0}) << (64 - by);
}

/// Which columns are first, first + step … in a row; step is at most 128.
void columns(int first, int step, std::uint64_t* to) {
  to[0] = to[1] = 0;
  for (int c = first; c < 128; c += step) to[c / 64] |= std::uint64_t{1} << (c % 64);
  for (int w = 2; w < kWords; ++w) to[w] = to[w - 2];
}

/// The vertices of a slice as a set, which grows level by level.
class Vertices {
 public:
  void begin(TileId id, GridRect extent) {
    const GridPoint corner{id.x * kTileSide, id.y * kTileSide};
    const GridRect part = common({corner, {corner.col + kTileSide - 1, corner.row + kTileSide - 1}}, extent);
    first_ = {part.first.col - corner.col, part.first.row - corner.row};
    last_ = {part.last.col - corner.col, part.last.row - corner.row};
    bits_.assign(static_cast<std::size_t>(kTileSide) * kWords, 0);
    // Points outside the tile or the extent count as present: no candidate needs them.
    std::uint64_t outside[kWords];
    for (int w = 0; w < kWords; ++w) {
      outside[w] = 0;
      for (int c = 0; c < 64; ++c) outside[w] |= std::uint64_t{64 * w + c < first_.col || 64 * w + c > last_.col} << c;
      inside_[w] = ~outside[w];
    }
    for (int row = 0; row < kTileSide; ++row) {
      std::uint64_t* words = row_of(row);
      const bool is_outside = row < first_.row || row > last_.row;
      for (int w = 0; w < kWords; ++w) words[w] = is_outside ? ~std::uint64_t{0} : outside[w];
    }
    std::fill(std::begin(beyond_), std::end(beyond_), ~std::uint64_t{0});
    for (std::int32_t row = 0; row < kTileSide; row += kBlockSide) {
      for (std::int32_t col = 0; col < kTileSide; col += kBlockSide) row_of(row)[col / 64] |= 1;
    }
  }

  [[nodiscard]] bool is_inside(std::int32_t col, std::int32_t row) const {
    return col >= first_.col && col <= last_.col && row >= first_.row && row <= last_.row;
  }
  /// Whether a point in the tile and the extent is a vertex or has spacing 64 and more.
  [[nodiscard]] bool has(std::int32_t col, std::int32_t row) const {
    return is_inside(col, row) && has_inside(col, row);
  }
  /// Whether all points within s of one in the tile and the extent are there, too.
  [[nodiscard]] bool is_amid(std::int32_t col, std::int32_t row, std::int32_t s) const {
    return col - s >= first_.col && col + s <= last_.col && row - s >= first_.row && row + s <= last_.row;
  }
  /// The same for a point in the tile and the extent.
  [[nodiscard]] bool has_inside(std::int32_t col, std::int32_t row) const {
    return (bits_[static_cast<std::size_t>(row) * kWords + static_cast<std::size_t>(col) / 64] >> (col % 64) & 1) != 0;
  }

  /// is_vertex(place) for each candidate, and add(candidate) for those that are. Level by level, centres before side
  /// midpoints, row by row.
  template <class IsVertex, class Add>
  void for_each_candidate(IsVertex&& is_vertex, Add&& add) {
    for (int level = kLevels - 1; level >= 0; --level) {
      const int s = 1 << level;
      std::uint64_t odd[kWords], even[kWords], even_square[kWords], odd_square[kWords];
      columns(s, 2 * s, odd), columns(0, 2 * s, even), columns(s, 4 * s, even_square);
      for (int w = 0; w < kWords; ++w) {
        odd[w] &= inside_[w], even[w] &= inside_[w], even_square[w] &= inside_[w];
        odd_square[w] = odd[w] & ~even_square[w];
      }
      std::uint64_t found[kWords], east[kWords], west[kWords], south_east[kWords], south_west[kWords];
      for (int row = s; row < kTileSide; row += 2 * s) {
        if (row < first_.row || row > last_.row) continue;
        shift_west(words(row - s), s, east), shift_east(words(row - s), s, west);
        shift_west(words(row + s), s, south_east), shift_east(words(row + s), s, south_west);
        const bool is_even = ((row - s) & (2 * s)) == 0;
        for (int w = 0; w < kWords; ++w) {
          found[w] = (east[w] & south_west[w] & (is_even ? even_square : odd_square)[w]) |
                     (west[w] & south_east[w] & (is_even ? odd_square : even_square)[w]);
        }
        visit_row(found, row, level, false, is_vertex, add);
      }
      for (int row = 0; row < kTileSide; row += s) {
        if (row < first_.row || row > last_.row) continue;
        if ((row & s) == 0) {
          const std::uint64_t *above = words(row - s), *below = words(row + s);
          for (int w = 0; w < kWords; ++w) found[w] = above[w] & below[w] & odd[w];
        } else {
          shift_west(words(row), s, east), shift_east(words(row), s, west);
          for (int w = 0; w < kWords; ++w) found[w] = east[w] & west[w] & even[w];
        }
        visit_row(found, row, level, true, is_vertex, add);
      }
    }
  }

 private:
  [[nodiscard]] std::uint64_t* row_of(int row) { return &bits_[static_cast<std::size_t>(row) * kWords]; }
  [[nodiscard]] const std::uint64_t* words(int row) { return row < 0 || row >= kTileSide ? beyond_ : row_of(row); }

  template <class IsVertex, class Add>
  void visit_row(const std::uint64_t* found, int row, int level, bool is_side, IsVertex&& is_vertex, Add&& add) {
    std::uint64_t* here = row_of(row);
    for (int w = 0; w < kWords; ++w) {
      std::uint64_t vertices = 0;
      for (std::uint64_t rest = found[w]; rest != 0; rest &= rest - 1) {
        const int bit = std::countr_zero(rest), col = 64 * w + bit;
        if (!is_vertex(static_cast<std::uint32_t>(row * kTileSide + col))) continue;
        add(candidate(col, row, level, is_side));
        vertices |= std::uint64_t{1} << bit;
      }
      here[w] |= vertices;
    }
  }

  [[nodiscard]] Candidate candidate(std::int32_t col, std::int32_t row, int level, bool is_side) const {
    Candidate c{};
    c.place = static_cast<std::uint32_t>(row * kTileSide + col);
    c.level = static_cast<std::uint8_t>(level);
    c.is_side = is_side;
    const Diamond d = diamond({col, row});
    const bool amid = is_amid(col, row, 1 << level);  // then it has both apexes: it is a candidate
    for (int i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const GridPoint end = d.ends[at], apex = d.apexes[at];
      c.has_end[i] = amid ? has_inside(end.col, end.row) : has(end.col, end.row);
      c.has_apex[i] = amid || has(apex.col, apex.row);
      c.ends[i] = static_cast<std::uint32_t>(end.row * kTileSide + end.col);
      c.apexes[i] = static_cast<std::uint32_t>(apex.row * kTileSide + apex.col);
    }
    return c;
  }

  std::vector<std::uint64_t> bits_;  ///< by row, 1 where no parent is missing: vertices, and points outside
  std::uint64_t beyond_[kWords], inside_[kWords];
  GridPoint first_, last_;
};

/// A predicted height, and the context of the difference to it.
struct Expected {
  std::int64_t number;
  int context;
};

}  // namespace

void TileSlice::take_post(const Page& page, std::size_t i, GridPoint p) {
  if (page.id.band != 1) return;
  const std::int32_t col = p.col & (kTileSide - 1), row = p.row & (kTileSide - 1);
  posts[static_cast<std::size_t>(row / kBlockSide * kTileBlocks + col / kBlockSide)] = page.height(i);
}

void TileSlice::add(const Page& page, std::size_t i, GridPoint p, std::int32_t error) {
  places.push_back(place_in_tile(p));
  heights.push_back(page.height(i));
  errors.push_back(std::max(error, above));
  if (page.covers.empty()) return;
  covers.resize(places.size() - 1, 15);
  covers.push_back(page.covers[i]);
}

void TileSlice::add_missing_parents(TileId id, GridRect extent) {
  const GridPoint corner{id.x * kTileSide, id.y * kTileSide};
  const GridRect part = common(page_square({1, id.x, id.y}), extent);
  std::vector<bool> is_known(static_cast<std::size_t>(kTileSide) * kTileSide);
  for (const std::uint32_t place : places) is_known[place] = true;
  for (std::size_t i = 0; i < places.size(); ++i) {  // those that are added have parents, too
    for (const GridPoint parent : diamond(point_at(corner, places[i])).apexes) {
      if (!part.contains(parent) || spacing(parent) >= kBlockSide || is_known[place_in_tile(parent)]) continue;
      is_known[place_in_tile(parent)] = true;
      covers.resize(places.size(), 15);
      covers.push_back(0);
      places.push_back(place_in_tile(parent));
      heights.push_back(heights[i]);
      errors.push_back(above);
    }
  }
}

struct SliceCoder::Scratch {
  Vertices vertices;
  std::vector<Candidate> found;
  std::vector<std::uint8_t> bits;  ///< of candidates
  // By place. Those of places that the slice does not have mean nothing. Empty until they are needed.
  std::vector<std::int32_t> numbers, errors;  ///< numbers: of posts, too
  std::vector<std::uint8_t> covers;
  TileSlice slice;
  NumberReader in;
  NumberWriter out;
  std::int32_t above = 0;
  int shift = 0;  ///< bends count in units of 2 to this power
  CodeDistance distance;
  Coding coding = Coding::whole;
  std::int64_t base = 0;

  void begin(TileId id, GridRect extent) {
    vertices.begin(id, extent);
    found.clear(), bits.clear();
    numbers.resize(kPlaces), errors.resize(kPlaces);
  }
  static std::size_t place_of_post(std::size_t i) {
    return (i / kTileBlocks * kTileSide + i % kTileBlocks) * static_cast<std::size_t>(kBlockSide);
  }

  [[nodiscard]] std::int64_t number_at(std::uint32_t place) const { return numbers[place]; }

  /// How far the ground around a vertex is from a level plane: its ends, and the sum of its apexes.
  [[nodiscard]] static std::uint64_t bend_around(std::int64_t a, std::int64_t b, std::int64_t across) {
    return static_cast<std::uint64_t>(std::abs(a + b - across) + std::abs(a - b));
  }
  /// A shift with which half of all bends have two bits or fewer left.
  [[nodiscard]] int usual_shift() {
    std::vector<std::uint64_t> bends;
    for (const Candidate& c : found) {
      if (c.has_end[0] && c.has_end[1] && c.has_apex[0] && c.has_apex[1]) {
        bends.push_back(
            bend_around(number_at(c.ends[0]), number_at(c.ends[1]), number_at(c.apexes[0]) + number_at(c.apexes[1])));
      }
    }
    if (bends.empty()) return 0;
    const auto middle = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
    std::nth_element(bends.begin(), middle, bends.end());
    return std::max(0, static_cast<int>(std::bit_width(*middle)) - 2);
  }
  [[nodiscard]] Expected expect(const Candidate& c) {
    const int from = kOfHeights + kClasses * (2 * c.level + (c.is_side ? 1 : 0));
    if (!c.has_end[0] || !c.has_end[1]) {
      std::int64_t number = 0;
      for (int i = 0; i < 2; ++i) number = c.has_apex[i] ? number_at(c.apexes[i]) : number;
      for (int i = 0; i < 2; ++i) number = c.has_end[i] ? number_at(c.ends[i]) : number;
      return {number, from + kClasses - 1};
    }
    const std::int64_t a = number_at(c.ends[0]), b = number_at(c.ends[1]);
    if (!c.has_apex[0] || !c.has_apex[1]) return {(a + b) >> 1, from + kClasses - 1};
    const std::int64_t across = number_at(c.apexes[0]) + number_at(c.apexes[1]);
    const int size = static_cast<int>(std::bit_width(bend_around(a, b, across) >> shift));
    return {(5 * (a + b) + 3 * across + 8) >> 4, from + std::min(size, kClasses - 1)};
  }

  [[nodiscard]] double height_of_number(std::int64_t number) const {
    return height_of(static_cast<std::int64_t>(static_cast<std::uint64_t>(base) + static_cast<std::uint64_t>(number)),
                     coding);
  }
  /// What the distance of a vertex from the middle of its ends counts as.
  [[nodiscard]] std::int64_t own_error(std::int64_t number, std::int64_t a, std::int64_t b) const {
    if (distance.is_whole()) return 4 * std::abs(2 * number - a - b);
    const double middle = height_of_number(a) / 2 + height_of_number(b) / 2;
    const double own = std::abs(height_of_number(number) - middle);
    return std::isfinite(own) ? error_code(distance.metres(own)) : kAlwaysSelected;
  }

  /// The least error of a vertex, and the context of what is added to it. Its children must have theirs.
  [[nodiscard]] Expected least_error(std::size_t i) {
    const Candidate& c = found[i];
    std::int64_t least = std::int64_t{above} + 1;
    int source = 0;
    if (c.has_end[0] && c.has_end[1]) {
      const std::int64_t own = own_error(number_at(c.place), number_at(c.ends[0]), number_at(c.ends[1]));
      if (own > least) least = own, source = 1;
    }
    const GridPoint here{static_cast<std::int32_t>(c.place % kTileSide),
                         static_cast<std::int32_t>(c.place / kTileSide)};
    const bool amid = vertices.is_amid(here.col, here.row, 1 << c.level);
    const Children below = children(here);
    for (int k = 0; k < below.count; ++k) {
      const GridPoint p = below.at[static_cast<std::size_t>(k)];
      if (!(amid ? vertices.has_inside(p.col, p.row) : vertices.has(p.col, p.row))) continue;
      const std::int64_t error = errors[static_cast<std::size_t>(p.row * kTileSide + p.col)];
      if (error >= least) least = error, source = 2;
    }
    return {std::min<std::int64_t>(least, kMostEighths - 1),
            kOfErrors + kSources * (2 * std::min<int>(c.level, kErrorLevels - 1) + (c.is_side ? 1 : 0)) + source};
  }

  /// The rung of an error: the smallest code that counts as no less.
  [[nodiscard]] std::int32_t rung_of(std::int32_t error) const {
    if (!distance.is_whole() || error == 0) return error;
    const double below = distance.metres((error - 1) / 8.0);
    const std::int32_t rung = error_code(below);
    return rung + (error_of(static_cast<ErrorCode>(rung)) <= below ? 1 : 0);
  }
  /// What the code of a rung counts as.
  [[nodiscard]] std::int32_t error_at(std::int32_t rung) const {
    return distance.is_whole() ? distance.eighths(error_of(static_cast<ErrorCode>(rung))) : rung;
  }
  /// The context of the eighths between an error and its rung. Errors of band 1 have none.
  [[nodiscard]] int context_of_eighths(std::size_t i) const {
    return kOfEighths + std::min<int>(found[i].level, kErrorLevels - 1);
  }

  void begin_covers() {
    covers.resize(kPlaces);
    for (std::size_t i = 0; i < slice.posts.size(); ++i) covers[place_of_post(i)] = 15;
  }
  /// Whether a parent in the slice has triangles without data.
  [[nodiscard]] int context_of_covers(const Candidate& c) const {
    bool all = true;
    for (int k = 0; k < 2; ++k) all = all && (!c.has_apex[k] || covers[c.apexes[k]] == 15);
    return kOfCovers + (all ? 0 : 1);
  }

  void add(const Candidate& c, std::int64_t number) {
    numbers[c.place] = static_cast<std::int32_t>(number);
    found.push_back(c);
  }
};

SliceCoder::SliceCoder() : scratch_(std::make_unique<Scratch>()) {}
SliceCoder::~SliceCoder() = default;
SliceCoder::SliceCoder(SliceCoder&&) noexcept = default;
SliceCoder& SliceCoder::operator=(SliceCoder&&) noexcept = default;

std::vector<std::byte> SliceCoder::encode(TileId id, GridRect extent, const CodeDistance& distance,
                                          const TileSlice& slice) {
  Scratch& s = *scratch_;
  const std::vector<std::byte> nothing = head_of(kNoSlice);
  const std::size_t posts = slice.posts.size();
  s.distance = distance;
  const auto is_beyond_ladder = [&](std::int32_t error) {
    return error == kMostEighths || s.rung_of(error) >= kAlwaysSelected;
  };
  if (slice.above == kNoSlice || std::any_of(slice.errors.begin(), slice.errors.end(), is_beyond_ladder))
    return nothing;
  std::vector<double> heights(slice.posts.begin(), slice.posts.end());
  heights.insert(heights.end(), slice.heights.begin(), slice.heights.end());
  s.coding = choose_coding(heights, {});
  if (distance.is_whole() && s.coding != Coding::whole) return nothing;
  std::vector<std::int64_t> numbers(heights.size());
  numbers_of(heights, {}, s.coding, numbers);
  const auto [lowest, highest] = std::minmax_element(numbers.begin(), numbers.end());
  const std::uint64_t span = static_cast<std::uint64_t>(*highest) - static_cast<std::uint64_t>(*lowest);
  if (span > 2 * static_cast<std::uint64_t>(kMostNumber)) return nothing;
  s.base = *lowest + static_cast<std::int64_t>(span / 2);
  for (std::int64_t& number : numbers) number -= s.base;
  s.above = slice.above;
  s.begin(id, extent);
  s.out.clear();
  for (std::size_t i = 0; i < posts; ++i) {
    s.out.put(zigzag(numbers[i] - (i == 0 ? 0 : numbers[i % kTileBlocks == 0 ? i - kTileBlocks : i - 1])), kOfPosts);
    s.numbers[Scratch::place_of_post(i)] = static_cast<std::int32_t>(numbers[i]);
  }
  std::vector<std::uint32_t> by_place(slice.size());  // sorted
  for (std::uint32_t i = 0; i < by_place.size(); ++i) by_place[i] = i;
  std::sort(by_place.begin(), by_place.end(),
            [&](std::uint32_t a, std::uint32_t b) { return slice.places[a] < slice.places[b]; });
  const auto find = [&](std::uint32_t place) {
    const auto at = std::lower_bound(by_place.begin(), by_place.end(), place,
                                     [&](std::uint32_t i, std::uint32_t p) { return slice.places[i] < p; });
    return at == by_place.end() || slice.places[*at] != place ? std::size_t{0} : std::size_t{*at} + 1;
  };
  std::vector<std::size_t> order;
  std::size_t which = 0;
  s.vertices.for_each_candidate(
      [&](std::uint32_t place) {
        which = find(place);
        s.bits.push_back(which != 0 ? 1 : 0);
        return which != 0;
      },
      [&](const Candidate& c) {
        s.add(c, numbers[posts + which - 1]);
        order.push_back(which - 1);
      });
  s.shift = s.usual_shift();
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Expected expected = s.expect(s.found[i]);
    s.out.put(zigzag(s.number_at(s.found[i].place) - expected.number), expected.context);
  }
  const auto is_above = [&](std::int32_t error) { return error > slice.above; };
  std::size_t above_found = 0;
  for (const std::size_t i : order) above_found += is_above(slice.errors[i]) ? 1 : 0;
  if (static_cast<std::ptrdiff_t>(above_found) != std::count_if(slice.errors.begin(), slice.errors.end(), is_above))
    return nothing;
  if (slice.is_all && order.size() != slice.size()) return nothing;
  std::vector<Expected> least(order.size());
  bool may_be_less = false, some_are_not_above = false;
  for (std::size_t i = order.size(); i-- > 0;) {
    const std::int32_t error = slice.errors[order[i]];
    s.errors[s.found[i].place] = error;
    least[i] = s.least_error(i);
    may_be_less = may_be_less || (error > slice.above && error < least[i].number);
    some_are_not_above = some_are_not_above || error <= slice.above;
  }
  for (std::size_t i = 0; some_are_not_above && i < order.size(); ++i)
    s.out.put(slice.errors[order[i]] > slice.above ? 0 : 1, kOfAbove);
  for (std::size_t i = order.size(); i-- > 0;) {
    const std::int32_t error = slice.errors[order[i]];
    if (error <= slice.above) continue;
    const auto least_here = static_cast<std::int32_t>(least[i].number);
    const std::int32_t rung = s.rung_of(error), more = rung - s.rung_of(least_here);
    s.out.put(may_be_less ? zigzag(more) : static_cast<std::uint64_t>(more), least[i].context);
    if (!distance.is_whole()) continue;
    const bool is_above_least = more == 0 && !may_be_less;
    s.out.put(static_cast<std::uint64_t>(is_above_least ? error - least_here : s.error_at(rung) - error),
              s.context_of_eighths(i));
  }
  const bool has_covers = std::any_of(slice.covers.begin(), slice.covers.end(), [](auto c) { return c != 15; });
  if (has_covers) s.begin_covers();
  for (std::size_t i = 0; has_covers && i < order.size(); ++i) {
    const Candidate& c = s.found[i];
    s.out.put(slice.covers[order[i]] ^ 15u, s.context_of_covers(c));
    s.covers[c.place] = slice.covers[order[i]];
  }
  std::vector<std::byte> bytes = head_of(slice.above);
  bytes[1] = static_cast<std::byte>((has_covers ? kHasCovers : 0) | (may_be_less ? kErrorsMayBeLess : 0) |
                                    (some_are_not_above ? kSomeAreNotAbove : 0));
  bytes[2] = static_cast<std::byte>(s.coding);
  bytes[3] = static_cast<std::byte>(s.shift);
  put(bytes, static_cast<std::uint64_t>(s.base));
  put(bytes, static_cast<std::uint32_t>((s.bits.size() + 7) / 8));
  for (std::size_t i = 0; i < s.bits.size(); ++i) {
    if (i % 8 == 0) bytes.push_back(std::byte{0});
    bytes.back() |= static_cast<std::byte>(s.bits[i] << (i % 8));
  }
  s.out.finish(bytes);
  return bytes;
}

bool SliceCoder::has(std::uint32_t place) const {
  const auto at = static_cast<std::int32_t>(place);
  return scratch_->vertices.has(at % kTileSide, at / kTileSide);
}

double SliceCoder::height_at(std::uint32_t place) const {
  return scratch_->height_of_number(scratch_->number_at(place));
}

std::int32_t SliceCoder::error_at(std::uint32_t place) const { return scratch_->errors[place]; }

std::uint8_t SliceCoder::covers_at(std::uint32_t place) const {
  return scratch_->slice.covers.empty() ? std::uint8_t{15} : scratch_->covers[place];
}

std::int32_t SliceCoder::threshold_of(std::span<const std::byte> bytes) {
  return bytes.size() < kShortest ? kNoSlice : static_cast<std::int32_t>(whole_at(bytes, 4, 4));
}

const TileSlice& SliceCoder::decode(TileId id, GridRect extent, const CodeDistance& distance,
                                    std::span<const std::byte> bytes) {
  Scratch& s = *scratch_;
  const auto require = [&](bool is_right, const char* what) {
    if (!is_right) fail(Cause::corrupt, "corrupt: slice of tile {}/{}: {}", id.x, id.y, what);
  };
  require(bytes.size() >= kShortest, "it is shorter than its head");
  require(bytes[0] == std::byte{kVersion}, "unknown version");
  const auto flags = std::to_integer<unsigned>(bytes[1]), coding = std::to_integer<unsigned>(bytes[2]);
  const std::int32_t most = distance.is_whole() ? kMostEighths : kAlwaysSelected;
  s.above = threshold_of(bytes);
  TileSlice& slice = s.slice;
  slice.above = s.above;
  slice.places.clear(), slice.heights.clear(), slice.errors.clear(), slice.covers.clear();
  if (s.above == kNoSlice) {
    require(bytes.size() == kShortest && flags == 0 && coding == 0 && bytes[3] == std::byte{0}, "bytes follow it");
    return s.slice;
  }
  require(flags <= kAllFlags, "unknown flags");
  s.shift = std::to_integer<int>(bytes[3]);
  require(s.shift < kMostShift, "its shift is impossible");
  require(s.above >= 0 && s.above < most, "its threshold is impossible");
  require(coding < (distance.is_whole() ? 1u : kCodings), "its coding is impossible");
  require(bytes.size() > kHead, "it is shorter than its head");
  const std::size_t bit_bytes = whole_at(bytes, 16, 4);
  require(bit_bytes < bytes.size() - kHead, "it is shorter than its parts");
  const auto bits = bytes.subspan(kHead, bit_bytes);
  s.coding = static_cast<Coding>(coding);
  s.base = static_cast<std::int64_t>(whole_at(bytes, 8, 8));
  require(std::abs(s.base / 2) < std::int64_t{1} << 61 || !distance.is_whole(), "its base is impossible");
  s.distance = distance;
  s.begin(id, extent);
  s.in.start(bytes.subspan(kHead + bit_bytes));
  const auto number_near = [&](std::int64_t expected, int context) {
    const std::uint64_t added = s.in.get(context);
    const std::int64_t number = expected + unzigzag(added & 0xffffffffffff);  // so that the sum does not overflow
    require(added >> 48 == 0 && number >= -kMostNumber && number <= kMostNumber, "a height is impossible");
    return number;
  };
  for (std::size_t i = 0; i < slice.posts.size(); ++i) {
    const std::size_t before = i % kTileBlocks == 0 ? i - kTileBlocks : i - 1;
    const std::int64_t expected = i == 0 ? 0 : s.numbers[Scratch::place_of_post(before)];
    s.numbers[Scratch::place_of_post(i)] = static_cast<std::int32_t>(number_near(expected, kOfPosts));
  }
  std::size_t at = 0;
  s.vertices.for_each_candidate(
      [&](std::uint32_t) {
        require(at < 8 * bits.size(), "it has too few candidates");
        const bool is_vertex = (std::to_integer<unsigned>(bits[at / 8]) >> (at % 8) & 1) != 0;
        ++at;
        return is_vertex;
      },
      [&](const Candidate& c) {
        const Expected expected = s.expect(c);
        s.add(c, number_near(expected.number, expected.context));
        s.errors[c.place] = s.above + 1;
      });
  require((at + 7) / 8 == bits.size() && (at % 8 == 0 || std::to_integer<unsigned>(bits.back()) >> (at % 8) == 0),
          "it has too many candidates");
  const std::size_t count = s.found.size();
  const bool may_be_less = (flags & kErrorsMayBeLess) != 0;
  if ((flags & kSomeAreNotAbove) != 0) {
    for (const Candidate& c : s.found) {
      const std::uint64_t is_not_above = s.in.get(kOfAbove);
      require(is_not_above <= 1, "an error is impossible");
      s.errors[c.place] -= static_cast<std::int32_t>(is_not_above);
    }
  }
  for (std::size_t i = count; i-- > 0;) {
    std::int32_t& here = s.errors[s.found[i].place];
    if (here == s.above) continue;
    const Expected least = s.least_error(i);
    const auto least_here = static_cast<std::int32_t>(least.number);
    const std::uint64_t number = s.in.get(least.context);
    const std::uint64_t eighths = distance.is_whole() ? s.in.get(s.context_of_eighths(i)) : 0;
    require(number <= 2 * kAlwaysSelected && eighths < std::uint64_t{kMostEighths}, "an error is impossible");
    const std::int64_t more = may_be_less ? unzigzag(number) : static_cast<std::int64_t>(number);
    const std::int64_t rung = s.rung_of(least_here) + more;
    require(rung >= 0 && rung < kAlwaysSelected, "an error is impossible");
    const std::int64_t error = more == 0 && !may_be_less
                                   ? std::int64_t{least_here} + static_cast<std::int64_t>(eighths)
                                   : s.error_at(static_cast<std::int32_t>(rung)) - static_cast<std::int64_t>(eighths);
    require(error > s.above && error < most, "an error is impossible");
    here = static_cast<std::int32_t>(error);
  }
  slice.places.resize(count), slice.heights.resize(count), slice.errors.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t place = s.found[i].place;
    slice.places[i] = place;
    slice.heights[i] = s.height_of_number(s.number_at(place));
    slice.errors[i] = s.errors[place];
    require(std::isfinite(slice.heights[i]), "a height is not a finite number");
  }
  for (std::size_t i = 0; i < slice.posts.size(); ++i)
    slice.posts[i] = s.height_of_number(s.number_at(static_cast<std::uint32_t>(Scratch::place_of_post(i))));
  const bool has_covers = (flags & kHasCovers) != 0;
  slice.covers.resize(has_covers ? count : 0);
  if (has_covers) s.begin_covers();
  for (std::size_t i = 0; i < slice.covers.size(); ++i) {
    const Candidate& c = s.found[i];
    const std::uint64_t missing = s.in.get(s.context_of_covers(c));
    require(missing <= 15, "the triangles around a vertex are impossible");
    slice.covers[i] = s.covers[c.place] = static_cast<std::uint8_t>(missing ^ 15u);
  }
  require(s.in.is_intact(), "it has too few or too many bits");
  return slice;
}

}  // namespace talus
