#include "engine/large_memory.hpp"

#include <memory_resource>

#include "talus/array.hpp"

namespace talus {

namespace {
constexpr std::size_t kLarge = std::size_t{1} << 20, kHugePage = std::size_t{2} << 20;
}  // namespace

void* detail::allocate_large(std::size_t bytes) {
  const bool large = bytes >= kLarge;
  if (large && bytes > SIZE_MAX - kHugePage) throw std::bad_alloc();
  if (large) bytes = (bytes + kHugePage - 1) & ~(kHugePage - 1);
  void* memory = large ? std::aligned_alloc(kHugePage, bytes) : std::malloc(bytes);
  if (memory == nullptr && bytes > 0) throw std::bad_alloc();
  if (large) ask_for_large_pages(memory, bytes);
  return memory;
}

void detail::free_large(void* memory) noexcept { std::free(memory); }

void* LargePages::do_allocate(std::size_t bytes, std::size_t) { return detail::allocate_large(bytes); }
void LargePages::do_deallocate(void* memory, std::size_t, std::size_t) { detail::free_large(memory); }

}  // namespace talus
