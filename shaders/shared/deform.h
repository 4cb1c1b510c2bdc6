#ifndef CANDELA_SHARED_DEFORM_H
#define CANDELA_SHARED_DEFORM_H
#include "shared/scene.h"

SHARED_BEGIN

// Skins and morphs the vertices of one section. Offsets in words: sources and the morph table in
// FrameConstants.vertices, destinations in the deformed buffer. A morph target is three words: offsets of its position,
// normal and tangent deltas.
struct DeformJob {
  uint vertex_count;
  uint position, normal, tangent;
  uint joints0, weights0, joints1, weights1;  // joints: two words a vertex (four 16-bit numbers)
  uint morph_table, morph_count;
  uint first_joint, joint_count, first_weight;
  uint out_position, out_normal, out_tangent;
};
struct DeformPush {
  uint64_t jobs, joints, weights, deformed;
  uint job;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(DeformJob) == 64);
}
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer DeformJobsRef { DeformJob j[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DeformedRef { float f[]; };
#endif

#endif
