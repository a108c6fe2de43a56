// The seal: a digest at the end of a finished file, after LMDB's last page.

#include "storage/seal.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include "storage/lmdb_check.hpp"
#include "storage/page_store.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::array<char, 8> kMagic{'T', 'A', 'L', 'U', 'S', 'E', 'N', 'D'};

/// Magic, length of the sealed part (little endian), digest (XXH3 of 128 bits, canonical: big endian).
using Seal = std::array<std::uint8_t, kSealBytes>;

class File {
 public:
  File(const std::filesystem::path& path, int flags) : path_(path), handle_(::open(path.c_str(), flags | O_CLOEXEC)) {
    if (handle_ < 0) fail();
  }
  ~File() { ::close(handle_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  [[nodiscard]] std::uint64_t size() const {
    const off_t end = ::lseek(handle_, 0, SEEK_END);
    if (end < 0) fail();
    return static_cast<std::uint64_t>(end);
  }
  [[nodiscard]] std::size_t read(std::uint64_t at, void* to, std::size_t bytes) const {
    ssize_t got = 0;
    do {
      got = ::pread(handle_, to, bytes, static_cast<off_t>(at));
    } while (got < 0 && errno == EINTR);
    if (got < 0) fail();
    return static_cast<std::size_t>(got);
  }
  void write(const void* from, std::size_t bytes, std::uint64_t at) const {
    const ssize_t put = ::pwrite(handle_, from, bytes, static_cast<off_t>(at));
    if (put == static_cast<ssize_t>(bytes)) return;
    if (put >= 0) errno = ENOSPC;
    fail();
  }
  void append(const Seal& seal, std::uint64_t at) const {
    write(seal.data(), seal.size(), at);
    if (::fsync(handle_) != 0) fail();
  }
  void cut(std::uint64_t bytes) const {
    if (::ftruncate(handle_, static_cast<off_t>(bytes)) != 0) fail();
  }

 private:
  [[noreturn]] void fail() const {
    const Cause cause = errno == ENOSPC || errno == EDQUOT ? Cause::full
                        : errno == ENOENT                  ? Cause::not_found
                                                           : Cause::io;
    throw Failure(cause,
                  cause == Cause::full
                      ? fmt::format("{}: the disk is full; free some space or write elsewhere", path_.string())
                      : fmt::format("{}: {}", path_.string(), std::strerror(errno)),
                  path_);
  }
  std::filesystem::path path_;
  int handle_;
};

Seal seal_over(const File& file, std::uint64_t bytes) {
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  const std::unique_ptr<XXH3_state_t, Free> state(XXH3_createState());
  if (!state) throw std::bad_alloc();
  XXH3_128bits_reset(state.get());
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  for (std::uint64_t at = 0; at < bytes;) {
    const std::size_t got = file.read(at, buffer.data(), std::min<std::uint64_t>(buffer.size(), bytes - at));
    if (got == 0) break;  // the file became shorter: the digest will differ
    XXH3_128bits_update(state.get(), buffer.data(), got);
    at += got;
  }
  XXH128_canonical_t digest;
  XXH128_canonicalFromHash(&digest, XXH3_128bits_digest(state.get()));
  Seal seal{};
  std::memcpy(seal.data(), kMagic.data(), kMagic.size());
  for (std::size_t i = 0; i < 8; ++i) seal[8 + i] = static_cast<std::uint8_t>(bytes >> (8 * i));
  std::memcpy(&seal[16], digest.digest, sizeof digest.digest);
  return seal;
}

/// The seal at the end of a file, if any.
std::optional<Seal> seal_of(const File& file) {
  const std::uint64_t size = file.size();
  Seal seal{};
  if (size < kSealBytes || file.read(size - kSealBytes, seal.data(), seal.size()) != kSealBytes ||
      std::memcmp(seal.data(), kMagic.data(), kMagic.size()) != 0) {
    return std::nullopt;
  }
  return seal;
}

}  // namespace

void put_seal(const std::filesystem::path& path) {
  const File file(path, O_RDWR);
  // Plans and pages that were replaced would stay in the file: paths and times of one machine.
  std::vector<std::byte> zeros;
  for (const auto& [first, bytes] : unused_ranges(path)) {
    zeros.resize(std::max<std::size_t>(zeros.size(), bytes));
    file.write(zeros.data(), bytes, first);
  }
  const std::uint64_t bytes = file.size();
  file.append(seal_over(file, bytes), bytes);
}

void break_seal(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return;
  const File file(path, O_RDWR);
  if (seal_of(file)) file.cut(file.size() - kSealBytes);
}

std::string check_seal(const std::filesystem::path& path) {
  const File file(path, O_RDONLY);
  const auto seal = seal_of(file);
  if (!seal) return "the file has no seal at its end: it was cut short or lengthened, or never finished";
  if (seal_over(file, file.size() - kSealBytes) != *seal) return "the file's bytes have changed since it was finished";
  return "";
}

}  // namespace talus
