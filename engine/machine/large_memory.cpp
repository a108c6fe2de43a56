#include "engine/machine/large_memory.hpp"

#include <algorithm>
#include <memory_resource>

#include "talus/array.hpp"

namespace talus {

namespace {

constexpr std::size_t kLarge = std::size_t{1} << 20, kHugePage = std::size_t{2} << 20;

constexpr std::size_t rounded(std::size_t bytes) { return (bytes + kHugePage - 1) & ~(kHugePage - 1); }

}  // namespace

// malloc is not used: it may return memory that already has small pages.
void* detail::allocate_large(std::size_t bytes) {
  if (bytes > SIZE_MAX / 2) throw std::bad_alloc();
  void* memory = bytes >= kLarge ? map_large_pages(rounded(bytes)) : std::malloc(std::max<std::size_t>(bytes, 1));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void detail::free_large(void* memory, std::size_t bytes) noexcept {
  bytes >= kLarge ? unmap_large_pages(memory, rounded(bytes)) : std::free(memory);
}

void* LargePages::do_allocate(std::size_t bytes, std::size_t) { return detail::allocate_large(bytes); }
void LargePages::do_deallocate(void* memory, std::size_t bytes, std::size_t) { detail::free_large(memory, bytes); }

}  // namespace talus
