#version 460
// One thread a light: an instance's place, direction and intensity at the frame's time, in double and in the order in
// which the host adds and multiplies (scene/frame_data.cpp), or a copy of what the host has posed.
#include "shared/pose_lights.h"
layout(push_constant, scalar) uniform Push { PoseLightsPush pc; };
layout(local_size_x = 64) in;

LightGroup group_at(uint i) { return LightGroupsRef(pc.groups).g[i]; }

// The last group whose first light is at or before this one.
uint group_of(uint light) {
  uint low = 0u, high = pc.group_count;
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (LightGroupsRef(pc.groups).g[middle].first <= light)
      low = middle;
    else
      high = middle;
  }
  return low;
}

// By the columns of the matrix.
dvec3 times_linear(LightGroup g, dvec3 v) {
  precise dvec3 sum = g.x_axis * v.x;
  sum = sum + g.y_axis * v.y;
  sum = sum + g.z_axis * v.z;
  return sum;
}

vec3 turned(LightGroup g, vec3 direction) {
  const dvec3 d = times_linear(g, dvec3(direction));
  precise double square = d.x * d.x;
  square = square + d.y * d.y;
  square = square + d.z * d.z;
  const double length_m = sqrt(square);
  return length_m > 0.0lf && length_m < 1e300lf ? vec3(d / length_m) : g.light.direction;
}

// scene/light_instances.h
double modulation_factor(LightInstance i) {
  precise double cycles = pc.time_s / double(i.period);
  cycles = cycles + double(i.phase);
  precise double triangle = 1.0lf - abs(2.0lf * (cycles - floor(cycles)) - 1.0lf);
  precise double gone = double(i.depth) * triangle;
  gone = gone * triangle;
  gone = gone * (3.0lf - 2.0lf * triangle);
  gone = 1.0lf - gone;
  return gone;
}

void main() {
  const uint light = (gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (light >= pc.light_count) return;
  const LightGroup g = group_at(group_of(light));
  const uint source = g.source + light - g.first;
  if (g.posed != 0u) {
    LightsRef(pc.lights).l[light] = LightsRef(pc.posed).l[source];
    return;
  }
  const LightInstance i = LightInstancesRef(pc.instances).i[source];
  Light l = g.light;
  precise dvec3 position = times_linear(g, dvec3(i.translation));
  position = g.origin + position;
  l.position = vec3(position);
  if (i.direction != vec3(0.0)) l.direction = turned(g, i.direction);
  if (i.inverse_range > 0.0) l.inverse_range = i.inverse_range;
  precise double intensity = g.candela * double(i.intensity);
  intensity = intensity * modulation_factor(i);
  precise vec3 color = g.light.intensity * i.color;
  color = color * float(intensity);
  l.intensity = color;
  LightsRef(pc.lights).l[light] = l;
}
