#pragma once
#include <cstdint>

namespace candela {

// How often this thread has asked the heap for memory by `new`, containers and strings with it, since it began.
uint64_t heap_allocations();

}  // namespace candela
