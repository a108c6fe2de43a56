#pragma once
// Array: a vector for the large arrays of an answer.

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace talus {

namespace detail {
/// Memory in the system's large pages from one megabyte up: the first write to a page is what costs most.
/// fails  std::bad_alloc
[[nodiscard]] void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes) noexcept;
}  // namespace detail

/// An allocator that leaves new elements unset: they are overwritten at once.
template <class T>
struct ArrayAllocator {
  using value_type = T;
  ArrayAllocator() = default;
  template <class U>
  explicit ArrayAllocator(const ArrayAllocator<U>&) {}

  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_alloc();
    return static_cast<T*>(detail::allocate_large(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) noexcept { detail::free_large(memory, count * sizeof(T)); }
  void construct(T*) {}
  template <class... Arguments>
  void construct(T* at, Arguments&&... arguments) {
    std::construct_at(at, std::forward<Arguments>(arguments)...);
  }
  friend bool operator==(ArrayAllocator, ArrayAllocator) { return true; }
};

/// A std::vector of numbers or points whose resize() leaves new elements unset.
template <class T>
using Array = std::vector<T, ArrayAllocator<T>>;

}  // namespace talus
