// Arbitrary bytes as a database file: refused with a sentence, or one that answers or refuses questions.
//
// LMDB maps the file and follows its pointers, so whatever the structure check lets through must be safe.
// Damage in a page's own bytes ends at its checksum: fuzz_page and fuzz_manifest go on from there.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "storage/page_store.hpp"
#include "talus/talus.hpp"

namespace {

using namespace talus;

void require(bool holds) {
  if (!holds) std::abort();
}

/// In memory, one for each process.
const std::filesystem::path& scratch() {
  static const std::filesystem::path file = [] {
    const std::filesystem::path folder =
        std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
    std::filesystem::path made = folder / ("talus_fuzz_database." + std::to_string(::getpid()));
    std::atexit([] { ::unlink(scratch().c_str()); });
    return made;
  }();
  return file;
}

bool write_file(const std::uint8_t* data, std::size_t size) {
  const int handle = ::open(scratch().c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (handle < 0) return false;
  const bool written = ::write(handle, data, size) == static_cast<ssize_t>(size);
  ::close(handle);
  return written;
}

/// Failures are answers; anything else is a bug.
template <class Ask>
void ask(Ask&& question) {
  try {
    question();
  } catch (const Failure& failure) {
    require(*failure.what() != '\0');
  }
}

/// The first samples of a database: whatever its header says, the answer stays small.
GridRect corner_of(GridRect extent) {
  return {extent.first,
          {static_cast<std::int32_t>(std::min<std::int64_t>(extent.last.col, std::int64_t{extent.first.col} + 299)),
           static_cast<std::int32_t>(std::min<std::int64_t>(extent.last.row, std::int64_t{extent.first.row} + 299))}};
}

void walk_pages() {
  const ReadTxn txn(PageStore::open(scratch()));
  for (int table = kHeaderTable; table < 32; ++table) {
    ask([&] { static_cast<void>(txn.summary(table)); });
    ask([&] { txn.for_each(table, [&](std::uint64_t position) { static_cast<void>(txn.find({table, position})); }); });
  }
}

void query() {
  const Snapshot now = Database::open(scratch()).snapshot();
  const GridRect region = corner_of(now.description().extent);
  for (const double tolerance : {0.0, 1.0, 1e9}) {
    ask([&] { static_cast<void>(triangulate(now.ask({.region = region, .tolerance = Metres{tolerance}}).quadtree)); });
  }
  ask([&] { static_cast<void>(now.samples(region)); });
  ask([&] { static_cast<void>(now.storage()); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (!write_file(data, size)) return 0;
  ask([] { static_cast<void>(check_structure(scratch())); });
  ask(walk_pages);
  ask(query);
  return 0;
}
