// Without any vector instructions of its own: for other processors, and to test the others against.
#define CANDELA_SIMD_SCALAR
#include "bvh/trace_packet.h"

namespace candela {

const Kernels* scalar_kernels() {
  static constexpr Kernels kernels{&trace<true>, &trace<false>, &trace_packet, "scalar"};
  return &kernels;
}

}  // namespace candela
