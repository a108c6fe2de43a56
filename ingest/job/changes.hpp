#pragma once
// The samples of a database that new inputs change.

#include <functional>
#include <unordered_map>

#include "ingest/job/existing_database.hpp"
#include "ingest/mosaic/source.hpp"
#include "talus/ingest.hpp"

namespace talus {

struct Changes {
  UpdateChange sum;
  GridPoint largest_at{};
  std::unordered_map<std::uint64_t, GridRect> of_tiles;  ///< changed rectangle in a tile's square, by curve position

  /// Whether a sample in `window` changes. `window` is no larger than a tile's window.
  [[nodiscard]] bool touches(GridRect window) const;
};

/// Compares the new samples with the old ones under them. A void sample changes nothing.
///
/// tiles_across  tiles compared at once; memory grows with it
/// tell          called now and then; may throw
/// cost          reads the new samples, and the old ones under them
[[nodiscard]] Changes changes_by(const ExistingDatabase& base, const Source& source, std::size_t kind,
                                 std::int32_t tiles_across, const std::function<void()>& tell);

/// Memory for `samples` codes of a kind, see code_kind.
[[nodiscard]] Codes codes_of_kind(std::size_t kind, std::size_t samples);

}  // namespace talus
