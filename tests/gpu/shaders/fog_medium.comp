#version 460
// The closed forms of fog at many places: eight words a place in, eleven out.
#include "shared/types.h"
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
#include "lib/fog_medium.glsl"
layout(local_size_x = 64) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PlacesRef { float f[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ResultsRef { float f[]; };
layout(push_constant, scalar) uniform Push { uint64_t places, results; uint count; } pc;

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= pc.count) return;
  PlacesRef p = PlacesRef(pc.places + 32ul * i);
  ResultsRef r = ResultsRef(pc.results + 44ul * i);
  const vec3 origin = vec3(p.f[0], p.f[1], p.f[2]), direction = vec3(p.f[3], p.f[4], p.f[5]);
  const vec2 span = fog_inside(origin, direction, vec2(0.0, p.f[6]));
  const float metres = fog_length(origin, direction, span.x, span.y);
  const vec3 through = fog_through(origin, direction, p.f[6]), held = fog_held(metres);
  r.f[0] = metres;
  r.f[1] = through.x, r.f[2] = through.y, r.f[3] = through.z;
  r.f[4] = held.x, r.f[5] = held.y, r.f[6] = held.z;
  r.f[7] = henyey_greenstein(p.f[7]);
  const vec3 sky = fog_sky_through_surface(origin, direction);
  r.f[8] = sky.x, r.f[9] = sky.y, r.f[10] = sky.z;
}
