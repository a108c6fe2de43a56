#pragma once
// What a writer that was cut short left in its .part file.

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
    nothing,   ///< an empty file, or one in which nothing was put down
    ingest,    ///< an ingest that was begun; `plan` says of what
    finished,  ///< a file that lacks its seal or its name only
    update,    ///< what an update or a compaction worked on
    damaged,   ///< `damage` says how
  };
  Kind kind = Kind::nothing;
  std::string plan, title;         ///< the title is the plan's first line
  std::optional<Provenance> made;  ///< of a finished file
  std::uint64_t tiles = 0;
  std::string damage;
};

/// Walks the file's trees without LMDB before anything in them is believed, then reads its header. Never fails for what
/// the file holds.
[[nodiscard]] LeftWork left_work_in(const std::filesystem::path& part);

/// Checks what is to be gone on with: every page and record against its checksum, every page decoded, each record
/// against the pages of its tile.
///
/// description  of the ingest that goes on with it
/// tell         called now and then; may throw
/// fails        corrupt: names the file, what is wrong, and what to do
/// cost         reads the file; about 5 ns a sample that was settled
void verify_left_work(const std::filesystem::path& part, const Description& description,
                      const std::function<void()>& tell);

}  // namespace talus
