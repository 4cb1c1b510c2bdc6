#pragma once
#include <sys/mman.h>

#include <memory>
#include <new>
#include <vector>

namespace candela {

// Leaves elements of types without constructors unwritten: builders fill theirs from many threads, or never use all of
// them.
template <class T>
struct UnwrittenAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = UnwrittenAllocator<U>;
  };
  template <class U>
  void construct(U* place) noexcept {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... A>
  void construct(U* place, A&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<A>(arguments)...);
  }
};
// And asks for large pages, for tables that rays jump about in: the processor remembers where few thousand pages lie.
template <class T>
struct LargePageAllocator : UnwrittenAllocator<T> {
  template <class U>
  struct rebind {
    using other = LargePageAllocator<U>;
  };
  static constexpr size_t page = size_t(2) << 20;
  static constexpr bool is_large(size_t count) { return count * sizeof(T) >= 2 * page; }
  T* allocate(size_t count) {
    if (!is_large(count)) return std::allocator<T>().allocate(count);
    void* place = ::operator new(count * sizeof(T), std::align_val_t(page));
    madvise(place, count * sizeof(T), MADV_HUGEPAGE);  // where the system refuses, pages are small
    return static_cast<T*>(place);
  }
  void deallocate(T* place, size_t count) {
    if (!is_large(count)) return std::allocator<T>().deallocate(place, count);
    ::operator delete(static_cast<void*>(place), std::align_val_t(page));
  }
};
template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

template <class T>
using RawVector = std::vector<T, UnwrittenAllocator<T>>;

}  // namespace candela
