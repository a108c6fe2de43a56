#include "storage/environment.hpp"

#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <lmdb.h>
#include <sys/stat.h>

#include "storage/lmdb_check.hpp"
#include "talus/failure.hpp"

namespace talus {

void check(int code, const char* doing, const std::filesystem::path& file) {
  if (code == MDB_SUCCESS) return;
  const std::string sentence = fmt::format("{}: cannot {}: {}", file.string(), doing, mdb_strerror(code));
  switch (code) {
    case ENOSPC:
    case EDQUOT:
    case MDB_MAP_FULL:
      throw Failure(Cause::full, fmt::format("{}: the disk is full; free some space or write elsewhere", file.string()),
                    file);
    case ENOENT: throw Failure(Cause::not_found, sentence, file);
    case ENOMEM: throw Failure(Cause::out_of_memory, sentence, file);
    case MDB_INVALID:
    case MDB_VERSION_MISMATCH:
    case MDB_CORRUPTED:
    case MDB_PAGE_NOTFOUND:
    case MDB_INCOMPATIBLE:
      throw Failure(Cause::corrupt, fmt::format("corrupt: {}: {}", file.string(), mdb_strerror(code)), file);
    default: throw Failure(Cause::io, sentence, file);
  }
}

void CloseEnv::operator()(MDB_env* env) const { mdb_env_close(env); }
void AbortTxn::operator()(MDB_txn* txn) const { mdb_txn_abort(txn); }

std::string table_name(int table) {
  if (table == kHeaderTable) return "header";
  if (table == kSliceTable) return "slices";
  return table == kRecordTable ? "records" : fmt::format("band/{:02}", table);
}

void PageStore::Environment::open_table() {
  MDB_txn* raw = nullptr;
  check(mdb_txn_begin(env.get(), nullptr, MDB_RDONLY, &raw), "read it", file);
  TxnPtr txn(raw);
  check(mdb_dbi_open(raw, nullptr, 0, &table), "read its table", file);
  watch_map(raw);
  check(mdb_txn_commit(txn.release()), "read its table", file);
}

void PageStore::Environment::watch_map(MDB_txn* txn) {
  // LMDB does not say where its map begins. A cursor's key lies in a page, and the page's header has its number.
  MDB_cursor* raw = nullptr;
  if (mdb_cursor_open(txn, table, &raw) != MDB_SUCCESS) return;
  const std::unique_ptr<MDB_cursor, decltype(&mdb_cursor_close)> cursor(raw, mdb_cursor_close);
  MDB_val key{}, value{};
  if (mdb_cursor_get(raw, &key, &value, MDB_FIRST) != MDB_SUCCESS) return;  // the file is empty
  MDB_stat sizes{};
  MDB_envinfo info{};
  check(mdb_env_stat(env.get(), &sizes), "read its size", file);
  check(mdb_env_info(env.get(), &info), "read its size", file);
  const auto at = reinterpret_cast<std::uintptr_t>(key.mv_data);
  const auto* page = static_cast<const std::byte*>(key.mv_data) - at % sizes.ms_psize;
  std::uint64_t number = 0;
  std::memcpy(&number, page, sizeof number);
  if (number <= info.me_last_pgno) guard.watch(page - number * sizes.ms_psize, info.me_mapsize);
}

namespace {

using ChangeTime = std::pair<std::int64_t, std::int64_t>;

ChangeTime change_time(const struct stat& status) { return {status.st_mtim.tv_sec, status.st_mtim.tv_nsec}; }

/// The state of the open file, whatever its name leads to now. Empty: the system does not say.
std::optional<struct stat> status_of(MDB_env* env) {
  int descriptor = -1;
  struct stat now {};
  if (mdb_env_get_fd(env, &descriptor) != MDB_SUCCESS || ::fstat(descriptor, &now) != 0) return std::nullopt;
  return now;
}

}  // namespace

bool PageStore::Environment::has_changed() const {
  if (!changed_before) return false;
  const auto now = status_of(env.get());
  return now && change_time(*now) != *changed_before;
}

void PageStore::Environment::require_all_bytes() const {
  if (!guard.has_lost_bytes() && !has_changed()) return;
  const auto now = status_of(env.get());
  const bool is_short = guard.has_lost_bytes() || (now && static_cast<std::uint64_t>(now->st_size) < file_bytes);
  const char* what = is_short
                         ? "the file was cut short while it was open, or its disk fails: restore it, and open it again"
                         : "another program wrote into the file while it was open: open it again";
  throw Failure(Cause::io, fmt::format("{}: {}", file.string(), what), file);
}

namespace {

/// LMDB fails if one process opens a file twice, so all users of a file share one environment.
class OpenFiles {
 public:
  std::shared_ptr<PageStore::Environment> open(const std::filesystem::path& file) {
    const std::lock_guard lock(mutex_);
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) {
      throw Failure(errno == ENOENT || errno == ENOTDIR ? Cause::not_found : Cause::io,
                    fmt::format("{}: {}", file.string(), std::strerror(errno)));
    }
    if (!S_ISREG(status.st_mode))
      throw Failure(Cause::corrupt,
                    fmt::format("{}: it is not a regular file, so it is not a database", file.string()));
    const auto key = std::pair{status.st_dev, status.st_ino};
    if (auto shared = open_[key].lock(); shared && !shared->has_changed()) return shared;
    auto made = make(file, static_cast<std::uint64_t>(status.st_size));
    made->changed_before = change_time(status);
    made->place = {status.st_dev, status.st_ino};
    open_[key] = made;
    return made;
  }

 private:
  static std::shared_ptr<PageStore::Environment> make(const std::filesystem::path& file, std::uint64_t bytes) {
    refuse_unsound(file);
    // A database file never changes after it is renamed into place, so it needs no lock file, also on read-only media.
    auto made = std::make_shared<PageStore::Environment>();
    MDB_env* env = nullptr;
    check(mdb_env_create(&env), "open it", file);
    made->env.reset(env);
    check(mdb_env_open(env, file.c_str(), MDB_NOSUBDIR | MDB_RDONLY | MDB_NOLOCK | MDB_NOTLS | MDB_NORDAHEAD, 0),
          "open it", file);
    made->file = file;
    made->file_bytes = bytes;
    made->open_table();
    return made;
  }

  std::mutex mutex_;
  std::map<std::pair<dev_t, ino_t>, std::weak_ptr<PageStore::Environment>> open_;
};

OpenFiles& open_files() {
  static OpenFiles files;
  return files;
}

}  // namespace

PageStore PageStore::open(const std::filesystem::path& file) { return PageStore(open_files().open(file)); }
const std::filesystem::path& PageStore::file() const { return environment_->file; }
bool PageStore::is_file(const std::filesystem::path& name) const {
  struct stat status {};
  return ::stat(name.c_str(), &status) == 0 &&
         environment_->place == std::pair<std::uint64_t, std::uint64_t>{status.st_dev, status.st_ino} &&
         !environment_->has_changed();
}
std::uint64_t PageStore::file_bytes() const { return environment_->file_bytes; }

}  // namespace talus
