// Compiled with AVX-512 (F, VL, DQ, BW) where the compiler knows it (CMakeLists.txt), and only called where the
// processor does.
#ifdef __AVX512VL__
#include "bvh/trace_packet.h"
#else
#include "bvh/trace.h"
#endif

namespace candela {

#ifdef __AVX512VL__
const Kernels* avx512_kernels() {
  static constexpr Kernels kernels{&trace<true>, &trace<false>, &trace_packet, "avx512"};
  const bool can = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  return can ? &kernels : nullptr;
}
#else
const Kernels* avx512_kernels() { return nullptr; }
#endif

}  // namespace candela
