#version 460
// Rays to the lights of the surfaces that the keys of pixels name, and what they find (lib/light_records.glsl). The
// lanes of a subgroup walk their lists together, and a ray waits until there is one for every lane, whoever's they are:
// so no lane idles while others trace, and neighbours' rays to the same light go side by side.
#define TRIANGLES
#ifndef TRACES  // as frames say that send rays
#define TRACES
#endif
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"
#include "lib/sample_places.glsl"
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_list.glsl"
#include "lib/traced_light.glsl"
#define RECORDS_AT pc.deformed_before
#include "lib/light_records.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 30) const int SAMPLES = 1;
#include "lib/keyed_triangles.glsl"

// Of a lane, numbered by its subgroup and its place there: where its rays begin.
struct Origin {
  TracePoint from;
  vec3 side, position;
  vec2 pixel_middle;
};
shared Origin origins[64];
// Rays that wait, of a subgroup: a ring of twice its lanes.
struct Waiting {
  uint lane, light, number, words;  // number: of the light's rays; words: where what it finds goes
};
shared Waiting waiting[128];

// On a CPU lanes run in step and need no barrier; lavapipe 25.0.7 would have all subgroups wait for each other.
void subgroup_meets() {
  subgroupMemoryBarrier();
#ifndef LOCKSTEP
  subgroupBarrier();
#endif
}

void main() {
  const uint width = min(gl_SubgroupSize, 64u), mine = gl_SubgroupID * width + gl_SubgroupInvocationID;
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  const bool inside = all(lessThan(pixel, frame.size_px));
  const uvec2 valid = min(pixel, frame.size_px - 1u);
  pixel_middle = vec2(valid) + 0.5;
  begin_keyed(valid);
  if (!inside) keyed_left = 0u;
  if (gl_WorkGroupID.xy == uvec2(pc.occlusion & 0xffffu, pc.occlusion >> 16) && mine == 0u) {
    for (uint i = 0u; i < record_room_word; ++i) all_records().w[i] = RecordsRef(pc.rays).w[i];
    all_records().w[record_room_word] = pc.own;
  }
  const uint room = pc.own / (64u / width), ring = 2u * width, ring_begin = gl_SubgroupID * ring;
  RecordsRef records = RecordsRef(record_room(pixel, pc.own) + 4ul * uint64_t(gl_SubgroupID * room));
  uint used = 0u;
  bool fits = gl_NumSubgroups == 64u / width;
  while (fits && subgroupOr(keyed_left) != 0u) {
    bool has = keyed_left != 0u;
    vec3 position = vec3(0.0);
    if (has) {
      // As shading takes them (shade_visible.comp).
      uint covered;
      vec2 place;
      const uint triangle = take_triangle(covered, place);
      const KeyedPoint k = keyed_point(triangle, place, pixel, covered);
      has = (k.batch.flags & batch_unlit) == 0u;
      if (has) {
        position = k.at.position;
        vec3 normal = keyed_plane_normal(k, keyed_direction_to_viewer());
        vec3 surface_point = position;
        round_off(k.item, k.geometry, k.corners, k.at, normal, surface_point);
        begin_rays(surface_point, normal);
      }
    }
    const vec3 side = rays_side;
    const uint first = subgroupMin(has ? mine : no_record);
    if (first != no_record) {
      origins[mine] = Origin(rays_from, side, position, pixel_middle);
      subgroup_meets();
      // Lanes without a surface walk along with one that has one.
      LightWalk walk = begin_lights(has ? position : origins[first].position);
      bool walks = true;
      uint light = 0u, ray = 0u, rays = 0u, head = 0u, waits = 0u, words = 0u;
      bool wants = false;
      while (true) {
        while (walks && waits < width) {
          if (ray == rays) {
            walks = next_light(walk);
            if (!walks) break;
            light = walk.light;
            ray = rays = 0u;
            LightRef data = light_at(pc.lights, light);
            const bool is_sun = floatBitsToUint(light_word(data, 3u).y) == light_directional;
            if (is_sun ? !SUNS_TRACED : !LAMPS_TRACED) continue;
            vec3 l;
            const LightCap cap = light_cap(data, position);
            wants = has && light_arriving(data, position, l) != 0.0;
            const uint samples = light_samples(cap);
            if (samples == 1u && !HAS_PASSING) wants = wants && dot(side, l) > 0.0;
            if (subgroupOr(wants ? 1u : 0u) == 0u) continue;
            const uint size = samples * record_words(width);
            fits = used + record_head + size < room;
            if (!fits) {
              walks = false;
              break;
            }
            if (gl_SubgroupInvocationID == 0u) {
              records.w[used] = light;
              records.w[used + 1u] = size;
            }
            words = used + record_head;
            for (uint i = gl_SubgroupInvocationID; i < size; i += width) records.w[words + i] = 0u;
            used = words + size;
            rays = samples;
            subgroup_meets();
          }
          const uint before = subgroupExclusiveAdd(wants ? 1u : 0u);
          if (wants)
            waiting[ring_begin + (head + waits + before) % ring] =
                Waiting(mine, light, ray, words + ray * record_words(width));
          waits += subgroupAdd(wants ? 1u : 0u);
          ++ray;
        }
        if (!fits || waits == 0u) break;
        subgroup_meets();
        if (gl_SubgroupInvocationID < waits) {
          const Waiting w = waiting[ring_begin + (head + gl_SubgroupInvocationID) % ring];
          const Origin o = origins[w.lane];
          rays_from = o.from;
          rays_side = o.side;
          pixel_middle = o.pixel_middle;
#ifdef LOBED
          lit_plane = o.side;
#endif
          LightRef data = light_at(pc.lights, w.light);
          const bool is_lamp = floatBitsToUint(light_word(data, 3u).y) != light_directional;
          const bool is_soft = is_lamp ? LAMPS_SOFT && light_word(data, 7u).x > 0.0 : SUNS_SOFT;
          const LightCap cap = light_cap(data, is_soft ? o.position : rays_from.position);
          vec3 l;
          const TraceRay sent = ray_to_light(cap, rays_first(light_samples(cap)) + w.number, rays_own(1u + w.light), l);
          const float through = ray_seen(sent, l, is_lamp);
          const uint lane = w.lane - gl_SubgroupID * width;
          if (RAYS_MEET_BLENDED != 0)
            records.w[w.words + lane] = floatBitsToUint(through);
          else if (through > 0.0)
            atomicOr(records.w[w.words + lane / 32u], 1u << (lane & 31u));
        }
        const uint sent = min(waits, width);
        head = (head + sent) % ring;
        waits -= sent;
        subgroup_meets();
      }
      pixel_middle = vec2(valid) + 0.5;
    }
    fits = fits && used < room;
    if (fits && gl_SubgroupInvocationID == 0u) records.w[used] = no_record;
    ++used;
    subgroup_meets();
  }
  if (inside)
    record_place(pixel).w[0] = fits ? 1u << 24u | width << 16u | gl_SubgroupID << 8u | gl_SubgroupInvocationID : 0u;
}
