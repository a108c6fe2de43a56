#pragma once
// Panels: rows of tiles, as wide as memory allows.

#include <functional>
#include <utility>
#include <vector>

#include "engine/tile/tile.hpp"
#include "ingest/mosaic/source.hpp"

namespace talus {

/// Reads a rectangle into a window that may have been used before. No other call has the same samples in `own`. One
/// call at a time.
using ReadWindow = std::function<void(Window& into, GridRect part, GridRect own)>;

struct Panel {
  std::vector<TileId> tiles;                  ///< side by side, west to east
  GridRect window;                            ///< the samples that they depend on
  std::int32_t first_col = 0, last_col = -1;  ///< the panel's own columns
};

/// Panels of at most `tiles_across` tiles, column by column of panels, so that a panel shares its first rows with the
/// panel before.
[[nodiscard]] std::vector<Panel> panels_of(GridRect extent, std::int32_t tiles_across);

/// The kind of codes (index in Codes) for the samples of a source type.
[[nodiscard]] std::size_t code_kind(const Description& source);
[[nodiscard]] std::size_t code_bytes(std::size_t kind);

/// Memory for the window of a panel.
[[nodiscard]] std::uint64_t window_bytes(std::int32_t tiles_across, std::size_t bytes_a_code);

/// Reads the windows of panels one after the other into the same memory, which is faster than fresh memory.
class PanelReader {
 public:
  explicit PanelReader(ReadWindow read) : read_(std::move(read)) {}
  /// Rows that the window shares with the one before are copied. It is valid until the next call but one.
  const Window& read(const Panel& panel);

 private:
  ReadWindow read_;
  Window windows_[2], fresh_;
  int last_ = 0;
};

/// Copies the part of a window that a tile depends on.
void cut(const Window& window, GridRect part, Window& into);

}  // namespace talus
