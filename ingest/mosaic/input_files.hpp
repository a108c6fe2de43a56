#pragma once
// The files that inputs are read from, and whether they are still the same.

#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "ingest/files/file_state.hpp"
#include "ingest/mosaic/source.hpp"

namespace talus {

/// A file and the XXH3 of its bytes.
struct DigestedFile {
  FileState state;
  /// It was written so shortly before that a second write could have left the same times: they vouch for nothing.
  bool is_young = false;
  std::uint64_t digest = 0;
};

/// All files behind all inputs, as they were before the first sample was read.
///
/// Each file is read once for its digest. Later looks compare what the system says of the file, and read it again only
/// where that differs: other times over the same bytes change nothing.
class InputFiles {
 public:
  /// known  files with digests of an earlier run: those that did not change since are not read again
  /// tell   called every few megabytes; may throw
  /// fails  not_found, io: names the file
  /// cost   reads every byte of every other file
  InputFiles(const Source& source, const std::vector<DigestedFile>& known, const std::function<void()>& tell);

  /// In the order in which they are found, each once.
  [[nodiscard]] const std::vector<DigestedFile>& files() const { return files_; }
  /// Of an input: the digest of its file. Of several: XXH3 over their digests, each as 8 bytes, big endian.
  [[nodiscard]] std::uint64_t checksum(std::size_t input) const;
  /// A later look has found that a file changed.
  [[nodiscard]] bool is_changed() const { return is_changed_; }

  /// Looks again at the files of inputs with samples in a rectangle: what was just read from them is what was digested.
  /// fails  io: a file was changed or removed; names it and says what changed
  void require_unchanged(GridRect part);
  /// Looks at all again, and whether a file has come or gone. Files that were young are read again.
  void require_unchanged(const std::function<void()>& tell);

 private:
  void look_again(DigestedFile& file, bool trusts_young, const std::function<void()>& tell);
  [[noreturn]] void fail(const FileState& file, const std::string& what);
  [[nodiscard]] FileState state_now(const FileState& then);

  const Source* source_;
  std::vector<DigestedFile> files_;
  std::vector<std::vector<std::size_t>> of_input_;  // indices into files_
  bool is_changed_ = false;
};

/// How a file differs from what it was: "has 120 bytes, had 100" or "has other content since 2026-05-13 14:03:20".
[[nodiscard]] std::string difference_of(const DigestedFile& then, const DigestedFile& now);

}  // namespace talus
