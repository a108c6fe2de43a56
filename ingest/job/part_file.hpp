#pragma once
// The file an ingest, an update or a compaction works in until it is whole.

#include <filesystem>
#include <optional>

#include "ingest/files/file_state.hpp"
#include "ingest/job/left_work.hpp"

namespace talus {

/// `database`.part: held against other writers; removed at the end unless published or kept. Where `database` is a
/// symbolic link, the file that it leads to is meant: the link stays.
class PartFile {
 public:
  /// What to do with work that an interrupted ingest left. What an update or a compaction left is worth nothing
  /// beside the database: it is replaced by all but `resume`.
  enum class Left { refuse, replace, resume };

  /// Locks the file, makes it if need be, and only then looks at it and at the database.
  /// fails  invalid_argument: the database exists and may not be overwritten or is no database at all; the working
  ///        name is another writer's, somebody's file or, with `refuse`, an interrupted ingest's, or with `resume` an
  ///        interrupted update's; corrupt: with `resume`, what was left is damaged; not_found: no such folder; io: the
  ///        database is write-protected or another user's
  PartFile(std::filesystem::path database, bool overwrite, Left left);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  /// The database that is made or replaced, symbolic links followed.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// Work to go on with, its structure checked; empty without any. See also verify_left_work.
  [[nodiscard]] const std::optional<LeftWork>& left() const { return left_; }
  /// Makes it a copy of the database; shares its blocks where the file system can.
  void copy_database();
  /// Writes from the file's begin: for who makes it by other means.
  [[nodiscard]] int handle() const { return handle_; }
  /// From now on it stays when the work ends before it is whole; or it goes.
  void keep(bool whether = true) { keep_ = whether; }
  /// The database is still the file that stood there when this was made.
  /// fails  io: another program has replaced, changed, removed or made it
  void require_database_unchanged() const;
  /// Puts the file in the database's place, in one step and for good. It has the database's owner and mode.
  /// fails  io: as require_database_unchanged, or renaming failed; full
  void publish();

 private:
  void lock();
  void look_at_database(bool overwrite);
  void look_at_left(Left left);
  void take_owner_and_mode() const;

  std::filesystem::path database_, target_, part_;  // as it was named; links followed; beside the target
  std::optional<FileState> replaced_;
  int handle_ = -1;
  bool keep_ = false;
  std::optional<LeftWork> left_;
};

/// A database's file can be made or replaced, and there is room for so many bytes. Writes nothing.
/// fails  as PartFile; full: less room than that
void require_target(const std::filesystem::path& database, bool overwrite, std::uint64_t bytes);

/// The file that a name leads to, symbolic links followed, whether it exists or not.
[[nodiscard]] std::filesystem::path followed(const std::filesystem::path& name);

}  // namespace talus
