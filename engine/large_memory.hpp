#pragma once
// Memory for arrays as large as the raster. Touching tens of megabytes page by page costs as much as computing what
// goes in (bench_engine, BM_ErrorsAndSaturation/side:4097); where the system hands out pages of 2 MiB, ask for them.

#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace talus {

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
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (large) ::madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: nothing depends on it
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) noexcept { std::free(memory); }
  friend bool operator==(LargeAllocator, LargeAllocator) { return true; }
};

}  // namespace talus
