#pragma once
// The interface of the traversal kernels, which exist for several instruction sets. Plain types only: see simd.h.
#include <cstdint>

#include "bvh/wide_node.h"

namespace candela {

struct KernelTree {
  const WideNode* nodes;
  const TriangleBlock* blocks;  // of a tree over triangles
  const uint32_t* indices;      // of a tree over other things
};

struct KernelRay {
  float origin[3], direction[3];
  float t_min, t_max;  // t_max shrinks to the nearest accepted hit
};

struct KernelCounts {
  uint64_t nodes, boxes, triangles;
};

struct KernelHit {
  float t, u, v;
  uint32_t id;
  bool clockwise;  // the corners turn clockwise as seen along the ray
};

// What a kernel asks while it goes. accept decides about a hit with t within the ray's limits: true shortens the ray,
// or ends a search for any hit; null, in such a search alone, accepts all. enter traces the thing of that index; true:
// a search for any hit ends.
struct KernelCaller {
  bool (*accept)(KernelCaller&, const KernelHit&);
  bool (*enter)(KernelCaller&, uint32_t index, KernelRay& ray);
};

// counts may be null. The ray's direction is finite and not zero, its origin finite. Returns true when a search for any
// hit ended early.
struct Kernels {
  bool (*triangles)(const KernelTree&, KernelRay&, KernelCaller&, bool any, KernelCounts* counts);
  bool (*things)(const KernelTree&, KernelRay&, KernelCaller&, bool any, KernelCounts* counts);
  const char* name;
};

// All give the same hits, bit for bit, and the same counts. Null where the machine or the build lacks them.
const Kernels* scalar_kernels();
const Kernels* sse2_kernels();
const Kernels* avx2_kernels();
const Kernels& best_kernels();  // for the processor this runs on

}  // namespace candela
