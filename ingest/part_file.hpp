#pragma once
// The file an ingest works in until it is whole.

#include <filesystem>

namespace talus {

/// `database`.part: held against other ingests; removed at the end unless published or kept.
class PartFile {
 public:
  /// What to do with work that an interrupted ingest left.
  enum class Left { refuse, replace, resume };

  /// Makes the file, empty, or takes what was left of it.
  /// fails  invalid_argument: the database exists and may not be overwritten or is no database at all; the working
  ///        name is another ingest's, somebody's file or, with `refuse`, an interrupted ingest's; not_found: no such
  ///        folder; io
  PartFile(std::filesystem::path database, bool overwrite, Left left);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  /// Makes it a copy of the database; shares its blocks where the file system can.
  void copy_database();
  /// From now on it stays when the work ends before it is whole.
  void keep() { keep_ = true; }
  /// Puts the file in the database's place, in one step and for good.
  void publish();

 private:
  std::filesystem::path database_, part_;
  int handle_ = -1;
  bool keep_ = false;
};

}  // namespace talus
