#version 460
// Morph targets, then linear blend skinning of one section's vertices, as glTF orders them. Skinned vertices come out
// in relative space (the joint matrices hold the camera's offset, composed in double), morphed ones in mesh space.
#include "shared/deform.h"
layout(push_constant, scalar) uniform Push { DeformPush pc; };
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MatricesRef { mat4 m[]; };

vec3 load3(uint64_t base, uint word) {
  FloatsRef s = FloatsRef(base);
  return vec3(s.f[word], s.f[word + 1u], s.f[word + 2u]);
}
void store3(uint word, vec3 v) {
  DeformedRef d = DeformedRef(pc.deformed);
  d.f[word] = v.x;
  d.f[word + 1u] = v.y;
  d.f[word + 2u] = v.z;
}

mat4 blended_joints(uint64_t vertices, DeformJob job, uint vertex) {
  MatricesRef joints = MatricesRef(pc.joints);
  mat4 sum = mat4(0.0);
  for (int set = 0; set < 2; ++set) {
    const uint joints_at = set == 0 ? job.joints0 : job.joints1, weights_at = set == 0 ? job.weights0 : job.weights1;
    if (joints_at == absent) continue;
    const uint low = WordsRef(vertices).w[joints_at + 2u * vertex],
        high = WordsRef(vertices).w[joints_at + 2u * vertex + 1u];
    const uvec4 j = uvec4(low & 0xffffu, low >> 16, high & 0xffffu, high >> 16);
    FloatsRef weights = FloatsRef(vertices);
    for (int i = 0; i < 4; ++i) {
      const float w = weights.f[weights_at + 4u * vertex + uint(i)];
      if (w != 0.0) sum += w * joints.m[job.first_joint + j[i]];
    }
  }
  return sum;
}

void deform_vertex(DeformJob job, uint v) {
  const uint64_t vertices = frame.vertices;
  vec3 position = load3(vertices, job.position + 3u * v);
  vec3 normal = job.normal != absent ? load3(vertices, job.normal + 3u * v) : vec3(0.0);
  vec3 tangent = job.tangent != absent ? load3(vertices, job.tangent + 4u * v) : vec3(0.0);
  for (uint m = 0u; m < job.morph_count; ++m) {
    const float weight = FloatsRef(pc.weights).f[job.first_weight + m];
    if (weight == 0.0) continue;
    WordsRef table = WordsRef(vertices);
    const uint at_position = table.w[job.morph_table + 3u * m], at_normal = table.w[job.morph_table + 3u * m + 1u],
               at_tangent = table.w[job.morph_table + 3u * m + 2u];
    if (at_position != absent) position += weight * load3(vertices, at_position + 3u * v);
    if (at_normal != absent) normal += weight * load3(vertices, at_normal + 3u * v);
    if (at_tangent != absent) tangent += weight * load3(vertices, at_tangent + 3u * v);
  }
  float handedness = 1.0;
  if (job.joint_count > 0u) {
    const mat4 m = blended_joints(vertices, job, v);
    position = (m * vec4(position, 1.0)).xyz;
    // Normals by the cofactor matrix, so that non-uniform joint scales keep them perpendicular.
    const vec3 ca = cross(m[1].xyz, m[2].xyz), cb = cross(m[2].xyz, m[0].xyz), cc = cross(m[0].xyz, m[1].xyz);
    const float flip = dot(m[0].xyz, ca) < 0.0 ? -1.0 : 1.0;
    handedness = flip;  // joints that mirror turn the bitangent over, as mirrored nodes do
    normal = flip * (ca * normal.x + cb * normal.y + cc * normal.z);
    tangent = mat3(m) * tangent;
  }
  store3(job.out_position + 3u * v, position);
  if (job.normal != absent) store3(job.out_normal + 3u * v, normal);
  if (job.tangent != absent) {
    store3(job.out_tangent + 4u * v, tangent);
    DeformedRef(pc.deformed).f[job.out_tangent + 4u * v + 3u] = handedness * FloatsRef(vertices).f[job.tangent +
        4u * v + 3u];
  }
}

// Strided: a section may have more vertices than one dispatch has threads.
void main() {
  const DeformJob job = DeformJobsRef(pc.jobs).j[pc.job];
  const uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint v = gl_GlobalInvocationID.x; v < job.vertex_count; v += stride) deform_vertex(job, v);
}
