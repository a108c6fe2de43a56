#include "query/export/output_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::size_t kBuffer = 1u << 20;  // bytes
constexpr int kTries = 100;                // names beside the target, where others write it, too

}  // namespace

OutputFile::OutputFile(std::filesystem::path target) : target_(std::move(target)) {
  std::error_code ignored;
  if (std::filesystem::is_directory(target_, ignored)) {
    throw Failure(Cause::io, fmt::format("cannot write {}: it is a folder", target_.string()));
  }
  for (int i = 0; file_ < 0; ++i) {
    beside_ = target_;
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
  if (::rename(beside_.c_str(), target_.c_str()) != 0) fail("rename what was written to");
  if (::close(std::exchange(file_, -1)) != 0) fail("close");
}

void OutputFile::fail(const char* what) const {
  const int code = errno;
  throw Failure(code == ENOSPC || code == EDQUOT ? Cause::full : Cause::io,
                fmt::format("cannot {} {}: {}", what, target_.string(), std::strerror(code)));
}

}  // namespace talus
