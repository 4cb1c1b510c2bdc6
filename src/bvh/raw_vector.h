#pragma once
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
template <class T>
using RawVector = std::vector<T, UnwrittenAllocator<T>>;

}  // namespace candela
