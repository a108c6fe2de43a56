#include "ingest/files/lines.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include "engine/machine/fail.hpp"

namespace talus {

Lines::Lines(const std::filesystem::path& file, const char* what, std::size_t longest)
    : file_(file), what_(what), longest_(longest) {
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::status(file, error);
  if (!std::filesystem::exists(there) && there.type() != std::filesystem::file_type::none)
    fail_in(file_, Cause::not_found, "there is no {} {}", what_, file_.string());
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) {
    fail_in(file_, Cause::io, "cannot read {} {}: it is {}", what_, file_.string(),
            std::filesystem::is_directory(there) ? "a folder"
                                                 : "a device, a pipe or a socket; copy its content to a file first");
  }
  in_.open(file);
  if (!in_) fail_in(file_, Cause::io, "cannot read {} {}: {}", what_, file_.string(), std::strerror(errno));
}

bool Lines::next(std::string& line) try {
  line.clear();
  for (int c = in_.rdbuf()->sbumpc();; c = in_.rdbuf()->sbumpc()) {
    const bool is_end = c == std::char_traits<char>::eof();
    if (is_end && line.empty()) return false;
    if (line.empty()) ++number_;
    if (is_end || c == '\n') return true;
    if (line.size() == longest_) {
      fail_in(file_, Cause::invalid_argument, "{}, line {}: longer than {} bytes, too long for a {}", file_.string(),
              number_, longest_, what_);
    }
    line.push_back(static_cast<char>(c));
  }
} catch (const std::ios_base::failure&) {
  fail_in(file_, Cause::io, "cannot read {} {}", what_, file_.string());
}

}  // namespace talus
