#include "ingest/job/panels.hpp"

#include <algorithm>
#include <cstring>
#include <variant>

#include "engine/machine/large_memory.hpp"
#include "ingest/mosaic/common_grid.hpp"

namespace talus {
namespace {

/// Copies a rectangle that lies in both regions.
template <class T>
void copy(const std::vector<T>& from, GridRect from_region, std::vector<T>& to, GridRect to_region, GridRect part) {
  const auto cols = static_cast<std::ptrdiff_t>(part.cols());
  for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
    const auto start = from.begin() + static_cast<std::ptrdiff_t>(index_in(from_region, {part.first.col, row}));
    std::copy(start, start + cols,
              to.begin() + static_cast<std::ptrdiff_t>(index_in(to_region, {part.first.col, row})));
  }
}

/// Copies a rectangle. If `from` has a mask, `to` must have one.
void copy(const Window& from, Window& to, GridRect part) {
  std::visit(
      [&](auto& codes) {
        copy(std::get<std::remove_reference_t<decltype(codes)>>(from.codes), from.region, codes, to.region, part);
      },
      to.codes);
  if (!from.valid.empty()) {
    copy(from.valid, from.region, to.valid, to.region, part);
  } else if (!to.valid.empty()) {
    const auto cols = static_cast<std::size_t>(part.cols());
    for (std::int32_t row = part.first.row; row <= part.last.row; ++row) {
      std::fill_n(to.valid.begin() + static_cast<std::ptrdiff_t>(index_in(to.region, {part.first.col, row})), cols, 1);
    }
  }
}

/// Sets a window's region and the kind of its codes; `masked`: with a mask. The content is arbitrary.
void prepare(Window& window, const Window& other, GridRect region, bool masked) {
  window.region = region;
  const auto n = static_cast<std::size_t>(region.samples());
  if (window.codes.index() != other.codes.index()) {
    std::visit([&](const auto& codes) { window.codes = std::remove_cvref_t<decltype(codes)>(); }, other.codes);
  }
  const auto resize = [](auto& values, std::size_t count) {
    make_room(values, count);
    values.resize(count);
  };
  std::visit([&](auto& codes) { resize(codes, n); }, window.codes);
  resize(window.valid, masked ? n : 0);
}

}  // namespace

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
      panel.window = common(grown(square, kHalo), extent);
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

const Window& PanelReader::read(const Panel& panel) {
  const Window& before = windows_[last_];
  Window& window = windows_[last_ ^= 1];
  const GridRect& w = panel.window;
  if (is_empty(w)) {
    window.region = {{0, 0}, {-1, -1}};
    return window;
  }
  // Each row belongs to one window only, and so do the columns of neighbouring panels.
  const auto own = [&](GridRect part) {
    return GridRect{{panel.first_col, part.first.row}, {panel.last_col, part.last.row}};
  };
  const bool shares = before.region.first.col == w.first.col && before.region.last.col == w.last.col &&
                      before.region.last.row >= w.first.row && before.region.first.row <= w.first.row;
  if (!shares) {
    read_(window, w, own(w));
    return window;
  }
  const GridRect old{w.first, {w.last.col, std::min(before.region.last.row, w.last.row)}};
  if (old.last.row == w.last.row) {
    prepare(window, before, w, !before.valid.empty());
    copy(before, window, old);
    return window;
  }
  const GridRect fresh{{w.first.col, old.last.row + 1}, w.last};
  read_(fresh_, fresh, own(fresh));
  prepare(window, fresh_, w, !before.valid.empty() || !fresh_.valid.empty());
  copy(before, window, old);
  copy(fresh_, window, fresh);
  return window;
}

void cut(const Window& window, GridRect part, Window& into) {
  prepare(into, window, part, !window.valid.empty());
  copy(window, into, part);
  if (!into.valid.empty() && std::memchr(into.valid.data(), 0, into.valid.size()) == nullptr) into.valid.clear();
}

}  // namespace talus
