#include <algorithm>
#include <cstring>

#include "engine/error/block_errors.hpp"
#include "engine/error/saturation.hpp"
#include "engine/error/slab_errors.hpp"
#include "engine/machine/large_memory.hpp"
#include "engine/tile/tile.hpp"

namespace talus {
namespace {

void copy(const CodeSpan& from, Codes& to) {
  std::visit(
      [&](auto codes) {
        using Code = std::remove_const_t<typename decltype(codes)::element_type>;
        if (!std::holds_alternative<std::vector<Code>>(to)) to.emplace<std::vector<Code>>();
        auto& own = std::get<std::vector<Code>>(to);
        make_room(own, codes.size());
        own.assign(codes.begin(), codes.end());
      },
      from);
}

// ---- vertices of spacing 64 … 512 --------------------------------------------------------------------

class FarVertices {
 public:
  FarVertices(const TileInput& tile, const ErrorInput& input, TileRecord& record)
      : tile_(closed_tile(tile.id)), extent_(tile.extent), input_(input), record_(record) {}

  /// shapes  of the blocks with the closed tile's samples
  void run(std::span<const detail::BlockShape> shapes, GridRect blocks) {
    if (input_.voids != nullptr) find_missing_fills();
    for (std::int32_t s = kBlockSide; s < kTileSide; s *= 2) {
      for (const bool centres : {false, true}) {
        for_each_vertex(s, centres, [&](GridPoint p) {
          settle(p, 0);
          settle(p, 1);
        });
      }
    }
    if (halves_.empty()) return;
    std::vector<double> distances(halves_.size());
    detail::largest_distances(input_.field, shapes, blocks, halves_, distances);
    for (std::size_t i = 0; i < halves_.size(); ++i) {
      const HalfDiamond& t = halves_[i];
      const double share =
          input_.rule.share(t, plane_of(t, [&](GridPoint p) { return input_.field[p]; }), input_.field.distance);
      ErrorCode& code = record_.errors[index(t.vertex)];
      const int side = diamond(t.vertex).apexes[0] == t.apex ? 0 : 1;
      code = std::max(code,
                      error_code((input_.field.distance.metres(distances[i]) + input_.margin(t.vertex, side)) * share));
    }
  }

 private:
  [[nodiscard]] std::size_t index(GridPoint p) const {
    return static_cast<std::size_t>(((p.row - tile_.first.row) >> kBlockShift) * TileRecord::kAcross +
                                    ((p.col - tile_.first.col) >> kBlockShift));
  }

  template <class Visit>
  void for_each_vertex(std::int32_t s, bool centres, Visit&& visit) const {
    for (std::int32_t row = tile_.first.row; row <= tile_.last.row; row += s) {
      for (std::int32_t col = tile_.first.col; col <= tile_.last.col; col += s) {
        const GridPoint p{col, row};
        if (spacing(p) == s && is_centre(p) == centres) visit(p);
      }
    }
  }

  void find_missing_fills() {
    const HeightField& field = input_.field;
    for (std::int32_t row = tile_.first.row; row <= tile_.last.row; row += kBlockSide) {
      for (std::int32_t col = tile_.first.col; col <= tile_.last.col; col += kBlockSide) {
        const GridPoint p{col, row};
        if (!extent_.contains(p) || field.is_valid(field.index(p))) continue;
        if (!has_data_near(field.extent, field.valid, p)) record_.holds[index(p)] |= TileRecord::kNoFill;
      }
    }
  }

  void settle(GridPoint p, int side) {
    const HalfDiamond t = half_diamond(p, side);
    if (!inside(t, tile_) || !inside(t, extent_)) return;
    const Holds holds = held(p, side);
    record_.holds[index(p)] |= static_cast<std::uint8_t>(holds << (2 * side));
    if ((holds & kData) == 0) return;
    if (holds == kMixed) {
      record_.errors[index(p)] = std::max(record_.errors[index(p)], error_code(detail::mixed_error(input_, t)));
    }
    if (has_fill(t.apex) && has_fill(t.a) && has_fill(t.b)) {
      halves_.push_back(t);
    } else {
      record_.holds[index(p)] |= TileRecord::kOpenHalf[side];
    }
  }

  [[nodiscard]] bool has_fill(GridPoint p) const { return (record_.holds[index(p)] & TileRecord::kNoFill) == 0; }

  /// A half holds what its two children hold; the children have their right angle at the vertex.
  [[nodiscard]] Holds held(GridPoint p, int side) const {
    if (input_.voids == nullptr) return kData;
    const auto triangles = apex_triangles(p);
    int holds = kNothing;
    for (std::size_t i = 0; i < 2; ++i) {
      const Triangle& t = triangles[2 * static_cast<std::size_t>(side) + i];
      const GridPoint split = midpoint(t.left, t.right);
      const int of_split = diamond(split).apexes[0] == t.apex ? 0 : 1;
      holds |= spacing(split) < kBlockSide ? input_.voids->half(split, of_split)
                                           : record_.holds[index(split)] >> (2 * of_split) & 3;
    }
    return static_cast<Holds>(holds);
  }

  GridRect tile_, extent_;
  const ErrorInput& input_;
  TileRecord& record_;
  std::vector<HalfDiamond> halves_;
};

void record_blocks(const TileInput& tile, const ErrorInput& input, const LevelGrid<ErrorCode>& errors,
                   std::span<const detail::BlockShape> shapes, TileRecord& record) {
  const GridPoint first = closed_tile(tile.id).first;
  for (std::int32_t y = 0; y < kTileBlocks; ++y) {
    for (std::int32_t x = 0; x < kTileBlocks; ++x) {
      TileRecord::Block& block = record.blocks[static_cast<std::size_t>(y * kTileBlocks + x)];
      const GridPoint corner{first.col + x * kBlockSide, first.row + y * kBlockSide};
      const GridPoint centre{corner.col + kBlockSide / 2, corner.row + kBlockSide / 2};
      if (errors.holds(centre)) block.error = errors[centre];
      for (const int side : {0, 1}) {
        if (!inside(half_diamond(centre, side), tile.extent)) continue;
        const Holds holds = input.voids == nullptr ? kData : input.voids->half(centre, side);
        block.holds |= static_cast<std::uint8_t>(holds << (2 * side));
      }
      const detail::BlockShape& shape = shapes[static_cast<std::size_t>(y * (kTileBlocks + 1) + x)];
      const GridPoint at{corner.col >> kBlockShift, corner.row >> kBlockShift};
      block.bits = input.bits == nullptr ? BitRange{0, 15} : (*input.bits)[at];
      block.has_data = shape.has_data;
      block.middle = shape.middle;
      block.right = shape.right;
      block.down = shape.down;
      block.above = shape.above;
      block.below = shape.below;
      block.typical = shape.typical;
    }
  }
}

}  // namespace

GridRect tile_window(TileId id, GridRect extent) {
  const GridPoint first = closed_tile(id).first;
  return common(grown({first, {first.col + kTileSide - 1, first.row + kTileSide - 1}}, kHalo), extent);
}

TileErrors tile_errors(const TileInput& tile) {
  TileErrors result;
  tile_errors(tile, result);
  return result;
}

void tile_errors(const TileInput& tile, TileErrors& result) {
  const GridRect window = tile_window(tile.id, tile.extent);
  const auto holds = [&](int valid) {
    return !tile.valid.empty() && std::memchr(tile.valid.data(), valid, tile.valid.size()) != nullptr;
  };
  const bool has_voids = holds(0), has_data = tile.valid.empty() || holds(1);
  result.record = {};
  result.all_void = is_empty(window) || !has_data;
  if (result.all_void) {
    result.errors.reset({{0, 0}, {-1, -1}}, kTileLevels, 0);
    result.voids.reset();
    std::visit([](auto& heights) { heights.clear(); }, result.heights);
    return;
  }
  const GridRect around = grown(closed_tile(tile.id), kBlockSide);
  result.errors.reset(window, kTileLevels, 0);
  copy(tile.heights, result.heights);
  if (!has_voids) {
    result.voids.reset();
  } else {
    if (result.voids) {
      result.voids->reset(window, tile.valid, kTileLevels);
    } else {
      result.voids.emplace(window, tile.valid, kTileLevels);
    }
    fill_voids(window, tile.valid, *result.voids, around, result.heights);
  }
  ErrorInput input;
  input.field = {window, view(result.heights), has_voids ? tile.valid : std::span<const std::uint8_t>(), tile.distance};
  input.voids = has_voids ? &*result.voids : nullptr;
  input.ground_side = tile.ground_side;
  input.void_weight = tile.void_weight;
  input.rule = tile.rule;
  std::optional<BlockBits> bits;
  if (!std::holds_alternative<std::vector<std::int16_t>>(result.heights)) {
    bits.emplace(input.field);
    input.bits = &*bits;
  }
  const GridRect used = common(around, window);
  if (tile.rule.is_vertical()) {
    detail::block_errors(input,
                         {{used.first.col >> kBlockShift, used.first.row >> kBlockShift},
                          {(used.last.col - 1) >> kBlockShift, (used.last.row - 1) >> kBlockShift}},
                         result.errors);
  } else {  // the kernels leave a triangle's sides to its children, which are tilted otherwise
    result.errors = reference_errors(input, kTileLevels);
  }
  saturate(input, result.errors);
  const GridPoint first{tile.id.x * kTileBlocks, tile.id.y * kTileBlocks};
  const GridRect blocks{first, {first.col + kTileBlocks, first.row + kTileBlocks}};
  const std::vector<detail::BlockShape> shapes = detail::block_shapes(input.field, blocks);
  record_blocks(tile, input, result.errors, shapes, result.record);
  FarVertices(tile, input, result.record).run(shapes, blocks);
}

}  // namespace talus
