#pragma once
// Rays against the frame's triangles: the trees of bvh/wide_tree.h in storage buffers, for any device. Same hits as the
// CPU's (bvh/trace_kernel.h): boxes hold those of the CPU, and triangles are tested by the same operations, after Woop,
// Benthin, Wald, "Watertight Ray/Triangle Intersection", 2013, whose edge functions are made anew in twice the
// precision where they are zero. Nodes are packed and their children ordered by the ray's octant, after Ylitie, Karras,
// Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017. Which candidates count is
// what src/reference/visibility.cpp says: holes of masks never, backs always, what glows all over not on the way to a
// lamp (src/scene/glow.h).
//
// lavapipe 25.0.7 loads from an address that is the same in all lanes even where no lane takes the branch, and for
// lanes that have left a loop. So every look-up stays in its table (trace_entry), and no table is empty.
//
// The stack has one entry a level, a node and which of its children are still to be visited, so its size is the trees'
// real depth, and no ray needs more. Needs lib/frame.glsl, lib/bindless.glsl, and before the include TRACE_ADDRESS (of
// a TraceScene) and TRACE_STACK (entries). Units: metres; t counts in the direction's length. With TRACE_QUERY or
// TRACE_RAYGEN the device's acceleration structures name the triangles instead (lib/trace_device.glsl).
#include "lib/exact_float.glsl"
#include "shared/trace.h"

struct TraceRay {
  vec3 origin;
  float t_min;
  vec3 direction;
  float t_max;
};
struct TraceHit {
  float t, u, v;  // u, v: weights of the second and third corner
  uint item, primitive;
  uint back;      // 1: the ray meets the side that glTF calls the back
  uint place;     // of the triangle in its table
  uint instance;  // no_trace: of the world tree
};
const TraceHit TRACE_NOTHING = TraceHit(0.0, 0.0, 0.0, 0u, 0u, 0u, 0u, no_trace);

// Any hit ends the search; on the way to a lamp; the hit nearest to t = 1, whichever side of it, of what is there at
// all; what `passed` names and what lies before it counts no more; surfaces that refract count too.
// TRACE_LIGHT: light comes along the ray, which single-sided faces let through from behind where --sides is open.
const uint TRACE_ANY = 1u, TRACE_TO_LAMP = 2u, TRACE_LOCATE = 4u, TRACE_PASSED = 8u, TRACE_GLASS = 16u,
           TRACE_LIGHT = 32u;
const float TRACE_FAR = 3.0e38;
// Of slabs, as a fraction of how far a node reaches from the ray's origin: what rounding does, and how far a triangle's
// t may lie before its box's.
const float TRACE_SLACK = 1.5e-6;
const float TRACE_SMALLEST = 1e-20, TRACE_LARGEST = 1e30;  // edge functions in floats lose digits beyond
// Slabs that the ray runs along, or nearly, would be met out of the range of floats: they are met as if there.
const float TRACE_FARTHEST_SLAB = 1e36;

#ifdef TRACE_COUNTS
uint trace_nodes = 0u, trace_triangles = 0u;  // entered and tested so far
#endif

// A ray as a tree's boxes and triangles take it.
struct TraceFrame {
  vec3 origin, inverse;
  uint octant;  // bit a: the ray does not go towards minus on axis a
  uvec3 axis;   // x, y, z of the sheared space
  float sx, sy, sz;
};

TraceFrame trace_frame(vec3 origin, vec3 d) {
  TraceFrame f;
  f.origin = origin;
  const vec3 size = abs(d);
  f.octant = (d.x < 0.0 ? 0u : 1u) | (d.y < 0.0 ? 0u : 2u) | (d.z < 0.0 ? 0u : 4u);
  for (int a = 0; a < 3; ++a) f.inverse[a] = size[a] > 1e-37 ? 1.0 / d[a] : TRACE_FAR;
  f.axis.z = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
  f.axis.x = f.axis.z == 2u ? 0u : f.axis.z + 1u;
  f.axis.y = f.axis.x == 2u ? 0u : f.axis.x + 1u;
  if (d[f.axis.z] < 0.0) f.axis.xy = f.axis.yx;  // keeps the winding
  f.sz = rounded_quotient(1.0, d[f.axis.z]);
  f.sx = d[f.axis.x] * f.sz;
  f.sy = d[f.axis.y] * f.sz;
  return f;
}

// Of an entry in the table that ends where the next begins; of the first where there is no such entry: lavapipe loads
// for lanes of a fragment's quad that have left a loop or took no part in it, too, with whatever number they hold.
uint64_t trace_entry(uint begin, uint end, uint64_t bytes, uint entry) {
  const uint64_t offset = bytes * uint64_t(entry);
  const uint64_t size = uint64_t(end - begin) * trace_table_align;
  return TRACE_ADDRESS + uint64_t(begin) * trace_table_align + (offset + bytes <= size ? offset : 0ul);
}
uint64_t trace_node(TraceScene s, uint node) { return trace_entry(s.nodes, s.triangles, 96ul, node); }
TraceTriangle trace_triangle(TraceScene s, uint place) {
  return TraceTriangleRef(trace_entry(s.triangles, s.items, 48ul, place)).t;
}
TraceItem trace_item(TraceScene s, uint item) {
  return TraceItemRef(trace_entry(s.items, s.instances, 12ul, item)).i;
}
TraceInstance trace_instance(TraceScene s, uint instance) {
  return TraceInstanceRef(trace_entry(s.instances, s.corners, 152ul, instance)).i;
}
TraceCorners trace_corners(TraceScene s, uint corners) {
  return TraceCornersRef(trace_entry(s.corners, s.end, 36ul, corners)).c;
}
vec4 trace_vec4(uint64_t at) { return TraceVec4Ref(at).v; }

vec4 trace_bytes(uint word) { return vec4(uvec4(word, word >> 8u, word >> 16u, word >> 24u) & 255u); }

// The children whose boxes the ray meets: a bit each, the first to be visited highest.
uint trace_children(uint64_t node, TraceFrame f, float t_min, float t_max) {
  const vec4 head = trace_vec4(node);
  const uint steps = floatBitsToUint(head.w);
  const vec3 step_m = uintBitsToFloat((uvec3(steps, steps >> 8u, steps >> 16u) & 255u) << 23u);
  vec4 near0 = vec4(t_min), near1 = near0, far0 = vec4(t_max), far1 = far0;
  for (int a = 0; a < 3; ++a) {
    const float from = head[a] - f.origin[a], reach = abs(from) + 256.0 * step_m[a];
    float inverse = f.inverse[a];
    if (!(reach * abs(inverse) < TRACE_FARTHEST_SLAB))
      inverse = (inverse < 0.0 ? -TRACE_FARTHEST_SLAB : TRACE_FARTHEST_SLAB) / reach;
    const float width = step_m[a] * inverse, begin = from * inverse, margin = TRACE_SLACK * reach * abs(inverse);
    const uvec4 rows = TraceUvec4Ref(node + 16ul + 16ul * uint64_t(a)).v;
    const uvec4 row = (f.octant >> a & 1u) != 0u ? rows : rows.zwxy;
    near0 = max(trace_bytes(row.x) * width + (begin - margin), near0);
    near1 = max(trace_bytes(row.y) * width + (begin - margin), near1);
    far0 = min(trace_bytes(row.z) * width + (begin + margin), far0);
    far1 = min(trace_bytes(row.w) * width + (begin + margin), far1);
  }
  uint met = 0u;
  for (uint i = 0u; i < 4u; ++i) {
    met |= near0[i] <= far0[i] ? 1u << i : 0u;
    met |= near1[i] <= far1[i] ? 16u << i : 0u;
  }
  met &= steps >> 24u;
  // Child c goes to bit c ^ octant.
  met = (f.octant & 1u) != 0u ? (met & 0x55u) << 1u | (met >> 1u & 0x55u) : met;
  met = (f.octant & 2u) != 0u ? (met & 0x33u) << 2u | (met >> 2u & 0x33u) : met;
  return (f.octant & 4u) != 0u ? (met & 0x0fu) << 4u | met >> 4u : met;
}

// Of the base colour at a hit: what it covers. Level 0 of the texture, as the reference reads it.
float trace_coverage(TraceScene s, TraceItem item, uint primitive, float u, float v) {
  if ((item.flags & (trace_masked | trace_blended)) == 0u || item.first_corner == no_trace) return 1.0;
  const TraceCorners c = trace_corners(s, item.first_corner + primitive);
  const vec3 weight = vec3(1.0 - u - v, u, v);
  MaterialsRef materials = MaterialsRef(frame.materials);
  float alpha = materials.m[item.material].base_color.a * dot(c.alpha, weight);
  const uint texture_index = materials.m[item.material].base_texture.texture;
  if (texture_index != absent) {
    const uint sampler_index = materials.m[item.material].base_texture.sampler_index;
    const vec2 uv = c.uv[0] * weight.x + c.uv[1] * weight.y + c.uv[2] * weight.z;
    alpha *= textureLod(nonuniformEXT(sampler2D(textures[nonuniformEXT(texture_index)],
                                                samplers[nonuniformEXT(sampler_index)])), uv, 0.0).a;
  }
  if ((item.flags & trace_blended) != 0u) return clamp(alpha, 0.0, 1.0);
  return alpha < materials.m[item.material].alpha_cutoff ? 0.0 : 1.0;
}

#include "lib/trace_point.glsl"

bool trace_on_edge(TraceHit h) { return min(min(h.u, h.v), 1.0 - h.u - h.v) < 1e-5; }

// A ray along the edge that two triangles of an item share meets both, and is covered but once.
bool trace_is_passed(TraceHit h, TraceHit passed) {
  if (h.t < passed.t) return true;
  if (h.t == passed.t && (h.item < passed.item || (h.item == passed.item && h.primitive <= passed.primitive)))
    return true;
  return h.item == passed.item && h.primitive != passed.primitive && abs(h.t - passed.t) <= 4e-6 * abs(passed.t) &&
      trace_on_edge(h) && trace_on_edge(passed);
}

// What changes while a ray goes.
struct TraceState {
  float t_min, t_max;
  TraceHit best;
  bool found;
};
#ifdef RELIEFS
#include "lib/trace_relief.glsl"
#endif

// Whether a triangle that the ray meets at h is there for it. asked: whether its item may have something against it.
bool trace_counts(TraceScene s, TraceHit h, bool asked, uint mode, TraceHit passed) {
  if ((mode & TRACE_LOCATE) != 0u) return true;
  if ((mode & TRACE_PASSED) != 0u && trace_is_passed(h, passed)) return false;
  if (!asked) return true;
  const TraceItem item = trace_item(s, h.item);
  if ((item.flags & trace_refracts) != 0u && (mode & TRACE_GLASS) == 0u) return false;
  if ((mode & TRACE_TO_LAMP) != 0u && (item.flags & trace_glows) != 0u) return false;
  if ((mode & TRACE_LIGHT) != 0u && (item.flags & trace_single) != 0u && h.back == 0u) return false;
  return (item.flags & trace_masked) == 0u || trace_coverage(s, item, h.primitive, h.u, h.v) != 0.0;
}

// A triangle that the ray meets at h, within its limits. True: the search ends.
bool trace_accept(TraceScene s, TraceHit h, bool asked, uint mode, TraceHit passed, inout TraceState state) {
  const float off = abs(h.t - 1.0);
  if (state.found) {
    const float best = state.best.t, best_off = abs(best - 1.0);
    const bool locates = (mode & TRACE_LOCATE) != 0u;
    if (locates && off > best_off) return false;
    if ((locates ? off == best_off : h.t == best) &&
        (h.item > state.best.item || (h.item == state.best.item && h.primitive >= state.best.primitive)))
      return false;
  }
  if (!trace_counts(s, h, asked, mode, passed)) return false;
  if ((mode & TRACE_LOCATE) == 0u) {
    state.t_max = h.t;
  } else {
    state.t_min = max(state.t_min, 1.0 - off);
    state.t_max = min(state.t_max, 1.0 + off);
  }
  state.best = h;
  state.found = true;
  return (mode & TRACE_ANY) != 0u;
}

// The edge functions and the hit in twice the precision: one of them is 0, or their sum is out of what floats hold.
bool trace_exactly(vec2 a, vec2 b, vec2 c, vec3 z, TraceState state, inout TraceHit h) {
  const vec2 m = max(max(abs(a), abs(b)), abs(c));
  const float most = max(m.x, m.y);
  if (!(most > 0.0) || most > TRACE_FAR) return false;
  int exponent;
  frexp(most, exponent);
  a = ldexp(a, ivec2(-exponent)), b = ldexp(b, ivec2(-exponent)), c = ldexp(c, ivec2(-exponent));
  const Pair u = difference_of_products(c.x, b.y, c.y, b.x);
  const Pair v = difference_of_products(a.x, c.y, a.y, c.x);
  const Pair w = difference_of_products(b.x, a.y, b.y, a.x);
  if ((u.high < 0.0 || v.high < 0.0 || w.high < 0.0) && (u.high > 0.0 || v.high > 0.0 || w.high > 0.0)) return false;
  const Pair sum = pair_sum(pair_sum(u, v), w);
  if (!(sum.high != 0.0)) return false;
  const Pair above = pair_sum(pair_sum(pair_times(u, z.x), pair_times(v, z.y)), pair_times(w, z.z));
  precise float t = above.high / sum.high;
  const Pair back = pair_times(sum, t);
  precise float rest = (above.high - back.high) + (above.low - back.low);
  t += rest / sum.high;
  if (!(t >= state.t_min && t <= state.t_max)) return false;
  h.t = t;
  h.u = v.high / sum.high;
  h.v = w.high / sum.high;
  h.back = sum.high < 0.0 ? 1u : 0u;
  return true;
}

// A corner as the ray sees it: sheared, its z along the ray.
vec3 trace_corner(vec3 corner, TraceFrame f) {
  const vec3 p = corner - f.origin;
  const float z = f.axis.z == 0u ? p.x : f.axis.z == 1u ? p.y : p.z;
  const float x = f.axis.x == 0u ? p.x : f.axis.x == 1u ? p.y : p.z;
  const float y = f.axis.y == 0u ? p.x : f.axis.y == 1u ? p.y : p.z;
  precise vec3 seen;
  seen.x = x - f.sx * z;
  seen.y = y - f.sy * z;
  seen.z = f.sz * z;
  return seen;
}
// Whether the ray meets a triangle within the limits, and where.
bool trace_test(TraceTriangle triangle, TraceFrame f, TraceState state, inout TraceHit h) {
  const vec3 a = trace_corner(triangle.a, f), b = trace_corner(triangle.b, f), c = trace_corner(triangle.c, f);
  precise float u = c.x * b.y - c.y * b.x;
  precise float v = a.x * c.y - a.y * c.x;
  precise float w = b.x * a.y - b.y * a.x;
  if (min(min(u, v), w) < 0.0 && max(max(u, v), w) > 0.0) return false;
  precise float sum = (u + v) + w;
  const float smallest = min(min(abs(u), abs(v)), abs(w)), size = abs(sum);
  if (!(smallest > 0.0 && size >= TRACE_SMALLEST && size <= TRACE_LARGEST))
    return trace_exactly(a.xy, b.xy, c.xy, vec3(a.z, b.z, c.z), state, h);
  precise float t = ((u * a.z + v * b.z) + w * c.z) / sum;
  if (!(t >= state.t_min && t <= state.t_max)) return false;
  h.t = t;
  h.u = v / sum;
  h.v = w / sum;
  h.back = sum < 0.0 ? 1u : 0u;
  return true;
}

// A triangle of the trees. True: the search ends.
bool trace_place(TraceScene s, uint place, TraceTriangle triangle, uint instance, TraceFrame f, uint mode,
                 TraceHit passed, inout TraceState state) {
#ifdef TRACE_COUNTS
  ++trace_triangles;
#endif
  TraceHit h = TRACE_NOTHING;
  if (!trace_test(triangle, f, state, h)) return false;
  h.place = place;
  h.instance = instance;
  h.primitive = triangle.primitive;
  // A mirroring transform of an instance turns corners and sight alike.
  uint item = triangle.item;
  if (instance != no_trace) item = trace_instance(s, instance).item;
  h.item = item & ~trace_asked;
  const bool asked = (item & trace_asked) != 0u;
  if (instance == no_trace && asked && (trace_item(s, h.item).flags & trace_mirrored) != 0u) h.back ^= 1u;
#ifdef RELIEFS
  if (asked && !trace_on_relief(s, triangle, f, state, h)) return false;
#endif
  return trace_accept(s, h, asked, mode, passed, state);
}

// Into mesh space, rounded once.
float trace_into(vec4 row, vec4 rest, vec3 v, float w) {
  Pair sum = Pair(0.0, 0.0);
  for (int a = 0; a < 3; ++a) {
    const Pair product = exact_product(row[a], v[a]);
    precise float low = product.low + rest[a] * v[a];
    sum = pair_sum(sum, Pair(product.high, low));
  }
  if (w != 0.0) sum = pair_sum(sum, Pair(row.w, rest.w));
  return sum.high;
}

bool trace_finite(vec3 v) { return all(lessThanEqual(abs(v), vec3(TRACE_FAR))); }

// The ray in an instance's mesh space; false: its numbers leave the range of floats there.
bool trace_enter(TraceInstance i, TraceRay ray, out vec3 origin, out vec3 direction) {
  for (int a = 0; a < 3; ++a) {
    origin[a] = trace_into(i.local_row[a], i.local_rest[a], ray.origin, 1.0);
    direction[a] = trace_into(i.local_row[a], i.local_rest[a], ray.direction, 0.0);
  }
  return trace_finite(origin) && trace_finite(direction) && direction != vec3(0.0);
}

#if defined(TRACE_QUERY) || defined(TRACE_RAYGEN) || defined(TRACE_HIT)
#include "lib/trace_device.glsl"
#else
// Through the trees. Drivers inline a function at every call, so trace_frame and trace_children are called in one place
// each: a shader that sends rays is mostly this one.
void trace_search(TraceScene s, TraceRay ray, uint mode, TraceHit passed, inout TraceState state) {
  TraceFrame f;
  vec3 origin = ray.origin, direction = ray.direction;  // in the space of the tree that is searched
  bool turned = true;                                   // f is another's yet
  uvec2 stack[TRACE_STACK];  // a node, and a bit for each child left; or a leaf of instances, and how many are left
  uint top = 0u, base = 0u;  // base: the stack of the instance's tree begins there
  uint instance = no_trace;
  bool in_top = false;
  uint node = s.world_root, left = 0u;
  bool entered = node != no_trace;  // the node, whose children have not been tested yet
  while (true) {
    if (turned) f = trace_frame(origin, direction);
    turned = false;
    // To the next leaf.
    uint leaf = no_trace;
    while (true) {
      if (entered) {
        left = trace_children(trace_node(s, node), f, state.t_min, state.t_max);
        entered = false;
#ifdef TRACE_COUNTS
        ++trace_nodes;
#endif
      }
      if (left == 0u) {
        if (top == base) break;
        --top;
        node = stack[top].x;
        left = stack[top].y;
      }
      if ((node & trace_leaf_bit) != 0u) break;
      const uint bit = uint(findMSB(left));
      left ^= 1u << bit;
      const uint child = TraceUintRef(trace_node(s, node) + 64ul + 4ul * uint64_t((bit ^ f.octant) & 7u)).u;
      if ((child & trace_leaf_bit) != 0u) {
        leaf = child;
        break;
      }
      if (left != 0u) stack[top++] = uvec2(node, left);
      node = child;
      entered = true;
    }
    uint root = no_trace;  // of the tree that is entered next
    if (leaf != no_trace) {
      const uint first = leaf & ((1u << trace_leaf_shift) - 1u);
      const uint count = ((leaf & ~trace_leaf_bit) >> trace_leaf_shift) + 1u;
      if (!in_top || instance != no_trace) {
        for (uint place = trace_block * first; place < trace_block * (first + count); ++place) {
          const TraceTriangle triangle = trace_triangle(s, place);
          if (triangle.item == no_trace) break;
          if (trace_place(s, place, triangle, instance, f, mode, passed, state)) return;
        }
        continue;
      }
      if (left != 0u) stack[top++] = uvec2(node, left);
      node = leaf;
      left = count;
    }
    if (left != 0u) {  // of instances
      const uint next = (node & ((1u << trace_leaf_shift) - 1u)) + --left;
      if (left != 0u) stack[top++] = uvec2(node, left);
      left = 0u;
      const TraceInstance i = trace_instance(s, next);
      vec3 from, along;
      if (!trace_enter(i, ray, from, along)) continue;
      instance = next;
      base = top;
      origin = from;
      direction = along;
      turned = true;
      root = i.root;  // never none: of empty trees there is no instance
    } else if (instance != no_trace) {  // which is done
      instance = no_trace;
      base = 0u;
      origin = ray.origin;
      direction = ray.direction;
      turned = true;
      continue;
    } else {
      if (in_top || s.top_root == no_trace) return;
      in_top = true;
      root = s.top_root;
    }
    node = root;
    entered = true;
  }
}
#endif

#ifndef TRACE_HIT
// The nearest hit that counts, or any. Rays with numbers that are none or without direction meet nothing.
bool trace(TraceRay ray, uint mode, TraceHit passed, out TraceHit hit) {
  TraceState state;
  state.t_min = ray.t_min;
  state.t_max = min(ray.t_max, TRACE_FAR);
  state.found = false;
  state.best = TRACE_NOTHING;
  hit = TRACE_NOTHING;
  const vec3 size = abs(ray.direction);
  const float largest = max(max(size.x, size.y), size.z);
  if (!trace_finite(ray.origin) || !trace_finite(ray.direction) || !(largest > 0.0) || !(state.t_min <= state.t_max))
    return false;
  precise vec3 rest = frame.trace_shift_rest + ray.origin;
  ray.origin = frame.trace_shift + rest;
  // Far from lengths about 1 numbers on the way would leave the range of floats.
  float scale = 1.0;
  if ((mode & TRACE_LOCATE) == 0u && !(largest >= 9.5367432e-7 && largest <= 1048576.0)) {
    int exponent;
    frexp(largest, exponent);
    scale = ldexp(1.0, exponent - 1);
    ray.direction = ldexp(ray.direction, ivec3(1 - exponent));
    state.t_min *= scale;
    state.t_max = min(state.t_max * scale, TRACE_FAR);
    passed.t *= scale;
  }
  trace_search(TraceSceneRef(TRACE_ADDRESS).s, ray, mode, passed, state);
  hit = state.best;
  hit.t /= scale;
  return state.found;
}
#endif

float trace_largest(vec3 v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

// From the space of the trees into relative space.
vec3 trace_out(vec3 position) {
  precise vec3 near = position - frame.trace_shift;
  return near - frame.trace_shift_rest;
}

// The same bounds as Accel::surface's.
TracePoint trace_point(TraceHit h) {
  const TraceScene s = TraceSceneRef(TRACE_ADDRESS).s;
  const TraceTriangle triangle = trace_triangle(s, h.place);
  vec3 p[3] = vec3[3](triangle.a, triangle.b, triangle.c);
  const TraceItem item = trace_item(s, h.item);
  float reach = 0.0;
  if (h.instance != no_trace) {
    const TraceInstance i = trace_instance(s, h.instance);
    for (int a = 0; a < 3; ++a) {
      const vec4 row = i.relative_row[a];
      reach = max(reach, abs(row.w) + dot(abs(row.xyz * p[0]), vec3(1.0)));
    }
    for (int k = 0; k < 3; ++k)
      p[k] = vec3(dot(i.relative_row[0], vec4(p[k], 1.0)), dot(i.relative_row[1], vec4(p[k], 1.0)),
          dot(i.relative_row[2], vec4(p[k], 1.0)));
  }
  TracePoint point = trace_free_point(vec3(0.0), vec3(0.0), 0.0);
  point.position = (1.0 - h.u - h.v) * p[0] + h.u * p[1] + h.v * p[2];
  const vec3 e0 = p[1] - p[0], e1 = p[2] - p[0], e2 = e1 - e0;
  const vec3 n = vec3(difference_of_products(e0.y, e1.z, e0.z, e1.y).high,
      difference_of_products(e0.z, e1.x, e0.x, e1.z).high, difference_of_products(e0.x, e1.y, e0.y, e1.x).high);
  const float largest = trace_largest(n);
  const vec3 scaled = n / max(largest, 1e-37);
  const float size = length(scaled);
  point.normal = largest > 0.0 ? scaled / size * ((item.flags & trace_mirrored) != 0u ? -1.0 : 1.0) : vec3(0.0);
#ifdef RELIEFS
  const float relief_error_m = put_on_relief(s, item, triangle, h, p[0], e0, e1, point);
#endif
  if (h.instance == no_trace) {
    point.error_m = triangle.error_m;
#ifdef RELIEFS
    point.error_m += relief_error_m;
#endif
    point.position = trace_out(point.position);
    return point;
  }
  reach = max(reach, max(max(trace_largest(p[0]), trace_largest(p[1])), trace_largest(p[2])));
  const float longest2 = max(max(dot(e0, e0), dot(e1, e1)), dot(e2, e2));
  const float thinness = largest > 0.0 ? min(longest2 / (largest * size), 1000.0) : 1000.0;
  point.position = trace_out(point.position);
  point.error_m = (16.0 * reach + 4.0 * (sqrt(longest2) * thinness)) * 5.9604645e-8;
#ifdef RELIEFS
  point.error_m += relief_error_m;
#endif
  return point;
}
