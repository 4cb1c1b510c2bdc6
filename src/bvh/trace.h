#pragma once
// The interface of the traversal kernels, which exist for several instruction sets. Plain types only: see simd.h.
#include <cstdint>

#include "bvh/wide_node.h"

namespace candela {

struct KernelTree {
  const WideNode* nodes;
  const TriangleBlock* blocks;  // of a tree over triangles
  const uint32_t* indices;      // of a tree over other things
  // Of a tree over triangles, which hits accept is asked about: doubt_turning of how the corners turn as seen along
  // the ray. By triangle id; null: of all triangles `doubt`.
  const uint8_t* doubts = nullptr;
  uint8_t doubt = 0;
  const uint32_t* wanted = nullptr;  // what the caller looks up by the id of its hit: fetched ahead
};
constexpr uint8_t doubt_turning(bool clockwise) { return clockwise ? 2 : 1; }

struct alignas(16) KernelRay {
  float origin[3], t_min;
  float direction[3], t_max;  // t_max shrinks to the nearest accepted hit
};

struct KernelCounts {
  uint64_t nodes = 0, boxes = 0, triangles = 0;
};

struct KernelHit {
  float t, u, v;
  uint32_t id;     // no_triangle: none
  bool clockwise;  // the corners turn clockwise as seen along the ray
};

// A search through one tree or several: what it has found, and what a kernel asks while it goes.
struct KernelSearch {
  KernelHit best{0, 0, 0, no_triangle, false};
  uint32_t place = 0, best_place = 0;  // of the tree at hand and the one that holds the best hit: ids count in it
  // About a hit in doubt with t within the ray's limits: false leaves it out.
  bool (*accept)(KernelSearch&, const KernelHit&);
  // Whether a hit goes behind the best one, which lies as near in another tree. In one tree the lower id goes first.
  bool (*loses_tie)(KernelSearch&, const KernelHit&);
  // Traces the thing of that index; true: a search for any hit ends.
  bool (*enter)(KernelSearch&, uint32_t index, KernelRay& ray);
};

constexpr uint32_t packet_rays = 16;

// counts may be null. The ray's direction is finite and not zero, its origin finite. Returns true when a search for any
// hit ended early.
struct Kernels {
  bool (*triangles)(const KernelTree&, KernelRay&, KernelSearch&, bool any, KernelCounts* counts);
  bool (*things)(const KernelTree&, KernelRay&, KernelSearch&, bool any, KernelCounts* counts);
  // Through triangles, several rays at once: those of bits `lanes` among packet_rays of them, one at least. Hits are
  // those of the rays one by one; quicker where they run beside one another. Returns the bits of searches for any hit
  // that ended early.
  uint32_t (*packet)(const KernelTree&, KernelRay*, KernelSearch* const*, uint32_t lanes, bool any);
  const char* name;
};

// All give the same hits, bit for bit, and the same counts. Null where the machine or the build lacks them.
const Kernels* scalar_kernels();
const Kernels* sse2_kernels();
const Kernels* avx2_kernels();
const Kernels* avx512_kernels();
const Kernels& best_kernels();  // for the processor this runs on

}  // namespace candela
