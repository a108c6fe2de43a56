#pragma once
// Which samples of a database new inputs change.

#include <functional>
#include <unordered_map>

#include "ingest/job/existing_database.hpp"
#include "ingest/mosaic/source.hpp"
#include "talus/ingest.hpp"

namespace talus {

struct Changes {
  UpdateChange sum;
  GridPoint largest_at{};
  std::unordered_map<std::uint64_t, GridRect> of_tiles;  ///< by place on the curve: what changes in a tile's own square

  /// Whether a sample of a rectangle, no larger than a tile's window, changes.
  [[nodiscard]] bool touches(GridRect window) const;
};

/// Lays the new samples over the old ones and looks where they differ. A void covers nothing, so it changes nothing.
///
/// tiles_across  how many tiles are looked at at once; memory follows from it
/// tell          called now and then; may throw
/// cost          a pass over the new samples, and over the old ones beneath
[[nodiscard]] Changes changes_by(const ExistingDatabase& base, const Source& source, std::size_t kind,
                                 std::int32_t tiles_across, const std::function<void()>& tell);

/// Room for codes of a kind, see code_kind.
[[nodiscard]] Codes codes_of_kind(std::size_t kind, std::size_t samples);

}  // namespace talus
