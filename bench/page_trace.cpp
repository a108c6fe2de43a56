#include "bench/page_trace.hpp"

#include <algorithm>
#include <utility>

#include "storage/checksum.hpp"

// What `--wrap` of the linker calls page_checksum, and what others then reach by its name.
#define TALUS_PAGE_CHECKSUM "_ZN5talus13page_checksumENS_7PageKeyEjSt4spanIKSt4byteLm18446744073709551615EE"

namespace talus::bench {
namespace {

PageTrace* watching = nullptr;

}  // namespace

std::uint64_t real_checksum(PageKey key, std::uint32_t generation,
                            std::span<const std::byte> content) asm("__real_" TALUS_PAGE_CHECKSUM);
std::uint64_t watched_checksum(PageKey key, std::uint32_t generation,
                               std::span<const std::byte> content) asm("__wrap_" TALUS_PAGE_CHECKSUM);

struct Watch {
  static void add(PageTrace& trace, PageKey key, std::span<const std::byte> content) {
    trace.reads_.push_back({key.table, content});
  }
};

std::uint64_t watched_checksum(PageKey key, std::uint32_t generation, std::span<const std::byte> content) {
  if (watching != nullptr) Watch::add(*watching, key, content);
  return real_checksum(key, generation, content);
}

PageTrace::PageTrace() { watching = this; }
PageTrace::~PageTrace() { watching = nullptr; }

std::size_t PageTrace::runs(std::size_t gap) const {
  constexpr std::uintptr_t kFilePage = 4096;
  std::vector<std::pair<std::uintptr_t, std::uintptr_t>> pieces;  // first and last page of the file
  for (const PageRead& read : reads_) {
    if (read.bytes.empty()) continue;
    const auto at = reinterpret_cast<std::uintptr_t>(read.bytes.data());
    pieces.emplace_back(at / kFilePage, (at + read.bytes.size() - 1) / kFilePage);
  }
  std::sort(pieces.begin(), pieces.end());
  std::size_t count = 0;
  std::uintptr_t last = 0;
  for (const auto& [from, to] : pieces) {
    if (count == 0 || from > last + 1 + gap / kFilePage) ++count;
    last = std::max(last, to);
  }
  return count;
}

}  // namespace talus::bench
