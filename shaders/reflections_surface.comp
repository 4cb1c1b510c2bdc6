#version 460
// The same as reflections_surface.frag, of the surface that the key of the pixel's middle names.
#define TRIANGLES
#include "shared/draw.h"
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"
#include "lib/shade.glsl"
#include "lib/image_kinds.glsl"
#include "lib/sample_places.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
const int SAMPLES = 1;
#include "lib/keyed_triangles.glsl"
#include "lib/reflections_surface.glsl"

uint place_of(uint n) { return pc.own >> (4u * n) & 0xfu; }  // REFLECTIONS_SURFACE_IMAGES

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  pixel_middle = vec2(pixel) + 0.5;
  begin_keyed(pixel);
  ReflectingTexel texel;
  texel.surface = uvec4(0u);
  texel.reflectance = uvec2(0u);
  texel.sky = vec4(0.0);
#ifdef FOG
  texel.fog = vec4(0.0);
#endif
  float z = 0.0;
  if (keyed_left != 0u) {
    z = uintBitsToFloat(uint(KeysRef(pc.table).k[pixel.y * frame.size_px.x + pixel.x] >> 32));
    uint covered;
    vec2 place;
    const uint triangle = take_triangle(covered, place);
    const KeyedPoint k = keyed_point(triangle, place, pixel, covered);
#ifdef RELIEFS
    end_relief_light();
#endif
    const vec3 to_viewer = keyed_direction_to_viewer();
    const Surface s = load_surface(k.material, keyed_varyings(k), is_front(k) ? 1.0 : -1.0, to_viewer);
    const vec3 plane_normal = keyed_plane_normal(k, to_viewer);
    vec3 rounded_normal = plane_normal, rounded_point = k.at.position;
    round_off(k.item, k.geometry, k.corners, k.at, rounded_normal, rounded_point);
    texel = reflecting_texel(s, (k.batch.flags & batch_unlit) != 0u, k.at.position, plane_normal, rounded_point,
        rounded_normal, to_viewer);
  }
  imageStore(storage_images[place_of(0u)], ivec2(pixel), vec4(z));
  imageStore(storage_uint_images[place_of(1u)], ivec2(pixel), texel.surface);
  imageStore(storage_uint_images[place_of(2u)], ivec2(pixel), uvec4(texel.reflectance, 0u, 0u));
  imageStore(storage_images[place_of(3u)], ivec2(pixel), texel.sky);
#ifdef FOG
  imageStore(storage_images[place_of(4u)], ivec2(pixel), texel.fog);
#endif
}
