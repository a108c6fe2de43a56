#pragma once
// Reads text files line by line: lists of files, points.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace talus {

class Lines {
 public:
  /// what      kind of file in failures: "list", "file of points"
  /// longest   most bytes in a line
  /// fails     not_found, io: a folder, a device, a pipe; names the file
  Lines(const std::filesystem::path& file, const char* what, std::size_t longest);

  /// Reads the next line without its end; false at the end of the file.
  /// fails  invalid_argument: a line that is too long; io
  [[nodiscard]] bool next(std::string& line);
  /// The number of the line that was read last, from 1.
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  std::filesystem::path file_;
  std::string what_;
  std::size_t longest_;
  std::uint64_t number_ = 0;
  std::ifstream in_;
};

}  // namespace talus
