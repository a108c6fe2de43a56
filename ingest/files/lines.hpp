#pragma once
// Lines of text files that people write: lists of files, points. Read within limits, from regular files only.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace talus {

class Lines {
 public:
  /// what      it is, for sentences: "list", "file of points"
  /// longest   bytes of a line
  /// fails     not_found, io: a folder, a device, a pipe; the sentence names the file
  Lines(const std::filesystem::path& file, const char* what, std::size_t longest);

  /// The next line without its end; false behind the last.
  /// fails  invalid_argument: a line that is too long; io
  [[nodiscard]] bool next(std::string& line);
  /// Of the line that was read last, from 1.
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  std::filesystem::path file_;
  std::string what_;
  std::size_t longest_;
  std::uint64_t number_ = 0;
  std::ifstream in_;
};

}  // namespace talus
