#pragma once
// How a raster goes through memory: panels, rows of tiles as wide as memory allows.

#include <functional>
#include <utility>
#include <vector>

#include "engine/tile/tile.hpp"
#include "ingest/mosaic/source.hpp"

namespace talus {

/// Reads a rectangle into a window that was used before; `own` is the part that no other call has as its own. One call
/// at a time.
using ReadWindow = std::function<void(Window& into, GridRect part, GridRect own)>;

struct Panel {
  std::vector<TileId> tiles;                  ///< beside each other, west to east
  GridRect window;                            ///< what they are computed from
  std::int32_t first_col = 0, last_col = -1;  ///< the columns that are theirs
};

/// The tiles of an extent: all whose square holds a sample or lies within a block of one, where vertices beyond the
/// extent pass errors on.
[[nodiscard]] GridRect tiles_of(GridRect extent);

/// Panels of at most `tiles_across` tiles; down one column of panels, then down the next, so that a panel's window
/// shares its first rows with the one before.
[[nodiscard]] std::vector<Panel> panels_of(GridRect extent, std::int32_t tiles_across);

/// Which of the types of Codes the samples of a source type come in, and its size.
[[nodiscard]] std::size_t code_kind(const Description& source);
[[nodiscard]] std::size_t code_bytes(std::size_t kind);

/// Bytes of memory for the window of a panel.
[[nodiscard]] std::uint64_t window_bytes(std::int32_t tiles_across, std::size_t bytes_a_code);

/// Windows of panels, one after the other, in the same memory: fresh memory costs as much as reading into it.
class PanelReader {
 public:
  explicit PanelReader(ReadWindow read) : read_(std::move(read)) {}
  /// Rows that the window shares with the one before are copied. It stays until the next call but one.
  const Window& read(const Panel& panel);

 private:
  ReadWindow read_;
  Window windows_[2], fresh_;
  int last_ = 0;
};

/// The part of a window that one tile is computed from.
void cut(const Window& window, GridRect part, Window& into);

}  // namespace talus
