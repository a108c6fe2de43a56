#include "ingest/part_file.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "storage/page_store.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, int error) {
  const Cause cause = error == ENOSPC || error == EDQUOT ? Cause::full : error == ENOENT ? Cause::not_found : Cause::io;
  throw Failure(cause, fmt::format("{}: cannot be written: {}", file.string(), std::strerror(error)));
}

/// A mistyped command must not replace somebody's raster: only files with a header of our kind, of whatever version,
/// are overwritten.
bool is_a_database(const fs::path& file) {
  try {
    return ReadTxn(PageStore::open(file)).has({kHeaderTable, 0});
  } catch (const Failure&) {
    return false;
  }
}

/// Empty, or begun by LMDB: nothing else may be lost for the sake of a name.
bool is_unfinished_database(int handle) {
  std::array<unsigned char, 20> head{};
  const ssize_t got = ::pread(handle, head.data(), head.size(), 0);
  constexpr std::array<unsigned char, 4> kMagic{0xde, 0xc0, 0xef, 0xbe};
  return got == 0 ||
         (got == static_cast<ssize_t>(head.size()) && std::memcmp(&head[16], kMagic.data(), kMagic.size()) == 0);
}

/// Whether any tile is done.
bool holds_work(const fs::path& part) {
  try {
    return ReadTxn(PageStore::open(part)).summary(kRecordTable).pages > 0;
  } catch (const Failure&) {
    return false;
  }
}

}  // namespace

PartFile::PartFile(fs::path database, bool overwrite, Left left)
    : database_(std::move(database)), part_(database_.string() + ".part") {
  std::error_code ignored;
  const fs::file_status status = fs::status(database_, ignored);
  if (database_.filename().empty() || fs::is_directory(status)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("{}: a folder; a database is one file, name it", database_.string()));
  }
  if (fs::exists(status)) {
    if (!overwrite) {
      throw Failure(
          Cause::invalid_argument,
          fmt::format("{}: exists already; replace it with --overwrite or choose another name", database_.string()));
    }
    if (!fs::is_regular_file(status) || !is_a_database(database_)) {
      throw Failure(
          Cause::invalid_argument,
          fmt::format("{}: exists and is no sound Talus database; it is left alone, remove it or choose another name",
                      database_.string()));
    }
  }
  handle_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (handle_ < 0) fail(part_, errno);
  if (::flock(handle_, LOCK_EX | LOCK_NB) != 0) {
    ::close(handle_);
    throw Failure(Cause::invalid_argument, fmt::format("{}: another ingest is at work on it", part_.string()));
  }
  if (!is_unfinished_database(handle_)) {
    ::close(handle_);
    throw Failure(
        Cause::invalid_argument,
        fmt::format("{}: exists and is not what an ingest left behind; the work needs this name, so move it away",
                    part_.string()));
  }
  if (left == Left::resume) return;
  if (left == Left::refuse && holds_work(part_)) {
    ::close(handle_);
    throw Failure(Cause::invalid_argument,
                  fmt::format("{}: holds an interrupted ingest; go on with it by --resume, or start anew by --overwrite",
                              part_.string()));
  }
  if (::ftruncate(handle_, 0) != 0) {
    const int error = errno;
    ::close(handle_);
    fail(part_, error);
  }
}

PartFile::~PartFile() {
  if (!keep_) ::unlink(part_.c_str());
  ::close(handle_);
}

void PartFile::copy_database() {
  const int from = ::open(database_.c_str(), O_RDONLY | O_CLOEXEC);
  if (from < 0) fail(database_, errno);
  constexpr std::size_t kAtOnce = std::size_t{64} << 20;
  ssize_t copied = 0;
  while ((copied = ::copy_file_range(from, nullptr, handle_, nullptr, kAtOnce, 0)) > 0) {
  }
  if (copied < 0 && (errno == EXDEV || errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP)) {
    std::vector<char> buffer(std::size_t{1} << 20);
    while ((copied = ::read(from, buffer.data(), buffer.size())) > 0) {
      for (ssize_t put = 0; put < copied;) {
        const ssize_t now = ::write(handle_, buffer.data() + put, static_cast<std::size_t>(copied - put));
        if (now < 0 && errno == EINTR) continue;
        if (now < 0) {
          const int error = errno;
          ::close(from);
          fail(part_, error);
        }
        put += now;
      }
    }
  }
  const int error = errno;
  ::close(from);
  if (copied < 0) fail(part_, error);
}

void PartFile::publish() {
  if (::fsync(handle_) != 0) fail(part_, errno);
  if (::rename(part_.c_str(), database_.c_str()) != 0) fail(database_, errno);
  keep_ = true;
  const fs::path folder = database_.has_parent_path() ? database_.parent_path() : fs::path(".");
  if (const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); handle >= 0) {
    ::fsync(handle);  // the new name, too, survives a power cut
    ::close(handle);
  }
}

}  // namespace talus
