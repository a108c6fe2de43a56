#pragma once
// The working file of an ingest, an update or a compaction.

#include <filesystem>
#include <optional>

#include "ingest/files/file_state.hpp"
#include "ingest/job/left_work.hpp"

namespace talus {

/// The file `database`.part, locked against other writers. It is removed at the end unless it is published or kept.
/// If `database` is a symbolic link, the file it leads to is replaced and the link stays.
class PartFile {
 public:
  /// Whether to refuse, replace or resume the work of an interrupted ingest. Work of an interrupted update or
  /// compaction is worthless: only `resume` does not replace it.
  enum class Left { refuse, replace, resume };

  /// Makes and locks the file, then checks it and the database.
  ///
  /// fails  invalid_argument: the database exists and may not be overwritten, or is not a database; another process
  ///        writes; the working file is not ours, or holds an interrupted ingest (`refuse`) or update (`resume`)
  ///        corrupt: the work to resume is damaged; not_found: no such folder
  ///        io: the database is write-protected or belongs to another user
  PartFile(std::filesystem::path database, bool overwrite, Left left);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  /// The database to be made or replaced, symbolic links followed.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// The work to resume, its structure checked; empty if there is none. See also verify_left_work.
  [[nodiscard]] const std::optional<LeftWork>& left() const { return left_; }
  /// Copies the database into this file. Shares blocks where the file system can.
  void copy_database();
  /// A handle for writing from the file's beginning.
  [[nodiscard]] int handle() const { return handle_; }
  /// Whether the file stays if the work ends early.
  void keep(bool whether = true) { keep_ = whether; }
  /// The database is still the file that was there at the beginning.
  /// fails  io: another program has replaced, changed, removed or made it
  void require_database_unchanged() const;
  /// Gives the file the database's name, owner and mode, in one step.
  /// fails  io: as require_database_unchanged, or the system refuses; full
  void publish();

 private:
  void lock();
  void look_at_database(bool overwrite);
  void look_at_left(Left left);
  void take_owner_and_mode() const;

  std::filesystem::path database_, target_, part_;  // as named; links followed; beside the target
  std::optional<FileState> replaced_;
  int handle_ = -1;
  bool keep_ = false;
  std::optional<LeftWork> left_;
};

/// A database can be made or replaced, and there is room for `bytes`. Writes nothing.
/// fails  as PartFile; full: too little room
void require_target(const std::filesystem::path& database, bool overwrite, std::uint64_t bytes);

/// The file that a name leads to, symbolic links followed. It need not exist.
[[nodiscard]] std::filesystem::path followed(const std::filesystem::path& name);

}  // namespace talus
