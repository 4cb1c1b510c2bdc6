#pragma once
#include <cstdint>

namespace candela {

// How often this thread has asked the heap for memory by `new`, containers and strings with it, since it began. 0 in
// programs that do not count (session/counted_heap.cpp does).
uint64_t heap_allocations();
void count_heap_allocation();

}  // namespace candela
