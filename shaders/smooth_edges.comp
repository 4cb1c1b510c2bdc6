#version 460
// Morphological anti-aliasing in three steps (src/passes/post/smooth_edges.h): edges, parts of pixels beside them that
// lie on the other side of the line they stand for, mixture. Or by contrast in one.
#include "shared/smooth_edges.h"
layout(push_constant, scalar) uniform Push { SmoothEdgesPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int STEP = 0;

bool outside(ivec2 p) { return any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(pc.size_px))); }
ivec2 inside(ivec2 p) { return clamp(p, ivec2(0), ivec2(pc.size_px) - 1); }

vec4 color_at(ivec2 p) { return texelFetch(pass_images[pc.color], inside(p), 0); }
// As bright as it looks: exposed luminance (Rec. 709) bent into 0 to 1, and how much covers the pixel.
vec2 shown(ivec2 p) {
  const vec4 c = color_at(p);
  const float y = max(dot(c.rgb, vec3(0.2126, 0.7152, 0.0722)) * pc.exposure, 0.0);
  return vec2(y < 1e30 ? y / (1.0 + y) : 1.0, c.a);
}
float contrast(ivec2 a, ivec2 b) {
  const vec2 d = abs(shown(a) - shown(b));
  return max(d.x, d.y);
}

// An edge to the left of a pixel, and one above it; none where a neighbouring contrast is more than twice as large.
vec2 edges_of(ivec2 p) {
  const ivec2 x = ivec2(1, 0), y = ivec2(0, 1);
  const vec2 own = vec2(contrast(p, p - x), contrast(p, p - y));
  if (all(lessThan(own, vec2(pc.threshold)))) return vec2(0.0);
  float most = max(max(contrast(p, p + x), contrast(p, p + y)), max(own.x, own.y));
  most = max(most, max(contrast(p - x, p - 2 * x), contrast(p - y, p - 2 * y)));
  return vec2(own.x >= pc.threshold && 2.0 * own.x >= most, own.y >= pc.threshold && 2.0 * own.y >= most);
}

vec2 edge(ivec2 p) { return outside(p) ? vec2(0.0) : texelFetch(pass_images[pc.source], p, 0).rg; }

// Integral of max(h, 0) and of max(-h, 0) over a line from h0 to h1 of unit length.
vec2 areas(float h0, float h1) {
  if (h0 * h1 >= 0.0) {
    const float mean = 0.5 * (h0 + h1);
    return vec2(max(mean, 0.0), max(-mean, 0.0));
  }
  const float t = h0 / (h0 - h1);
  const vec2 both = 0.5 * vec2(abs(h0) * t, abs(h1) * (1.0 - t));
  return h0 > 0.0 ? both : both.yx;
}
// The height of the line that an edge of some length stands for, at a place along it. h: half a pixel up or down where
// something crosses its ends, 0 where nothing does.
float height(float x, float len, vec2 h) {
  if (h.x * h.y < 0.0) return mix(h.x, h.y, x / len);
  const float middle = 0.5 * len;
  return x < middle ? h.x * (1.0 - x / middle) : h.y * (x / middle - 1.0);
}

// Half a pixel into the row of p where only there something crosses the end of its edge, half a pixel out of it where
// only on the other side something does.
float end_height(ivec2 at, ivec2 across, int o) { return 0.5 * (edge(at)[o] - edge(at + across)[o]); }
bool crosses(ivec2 at, ivec2 across, int o) { return edge(at)[o] + edge(at + across)[o] > 0.0; }

// Of the edge of pixel p towards `across`, which runs along `along`: the part of p that lies on the other side of the
// line, and of the pixel across it. c: the component of edge() that such edges are, o: that of those which cross them.
vec2 parts_of(ivec2 p, ivec2 along, ivec2 across, int c, int o) {
  const int reach = int(pc.reach_px);
  int back = 0, front = 0;
  while (back < reach && !crosses(p - back * along, across, o) && edge(p - (back + 1) * along)[c] > 0.0) ++back;
  while (front < reach && !crosses(p + (front + 1) * along, across, o) && edge(p + (front + 1) * along)[c] > 0.0)
    ++front;
  const vec2 h =
      vec2(end_height(p - back * along, across, o), end_height(p + (front + 1) * along, across, o));
  if (h == vec2(0.0)) return vec2(0.0);
  const float len = float(back + front + 1), from = float(back), to = from + 1.0, middle = 0.5 * len;
  if (h.x * h.y < 0.0 || middle <= from || middle >= to) return areas(height(from, len, h), height(to, len, h));
  // The line has a corner at its middle.
  return areas(height(from, len, h), 0.0) * (middle - from) + areas(0.0, height(to, len, h)) * (to - middle);
}

// What covers a pixel counts too: an edge against nothing is one.
float brightness(ivec2 p) {
  const vec2 s = shown(p);
  return s.x + s.y;
}
// How far from p along a way the mean of both sides of its edge is no longer that of its own, and by what it differs.
vec2 end_of_edge(ivec2 p, ivec2 along, ivec2 across, float mean, float least) {
  int k = 0;
  float off = 0.0;
  do {
    ++k;
    off = 0.5 * (brightness(p + k * along) + brightness(p + k * along + across)) - mean;
  } while (k < int(pc.reach_px) && abs(off) < least);
  return vec2(float(k), off);
}
const float LONE_FROM = 0.25, LONE_MOST = 0.75;  // of what stands alone, as a part of its contrast
vec4 by_contrast(ivec2 p) {
  const ivec2 x = ivec2(1, 0), y = ivec2(0, 1);
  const vec4 own = color_at(p);
  const float m = brightness(p), n = brightness(p - y), s = brightness(p + y), w = brightness(p - x),
              e = brightness(p + x);
  const float range = max(m, max(max(n, s), max(w, e))) - min(m, min(min(n, s), min(w, e)));
  if (range < pc.threshold) return own;
  const float nw = brightness(p - x - y), ne = brightness(p + x - y), sw = brightness(p - x + y),
              se = brightness(p + x + y);
  const float lone = abs(0.25 * (n + s + w + e) - m) / range;
  const float mixed = min(max(lone - LONE_FROM, 0.0) / (1.0 - LONE_FROM), LONE_MOST);
  const float vertical = abs(nw - 2.0 * n + ne) + 2.0 * abs(w - 2.0 * m + e) + abs(sw - 2.0 * s + se);
  const float horizontal = abs(nw - 2.0 * w + sw) + 2.0 * abs(n - 2.0 * m + s) + abs(ne - 2.0 * e + se);
  const bool lies = horizontal >= vertical;
  const float before = lies ? n : w, behind = lies ? s : e;
  const bool back = abs(before - m) >= abs(behind - m);
  const ivec2 along = lies ? x : y, across = (lies ? y : x) * (back ? -1 : 1);
  const float other = back ? before : behind, mean = 0.5 * (m + other), least = 0.25 * abs(other - m);
  const vec2 a = end_of_edge(p, -along, across, mean, least), b = end_of_edge(p, along, across, mean, least);
  const float nearer = a.x < b.x ? a.y : b.y;
  // Beyond the nearer end the line lies on the other side: this pixel is not one that it covers.
  const float moved = (m < mean) != (nearer < 0.0) ? 0.5 - min(a.x, b.x) / (a.x + b.x) : 0.0;
  precise vec4 sum = vec4(0.0);
  for (int i = 0; i < 9; ++i) sum += color_at(p + ivec2(i % 3 - 1, i / 3 - 1));
  precise vec4 color = mix(own, color_at(p + across), moved);
  color += (sum / 9.0 - color) * mixed;
  return color;
}

void main() {
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(at, pc.size_px))) return;
  const ivec2 p = ivec2(at), x = ivec2(1, 0), y = ivec2(0, 1);
  vec4 result;
  if (STEP == 3) {
    result = by_contrast(p);
  } else if (STEP == 0) {
    result = vec4(edges_of(p) * vec2(p.x > 0, p.y > 0), 0.0, 0.0);
  } else if (STEP == 1) {
    const vec2 e = edge(p);
    result.xy = e.x > 0.0 ? parts_of(p, y, -x, 0, 1) : vec2(0.0);
    result.zw = e.y > 0.0 ? parts_of(p, x, -y, 1, 0) : vec2(0.0);
  } else {
    const vec4 own = texelFetch(pass_images[pc.source], p, 0);
    const float right = p.x + 1 < int(pc.size_px.x) ? texelFetch(pass_images[pc.source], p + x, 0).y : 0.0;
    const float down = p.y + 1 < int(pc.size_px.y) ? texelFetch(pass_images[pc.source], p + y, 0).w : 0.0;
    // Of a line's two kinds of edges the longer ones say where it runs; the steps between them are theirs.
    const bool across = max(own.x, right) > max(own.z, down);
    const vec4 taken = across ? vec4(own.x, right, 0.0, 0.0) : vec4(0.0, 0.0, own.z, down);
    const float sum = taken.x + taken.y + taken.z + taken.w;
    result = color_at(p);
    if (sum > 0.0) {
      const float scale = 1.0 / max(sum, 1.0);
      precise vec4 mixed = result * (1.0 - min(sum, 1.0));
      mixed += color_at(p - x) * (taken.x * scale) + color_at(p + x) * (taken.y * scale);
      mixed += color_at(p - y) * (taken.z * scale) + color_at(p + y) * (taken.w * scale);
      result = mixed;
    }
  }
  imageStore(storage_images[pc.target], p, result);
}
