#include "bvh/trace.h"
#ifdef __SSE2__
#include "bvh/trace_packet.h"
#endif

namespace candela {

#ifdef __SSE2__
const Kernels* sse2_kernels() {
  static constexpr Kernels kernels{&trace<true>, &trace<false>, &trace_packet, "sse2"};
  return &kernels;
}
#else
const Kernels* sse2_kernels() { return nullptr; }
#endif

const Kernels& best_kernels() {
  static const Kernels& best = [] -> const Kernels& {
    if (const Kernels* k = avx512_kernels()) return *k;
    if (const Kernels* k = avx2_kernels()) return *k;
    if (const Kernels* k = sse2_kernels()) return *k;
    return *scalar_kernels();
  }();
  return best;
}

}  // namespace candela
