#version 460
#include "lib/image_kinds.glsl"
// One texel of output for each place: what a sampler gives there, of the kind of image that KIND names.
layout(local_size_x = 8) in;
layout(constant_id = 0) const int KIND = 0;
layout(constant_id = 1) const int SAMPLER = 0;
layout(push_constant, scalar) uniform Push { uint source, target, count; float lod; vec4 place[6]; } push;
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = push.place[i];
  vec4 value = vec4(0);
  if (KIND == 0) value = textureLod(sampler2D(pass_images[push.source], graph_samplers[SAMPLER]), p.xy, push.lod);
  if (KIND == 1)
    value = textureLod(sampler2DArray(pass_array_images[push.source], graph_samplers[SAMPLER]), p.xyz, push.lod);
  if (KIND == 2)
    value = textureLod(samplerCube(pass_cube_images[push.source], graph_samplers[SAMPLER]), p.xyz, push.lod);
  if (KIND == 4)
    value = textureLod(sampler3D(pass_volume_images[push.source], graph_samplers[SAMPLER]), p.xyz, push.lod);
  if (KIND == 5)
    value = vec4(textureLod(sampler2DShadow(pass_images[push.source], graph_shadow_samplers[SAMPLER]), p.xyz, 0));
  imageStore(storage_images[push.target], ivec2(i, 0), value);
}
