#pragma once
// Memory for arrays as large as the raster. The first write to each page of 4 KiB costs as much as computing what is
// written (bench_engine, BM_ErrorsAndSaturation/side:4097), so these ask the system for pages of 2 MiB.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory_resource>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace talus {

/// Asks for large pages. The system may ignore it.
inline void ask_for_large_pages(void* memory, std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr std::size_t kPage = 4096;
  auto* first = static_cast<char*>(memory);
  const std::size_t before = (kPage - reinterpret_cast<std::uintptr_t>(first) % kPage) % kPage;
  if (bytes > before) ::madvise(first + before, bytes - before, MADV_HUGEPAGE);
#else
  (void)memory, (void)bytes;
#endif
}

/// Memory in whole large pages, aligned to them; null: none is free.
inline void* map_large_pages(std::size_t bytes) {
  constexpr std::size_t kHugePage = std::size_t{2} << 20;
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  void* mapped = ::mmap(nullptr, bytes + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) return nullptr;
  auto* first = static_cast<char*>(mapped);
  const std::size_t before = (kHugePage - reinterpret_cast<std::uintptr_t>(first) % kHugePage) % kHugePage;
  if (before > 0) ::munmap(first, before);
  ::munmap(first + before + bytes, kHugePage - before);
  ask_for_large_pages(first + before, bytes);
  return first + before;
#else
  return std::aligned_alloc(kHugePage, bytes);
#endif
}
inline void unmap_large_pages(void* memory, std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  ::munmap(memory, bytes);
#else
  (void)bytes;
  std::free(memory);
#endif
}

/// Reserves room for `count` values and a quarter more, because later tiles and panels are larger than the first one.
/// The old values may be lost.
template <class T, class Allocator>
void make_room(std::vector<T, Allocator>& values, std::size_t count) {
  if (values.capacity() >= count) return;
  values = {};
  values.reserve(count + count / 4);
  ask_for_large_pages(values.data(), values.capacity() * sizeof(T));
}

/// A source of memory for containers that allocate piece by piece and free everything at once.
class LargePages final : public std::pmr::memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

template <class T>
struct LargeAllocator {
  using value_type = T;
  static constexpr std::size_t kHugePage = std::size_t{2} << 20;

  LargeAllocator() = default;
  template <class U>
  explicit LargeAllocator(const LargeAllocator<U>&) {}

  [[nodiscard]] T* allocate(std::size_t count) {
    std::size_t bytes = count * sizeof(T);
    const bool large = bytes >= 2 * kHugePage;
    if (large) bytes = (bytes + kHugePage - 1) & ~(kHugePage - 1);
    void* memory = large ? std::aligned_alloc(kHugePage, bytes) : std::malloc(bytes);
    if (memory == nullptr) throw std::bad_alloc();
    if (large) ask_for_large_pages(memory, bytes);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) noexcept { std::free(memory); }
  friend bool operator==(LargeAllocator, LargeAllocator) { return true; }
};

}  // namespace talus
