#version 460
// What each bounding test of lib/light_bounds.glsl says of pairs of a light and a slab: bit 0 aabb ... bit 3
// capsule-joint.
#include "shared/scene.h"
struct PairSlab {
  vec2 low, high;
  float z_near, z_far;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SlabsRef { PairSlab s[]; };
struct TouchesPush {
  uint64_t frame, bounds, slabs, results;
  uint count;
};
layout(push_constant, scalar) uniform Push { TouchesPush pc; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer FrameConstantsRef { FrameConstants c; };
#define frame (FrameConstantsRef(pc.frame).c)
#include "lib/light_cells.glsl"
#include "lib/light_bounds.glsl"
layout(local_size_x = 64) in;

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= pc.count) return;
  const LightBounds b = LightBoundsRef(pc.bounds).b[i];
  const PairSlab p = SlabsRef(pc.slabs).s[i];
  Slab s = Slab(p.low, p.high, max(p.z_near, b.z_low), min(p.z_far, b.z_high));
  uint bits = 0u;
  for (int test = 0; test < 4; ++test) bits |= light_touches(test, b, s) ? 1u << test : 0u;
  UintsRef(pc.results).u[i] = bits;
}
