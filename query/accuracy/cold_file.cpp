#include "query/accuracy/cold_file.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace talus {
namespace {

class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& file) : number_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() {
    if (number_ >= 0) ::close(number_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

void drop_from_memory(const std::filesystem::path& file) noexcept {
  const OpenFile opened(file);
  if (opened.number() >= 0) static_cast<void>(::posix_fadvise(opened.number(), 0, 0, POSIX_FADV_DONTNEED));
}

std::optional<double> share_in_memory(const std::filesystem::path& file) {
  const OpenFile opened(file);
  struct stat status {};
  if (opened.number() < 0 || ::fstat(opened.number(), &status) != 0 || status.st_size <= 0) return {};
  const auto bytes = static_cast<std::size_t>(status.st_size);
  void* const map = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, opened.number(), 0);
  if (map == MAP_FAILED) return {};
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> held((bytes + page - 1) / page);
  const bool told = ::mincore(map, bytes, held.data()) == 0;
  ::munmap(map, bytes);
  if (!told) return {};
  const auto pages = std::count_if(held.begin(), held.end(), [](unsigned char h) { return (h & 1u) != 0; });
  return static_cast<double>(pages) / static_cast<double>(held.size());
}

}  // namespace talus
