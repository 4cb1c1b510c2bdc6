#pragma once
#include <bit>
#include <vector>

namespace candela {

// Room for `count` values in steps of powers of two, so that a copy that grows a little from frame to frame seldom asks
// the heap for memory.
template <class T>
void make_room(std::vector<T>& values, size_t count) {
  if (values.capacity() < count) values.reserve(std::bit_ceil(count));
}

}  // namespace candela
