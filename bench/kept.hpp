#pragma once
// What benches make and keep: databases of real models, under build/, for the next run too.

#include <filesystem>
#include <functional>
#include <string>

#include "talus/ingest.hpp"
#include "talus/talus.hpp"

namespace talus::bench {

/// build/kept. Remove it after changes to ingest: files of one format version are taken as they are.
inline std::filesystem::path kept_folder() {
  std::filesystem::create_directories(TALUS_BENCH_KEPT);
  return TALUS_BENCH_KEPT;
}

/// A database that is kept, made from what `source` returns where there is none that can be read.
inline std::filesystem::path kept_database(const std::string& name,
                                           const std::function<std::filesystem::path()>& source) {
  const auto file = kept_folder() / (name + ".talus");
  try {
    (void)Database::open(file).snapshot();
  } catch (const Failure&) {
    ingest(source(), file, {.overwrite = true});
  }
  return file;
}

}  // namespace talus::bench
