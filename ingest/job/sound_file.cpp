#include "ingest/job/sound_file.hpp"

#include "engine/machine/fail.hpp"
#include "storage/page_store.hpp"

namespace talus {

void require_sound_file(const std::filesystem::path& database) {
  std::string finding;
  if (const auto findings = check_structure(database); !findings.empty()) finding = findings.front();
  if (finding.empty()) finding = check_seal(database);
  if (finding.empty()) return;
  fail_in(database, Cause::corrupt, "corrupt: {}: is damaged: {}. It was not changed. Ingest its sources again",
          database.string(), finding);
}

}  // namespace talus
