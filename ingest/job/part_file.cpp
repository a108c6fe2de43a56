#include "ingest/job/part_file.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/machine/fail.hpp"
#include "storage/page_store.hpp"
#include "talus/ingest.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, int error) {
  const Cause cause = error == ENOSPC || error == EDQUOT ? Cause::full : error == ENOENT ? Cause::not_found : Cause::io;
  fail_in(file, cause, "{}: cannot be written: {}", file.string(), std::strerror(error));
}

/// Only files with a header of our kind, in any version, are overwritten: a mistyped command must not replace a raster.
bool is_a_database(const fs::path& file) {
  try {
    return ReadTxn(PageStore::open(file)).has({kHeaderTable, 0});
  } catch (const Failure& f) {
    return f.cause() == Cause::unsupported;  // of an older version
  }
}

/// Whether the file is empty or was begun by LMDB. No other file is overwritten.
bool is_unfinished_database(int handle) {
  std::array<unsigned char, 20> head{};
  const ssize_t got = ::pread(handle, head.data(), head.size(), 0);
  constexpr std::array<unsigned char, 4> kMagic{0xde, 0xc0, 0xef, 0xbe};
  return got == 0 ||
         (got == static_cast<ssize_t>(head.size()) && std::memcmp(&head[16], kMagic.data(), kMagic.size()) == 0);
}

bool is_same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// Refuses if the database must not be made or replaced under this name.
/// returns  the file that has the name now
std::optional<FileState> require_replaceable(const fs::path& database, const fs::path& target, bool overwrite) {
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (database.filename().empty() || fs::is_directory(status)) {
    fail_in(database, Cause::invalid_argument, "{}: is a folder. Name a file: a database is one file",
            database.string());
  }
  if (!fs::exists(status)) return std::nullopt;
  if (!overwrite) {
    fail_in(database, Cause::invalid_argument,
            "{}: exists already; replace it with IngestOptions::overwrite or choose another name", database.string());
  }
  if (!fs::is_regular_file(status) || !is_a_database(target)) {
    fail_in(database, Cause::invalid_argument,
            "{}: exists, but is damaged or not a Talus database. Remove it or choose another name", database.string());
  }
  struct stat about {};
  if (::stat(target.c_str(), &about) != 0) fail(database, errno);
  const auto mode = about.st_mode & 07777u;
  // Root may write every file, so the mode counts as well.
  if ((mode & 0222u) == 0 || ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) {
    fail_in(database, Cause::io, "{}: is write-protected (mode {:04o}). Allow writing to it first", database.string(),
            mode);
  }
  return state_of(target);
}

}  // namespace

fs::path followed(const fs::path& name) {
  fs::path at = name;
  constexpr int kMostLinks = 40;  // the system's own limit
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(at, error))) return at;
    const fs::path to = fs::read_symlink(at, error);
    if (error) fail_in(name, Cause::io, "{}: {}", at.string(), error.message());
    at = to.is_absolute() ? to : at.parent_path() / to;
  }
  fail_in(name, Cause::invalid_argument, "{}: its symbolic links lead in a circle", name.string());
}

fs::path unfinished_file(const fs::path& database) { return followed(database).string() + ".part"; }

PartFile::PartFile(fs::path database, bool overwrite, Left left)
    : database_(std::move(database)), target_(followed(database_)), part_(unfinished_file(database_)) {
  look_at_database(overwrite);  // once now, and again under the lock
  lock();
  try {
    look_at_database(overwrite);
    look_at_left(left);
    if (replaced_) take_owner_and_mode();
  } catch (...) {
    if (!keep_) ::unlink(part_.c_str());
    ::close(handle_);
    throw;
  }
}

/// Another process may rename or remove the file between open and lock; then the lock is on the wrong file.
void PartFile::lock() {
  constexpr int kTries = 1000;
  for (int i = 0; i < kTries; ++i) {
    handle_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
    if (handle_ < 0) fail(part_, errno);
    struct stat locked {
    }, named{};
    if (::fstat(handle_, &locked) != 0 || !S_ISREG(locked.st_mode)) {
      ::close(handle_);
      fail_in(part_, Cause::invalid_argument, "{}: is not a file, but Talus needs this name for its work. Move it away",
              part_.string());
    }
    if (::flock(handle_, LOCK_EX | LOCK_NB) != 0) {
      ::close(handle_);
      fail_in(part_, Cause::invalid_argument,
              "{}: another ingest or update is writing it. Try again when that has ended", part_.string());
    }
    if (::stat(part_.c_str(), &named) == 0 && is_same_file(locked, named)) {
      keep_ = true;  // until we know that it is worthless
      if (::fstat(handle_, &locked) == 0 && locked.st_size == 0) keep_ = false;
      return;
    }
    ::close(handle_);
  }
  fail_in(part_, Cause::io, "{}: other programs keep replacing it. Try again when they have ended", part_.string());
}

void PartFile::look_at_database(bool overwrite) { replaced_ = require_replaceable(database_, target_, overwrite); }

void PartFile::look_at_left(Left left) {
  const bool is_ours = is_unfinished_database(handle_);
  if (!is_ours && left == Left::resume) {
    fail_in(
        part_, Cause::corrupt,
        "{}: is damaged, or was not written by an ingest. Move it away and start again without IngestOptions::resume",
        part_.string());
  }
  if (!is_ours) {
    fail_in(part_, Cause::invalid_argument,
            "{}: exists and was not written by an ingest, but Talus needs this name for its work. Move it away",
            part_.string());
  }
  const bool is_empty = !keep_;
  if (!is_empty && left != Left::replace) {
    const LeftWork work = left_work_in(part_);
    if (left == Left::resume && work.kind == LeftWork::Kind::damaged) {
      fail_in(part_, Cause::corrupt,
              "{}: is damaged: {}. It cannot be resumed; start again with IngestOptions::overwrite", part_.string(),
              work.damage);
    }
    if (left == Left::resume && work.kind == LeftWork::Kind::update) {
      fail_in(part_, Cause::invalid_argument,
              "{}: is from an interrupted update ({}), which cannot be resumed. The database is unchanged. Start again "
              "without IngestOptions::resume",
              part_.string(), work.title);
    }
    if (left == Left::resume) {
      left_ = work;
      return;
    }
    const bool is_worthless = work.kind == LeftWork::Kind::update && replaced_;
    if (work.tiles > 0 && !is_worthless) {
      fail_in(part_, Cause::invalid_argument,
              "{}: holds an interrupted ingest. Continue it with IngestOptions::resume, or start again with "
              "IngestOptions::overwrite",
              part_.string());
    }
  }
  if (::ftruncate(handle_, 0) != 0) fail(part_, errno);
  keep_ = false;
}

void PartFile::take_owner_and_mode() const {
  struct stat theirs {
  }, ours{};
  if (::stat(target_.c_str(), &theirs) != 0 || ::fstat(handle_, &ours) != 0) fail(database_, errno);
  const bool same_owner = theirs.st_uid == ours.st_uid && theirs.st_gid == ours.st_gid;
  if (!same_owner && ::fchown(handle_, theirs.st_uid, theirs.st_gid) != 0) {
    fail_in(database_, Cause::io,
            "{}: belongs to user {}, group {}. Only they or root can replace it and keep the owner", database_.string(),
            theirs.st_uid, theirs.st_gid);
  }
  if (::fchmod(handle_, theirs.st_mode & 07777u) != 0) fail(part_, errno);
}

PartFile::~PartFile() {
  if (!keep_) ::unlink(part_.c_str());
  ::close(handle_);
}

void PartFile::copy_database() {
  const int from = ::open(target_.c_str(), O_RDONLY | O_CLOEXEC);
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
  require_database_unchanged();
}

void PartFile::require_database_unchanged() const {
  std::optional<FileState> now;
  try {
    now = state_of(target_);
  } catch (const Failure& f) {
    if (f.cause() != Cause::not_found) throw;
  }
  if (now && replaced_) {
    now->changed_ns = replaced_->changed_ns;  // a new link or mode does not change the content
  }
  if (now == replaced_) return;
  const char* what = !replaced_ ? "was made" : !now ? "was removed" : "was replaced or changed";
  fail_in(database_, Cause::io,
          "{}: {} by another program meanwhile; nothing was changed. Look at it and run the command again",
          database_.string(), what);
}

void PartFile::publish() {
  if (::fsync(handle_) != 0) fail(part_, errno);
  struct stat locked {
  }, named{};
  if (::fstat(handle_, &locked) != 0 || ::stat(part_.c_str(), &named) != 0 || !is_same_file(locked, named)) {
    keep_ = true;  // it belongs to another program
    fail_in(part_, Cause::io,
            "{}: was removed or replaced by another program meanwhile; nothing was changed. Run the command again",
            part_.string());
  }
  require_database_unchanged();
  int renamed = -1;
  if (!replaced_) {  // a file that was made meanwhile is not replaced
    renamed = ::renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE);
    if (renamed != 0 && errno == EEXIST) require_database_unchanged();
  }
  if (renamed != 0 && ::rename(part_.c_str(), target_.c_str()) != 0) fail(database_, errno);
  keep_ = true;
  if (const int handle = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); handle >= 0) {
    ::fsync(handle);  // so that the new name survives a power cut
    ::close(handle);
  }
}

void require_target(const fs::path& database, bool overwrite, std::uint64_t bytes) {
  const fs::path target = followed(database), part = unfinished_file(database), folder = folder_of(target);
  static_cast<void>(require_replaceable(database, target, overwrite));
  std::error_code error;
  if (!fs::is_directory(folder, error))
    fail_in(folder, Cause::not_found, "{}: there is no folder {}; make it first", database.string(), folder.string());
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    fail_in(folder, Cause::io, "{}: cannot write in {}: {}", database.string(), folder.string(), std::strerror(errno));
  const fs::space_info space = fs::space(folder, error);
  std::error_code none;
  const auto left = fs::file_size(part, none);  // will be reused or replaced
  const std::uint64_t room = error ? bytes : space.available + (none ? 0 : left);
  if (room < bytes) {
    fail_in(folder, Cause::full,
            "{}: about {} MB are needed and {} MB are free in {}; free some space or write elsewhere",
            database.string(), (bytes + 999'999) / 1'000'000, room / 1'000'000, folder.string());
  }
}

}  // namespace talus
