#pragma once
// The files behind the inputs, and whether they have changed.

#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "ingest/files/file_state.hpp"
#include "ingest/mosaic/source.hpp"

namespace talus {

/// A file and the XXH3 digest of its bytes.
struct DigestedFile {
  FileState state;
  /// Written so shortly before it was read that a second write could have the same times.
  bool is_young = false;
  std::uint64_t digest = 0;
};

/// All files behind all inputs, as they were before the first sample was read.
///
/// Each file is read once for its digest. Later checks compare its state, and read it again only if the state differs:
/// new times over the same bytes are no change.
class InputFiles {
 public:
  /// known  files with digests of an earlier run; unchanged ones are not read again
  /// tell   called every few megabytes; may throw
  /// fails  not_found, io: names the file
  /// cost   reads every byte of all other files
  InputFiles(const Source& source, const std::vector<DigestedFile>& known, const std::function<void()>& tell);

  /// Each file once, in the order found.
  [[nodiscard]] const std::vector<DigestedFile>& files() const { return files_; }
  /// The digest of an input's file. If it has several: XXH3 over their digests, each as 8 bytes, big endian.
  [[nodiscard]] std::uint64_t checksum(std::size_t input) const;
  /// Whether a check has found a changed file.
  [[nodiscard]] bool is_changed() const { return is_changed_; }

  /// Checks the files of inputs with samples in a rectangle.
  /// fails  io: a file was changed or removed; names it and the change
  void require_unchanged(GridRect part);
  /// Checks all files, and whether a file was added or removed. Reads young files again.
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

/// How a file has changed: "has 120 bytes, had 100" or "has other content, written 2026-05-13 14:03:20"; empty if not.
[[nodiscard]] std::string difference_of(const DigestedFile& then, const DigestedFile& now);

}  // namespace talus
