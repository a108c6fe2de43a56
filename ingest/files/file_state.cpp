#include "ingest/files/file_state.hpp"

#include <cerrno>
#include <cstring>

#include <sys/stat.h>

#include "engine/machine/fail.hpp"

namespace talus {

FileState state_of(const std::filesystem::path& file) {
  struct stat about {};
  if (::stat(file.c_str(), &about) != 0) {
    const int error = errno;
    const bool gone = error == ENOENT || error == ENOTDIR;
    fail_in(file, gone ? Cause::not_found : Cause::io, "{}: {}", file.string(), std::strerror(error));
  }
  const auto nanoseconds = [](const timespec& t) { return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec; };
  return {file,
          static_cast<std::uint64_t>(about.st_size),
          nanoseconds(about.st_mtim),
          nanoseconds(about.st_ctim),
          static_cast<std::uint64_t>(about.st_dev),
          static_cast<std::uint64_t>(about.st_ino)};
}

}  // namespace talus
