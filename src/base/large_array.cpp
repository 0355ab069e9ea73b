#include "patchlight/base/large_array.h"

#include <cstdint>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace patchlight {

void* allocate_pages(std::size_t bytes) {
  constexpr std::size_t page = std::size_t{2} << 20;
  constexpr std::size_t line = 64;
  const std::size_t unit = bytes >= 4 * page ? page : line;
  if (bytes > SIZE_MAX - unit) throw std::bad_alloc();
  const std::size_t size = (bytes + unit - 1) / unit * unit;
  void* const memory = std::aligned_alloc(unit, size);
  if (memory == nullptr) throw std::bad_alloc();
  // A wish: without large pages the memory is as good, but slower.
  if (unit == page) madvise(memory, size, MADV_HUGEPAGE);
  return memory;
}

void free_pages(void* memory) noexcept { std::free(memory); }

}  // namespace patchlight
