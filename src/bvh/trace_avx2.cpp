// Compiled with -mavx2 -mfma where the compiler knows it (CMakeLists.txt), and only called where the processor does.
#ifdef __AVX2__
#include "bvh/trace_packet.h"
#else
#include "bvh/trace.h"
#endif

namespace candela {

#ifdef __AVX2__
const Kernels* avx2_kernels() {
  static constexpr Kernels kernels{&trace<true>, &trace<false>, &trace_packet, "avx2"};
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &kernels : nullptr;
}
#else
const Kernels* avx2_kernels() { return nullptr; }
#endif

}  // namespace candela
