#version 460
// The mean over 5 by 5 texels whose outer rows count half, so that each value of the pattern of 4 by 4 counts alike.
// Texels count less that are off the tangent plane, and where four rays' share of the lobe is narrower than what lies
// between the two: the angle between the pixels, or between their normals. So with more rays it blurs less.
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { ReflectionsSmoothPush pc; };
#include "lib/frame.glsl"
#include "lib/bindless.glsl"
#include "lib/reflections.glsl"
#include "shared/split_sum.h"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SIDE = 1;  // of a texel, in pixels

vec3 point_at(ivec2 p, float depth) {
  return occlusion_position(vec2(p) + 0.5, metres_of(depth), pc.subsample_ndc);
}

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(texel), pc.texels))) return;
  const ivec2 largest = ivec2(frame.size_px) - 1, pixel = min(texel * SIDE, largest);
  const float depth = texelFetch(pass_images[pc.at.z], pixel, 0).r;
  const vec4 reflectance = unpack_reflectance(texelFetch(pass_uint_images[pc.at.reflectance], pixel, 0).xy);
  vec4 light = texelFetch(pass_images[pc.light], texel, 0);
  if (depth > 0.0 && reflectance.rgb != vec3(0.0)) {
    const Reflecting r = unpack_reflecting(texelFetch(pass_uint_images[pc.at.surface], pixel, 0));
    const vec3 p = point_at(pixel, depth);
    const float roughness = max(reflectance.a, least_roughness), alpha = roughness * roughness;
    const float angle = frame.perspective != 0u ? 2.0 * frame.tan_half.y / float(frame.size_px.y) * float(SIDE)
        : 0.0;  // orthographic: all pixels look along one direction
    precise vec4 sum = vec4(0.0);  // of sixteenths: the weights' sum, and no light is beyond floats
    float weights = 0.0;
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const ivec2 other = texel + ivec2(x, y);
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(pc.texels)))) continue;
        const ivec2 there = min(other * SIDE, largest);
        const float z = texelFetch(pass_images[pc.at.z], there, 0).r;
        const vec4 its = unpack_reflectance(texelFetch(pass_uint_images[pc.at.reflectance], there, 0).xy);
        if (!(z > 0.0) || its.rgb == vec3(0.0)) continue;
        const vec3 normal = unpack_normal(texelFetch(pass_uint_images[pc.at.surface], there, 0).z);
        const vec3 turned = normal - r.normal;
        const float apart = (angle * angle * float(x * x + y * y) + 4.0 * dot(turned, turned)) / (alpha * alpha);
        const float rougher = 4.0 * (its.a - reflectance.a) / roughness;
        float w = (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0);
        w *= exp2(-0.25 * float(pc.rays) * apart - rougher * rougher);
        w *= occlusion_likeness(point_at(there, z), p, r.plane);
        if (!(w > 0.0)) continue;
        sum += (w * 0.0625) * texelFetch(pass_images[pc.light], other, 0);
        weights += w;
      }
    if (weights > 0.0) light = sum / (weights * 0.0625);
  }
  imageStore(storage_images[pc.smooth_light], texel, light);
}
