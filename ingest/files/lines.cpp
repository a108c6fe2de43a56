#include "ingest/files/lines.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus {

Lines::Lines(const std::filesystem::path& file, const char* what, std::size_t longest)
    : file_(file), what_(what), longest_(longest) {
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::status(file, error);
  if (!std::filesystem::exists(there) && there.type() != std::filesystem::file_type::none)
    throw Failure(Cause::not_found, fmt::format("there is no {} {}", what_, file_.string()), file_);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) {
    throw Failure(Cause::io,
                  fmt::format("cannot read {} {}: it is {}", what_, file_.string(),
                              std::filesystem::is_directory(there)
                                  ? "a folder"
                                  : "a device, a pipe or a socket; copy its content to a file first"),
                  file_);
  }
  in_.open(file);
  if (!in_)
    throw Failure(Cause::io, fmt::format("cannot read {} {}: {}", what_, file_.string(), std::strerror(errno)), file_);
}

bool Lines::next(std::string& line) try {
  line.clear();
  for (int c = in_.rdbuf()->sbumpc();; c = in_.rdbuf()->sbumpc()) {
    const bool is_end = c == std::char_traits<char>::eof();
    if (is_end && line.empty()) return false;
    if (line.empty()) ++number_;
    if (is_end || c == '\n') return true;
    if (line.size() == longest_) {
      throw Failure(
          Cause::invalid_argument,
          fmt::format("{}, line {}: longer than {} bytes, too long for a {}", file_.string(), number_, longest_, what_),
          file_);
    }
    line.push_back(static_cast<char>(c));
  }
} catch (const std::ios_base::failure&) {
  throw Failure(Cause::io, fmt::format("cannot read {} {}", what_, file_.string()), file_);
}

}  // namespace talus
