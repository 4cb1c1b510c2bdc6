#include "base/allocations.h"

#include <cstdlib>
#include <new>

// The program's own operator new counts, by thread; the memory is malloc's as before.
namespace {
thread_local uint64_t count = 0;

void* counted(void* memory) {
  if (!memory) throw std::bad_alloc();
  ++count;
  return memory;
}
}  // namespace

uint64_t candela::heap_allocations() { return count; }

void* operator new(size_t bytes) { return counted(std::malloc(bytes ? bytes : 1)); }
void* operator new(size_t bytes, std::align_val_t alignment) {
  const size_t a = size_t(alignment);
  return counted(std::aligned_alloc(a, (bytes + a - 1) / a * a));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
