#include <chrono>

#include <fmt/format.h>

#include "ingest/job/part_file.hpp"
#include "ingest/job/sound_file.hpp"
#include "storage/page_store.hpp"
#include "talus/ingest.hpp"

namespace talus {

CompactReport compact(const std::filesystem::path& database) {
  const auto started = std::chrono::steady_clock::now();
  static_cast<void>(PageStore::open(followed(database)));  // refuses a missing database before any file is made
  PartFile part(database, true, PartFile::Left::refuse);
  require_sound_file(part.target());
  CompactReport report;
  report.bytes_before = std::filesystem::file_size(part.target());
  report.bytes = write_compact(PageStore::open(part.target()), part.path());
  require_sound_file(part.path());
  if (report.bytes < report.bytes_before) {
    part.publish();
  } else {
    report.bytes = report.bytes_before;  // nothing to gain: the file stays
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return report;
}

}  // namespace talus
