#include "ingest/panels.hpp"

#include <algorithm>
#include <variant>

namespace talus {
namespace {

GridRect cut_to(GridRect r, GridRect extent) {
  return {{std::max(r.first.col, extent.first.col), std::max(r.first.row, extent.first.row)},
          {std::min(r.last.col, extent.last.col), std::min(r.last.row, extent.last.row)}};
}

std::size_t index(GridRect region, GridPoint p) {
  return static_cast<std::size_t>((std::int64_t{p.row} - region.first.row) * region.cols() +
                                  (std::int64_t{p.col} - region.first.col));
}

/// Copies a rectangle that lies in both.
template <class T>
void copy(const std::vector<T>& from, GridRect from_region, std::vector<T>& to, GridRect to_region, GridRect part) {
  const auto cols = static_cast<std::ptrdiff_t>(part.cols());
  for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
    const auto start = from.begin() + static_cast<std::ptrdiff_t>(index(from_region, {part.first.col, row}));
    std::copy(start, start + cols, to.begin() + static_cast<std::ptrdiff_t>(index(to_region, {part.first.col, row})));
  }
}

void copy(const Window& from, Window& to, GridRect part) {
  std::visit(
      [&](auto& codes) {
        copy(std::get<std::remove_reference_t<decltype(codes)>>(from.codes), from.region, codes, to.region, part);
      },
      to.codes);
  if (!from.valid.empty()) copy(from.valid, from.region, to.valid, to.region, part);
}

/// An empty window of the same kind of codes. `masked`: with room for voids.
Window like(const Window& other, GridRect region, bool masked) {
  Window made;
  made.region = region;
  const auto n = static_cast<std::size_t>(region.samples());
  std::visit([&](const auto& codes) { made.codes = std::remove_cvref_t<decltype(codes)>(n); }, other.codes);
  if (masked) made.valid.assign(n, 1);
  return made;
}

}  // namespace

GridRect tiles_of(GridRect extent) {
  return {{(extent.first.col - kBlockSide) >> kTileShift, (extent.first.row - kBlockSide) >> kTileShift},
          {(extent.last.col + kBlockSide) >> kTileShift, (extent.last.row + kBlockSide) >> kTileShift}};
}

std::vector<Panel> panels_of(GridRect extent, std::int32_t tiles_across) {
  const GridRect tiles = tiles_of(extent);
  std::vector<Panel> panels;
  for (std::int32_t west = tiles.first.col; west <= tiles.last.col; west += tiles_across) {
    const std::int32_t east = std::min(west + tiles_across - 1, tiles.last.col);
    for (std::int32_t y = tiles.first.row; y <= tiles.last.row; ++y) {
      Panel panel;
      for (std::int32_t x = west; x <= east; ++x) panel.tiles.push_back({x, y});
      const GridRect square{{west * kTileSide, y * kTileSide}, {(east + 1) * kTileSide - 1, (y + 1) * kTileSide - 1}};
      panel.first_col = std::max(square.first.col, extent.first.col);
      panel.last_col = std::min(square.last.col, extent.last.col);
      panel.window = cut_to({{square.first.col - kHalo, square.first.row - kHalo},
                             {square.last.col + kHalo, square.last.row + kHalo}},
                            extent);
      panels.push_back(std::move(panel));
    }
  }
  return panels;
}

std::size_t code_kind(const Description& source) {
  const std::string& type = source.source_type;
  if (type == "Byte" || type == "Int16") return 0;
  return type == "UInt16" || type == "Float32" ? 1 : 2;
}
std::size_t code_bytes(std::size_t kind) {
  constexpr std::size_t kBytes[] = {sizeof(std::int16_t), sizeof(float), sizeof(double)};
  return kBytes[kind];
}

std::uint64_t window_bytes(std::int32_t tiles_across, std::size_t bytes_a_code) {
  constexpr std::uint64_t kHalos = 2 * kHalo;
  return (static_cast<std::uint64_t>(tiles_across) * kTileSide + kHalos) * (kTileSide + kHalos) * (bytes_a_code + 1);
}

std::shared_ptr<const Window> read_panel(const Panel& panel, const std::shared_ptr<const Window>& before,
                                         const ReadWindow& read) {
  const GridRect& w = panel.window;
  if (w.cols() <= 0 || w.rows() <= 0) return std::make_shared<Window>();
  const auto own = [&](GridRect part) {  // row by row once, without the columns of panels beside
    return GridRect{{panel.first_col, part.first.row}, {panel.last_col, part.last.row}};
  };
  const bool shares = before && before->region.first.col == w.first.col && before->region.last.col == w.last.col &&
                      before->region.last.row >= w.first.row && before->region.first.row <= w.first.row;
  if (!shares) return std::make_shared<Window>(read(w, own(w)));
  const GridRect old{w.first, {w.last.col, std::min(before->region.last.row, w.last.row)}};
  if (old.last.row == w.last.row) {
    auto window = std::make_shared<Window>(like(*before, w, !before->valid.empty()));
    copy(*before, *window, old);
    return window;
  }
  const GridRect fresh{{w.first.col, old.last.row + 1}, w.last};
  const Window rest = read(fresh, own(fresh));
  auto window = std::make_shared<Window>(like(rest, w, !before->valid.empty() || !rest.valid.empty()));
  copy(*before, *window, old);
  copy(rest, *window, fresh);
  return window;
}

Window cut(const Window& window, GridRect part) {
  Window made = like(window, part, !window.valid.empty());
  copy(window, made, part);
  if (std::find(made.valid.begin(), made.valid.end(), 0) == made.valid.end()) made.valid.clear();
  return made;
}

}  // namespace talus
