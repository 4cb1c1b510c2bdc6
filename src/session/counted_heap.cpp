// The program's own operator new counts, by thread (base/allocations.h); the memory is malloc's as before.
#include <cstdlib>
#include <new>

#include "base/allocations.h"

namespace {
void* counted(void* memory) {
  if (!memory) throw std::bad_alloc();
  candela::count_heap_allocation();
  return memory;
}
}  // namespace

void* operator new(size_t bytes) { return counted(std::malloc(bytes ? bytes : 1)); }
void* operator new(size_t bytes, std::align_val_t alignment) {
  const size_t a = size_t(alignment);
  return counted(std::aligned_alloc(a, (bytes + a - 1) / a * a));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
