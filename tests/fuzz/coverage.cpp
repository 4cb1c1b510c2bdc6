#include <cstddef>
#include <cstdint>

// g++ calls __sanitizer_cov_trace_pc at every edge (which libFuzzer ignores, hence the linker's --wrap); libFuzzer
// reads what it counts from this section. (clang 14 of Debian 12 would feed libFuzzer by itself, but cannot compile g++
// 12's <expected>.) This file is compiled without coverage.
__attribute__((section("__libfuzzer_extra_counters"))) static uint8_t counters[1 << 17];

extern "C" void __wrap___sanitizer_cov_trace_pc() {
  const uintptr_t pc = reinterpret_cast<uintptr_t>(__builtin_return_address(0));
  uint8_t& counter = counters[(pc * 0x9E3779B97F4A7C15u) >> 47];
  if (counter < 255) ++counter;
}
