#version 460
// Reads element 1 of an array of structs member by member, in the order of declaration, and writes the members' words
// one after the other: the C++ bytes, if both languages lay the struct out alike.
#include "shared/scene.h"
#include "shared/cull.h"
#include "shared/deform.h"

layout(local_size_x = 1) in;
layout(constant_id = 0) const uint kind = 0u;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TargetRef { uint w[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer FramesRef { FrameConstants c[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer ImageLightsRef { ImageLight l[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightsRef { Light l[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer FogsRef { FogMedium f[]; };
layout(push_constant, scalar) uniform Push { uint64_t source, target; } push;

uint at = 0u;
void put(uint v) { TargetRef(push.target).w[at++] = v; }
void put(int v) { put(uint(v)); }
void put(float v) { put(floatBitsToUint(v)); }
void put(uint64_t v) { put(uint(v & 0xffffffffUL)); put(uint(v >> 32)); }
void put(vec2 v) { put(v.x); put(v.y); }
void put(uvec2 v) { put(v.x); put(v.y); }
void put(vec3 v) { put(v.x); put(v.y); put(v.z); }
void put(uvec3 v) { put(v.x); put(v.y); put(v.z); }
void put(vec4 v) { put(v.x); put(v.y); put(v.z); put(v.w); }
void put(TextureRef v) {
  put(v.texture); put(v.sampler_index); put(v.uv_set); put(v.wraps); put(v.u_row); put(v.v_row);
}

void put_transform(Transform v) { put(v.row0); put(v.row1); put(v.row2); }
void put_geometry(Geometry v) {
  put(v.position); put(v.normal); put(v.tangent); put(v.uv0); put(v.uv1); put(v.color); put(v.flags);
}
void put_item(Item v) {
  put(v.bounds_centre); put(v.transform); put(v.bounds_extent); put(v.geometry);
  put(v.first_index); put(v.index_count); put(v.material); put(v.object_id);
}
void put_material(Material v) {
  put(v.base_color); put(v.emissive); put(v.alpha_cutoff);
  put(v.metallic); put(v.roughness); put(v.normal_scale); put(v.occlusion_strength);
  put(v.specular); put(v.ior_f0); put(v.flags); put(v.id); put(v.specular_color); put(v.relief);
  put(v.base_texture); put(v.orm_texture); put(v.occlusion_texture); put(v.normal_texture);
  put(v.emissive_texture); put(v.specular_texture); put(v.specular_color_texture);
}
void put_light(Light v) {
  put(v.position); put(v.inverse_range); put(v.direction); put(v.type); put(v.spot_scale); put(v.spot_offset);
  put(v.intensity); put(v.shadow); put(v.radius_m); put(v.sun_height);
}
void put_fog(FogMedium v) {
  put(v.extinction); put(v.falloff); put(v.scattering); put(v.height); put(v.glow); put(v.anisotropy);
  put(v.lowest); put(v.highest); put(v.bounded); put(v.nodes); put(v.nearest_m); put(v.log2_ratio);
  put(v.sky_directions);
  for (uint i = 0u; i < max_fog_media; ++i) {
    const FogBox b = v.media[i];
    put(b.extinction); put(b.falloff); put(b.albedo); put(b.height); put(b.glow); put(b.anisotropy);
    put(b.lowest); put(b.highest); put(b.turn); put(b.middle); put(b.bounded);
  }
}
void put_frame(FrameConstants v) {
  put(v.vertices); put(v.transforms); put(v.geometries); put(v.items); put(v.materials); put(v.lobes);
  for (int i = 0; i < 4; ++i) put(v.clip_from_relative[i]);
  for (int i = 0; i < 5; ++i) put(v.planes[i]);
  for (int i = 0; i < 9; ++i) put(v.ambient_sh[i]);
  put(v.camera_right); put(v.camera_up); put(v.camera_back);
  put(v.tan_half); put(v.size_px); put(v.light_count); put(v.item_count);
  put(v.perspective); put(v.sky_texture); put(v.sky_sampler);
  put(v.split_sum_texture); put(v.split_sum_sampler); put(v.sky_size_px); put(v.pre_exposure);
}
void put_image_light(ImageLight v) {
  put(v.slices); put(v.lights); put(v.texture); put(v.irradiance_texture); put(v.lobe_texture); put(v.clamp_sampler);
  put(v.light_count); put(v.pixel_samples); put(v.irradiance_uv); put(v.rest_px);
}
void put_probes(ProbeLights v) {
  put(v.slices); put(v.lobe_texture); put(v.clamp_sampler);
  for (uint i = 0u; i < most_probes; ++i) {
    const Probe p = v.probe[i];
    put(p.position); put(p.texture); put(p.lowest); put(p.fade_m); put(p.highest); put(p.unused);
  }
}
void put_sky_slice(SkySlice v) { put(v.offset); put(v.scale); }
void put_sky_light(SkyLight v) { put(v.direction); put(v.illuminance); }
void put_group(CullGroup v) {
  put(v.first_item); put(v.item_count); put(v.run); put(v.first_group); put(v.is_last); put(v.hides);
  put(v.is_blended);
}
void put_command(DrawCommand v) {
  put(v.index_count); put(v.instance_count); put(v.first_index); put(v.vertex_offset); put(v.first_instance);
}
void put_job(DeformJob v) {
  put(v.vertex_count); put(v.position); put(v.normal); put(v.tangent);
  put(v.joints0); put(v.weights0); put(v.joints1); put(v.weights1);
  put(v.morph_table); put(v.morph_count); put(v.first_joint); put(v.joint_count); put(v.first_weight);
  put(v.out_position); put(v.out_normal); put(v.out_tangent);
}

void main() {
  if (kind == 0u) put_transform(TransformsRef(push.source).t[1]);
  if (kind == 1u) put_geometry(GeometriesRef(push.source).g[1]);
  if (kind == 2u) put_item(ItemsRef(push.source).i[1]);
  if (kind == 3u) put_material(MaterialsRef(push.source).m[1]);
  if (kind == 4u) put_light(LightsRef(push.source).l[1]);
  if (kind == 5u) put_frame(FramesRef(push.source).c[1]);
  if (kind == 6u) put_group(CullGroupsRef(push.source).g[1]);
  if (kind == 7u) put_command(DrawCommandsRef(push.source).d[1]);
  if (kind == 8u) put_job(DeformJobsRef(push.source).j[1]);
  if (kind == 9u) put_image_light(ImageLightsRef(push.source).l[1]);
  if (kind == 10u) put_sky_slice(SkySlicesRef(push.source).s[1]);
  if (kind == 11u) put_sky_light(SkyLightsRef(push.source).s[1]);
  if (kind == 12u) put_fog(FogsRef(push.source).f[1]);
  if (kind == 13u) put_probes(ProbeLightsRef(push.source).l[1]);
}
