#pragma once
// The file an ingest works in until it is whole.

#include <filesystem>

namespace talus {

/// `database`.part: made empty and held against other ingests; removed unless published.
class PartFile {
 public:
  /// fails  invalid_argument: the database exists and may not be overwritten or is no database at all; the
  ///        working name is another ingest's or somebody's file; not_found: no such folder; io
  PartFile(std::filesystem::path database, bool overwrite);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  /// Puts the file in the database's place, in one step and for good.
  void publish();

 private:
  std::filesystem::path database_, part_;
  int handle_ = -1;
  bool published_ = false;
};

}  // namespace talus
