#pragma once

#include <cstddef>
#include <vector>

namespace patchlight {

/// Memory that starts at a multiple of 64 bytes; large pieces in pages of 2 MiB where the system has them, so that a
/// pass over them misses fewer addresses. \throws std::bad_alloc.
void* allocate_pages(std::size_t bytes);
void free_pages(void* memory) noexcept;  ///< gives it back

/// The allocator of such memory.
template <typename T>
struct PageAllocator {
  using value_type = T;
  PageAllocator() = default;
  template <typename U>
  explicit PageAllocator(const PageAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_pages(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t) noexcept { free_pages(memory); }
  bool operator==(const PageAllocator&) const = default;
};

/// A vector whose memory is taken in whole pages.
template <typename T>
using LargeArray = std::vector<T, PageAllocator<T>>;

}  // namespace patchlight
