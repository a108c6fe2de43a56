// Prepares blocks for the kernels (engine/error/block_kernel.inc): which blocks share a batch, and as which numbers.

#include "engine/error/block_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "engine/error/kernel_choice.hpp"

namespace talus::detail {
namespace {

constexpr int kSide = kBlockSamples;
static_assert(kBlockSide == kBlockCells && kBlockShift == kBlockLevels);

/// Index of each level's first vertex in a block's own arrays, which are row by row.
constexpr std::array<std::size_t, kBlockLevels> kLevelStart = {0, 4225, 5314, 5603, 5684, 5709};
constexpr int level_side(int level) { return (kBlockSide >> level) + 1; }

/// Error codes of the smallest distances of whole numbers.
class ShortCodes {
 public:
  explicit ShortCodes(const CodeDistance& distance) : distance_(distance) {
    for (int level = 0; level < kBlockLevels; ++level) {
      ErrorCode code = 0;
      for (int i = 0; i < LadderTables::kShort; ++i) {
        const double metres = distance.metres(static_cast<double>(i) / (2 << level));
        while (error_of(code) < metres) ++code;
        codes_[static_cast<std::size_t>(level)][static_cast<std::size_t>(i)] = code;
      }
    }
  }
  [[nodiscard]] bool is_of(const CodeDistance& distance) const { return distance_ == distance; }
  [[nodiscard]] LadderTables tables() const {
    LadderTables tables;
    for (std::size_t level = 0; level < kBlockLevels; ++level) tables.steps[level] = codes_[level].data();
    tables.factor = distance_.factor();
    tables.divisor = distance_.divisor();
    tables.rungs = error_ladder.metres.data();
    tables.first_guess = error_ladder.first_guess.data();
    return tables;
  }

 private:
  CodeDistance distance_;
  std::array<std::array<ErrorCode, LadderTables::kShort>, kBlockLevels> codes_{};
};

/// A copy of a block that the edge of the field cuts.
struct OwnBlock {
  std::array<std::byte, kKernelCells * sizeof(double)> heights;
  std::array<std::uint8_t, kKernelCells> valid;
  std::array<ErrorCode, kKernelPlane> errors;
  std::array<std::uint8_t, kKernelPlane> holds;

  template <class Code>
  [[nodiscard]] Code* codes() {
    return reinterpret_cast<Code*>(heights.data());
  }
};

/// Memory that a thread reuses from tile to tile. No result depends on its content.
struct Workspace {
  Workspace() : kernel(static_cast<std::byte*>(std::aligned_alloc(64, kMemory))) {
    if (kernel == nullptr) throw std::bad_alloc();
    std::memset(kernel.get(), 0, kMemory);
  }
  static constexpr std::size_t kMemory = (kKernelMemory + 63) & ~std::size_t{63};
  struct Free {
    void operator()(std::byte* memory) const { std::free(memory); }
  };
  std::unique_ptr<std::byte, Free> kernel;
  std::vector<std::unique_ptr<OwnBlock>> blocks;
  std::unique_ptr<ShortCodes> codes;
};

Workspace& workspace() {
  static thread_local Workspace memory;
  return memory;
}

/// A kind of block; blocks of one kind can share a batch. `whole`: all heights are multiples of one unit.
struct Kind {
  bool whole = false, masked = false;
};

template <class Code>
class BlockErrors {
 public:
  BlockErrors(const ErrorInput& input, LevelGrid<ErrorCode>& errors) : input_(input), errors_(errors) {
    if (memory_.codes == nullptr || !memory_.codes->is_of(field_.distance)) {
      memory_.codes = std::make_unique<ShortCodes>(field_.distance);
    }
  }

  void run(GridRect blocks) {
    std::array<std::vector<GridPoint>, 2> whole, real;  // without voids, with voids
    for_each_point(blocks, [&](GridPoint block) {
      const GridPoint corner{block.col * kBlockSide, block.row * kBlockSide};
      const int valid = count_valid(corner);
      if (valid > 0) (is_whole(corner) ? whole : real)[valid < kSide * kSide ? 1 : 0].push_back(corner);
    });
    for (const bool masked : {false, true}) {
      auto& others = real[masked ? 1 : 0];
      const auto too_wide = batches(whole[masked ? 1 : 0], {true, masked});
      others.insert(others.end(), too_wide.begin(), too_wide.end());
      batches(others, {false, masked});
    }
  }

 private:
  [[nodiscard]] GridRect closed(GridPoint corner) const {
    return {corner, {corner.col + kBlockSide, corner.row + kBlockSide}};
  }
  [[nodiscard]] bool is_cut(GridPoint corner) const {
    return !field_.extent.contains(corner) || !field_.extent.contains(closed(corner).last);
  }
  [[nodiscard]] GridRect part_of_field(GridPoint corner) const { return common(closed(corner), field_.extent); }

  /// Number of valid samples of a closed block.
  [[nodiscard]] int count_valid(GridPoint corner) const {
    const GridRect part = part_of_field(corner);
    if (is_empty(part)) return 0;
    if (field_.valid.empty()) return static_cast<int>(part.samples());
    int count = 0;
    for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
      const std::uint8_t* line = &field_.valid[field_.index({part.first.col, row})];
      int in_row = 0;
      for (std::int64_t col = 0; col < part.cols(); ++col) in_row += line[col];
      count += in_row;
    }
    return count;
  }

  [[nodiscard]] BitRange bits_of(GridPoint corner) const {
    return (*input_.bits)[{corner.col >> kBlockShift, corner.row >> kBlockShift}];
  }

  /// Whether all heights of a block are whole numbers, or are whole numbers of 32 bits in a unit of the block. Then
  /// every interpolation between them is exact in double, too.
  [[nodiscard]] bool is_whole(GridPoint corner) const {
    if constexpr (std::is_same_v<Code, std::int16_t>) return true;
    const BitRange bits = bits_of(corner);
    if (bits.finest > bits.coarsest) return true;  // all are zero
    return bits.coarsest - bits.finest < kUnitBits && std::abs(bits.finest) <= kMostUnitExponent;
  }

  /// Returns the blocks that the kernel could not do.
  std::vector<GridPoint> batches(const std::vector<GridPoint>& corners, Kind kind) {
    const auto most = static_cast<std::size_t>(kind.whole ? kernel_.whole_lanes : kernel_.real_lanes);
    std::vector<GridPoint> left;
    for (std::size_t first = 0; first < corners.size(); first += most) {
      const auto some = std::span(corners).subspan(first, std::min(most, corners.size() - first));
      const std::uint32_t not_done = batch(some, kind);
      for (std::size_t i = 0; i < some.size(); ++i) {
        if ((not_done >> i & 1) != 0) left.push_back(some[i]);
      }
    }
    return left;
  }

  /// Returns a bit for each block that the kernel could not do.
  std::uint32_t batch(std::span<const GridPoint> corners, Kind kind) {
    std::array<Lane, kMostLanes> lanes;
    for (std::size_t i = 0; i < corners.size(); ++i) lanes[i] = lane(corners[i], kind, i);
    const Batch batch{lanes.data(), static_cast<int>(corners.size()), kind.masked, memory_.kernel.get()};
    const LadderTables tables = memory_.codes->tables();
    std::uint32_t not_done = 0;
    if constexpr (std::is_same_v<Code, std::int16_t>) {
      kernel_.whole(batch, tables);
    } else if (kind.whole) {
      not_done = (std::is_same_v<Code, float> ? kernel_.scaled_floats : kernel_.scaled_doubles)(batch, tables);
    } else {
      (std::is_same_v<Code, float> ? kernel_.floats : kernel_.doubles)(batch, tables);
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (lanes[i].margin != 0) finest_side_midpoints(lanes[i]);
      if (is_cut(corners[i])) give_back(corners[i], own(i));
    }
    return not_done;
  }

  [[nodiscard]] OwnBlock& own(std::size_t i) {
    while (memory_.blocks.size() <= i) memory_.blocks.push_back(std::make_unique<OwnBlock>());
    return *memory_.blocks[i];
  }

  [[nodiscard]] Lane lane(GridPoint corner, Kind kind, std::size_t number) {
    Lane lane;
    lane.odd = static_cast<std::uint8_t>(((corner.col ^ corner.row) >> kBlockShift) & 1);
    if (input_.bits != nullptr) {
      const BitRange bits = bits_of(corner);
      lane.margin = bits.interpolates_exactly(kBlockSide) ? 0 : kRoundingMargin;
      if (kind.whole) lane.unit = bits.finest > bits.coarsest ? 1 : std::ldexp(1.0F, bits.finest);
    }
    if (is_cut(corner)) {
      cut_out(corner, lane, own(number));
    } else {
      const std::size_t at = field_.index(corner);
      lane.heights = &heights_[at];
      lane.stride = field_.extent.cols();
      if (kind.masked) lane.valid = &field_.valid[at];
      lane.valid_stride = lane.stride;
      for (int level = 0; level < kBlockLevels; ++level) {
        const auto units = errors_.units(level);
        lane.errors[level] = &units.at(corner.col >> level, corner.row >> level);
        lane.level_stride[level] = units.stride;
        if (kind.masked) lane.holds[level] = &holds_at(level, corner);
      }
    }
    return lane;
  }

  [[nodiscard]] const std::uint8_t& holds_at(int level, GridPoint corner) const {
    return input_.voids->units(level).at(corner.col >> level, corner.row >> level);
  }

  /// Samples outside the field become copies of the nearest ones, so that ranges stay small, and do not count. In a
  /// raster a few samples wide every block is cut, so only existing rows are visited.
  void cut_out(GridPoint corner, Lane& lane, OwnBlock& block) const {
    const GridRect part = part_of_field(corner);
    const auto first_row = static_cast<std::size_t>(part.first.row - corner.row);
    const auto first_col = static_cast<std::size_t>(part.first.col - corner.col);
    const auto rows = static_cast<std::size_t>(part.rows()), cols = static_cast<std::size_t>(part.cols());
    Code* const heights = block.codes<Code>();
    block.valid.fill(0);
    for (std::size_t row = first_row; row < first_row + rows; ++row) {
      const std::size_t from = field_.index({part.first.col, corner.row + static_cast<std::int32_t>(row)});
      Code* const line = heights + row * kSide;
      std::copy_n(&heights_[from], cols, line + first_col);
      std::fill_n(line, first_col, line[first_col]);
      std::fill(line + first_col + cols, line + kSide, line[first_col + cols - 1]);
      std::uint8_t* const valid = block.valid.data() + row * kSide + first_col;
      if (field_.valid.empty()) {
        std::fill_n(valid, cols, std::uint8_t{1});
      } else {
        std::copy_n(&field_.valid[from], cols, valid);
      }
    }
    for (std::size_t row = 0; row < kSide; ++row) {
      if (row >= first_row && row < first_row + rows) continue;
      std::copy_n(heights + (row < first_row ? first_row : first_row + rows - 1) * kSide, kSide, heights + row * kSide);
    }
    block.errors.fill(0);
    block.holds.fill(0);
    for (int level = 0; level < kBlockLevels; ++level) {
      const std::size_t start = kLevelStart[static_cast<std::size_t>(level)];
      // A vertex outside the field is not the midpoint of a hypotenuse inside it.
      for_each_vertex(part, level, [&](GridPoint p) { block.holds[start + index_of(p, corner, level)] = held_by(p); });
      lane.errors[level] = block.errors.data() + start;
      lane.holds[level] = block.holds.data() + start;
      lane.level_stride[level] = level_side(level);
    }
    lane.heights = block.heights.data();
    lane.valid = block.valid.data();
    lane.stride = lane.valid_stride = kSide;
  }
  [[nodiscard]] std::uint8_t held_by(GridPoint p) const {
    const auto half = [&](int side) {
      if (!inside(half_diamond(p, side), field_.extent)) return kNothing;
      return input_.voids == nullptr ? kData : input_.voids->half(p, side);
    };
    return static_cast<std::uint8_t>(half(0) | half(1) << 2);
  }
  /// visit(vertex) for each vertex of spacing 1 << level in a part of a block.
  template <class Visit>
  static void for_each_vertex(GridRect part, int level, Visit&& visit) {
    const std::int32_t step = 1 << level;
    const auto up = [&](std::int32_t i) { return (i + step - 1) & -step; };
    for (std::int32_t row = up(part.first.row); row <= part.last.row; row += step) {
      const bool odd = (row & step) != 0;  // every column of an odd row; every second one of an even row
      const std::int32_t stride = odd ? step : 2 * step;
      std::int32_t col = up(part.first.col);
      if (!odd && (col & step) == 0) col += step;
      for (; col <= part.last.col; col += stride) visit(GridPoint{col, row});
    }
  }
  [[nodiscard]] static std::size_t index_of(GridPoint p, GridPoint corner, int level) {
    return static_cast<std::size_t>(((p.row - corner.row) >> level) * level_side(level) +
                                    ((p.col - corner.col) >> level));
  }

  /// Copies the errors of a cut block back.
  void give_back(GridPoint corner, const OwnBlock& block) {
    for (int level = 0; level < kBlockLevels; ++level) {
      const auto units = errors_.units(level);
      for_each_vertex(part_of_field(corner), level, [&](GridPoint p) {
        ErrorCode& error = units.at(p.col >> level, p.row >> level);
        error =
            std::max(error, block.errors[kLevelStart[static_cast<std::size_t>(level)] + index_of(p, corner, level)]);
      });
    }
  }

  /// Where arithmetic rounds, the margin of a finest side midpoint depends on its own three heights.
  void finest_side_midpoints(const Lane& lane) const {
    const auto* heights = static_cast<const Code*>(lane.heights);
    for (int row = 0; row < kSide; ++row) {
      for (int col = 1 - (row & 1); col < kSide; col += 2) {
        const bool level = (row & 1) == 0;
        const auto at = row * lane.level_stride[0] + col;
        if (lane.holds[0] != nullptr &&
            ((lane.holds[0][at] & (kData | kData << 2)) == 0 || lane.valid[row * lane.valid_stride + col] == 0)) {
          continue;
        }
        const Code* own = heights + row * lane.stride + col;
        const std::ptrdiff_t step = level ? 1 : lane.stride;
        const double metres = finest_error(static_cast<double>(*own), static_cast<double>(own[-step]),
                                           static_cast<double>(own[step]), field_.distance);
        ErrorCode& error = lane.errors[0][at];
        error = std::max(error, error_code(metres));
      }
    }
  }

  const ErrorInput& input_;
  const HeightField& field_ = input_.field;
  std::span<const Code> heights_ = std::get<std::span<const Code>>(field_.heights);
  LevelGrid<ErrorCode>& errors_;
  const BlockKernel& kernel_ = block_kernel();
  Workspace& memory_ = workspace();
};

/// Raises the errors of vertices with a half that mixes data and void to the least such a half has, which follows from
/// its row and shape. The input has voids.
void mixed_errors(const ErrorInput& input, LevelGrid<ErrorCode>& errors) {
  const BlockKernel& kernel = block_kernel();
  for (int level = 0; level < errors.levels(); ++level) {
    const auto to = errors.units(level);
    const auto holds = input.voids->units(level);
    const std::int32_t width = to.last_col - to.first_col + 1;
    for (std::int32_t row = to.first_row; row <= to.last_row; ++row) {
      const std::uint8_t* held = &holds.at(to.first_col, row);
      const auto is_mixed = [](std::uint8_t h) { return (h & 3) == kMixed || h >> 2 == kMixed; };
      if (std::none_of(held, held + width, is_mixed)) continue;
      ErrorCode codes[2][2];  // by parity of the position in the row, and by side
      for (const int place : {0, 1}) {
        const GridPoint p{to.first_col + place, row};
        for (const int side : {0, 1}) {
          const bool is_vertex = ((p.col | p.row) & 1) != 0;
          const HalfDiamond t = half_diamond({p.col * (1 << level), p.row * (1 << level)}, side);
          codes[place][side] = is_vertex ? error_code(mixed_error(input, t)) : ErrorCode{0};
        }
      }
      kernel.raise_mixed(&to.at(to.first_col, row), held, width, codes);
    }
  }
}

}  // namespace

void block_errors(const ErrorInput& input, GridRect blocks, LevelGrid<ErrorCode>& errors) {
  std::visit(
      [&](auto heights) {
        using Code = std::remove_const_t<typename decltype(heights)::element_type>;
        BlockErrors<Code>(input, errors).run(blocks);
      },
      input.field.heights);
  if (input.voids != nullptr) mixed_errors(input, errors);
}

}  // namespace talus::detail
