#include "engine/stream/stream_levels.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "engine/machine/parallel.hpp"
#include "engine/page/number_coder.hpp"
#include "engine/quadtree/border.hpp"
#include "engine/stream/scattered_numbers.hpp"
#include "engine/stream/stream_bytes.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

bool is_before(GridPoint a, GridPoint b) { return a.row != b.row ? a.row < b.row : a.col < b.col; }

int level_of(GridPoint p, int root) { return std::min(height_in_tree(p), root); }

/// Centres come first, because the parents of a side midpoint are centres of its level.
void put_centres_first(std::vector<GridPoint>& points) {
  std::stable_partition(points.begin(), points.end(), [](GridPoint p) { return is_centre(p); });
}

std::vector<std::byte> finished(NumberWriter& writer) {
  std::vector<std::byte> out;
  writer.finish(out);
  return out;
}

/// Joins the pieces of a part's payload, each after its length.
std::vector<std::byte> joined(std::initializer_list<std::vector<std::byte>> pieces) {
  std::vector<std::byte> out;
  for (const auto& piece : pieces) {
    put_variable(out, piece.size());
    out.insert(out.end(), piece.begin(), piece.end());
  }
  return out;
}
template <std::size_t count>
std::array<std::span<const std::byte>, count> split(std::span<const std::byte> payload) {
  std::array<std::span<const std::byte>, count> pieces;
  VariableReader in(payload);
  for (auto& piece : pieces) piece = in.take(in.size());
  if (in.left() > 0) refuse_stream("a part has bytes after its last piece");
  return pieces;
}

/// The vertices that the border needs at any tolerance, row by row. A reader knows their places.
std::vector<GridPoint> forced_vertices(const StreamHeader& h) {
  if (h.is_increment || h.quadtree.origin.border != Border::constrain) return {};
  auto forced = border_vertices(h.window, std::int32_t{1} << h.root());
  std::sort(forced.begin(), forced.end(), is_before);
  return forced;
}

template <class Code>
LevelVertices<Code> root_vertices(const KnownLevels<Code>& known, GridRect window, int root) {
  LevelVertices<Code> at;
  at.bits = BitLattice(window, root);
  const KnownVertices<Code>& all = known.at(root, 1);
  for (const GridPoint p : all.points) at.bits.insert(p);
  at.heights.assign(all.heights.begin(), all.heights.end());
  at.sizes.assign(all.heights.size(), 8);
  at.row_start = {0};
  for (std::int32_t j = 0; j < at.bits.rows; ++j) {
    std::size_t count = 0;
    for (std::size_t w = 0; w < at.bits.words_per_row; ++w)
      count += static_cast<std::size_t>(std::popcount(at.bits.row(j)[w]));
    at.row_start.push_back(at.row_start.back() + count);
  }
  return at;
}

/// Walks one half of a level by stripes. coder(stripe, row) fills in each row.
template <class Code, class Coder>
std::vector<typename LevelWalk<Code>::WalkedRows> walk_half(LevelWalk<Code>& walk, std::size_t half,
                                                            std::size_t stripes, int threads,
                                                            const KnownVertices<Code>& known, Coder&& coder) {
  std::vector<typename LevelWalk<Code>::WalkedRows> parts(stripes);
  for_each_task(threads, stripes, [&](int, std::size_t b) {
    const std::int32_t first = stripe_row(walk.rows(), stripes, b), last = stripe_row(walk.rows(), stripes, b + 1);
    const auto tell = [&](CandidateRow<Code>& row) { coder(b, row); };
    parts[b] = half == 0 ? walk.centres(first, last, known, tell) : walk.sides(first, last, known, tell);
  });
  return parts;
}

bool is_of_level(const BitLattice& lattice, std::int32_t i, std::int32_t j) {
  return (((lattice.first_col + i) | (lattice.first_row + j)) & 1) != 0;
}

/// Visits the vertices of a lattice's own spacing, row by row.
template <class Visit>
void for_each_of_level(const BitLattice& lattice, Visit&& visit) {
  for (std::int32_t j = 0; j < lattice.rows; ++j) {
    for (std::size_t w = 0; w < lattice.words_per_row; ++w) {
      for (std::uint64_t rest = lattice.row(j)[w]; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::int32_t>(64 * w) + std::countr_zero(rest);
        if (is_of_level(lattice, i, j)) visit(lattice.at(i, j));
      }
    }
  }
}

}  // namespace

template <class Code>
void KnownLevels<Code>::insert(GridPoint p, Code height) {
  const int root = static_cast<int>(levels_.size()) - 1, shift = level_of(p, root);
  auto& list = levels_[static_cast<std::size_t>(shift)][shift < root && is_centre(p) ? 0 : 1];
  list.points.push_back(p);
  list.heights.push_back(height);
}

template <class Code>
void KnownLevels<Code>::sort() {
  for (auto& halves : levels_) {
    for (auto& list : halves) {
      if (std::is_sorted(list.points.begin(), list.points.end(), is_before)) continue;
      std::vector<std::size_t> order(list.points.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return is_before(list.points[a], list.points[b]); });
      KnownVertices<Code> sorted;
      for (const std::size_t i : order) {
        sorted.points.push_back(list.points[i]);
        sorted.heights.push_back(list.heights[i]);
      }
      list = std::move(sorted);
    }
  }
}

// ---- writing --------------------------------------------------------------------------------------------

namespace {

template <class Code>
class PartsEncoder {
 public:
  PartsEncoder(const StreamHeader& header, const RestrictedQuadtree& q, std::span<const Code> codes,
               const StreamOptions& options)
      : h_(header), q_(q), codes_(codes), options_(options) {
    lattices_.push_back(bits_of(q.vertices));
    for (int shift = 1; shift <= header.root(); ++shift) lattices_.push_back(coarser(lattices_.back(), header.window));
  }

  std::vector<EncodedPart> run(const RestrictedQuadtree* base, std::span<const Code> base_codes) {
    if (base != nullptr) covers_.take(*base);
    std::vector<EncodedPart> parts{first_part()};
    if (base != nullptr) {
      std::size_t i = 0;
      base->vertices.for_each([&](GridPoint p) { known_.insert(p, base_codes[i++]); });
      most_ = base_codes.size();
    }
    most_ += codes_.size();
    known_.sort();
    so_far_ = root_vertices(known_, h_.window, h_.root());
    for (int shift = h_.root() - 1; shift >= 0; --shift) parts.push_back(level(shift));
    return parts;
  }

 private:
  [[nodiscard]] Code code(GridPoint p) const { return codes_[q_.vertices.rank(p)]; }
  [[nodiscard]] std::uint8_t cover(GridPoint p) const { return q_.covers[q_.vertices.rank(p)]; }
  [[nodiscard]] std::vector<std::byte> covers_of(std::span<const GridPoint> points) {
    if (!h_.has_covers) return {};
    std::vector<std::uint8_t> covers;
    for (const GridPoint p : points) covers.push_back(cover(p));
    return covers_.encode(points, covers);
  }

  EncodedPart first_part() {
    NumberWriter out;
    const std::vector<GridPoint> forced = forced_vertices(h_);
    Scattered<Code> there;
    const auto all = static_cast<std::size_t>(
        std::count_if(forced.begin(), forced.end(), [&](GridPoint p) { return q_.vertices.contains(p); }));
    if (!forced.empty()) out.put(all == forced.size() ? 0 : 1, kCount);
    forced_ = BitLattice(h_.window, 0);
    for (const GridPoint p : forced) {
      const bool is_there = q_.vertices.contains(p);
      if (all != forced.size()) out.put(is_there ? 1 : 0, kIsThere);
      if (!is_there) continue;
      there.points.push_back(p);
      forced_.insert(p);
    }
    const BitLattice& top = lattices_.back();
    std::vector<GridPoint> roots;
    for (std::int32_t j = 0; j < top.rows; ++j) {
      for (std::int32_t i = 0; i < top.cols; ++i) {
        const GridPoint p = top.at(i, j);
        if (top.contains(i, j) && !is_forced(p)) roots.push_back(p);
      }
    }
    put_points(out, top, roots);
    there.points.insert(there.points.end(), roots.begin(), roots.end());
    for (const GridPoint p : there.points) there.heights.push_back(code(p)), known_.insert(p, there.heights.back());
    put_heights(out, there);
    return {there.points.size(), joined({finished(out), covers_of(there.points)})};
  }
  [[nodiscard]] bool is_forced(GridPoint p) const {
    return forced_.contains(p.col - forced_.first_col, p.row - forced_.first_row);
  }

  EncodedPart level(int shift) {
    const BitLattice& lattice = lattices_[static_cast<std::size_t>(shift)];
    std::vector<GridPoint> own;
    std::size_t count = 0;
    const bool lists = h_.has_covers;
    for_each_of_level(lattice, [&](GridPoint p) {
      if (is_forced(p)) return;
      ++count;
      if (lists) own.push_back(p);
    });
    put_centres_first(own);
    const std::size_t wanted =
        options_.stripes > 0 ? static_cast<std::size_t>(options_.stripes) : 1 + count / (1u << 16);
    const std::size_t stripes = std::clamp<std::size_t>(wanted, 1, static_cast<std::size_t>(std::max(1, lattice.rows)));

    LevelWalk<Code> walk(h_.window, so_far_, scale_, h_.has_loose, most_);
    std::array<std::vector<StripeRecord<Code>>, 2> records;
    Scattered<Code> strays;
    for (std::size_t half = 0; half < 2; ++half) {
      const auto attempt = [&] {
        records[half].assign(stripes, {});
        auto parts = walk_half(walk, half, stripes, threads_, known_.at(shift, half),
                               [&](std::size_t b, CandidateRow<Code>& row) {
                                 tell(lattice, row);
                                 records[half][b].take(row);
                               });
        half == 0 ? walk.take_centres(std::move(parts)) : walk.take_all(std::move(parts));
      };
      attempt();
      // Vertices that are not candidates become known vertices, and the half is walked again.
      const std::vector<GridPoint> missing = missing_from(half == 0 ? walk.centre_bits() : walk.bits(), lattice, half);
      if (missing.empty()) continue;
      for (const GridPoint p : missing) {
        strays.points.push_back(p);
        known_.insert(p, code(p));
      }
      known_.sort();
      attempt();
    }
    so_far_ = walk.take_vertices();
    std::sort(strays.points.begin(), strays.points.end(), is_before);
    std::vector<std::byte> scattered;
    if (!strays.points.empty()) {
      for (const GridPoint p : strays.points) strays.heights.push_back(code(p));
      NumberWriter out;
      put_points(out, lattice, strays.points);
      put_heights(out, strays);
      scattered = finished(out);
    }
    return {count, joined({scattered, encoder_.encode(records), covers_of(own)})};
  }

  void tell(const BitLattice& lattice, CandidateRow<Code>& row) const {
    const std::uint64_t* words = lattice.row(row.row);
    for (std::size_t k = 0; k < row.count; ++k) {
      const std::uint32_t i = row.columns[k];
      row.present[k] = static_cast<std::uint8_t>(words[i / 64] >> (i % 64) & 1u);
      row.residuals[k] = 0;
      if (row.present[k] == 0) continue;
      const Code residual =
          wrapped_difference(code(lattice.at(static_cast<std::int32_t>(i), row.row)), row.predicted[k]);
      row.residuals[k] = static_cast<Code>(residual ^ row.flips[k]);
    }
  }

  [[nodiscard]] std::vector<GridPoint> missing_from(const BitLattice& found, const BitLattice& lattice,
                                                    std::size_t half) const {
    std::vector<GridPoint> missing;
    const std::uint64_t odd_columns = lattice.starts_odd() != 0 ? 0x5555555555555555u : 0xaaaaaaaaaaaaaaaau;
    for (std::int32_t j = 0; j < lattice.rows; ++j) {
      const bool odd_row = ((lattice.first_row + j) & 1) != 0;
      if (half == 0 && !odd_row) continue;
      const std::uint64_t columns = half == 0 ? odd_columns : odd_row ? ~odd_columns : odd_columns;
      for (std::size_t w = 0; w < lattice.words_per_row; ++w) {
        for (std::uint64_t rest = lattice.row(j)[w] & columns & ~found.row(j)[w]; rest != 0; rest &= rest - 1)
          missing.push_back(lattice.at(static_cast<std::int32_t>(64 * w) + std::countr_zero(rest), j));
      }
    }
    return missing;
  }

  const StreamHeader& h_;
  const RestrictedQuadtree& q_;
  std::span<const Code> codes_;
  const StreamOptions& options_;
  int threads_ = threads_or_all(options_.threads);
  Scale scale_{HeightCoding::of(h_).tolerance};
  LevelEncoder<Code> encoder_;
  KnownLevels<Code> known_{h_.root()};
  CoverCoder covers_;
  std::vector<BitLattice> lattices_;  ///< index: log2 of the spacing
  BitLattice forced_;
  LevelVertices<Code> so_far_;
  std::size_t most_ = 0;
};

}  // namespace

template <class Code>
std::vector<EncodedPart> encode_parts(const StreamHeader& header, const RestrictedQuadtree& quadtree,
                                      std::span<const Code> codes, const RestrictedQuadtree* base,
                                      std::span<const Code> base_codes, const StreamOptions& options) {
  return PartsEncoder<Code>(header, quadtree, codes, options).run(base, base_codes);
}

// ---- reading --------------------------------------------------------------------------------------------

template <class Code>
PartsDecoder<Code>::PartsDecoder(const StreamHeader& header, const RestrictedQuadtree* base,
                                 std::span<const Code> base_codes, int threads)
    : header_(header),
      base_(base),
      threads_(threads_or_all(threads)),
      coding_(HeightCoding::of(header)),
      known_(header.root()),
      may_have_gaps_(header.has_loose) {
  if (base == nullptr) return;
  cover_coder_.take(*base);
  std::size_t i = 0;
  base->vertices.for_each([&](GridPoint p) { known_.insert(p, base_codes[i++]); });
}
template <class Code>
PartsDecoder<Code>::~PartsDecoder() = default;

template <class Code>
void PartsDecoder<Code>::take(std::span<const std::byte> payload, std::uint64_t vertices) {
  if (vertices > header_.vertices - found_) refuse_stream(fmt::format("{} vertices are too many", vertices));
  taken_ == 0 ? take_first(payload, vertices) : take_level(payload, vertices);
  found_ += vertices;
  ++taken_;
}

template <class Code>
void PartsDecoder<Code>::take_first(std::span<const std::byte> payload, std::uint64_t vertices) {
  const auto [numbers, covers] = split<2>(payload);
  NumberReader in;
  in.start(numbers);
  const std::vector<GridPoint> forced = forced_vertices(header_);
  const bool all = forced.empty() || in.get(kCount) == 0;
  Scattered<Code> there;
  VertexMask seen(header_.window);
  if (base_ != nullptr) seen = base_->vertices;
  for (const GridPoint p : forced) {
    if (!all && in.get(kIsThere) == 0) continue;
    there.points.push_back(p);
    seen.insert(p);
  }
  may_have_gaps_ = may_have_gaps_ || !all;
  const BitLattice top(header_.window, header_.root());
  const auto roots =
      take_points(in, top, 64 + 64 * std::uint64_t{numbers.size()}, [&](GridPoint p) { return !seen.contains(p); });
  there.points.insert(there.points.end(), roots.begin(), roots.end());
  take_heights(in, there);
  if (!in.is_intact()) refuse_stream("the first part is damaged");
  if (there.points.size() != vertices)
    refuse_stream(fmt::format("{} vertices instead of {}", there.points.size(), vertices));
  for (std::size_t i = 0; i < there.points.size(); ++i) known_.insert(there.points[i], there.heights[i]);
  known_.sort();
  if (header_.has_covers) {
    take_covers(covers, there.points);
  } else if (!covers.empty()) {
    refuse_stream("covers that the header does not name");
  }
  so_far_ = root_vertices(known_, header_.window, header_.root());
}

template <class Code>
void PartsDecoder<Code>::take_level(std::span<const std::byte> payload, std::uint64_t vertices) {
  const int shift = header_.root() - static_cast<int>(taken_);
  const auto [scattered, symbols, covers] = split<3>(payload);
  BitLattice before;  // vertices that are known before the level
  const std::size_t known_before = known_.size(shift);
  if (header_.has_covers || !scattered.empty()) {
    before = BitLattice(header_.window, shift);
    for (const std::size_t half : {0u, 1u}) {
      for (const GridPoint p : known_.at(shift, half).points) before.insert(p);
    }
  }
  if (!scattered.empty()) {
    NumberReader in;
    in.start(scattered);
    Scattered<Code> found;
    found.points = take_points(in, before, 64 * std::uint64_t{scattered.size()}, [&](GridPoint p) {
      const std::int32_t i = (p.col >> shift) - before.first_col, j = (p.row >> shift) - before.first_row;
      return is_of_level(before, i, j) && !before.contains(i, j);
    });
    take_heights(in, found);
    if (!in.is_intact()) refuse_stream("the scattered vertices are damaged");
    for (std::size_t i = 0; i < found.points.size(); ++i) known_.insert(found.points[i], found.heights[i]);
    known_.sort();
    may_have_gaps_ = true;
  }
  const std::size_t so_far = so_far_.heights.size();
  LevelWalk<Code> walk(header_.window, so_far_, Scale(coding_.tolerance), header_.has_loose,
                       so_far + known_.size(shift) + static_cast<std::size_t>(vertices));
  const std::size_t stripes = decoder_.start(symbols);
  if (stripes > static_cast<std::size_t>(std::max(1, walk.rows()))) refuse_stream("a level has more stripes than rows");
  for (const std::size_t half : {0u, 1u}) {
    auto parts = walk_half(walk, half, stripes, threads_, known_.at(shift, half),
                           [&](std::size_t b, CandidateRow<Code>& row) { decoder_.take(half, b, row); });
    half == 0 ? walk.take_centres(std::move(parts)) : walk.take_all(std::move(parts));
  }
  if (!decoder_.is_intact()) refuse_stream("a level is damaged");
  so_far_ = walk.take_vertices();
  if (so_far_.heights.size() - so_far - known_before != vertices)
    refuse_stream(fmt::format("{} vertices instead of {}", so_far_.heights.size() - so_far - known_before, vertices));
  if (!header_.has_covers) {
    if (!covers.empty()) refuse_stream("covers that the header does not name");
    return;
  }
  std::vector<GridPoint> own;
  for_each_of_level(so_far_.bits, [&](GridPoint p) {
    if (!before.contains((p.col >> shift) - before.first_col, (p.row >> shift) - before.first_row)) own.push_back(p);
  });
  put_centres_first(own);
  take_covers(covers, own);
}

template <class Code>
void PartsDecoder<Code>::take_covers(std::span<const std::byte> bytes, std::span<const GridPoint> points) {
  const auto decoded = cover_coder_.decode(bytes, points);
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    if (decoded[i] != 15) covers_.push_back({points[i], decoded[i]});
  }
}

template <class Code>
RestrictedQuadtree PartsDecoder<Code>::quadtree() const {
  // Levels that were not read yet have only their known vertices.
  const LevelVertices<Code>* all = &so_far_;
  LevelVertices<Code> finer;
  const auto none = [](CandidateRow<Code>& row) {
    std::fill_n(row.present, row.count, std::uint8_t{0});
    std::fill_n(row.residuals, row.count, Code{0});
  };
  for (int shift = all->bits.shift - 1; shift >= 0; --shift) {
    LevelWalk<Code> walk(header_.window, *all, Scale(coding_.tolerance), false,
                         all->heights.size() + known_.size(shift));
    std::vector<typename LevelWalk<Code>::WalkedRows> centres, sides;
    centres.push_back(walk.centres(0, walk.rows(), known_.at(shift, 0), none));
    walk.take_centres(std::move(centres));
    sides.push_back(walk.sides(0, walk.rows(), known_.at(shift, 1), none));
    walk.take_all(std::move(sides));
    finer = walk.take_vertices();
    all = &finer;
  }
  RestrictedQuadtree q = header_.quadtree;
  q.vertices = VertexMask(header_.window);
  Array<Code> rest;
  std::span<const Code> codes = all->heights;
  if (base_ != nullptr) rest.reserve(static_cast<std::size_t>(found_));
  std::size_t next = 0;
  for (std::int32_t j = 0; j < all->bits.rows; ++j) {
    const std::int32_t row = header_.window.first.row + j;
    const auto to = q.vertices.row_words(row);
    const std::uint64_t* from = all->bits.row(j);
    if (base_ == nullptr) {
      std::copy_n(from, to.size(), to.begin());
      continue;
    }
    const auto had = base_->vertices.row_words(row);
    for (std::size_t w = 0; w < to.size(); ++w) {
      to[w] = from[w] & ~had[w];
      for (std::uint64_t bits = from[w]; bits != 0; bits &= bits - 1, ++next) {
        if ((had[w] >> std::countr_zero(bits) & 1u) == 0) rest.push_back(codes[next]);
      }
    }
  }
  q.vertices.seal();
  if (base_ != nullptr) codes = rest;
  q.heights = heights_of<Code>(coding_, codes);
  if (header_.has_covers) {
    q.covers.assign(q.vertices.size(), 15);
    for (const auto& [p, cover] : covers_) q.covers[q.vertices.rank(p)] = cover;
  }
  if (taken_ < header_.parts) {
    q.bound = header_.bound(taken_ - 1);
    q.origin.is_plain = false;
    for (std::size_t i = taken_; i < header_.parts && !q.level_errors.empty(); ++i)
      q.level_errors[header_.parts - 1 - i] = 0;
  }
  if (base_ == nullptr && may_have_gaps_ && q.origin.border == Border::constrain) {
    const int root = header_.root();
    std::size_t rank = 0;
    q.vertices.for_each([&](GridPoint p) {
      const unsigned covers = header_.has_covers ? q.covers[rank] : 15u;
      ++rank;
      if (height_in_tree(p) >= root) return;
      const Diamond d = diamond(p);
      for (std::size_t triangle = 0; triangle < 4; ++triangle) {
        const GridPoint apex = d.apexes[triangle / 2], end = d.ends[triangle % 2];
        if ((covers >> triangle & 1) == 0 || !q.region.contains(apex) || !q.region.contains(end)) continue;
        if (!q.vertices.contains(apex) || !q.vertices.contains(end))
          refuse_stream(fmt::format("the vertex at column {}, row {} lacks a corner of its triangles", p.col, p.row));
      }
    });
  }
  return q;
}

template class KnownLevels<std::int32_t>;
template class KnownLevels<std::int64_t>;
template class PartsDecoder<std::int32_t>;
template class PartsDecoder<std::int64_t>;
template std::vector<EncodedPart> encode_parts(const StreamHeader&, const RestrictedQuadtree&,
                                               std::span<const std::int32_t>, const RestrictedQuadtree*,
                                               std::span<const std::int32_t>, const StreamOptions&);
template std::vector<EncodedPart> encode_parts(const StreamHeader&, const RestrictedQuadtree&,
                                               std::span<const std::int64_t>, const RestrictedQuadtree*,
                                               std::span<const std::int64_t>, const StreamOptions&);

}  // namespace talus
