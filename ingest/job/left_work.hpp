#pragma once
// The work that an interrupted writer left in its .part file.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "engine/page/manifest.hpp"
#include "talus/description.hpp"

namespace talus {

struct LeftWork {
  enum class Kind {
    nothing,   ///< an empty file, or one without anything in it
    ingest,    ///< an interrupted ingest with the plan `plan`
    finished,  ///< a finished file without its seal or its name
    update,    ///< work of an update or a compaction
    damaged,   ///< a damaged file, see `damage`
  };
  Kind kind = Kind::nothing;
  std::string plan, title;         ///< the first line of the plan
  std::optional<Provenance> made;  ///< if finished
  std::uint64_t tiles = 0;
  std::string damage;
};

/// Checks the file's trees without LMDB, then reads its header. Damage is a value, not a failure.
[[nodiscard]] LeftWork left_work_in(const std::filesystem::path& part);

/// Checks the work before it is resumed: the checksum of every page and record, the content of every page, and each
/// record against the pages of its tile.
///
/// description  of the ingest that resumes it
/// tell         called now and then; may throw
/// fails        corrupt: names the file, what is wrong, and what to do
/// cost         reads the file; about 5 ns a sample of a finished tile
void verify_left_work(const std::filesystem::path& part, const Description& description,
                      const std::function<void()>& tell);

}  // namespace talus
