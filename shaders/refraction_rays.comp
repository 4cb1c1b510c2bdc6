#version 460
// What is seen through the surface that lets light through and that the camera sees in a pixel's middle, by one ray
// that is bent at every wall of the bodies in its way, is reflected where no light gets through, and is absorbed
// inside. Walls reflect by Fresnel's equations; roughness does not scatter it. What it meets sends the light that the
// functions of all techniques give it; blended surfaces cover what they cover; else there is the picture's background.
// target: the light, pre-exposed, that comes through, as far as the fog on the way lets it; how much it covers of what
// is behind the picture. Below 0: no ray was sent.
#define TRIANGLES
#define FACETS_DISC
#ifndef TRACES  // as frames say that send rays
#define TRACES
#endif
#include "shared/draw.h"
#include "shared/refraction.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"
#include "lib/shade.glsl"
#include "lib/shade_hit.glsl"
#include "lib/bend.glsl"
#include "lib/ambient_sh.glsl"
#include "lib/sky_seen.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 43) const int WALLS = 8;  // that bend a ray; it goes straight through those after them
layout(constant_id = 44) const int SHOWS_SKY = 0;
const int MOST_HELD = 4;  // bodies in each other

// For green light and for what is not split; red; blue (KHR_materials_dispersion).
const int GREEN = 0, RED = 1, BLUE = 2;
float index_of(Glass glass, int light) {
  if (!(glass.ior >= 1.0)) return 1.0;  // 0 is what bends nothing; below 1 is no glass in air
  const float half_spread = (glass.ior - 1.0) * 0.025 * glass.dispersion;
  return max(glass.ior + (light == RED ? -half_spread : light == BLUE ? half_spread : 0.0), 1.0);
}

// Of unpolarised light at a smooth dielectric; eta: index behind over index before.
float fresnel(float cosine, float eta) {
  const float sine2 = (1.0 - cosine * cosine) / (eta * eta);
  if (sine2 >= 1.0) return 1.0;
  const float behind = sqrt(1.0 - sine2);
  const float across = (cosine - eta * behind) / (cosine + eta * behind);
  const float along = (behind - eta * cosine) / (behind + eta * cosine);
  return 0.5 * (across * across + along * along);
}

// The bodies about a place, the one entered last behind the others: the reference's Interior.
struct Held {
  uint body[MOST_HELD];
  int count;
};
bool holds(Held held, uint body) {
  for (int i = 0; i < held.count; ++i)
    if (held.body[i] == body) return true;
  return false;
}
void enter(inout Held held, uint body) {
  if (held.count < MOST_HELD) held.body[held.count++] = body;
}
void leave(inout Held held, uint body) {
  bool found = false;
  for (int i = held.count - 1; i >= 0; --i)
    if (!found && held.body[i] == body) {
      found = true;
      for (int k = i; k + 1 < held.count; ++k) held.body[k] = held.body[k + 1];
    }
  if (found) --held.count;
}
float index_within(Held held, int light) {
  return held.count > 0 ? index_of(load_glass(held.body[held.count - 1]), light) : 1.0;
}

// What is where nothing is met: the background, but a bent ray meets the sky's light whether it is shown or not, by its
// harmonics where there is no image; these are stored as diffuse surfaces take them.
vec4 behind_all(vec3 direction, float pixel_at_1m, bool is_bent) {
  if (SHOWS_SKY != 0) return vec4(sky_radiance(direction, pixel_at_1m), 1.0);
  if (!is_bent || HAS_AMBIENT == 0) return frame.background;
  return vec4(ambient_radiance(direction, vec3(1.0, 1.5, 4.0)) * frame.pre_exposure, 1.0);
}

struct Followed {
  vec3 light;
  float covers;  // below 0: the surface is none, or too rough
  bool splits;   // the first body does, and light of other colours goes other ways
};

Followed follow(TraceRay ray, int light, float roughest) {
  Followed f = Followed(vec3(0.0), -1.0, false);
  const TraceScene scene = TraceSceneRef(TRACE_ADDRESS).s;
  Held held;
  held.count = 0;
  vec3 through = vec3(1.0);
  TraceHit passed = TRACE_NOTHING;
  uint mode = TRACE_GLASS;
  bool is_first = true;
  int walls = 0;
  float before_m = 0.0;  // all of the way up to the ray's origin
  float done_m = 0.0;    // of the ray, what has been followed
  const float pixel_at_1m = 2.0 * frame.tan_half.y / float(frame.size_px.y);
  while (true) {
    TraceHit hit;
    const bool met = trace(ray, mode, passed, hit);
    const TraceItem item = trace_item(scene, met ? hit.item : 0u);
    const bool is_glass = met && (item.flags & trace_refracts) != 0u;
    const bool is_blended = met && (item.flags & trace_blended) != 0u;
    if (is_first && !is_glass) {
      if (!is_blended) return f;
      passed = hit;
      ray.t_min = hit.t;
      mode |= TRACE_PASSED;
      continue;
    }
    HitPoint h;
    Surface s;
    Glass glass;
    float way_m = 0.0;
    if (met) {
      way_m = max(hit.t - done_m, 0.0);
      const float far_m = before_m + hit.t;
      h = hit_point(hit, ray, pixel_at_1m * (frame.perspective != 0u ? far_m : 1.0), 0.0);
      if (is_glass) {
        glass = load_glass(h.material);
        // A ray that began inside, where the camera stands.
        if (glass.thickness_m > 0.0 && hit.back != 0u && walls < WALLS && !holds(held, h.material))
          enter(held, h.material);
      }
      s = hit_surface(h, hit);
      begin_rays_at(hit, h.to_viewer);
    }
    if (held.count > 0) {
      const vec3 absorption = load_glass(held.body[held.count - 1]).absorption;
      // Beyond all ends as much is left as where nothing absorbs, or nothing.
      through *= met ? exp(-absorption * way_m) : vec3(lessThanEqual(absorption, vec3(0.0)));
    }
#ifdef FOG
    else if (!is_first) {
      through *= fog_through(ray.origin + ray.direction * done_m, ray.direction, met ? way_m : FOG_FAR);
    }
#endif
    if (!met) {
      const vec4 behind = behind_all(ray.direction, pixel_at_1m, walls > 0);
      f.light += through * behind.rgb;
      f.covers = 1.0 - max(through.r, max(through.g, through.b)) * (1.0 - behind.a);
      return f;
    }
    done_m = hit.t;
    float fraction = 0.0, shows = 1.0;  // shows: of the surface's own light
    if (is_glass) {
      fraction = glass.transmission;
      if (glass.transmission_texture.texture != absent) fraction *= sample_texture(glass.transmission_texture, h.v).r;
      fraction = clamp(fraction, 0.0, 1.0);
      // The camera sees the first one itself, and what walls reflect inside goes no way that is followed.
      shows = is_first || held.count > 0 || hit.back != 0u ? 0.0 : 1.0;
    } else if (is_blended) {
      shows = trace_coverage(scene, item, hit.primitive, hit.u, hit.v);
    }
    if (is_first) {
      if (s.roughness >= roughest) return f;
      f.splits = glass.dispersion > 0.0 && glass.thickness_m > 0.0;
    }
    if (shows > 0.0) {
      // Radiance in a body is less by the square of its index where the camera sees it.
      const float within = index_within(held, light);
      Surface lit = s;
      lit.base_color *= 1.0 - fraction;
      const vec3 own = h.is_unlit ? max(surface_base_color(h.m, h.v).rgb, vec3(0.0)) : lit_hit(h, lit);
      f.light += through * own * (shows * frame.pre_exposure / (within * within));
    }
    if (!is_glass) through *= 1.0 - shows;
    bool is_bent = false;
    vec3 onward = ray.direction;
    if (is_glass) {
      const bool is_body = glass.thickness_m > 0.0 && walls < WALLS;
      const vec3 v = h.to_viewer, n = dot(s.normal, v) > 1e-4 ? s.normal : rays_side;
      const float cosine = clamp(dot(n, v), 0.0, 1.0), in_air = index_of(glass, light);
      Held behind = held;
      if (is_body && hit.back != 0u)
        leave(behind, h.material);
      else if (is_body)
        enter(behind, h.material);
      const float eta = is_body ? index_within(behind, light) / index_within(held, light) : in_air;
      const float exact = fresnel(cosine, eta);
      is_bent = is_body && eta != 1.0;
      if (is_body && exact >= 1.0) {
        onward = reflect(-v, n);
        if (!(dot(onward, rays_side) > 0.0)) onward = reflect(-v, rays_side);
      } else {
        // The specular extension scales what is reflected at normal and at grazing incidence.
        const float normal = (eta - 1.0) * (eta - 1.0) / ((eta + 1.0) * (eta + 1.0));
        const float air = (in_air - 1.0) * (in_air - 1.0) / ((in_air + 1.0) * (in_air + 1.0));
        // Index 0 reflects all, and index 1 nothing.
        const vec3 f0 = s.dielectric_f0 * (air > 0.0 ? normal / air : 1.0);
        const vec3 reflected =
            mix(f0, vec3(s.dielectric_f90), normal < 1.0 ? (exact - normal) / (1.0 - normal) : 1.0);
        const float most = clamp(max(reflected.r, max(reflected.g, reflected.b)), 0.0, 1.0);
        through *= s.base_color * ((1.0 - s.metallic) * fraction * (1.0 - most));
        if (is_bent) {
          onward = refract(-v, n, 1.0 / eta);
          if (!(dot(onward, rays_side) < 0.0)) onward = refract(-v, rays_side, 1.0 / eta);
        }
        held = behind;
      }
    }
    is_first = false;
    if (through == vec3(0.0)) {
      f.covers = 1.0;
      return f;
    }
    if (is_bent) {
      if (!(dot(onward, onward) > 0.0)) onward = ray.direction;  // along the wall
      before_m += hit.t;
      done_m = 0.0;
      ray = TraceRay(leaving_origin(rays_from, onward), 0.0, normalize(onward), TRACE_FAR);
      mode = TRACE_GLASS;
      passed = TRACE_NOTHING;
      if (++walls == WALLS) held.count = 0;
    } else {
      passed = hit;
      ray.t_min = hit.t;
      mode |= TRACE_PASSED;
    }
  }
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  pixel_middle = vec2(pixel) + 0.5;
  const ViewRay seen = view_ray(pixel_middle);
  const TraceRay ray = TraceRay(seen.origin, 0.0, normalize(seen.direction), TRACE_FAR);
  vec4 target = vec4(0.0);
  int lights = 1;
  for (int light = GREEN; light < lights; ++light) {
    const Followed f = follow(ray, light, uintBitsToFloat(pc.own));
    if (light == GREEN)
      target = vec4(f.light, f.covers);
    else if (light == RED)
      target.r = f.light.r;
    else
      target.b = f.light.b;
    target.a = max(target.a, f.covers);
    if (f.splits) lights = 3;
  }
  imageStore(storage_images[REFRACTION_PLACE(uint(pc.table), 3u)], ivec2(pixel), target);
}
