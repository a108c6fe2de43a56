#include "ingest/job/sound_file.hpp"

#include <fmt/format.h>

#include "storage/page_store.hpp"
#include "talus/failure.hpp"

namespace talus {

void require_sound_file(const std::filesystem::path& database) {
  std::string finding;
  if (const auto findings = check_structure(database); !findings.empty()) finding = findings.front();
  if (finding.empty()) finding = check_seal(database);
  if (finding.empty()) return;
  throw Failure(Cause::corrupt,
                fmt::format("corrupt: {}: is damaged: {}. It was not changed. Ingest its sources again",
                            database.string(), finding),
                database);
}

}  // namespace talus
