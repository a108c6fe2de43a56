#include "query/export/output_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "engine/machine/fail.hpp"

namespace talus {
namespace {

constexpr std::size_t kBuffer = 1u << 20;  // bytes
constexpr int kTries = 100;                // file names to try; others may write beside the target, too
constexpr int kLinks = 40;                 // most links in a chain

/// The file that a link leads to. It need not exist.
std::filesystem::path followed(const std::filesystem::path& target) {
  std::error_code failed;
  std::filesystem::path place = target;
  for (int i = 0; i < kLinks && std::filesystem::is_symlink(place, failed); ++i) {
    const std::filesystem::path next = std::filesystem::read_symlink(place, failed);
    if (failed) break;
    place = place.parent_path() / next;
  }
  return place;
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path target) : target_(std::move(target)), place_(followed(target_)) {
  std::error_code ignored;
  const std::filesystem::file_status there = std::filesystem::status(place_, ignored);
  if (std::filesystem::is_directory(there))
    fail_in(target_, Cause::io, "cannot write {}: it is a folder", target_.string());
  if (std::filesystem::is_symlink(place_, ignored))
    fail_in(target_, Cause::io, "cannot write {}: its links lead in a circle", target_.string());
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))
    fail_in(target_, Cause::io, "cannot write {}: it is a device, a pipe or a socket. Name a file", target_.string());
  for (int i = 0; file_ < 0; ++i) {
    beside_ = place_;
    beside_ += fmt::format(".{}-{}.part", ::getpid(), i);
    file_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ < 0 && (errno != EEXIST || i == kTries)) fail("write");
  }
  buffer_.reserve(kBuffer);
}

OutputFile::~OutputFile() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(beside_.c_str());
}

void OutputFile::write(const void* bytes, std::size_t count) {
  const auto* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const std::size_t part = std::min(count, kBuffer - buffer_.size());
    buffer_.insert(buffer_.end(), from, from + part);
    from += part;
    count -= part;
    if (buffer_.size() == kBuffer) flush();
  }
}

void OutputFile::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ::ssize_t written = ::write(file_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    done += static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

void OutputFile::commit() {
  flush();
  if (::fsync(file_) != 0) fail("write");
  if (::rename(beside_.c_str(), place_.c_str()) != 0) fail("rename what was written to");
  if (::close(std::exchange(file_, -1)) != 0) fail("close");
}

void OutputFile::fail(const char* what) const {
  const int code = errno;
  const std::string why = code == EFBIG
                              ? "it is larger than this process or the file system may write (ulimit -f says how large)"
                              : std::strerror(code);
  fail_in(target_, code == ENOSPC || code == EDQUOT ? Cause::full : Cause::io, "cannot {} {}: {}", what,
          target_.string(), why);
}

}  // namespace talus
