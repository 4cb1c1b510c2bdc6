#include "base/allocations.h"

namespace candela {
namespace {
thread_local uint64_t count = 0;
}  // namespace

uint64_t heap_allocations() { return count; }
void count_heap_allocation() { ++count; }

}  // namespace candela
