#pragma once
// Rays against the frame's triangles: the trees of bvh/wide_tree.h in storage buffers, for any device. Same hits as the
// CPU's (bvh/trace_kernel.h), for the operations are the same: slabs after Ize, "Robust BVH Ray Traversal", 2013;
// triangles after Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", 2013, whose edge functions are made anew
// in twice the precision where they are zero. Which candidates count is what src/reference/visibility.cpp says: holes
// of masks never, backs always, what glows all over not on the way to a lamp (src/scene/glow.h).
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
  uint place;     // four times its block, plus its lane
  uint instance;  // no_trace: of the world tree
};
const TraceHit TRACE_NOTHING = TraceHit(0.0, 0.0, 0.0, 0u, 0u, 0u, 0u, no_trace);

// Any hit ends the search; on the way to a lamp; the hit nearest to t = 1, whichever side of it, of what is there at
// all; what `passed` names and what lies before it counts no more; surfaces that refract count too.
const uint TRACE_ANY = 1u, TRACE_TO_LAMP = 2u, TRACE_LOCATE = 4u, TRACE_PASSED = 8u, TRACE_GLASS = 16u;
const float TRACE_FAR = 3.0e38;
// Of slabs: what rounding does, and how far a triangle's t may lie before its box's.
const float TRACE_SLACK = 1.000001;
const float TRACE_SMALLEST = 1e-20, TRACE_LARGEST = 1e30;  // edge functions in floats lose digits beyond
// A direction's component below this is none: what lies in the slab's plane is in the slab.
const float TRACE_NONE = 1e-30, TRACE_SLAB_SCALE = 1e36, TRACE_SLAB_MARGIN = 1e30;

#ifdef TRACE_COUNTS
uint trace_nodes = 0u, trace_triangles = 0u;  // entered and tested so far
#endif

// A ray as a tree's boxes and triangles take it.
struct TraceFrame {
  vec3 origin, inverse, inverse_far;  // far: widened
  vec3 margin;                        // of slabs that the ray runs along
  uvec3 low_row;                      // first vector of the nearer bound, for each axis; the farther is its neighbour
  uvec3 axis;                         // x, y, z of the sheared space
  float sx, sy, sz;
};

TraceFrame trace_frame(vec3 origin, vec3 d) {
  TraceFrame f;
  f.origin = origin;
  const vec3 size = abs(d);
  for (int a = 0; a < 3; ++a) {
    const bool none = size[a] < TRACE_NONE;
    const float inverse = none ? TRACE_SLAB_SCALE : rounded_quotient(1.0, d[a]);
    f.inverse[a] = inverse;
    f.inverse_far[a] = inverse * TRACE_SLACK;
    f.margin[a] = none ? TRACE_SLAB_MARGIN : 0.0;
    f.low_row[a] = uint(4 * a) + (!none && d[a] < 0.0 ? 2u : 0u);
  }
  f.axis.z = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
  f.axis.x = f.axis.z == 2u ? 0u : f.axis.z + 1u;
  f.axis.y = f.axis.x == 2u ? 0u : f.axis.x + 1u;
  if (d[f.axis.z] < 0.0) f.axis.xy = f.axis.yx;  // keeps the winding
  f.sz = f.inverse[f.axis.z];
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
uint64_t trace_node(TraceScene s, uint node) { return trace_entry(s.nodes, s.blocks, 224ul, node); }
uint64_t trace_block_of(TraceScene s, uint block) { return trace_entry(s.blocks, s.triangles, 160ul, block); }
TraceTriangle trace_triangle(TraceScene s, uint triangle) {
  return TraceTriangleRef(trace_entry(s.triangles, s.items, 8ul, triangle)).t;
}
TraceItem trace_item(TraceScene s, uint item) {
  return TraceItemRef(trace_entry(s.items, s.instances, 16ul, item)).i;
}
TraceInstance trace_instance(TraceScene s, uint instance) {
  return TraceInstanceRef(trace_entry(s.instances, s.corners, 152ul, instance)).i;
}
TraceCorners trace_corners(TraceScene s, uint corners) {
  return TraceCornersRef(trace_entry(s.corners, s.end, 36ul, corners)).c;
}
vec4 trace_vec4(uint64_t at) { return TraceVec4Ref(at).v; }

// Whether the ray meets the boxes of four children, and from where on.
bvec4 trace_boxes(uint64_t node, uint quad, TraceFrame f, float t_min, float t_max, out vec4 near) {
  near = vec4(t_min);
  vec4 far = vec4(t_max * TRACE_SLACK);
  for (int a = 0; a < 3; ++a) {
    const uint row = f.low_row[a] + quad;
    const vec4 low = trace_vec4(node + 16ul * row), high = trace_vec4(node + 16ul * (row ^ 2u));
    near = max((low - f.origin[a]) * f.inverse[a] - f.margin[a], near);
    far = min((high - f.origin[a]) * f.inverse_far[a] + f.margin[a], far);
  }
  return lessThanEqual(near, far);
}
// From where on the ray is in the box of one child.
float trace_box(uint64_t node, uint child, TraceFrame f) {
  float near = -TRACE_FAR;
  for (int a = 0; a < 3; ++a)
    near = max((TraceFloatRef(node + 16ul * f.low_row[a] + 4ul * child).f - f.origin[a]) * f.inverse[a] - f.margin[a],
        near);
  return near;
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

// Whether a triangle that the ray meets at h is there for it.
bool trace_counts(TraceScene s, TraceHit h, uint mode, TraceHit passed) {
  if ((mode & TRACE_LOCATE) != 0u) return true;
  if ((mode & TRACE_PASSED) != 0u && trace_is_passed(h, passed)) return false;
  const TraceItem item = trace_item(s, h.item);
  if ((item.flags & trace_refracts) != 0u && (mode & TRACE_GLASS) == 0u) return false;
  if ((mode & TRACE_TO_LAMP) != 0u && (item.flags & trace_glows) != 0u) return false;
  return (item.flags & trace_masked) == 0u || trace_coverage(s, item, h.primitive, h.u, h.v) != 0.0;
}

// A triangle that the ray meets at h, within its limits. True: the search ends.
bool trace_accept(TraceScene s, TraceHit h, uint mode, TraceHit passed, inout TraceState state) {
  const float off = abs(h.t - 1.0);
  if (state.found) {
    const float best = state.best.t, best_off = abs(best - 1.0);
    const bool locates = (mode & TRACE_LOCATE) != 0u;
    if (locates && off > best_off) return false;
    if ((locates ? off == best_off : h.t == best) &&
        (h.item > state.best.item || (h.item == state.best.item && h.primitive >= state.best.primitive)))
      return false;
  }
  if (!trace_counts(s, h, mode, passed)) return false;
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

// Four triangles as the ray sees them: corners sheared, their z along the ray, and edge functions.
struct TraceLanes {
  vec4 x[3], y[3], z[3], u, v, w;
};
TraceLanes trace_lanes(uint64_t block, TraceFrame f) {
  TraceLanes l;
  for (int k = 0; k < 3; ++k) {
    const uint64_t corner = block + uint64_t(48 * k);
    precise vec4 dz = trace_vec4(corner + 16ul * f.axis.z) - f.origin[f.axis.z];
    precise vec4 dx = (trace_vec4(corner + 16ul * f.axis.x) - f.origin[f.axis.x]) - f.sx * dz;
    precise vec4 dy = (trace_vec4(corner + 16ul * f.axis.y) - f.origin[f.axis.y]) - f.sy * dz;
    precise vec4 along = f.sz * dz;
    l.x[k] = dx, l.y[k] = dy, l.z[k] = along;
  }
  precise vec4 u = l.x[2] * l.y[1] - l.y[2] * l.x[1];
  precise vec4 v = l.x[0] * l.y[2] - l.y[0] * l.x[2];
  precise vec4 w = l.x[1] * l.y[0] - l.y[1] * l.x[0];
  l.u = u, l.v = v, l.w = w;
  return l;
}
// Whether the ray meets one of them within the limits, and where.
bool trace_lane(TraceLanes l, uint lane, TraceState state, inout TraceHit h) {
  const float u = l.u[lane], v = l.v[lane], w = l.w[lane];
  const vec3 z = vec3(l.z[0][lane], l.z[1][lane], l.z[2][lane]);
  if (min(min(u, v), w) < 0.0 && max(max(u, v), w) > 0.0) return false;
  precise float sum = (u + v) + w;
  const float smallest = min(min(abs(u), abs(v)), abs(w)), size = abs(sum);
  if (!(smallest > 0.0 && size >= TRACE_SMALLEST && size <= TRACE_LARGEST))
    return trace_exactly(vec2(l.x[0][lane], l.y[0][lane]), vec2(l.x[1][lane], l.y[1][lane]),
        vec2(l.x[2][lane], l.y[2][lane]), z, state, h);
  precise float t = ((u * z.x + v * z.y) + w * z.z) / sum;
  if (!(t >= state.t_min && t <= state.t_max)) return false;
  h.t = t;
  h.u = v / sum;
  h.v = w / sum;
  h.back = sum < 0.0 ? 1u : 0u;
  return true;
}

// The four triangles of a block. True: the search ends.
bool trace_block(TraceScene s, uint block, uint instance, TraceFrame f, uint mode, TraceHit passed,
                 inout TraceState state) {
  const uint64_t at = trace_block_of(s, block);
#ifdef TRACE_COUNTS
  const uvec4 ids = TraceUvec4Ref(at + 144ul).v;
  for (uint lane = 0u; lane < 4u; ++lane) trace_triangles += ids[lane] != no_trace ? 1u : 0u;
#endif
  const TraceLanes l = trace_lanes(at, f);
  const vec4 least = min(min(l.u, l.v), l.w), largest = max(max(l.u, l.v), l.w);
  if (all(lessThan(least, vec4(0.0))) && all(greaterThan(largest, vec4(0.0)))) return false;
  const uvec4 id = TraceUvec4Ref(at + 144ul).v;
  for (uint lane = 0u; lane < 4u; ++lane) {
    TraceHit h = TRACE_NOTHING;
    if (id[lane] == no_trace || !trace_lane(l, lane, state, h)) continue;
    h.place = 4u * block + lane;
    h.instance = instance;
    if (instance == no_trace) {
      h.item = trace_triangle(s, id[lane]).item;
      const TraceItem item = trace_item(s, h.item);
      h.primitive = id[lane] - item.first;
      if ((item.flags & trace_mirrored) != 0u) h.back ^= 1u;
    } else {
      // A mirroring transform turns corners and sight alike.
      h.item = trace_instance(s, instance).item;
      h.primitive = id[lane];
    }
    if (trace_accept(s, h, mode, passed, state)) return true;
  }
  return false;
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
bool trace_enter(TraceInstance i, TraceRay ray, out TraceFrame f) {
  vec3 origin, direction;
  for (int a = 0; a < 3; ++a) {
    origin[a] = trace_into(i.local_row[a], i.local_rest[a], ray.origin, 1.0);
    direction[a] = trace_into(i.local_row[a], i.local_rest[a], ray.direction, 0.0);
  }
  f = trace_frame(origin, direction);
  return trace_finite(origin) && trace_finite(direction) && direction != vec3(0.0);
}

#if defined(TRACE_QUERY) || defined(TRACE_RAYGEN) || defined(TRACE_HIT)
#include "lib/trace_device.glsl"
#else
// Through the trees, one node at a time.
void trace_search(TraceScene s, TraceRay ray, uint mode, TraceHit passed, inout TraceState state) {
  TraceFrame f = trace_frame(ray.origin, ray.direction);
  uvec2 stack[TRACE_STACK];  // of a node: the children left, nearest lowest, three bits each, and above them how many.
                             // Of a leaf of instances: how many are left
  uint top = 0u, base = 0u;  // base: the stack of the instance's tree begins there
  uint instance = no_trace;
  bool in_top = s.world_root == no_trace;
  uint child = in_top ? s.top_root : s.world_root;
  if (child == no_trace) return;
  child = child == no_trace ? 0u : child;
  while (true) {
    if ((child & trace_leaf_bit) == 0u) {
      const uint64_t node = trace_node(s, child);
#ifdef TRACE_COUNTS
      ++trace_nodes;
#endif
      vec4 near0, near1;
      const bvec4 met0 = trace_boxes(node, 0u, f, state.t_min, state.t_max, near0);
      const bvec4 met1 = trace_boxes(node, 1u, f, state.t_min, state.t_max, near1);
      uint order = 0u, count = 0u;
      float near[8] = float[8](near0.x, near0.y, near0.z, near0.w, near1.x, near1.y, near1.z, near1.w);
      bool met[8] = bool[8](met0.x, met0.y, met0.z, met0.w, met1.x, met1.y, met1.z, met1.w);
      for (uint i = 0u; i < 8u; ++i) {
        if (!met[i]) continue;
        uint before = 0u;
        for (uint j = 0u; j < 8u; ++j)
          before += met[j] && (near[j] < near[i] || (near[j] == near[i] && j < i)) ? 1u : 0u;
        order |= i << (3u * before);
        ++count;
      }
      if (count > 0u) stack[top++] = uvec2(child, order | count << 24);
    } else {
      const uint first = child & ((1u << trace_leaf_shift) - 1u);
      const uint count = ((child & ~trace_leaf_bit) >> trace_leaf_shift) + 1u;
      if (in_top && instance == no_trace) {
        stack[top++] = uvec2(child, count);
      } else {
        for (uint i = first; i < first + count; ++i)
          if (trace_block(s, i, instance, f, mode, passed, state)) return;
      }
    }
    // What is next.
    while (true) {
      if (top == base) {
        if (instance != no_trace) {
          instance = no_trace;
          base = 0u;
          f = trace_frame(ray.origin, ray.direction);
          continue;
        }
        if (in_top || s.top_root == no_trace) return;
        in_top = true;
        child = s.top_root == no_trace ? 0u : s.top_root;
        break;
      }
      const uvec2 entry = stack[top - 1u];
      if ((entry.x & trace_leaf_bit) != 0u) {
        const uint first = entry.x & ((1u << trace_leaf_shift) - 1u);
        if (entry.y == 0u) {
          --top;
          continue;
        }
        stack[top - 1u].y = entry.y - 1u;
        const uint entered = first + entry.y - 1u;
        const TraceInstance i = trace_instance(s, entered);
        TraceFrame entering;
        if (!trace_enter(i, ray, entering)) continue;
        instance = entered;
        base = top;
        f = entering;
        child = i.root;  // never none: of empty trees there is no instance
        break;
      }
      const uint lane = entry.y & 7u, left = entry.y >> 24;
      const uint64_t node = trace_node(s, entry.x);
      if (left == 1u)
        --top;
      else
        stack[top - 1u].y = ((entry.y & 0xffffffu) >> 3u) | (left - 1u) << 24;
      // The ray may have become shorter since its boxes were tested.
      if (state.found && trace_box(node, lane, f) > state.t_max * TRACE_SLACK) continue;
      const uint met_child = TraceUintRef(node + 192ul + 4ul * lane).u;
      if (met_child == no_trace) continue;  // of a ray whose numbers have left the range of floats
      child = met_child;
      break;
    }
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

// A point of a triangle, with what is needed to leave it.
struct TracePoint {
  vec3 position, normal;  // relative; the normal is unit, towards the glTF front; 0 for a degenerate triangle
  float error_m;          // a ray that begins this far off along the normal does not meet the triangle again
};

float trace_largest(vec3 v) { return max(max(abs(v.x), abs(v.y)), abs(v.z)); }

// The same bounds as Accel::surface's.
TracePoint trace_point(TraceHit h) {
  const TraceScene s = TraceSceneRef(TRACE_ADDRESS).s;
  const uint64_t at = trace_block_of(s, h.place >> 2u) + 4ul * uint64_t(h.place & 3u);
  vec3 p[3];
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a) p[k][a] = TraceFloatRef(at + uint64_t(48 * k + 16 * a)).f;
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
  TracePoint point;
  point.position = (1.0 - h.u - h.v) * p[0] + h.u * p[1] + h.v * p[2];
  const vec3 e0 = p[1] - p[0], e1 = p[2] - p[0], e2 = e1 - e0;
  const vec3 n = vec3(difference_of_products(e0.y, e1.z, e0.z, e1.y).high,
      difference_of_products(e0.z, e1.x, e0.x, e1.z).high, difference_of_products(e0.x, e1.y, e0.y, e1.x).high);
  const float largest = trace_largest(n);
  const vec3 scaled = n / max(largest, 1e-37);
  const float size = length(scaled);
  point.normal = largest > 0.0 ? scaled / size * ((item.flags & trace_mirrored) != 0u ? -1.0 : 1.0) : vec3(0.0);
  if (h.instance == no_trace) {
    const uint id = TraceUintRef(trace_block_of(s, h.place >> 2u) + 144ul + 4ul * uint64_t(h.place & 3u)).u;
    point.error_m = trace_triangle(s, id).error_m;
    return point;
  }
  reach = max(reach, max(max(trace_largest(p[0]), trace_largest(p[1])), trace_largest(p[2])));
  const float longest2 = max(max(dot(e0, e0), dot(e1, e1)), dot(e2, e2));
  const float thinness = largest > 0.0 ? min(longest2 / (largest * size), 1000.0) : 1000.0;
  point.error_m = (16.0 * reach + 4.0 * (sqrt(longest2) * thinness)) * 5.9604645e-8;
  return point;
}

vec3 leaving_origin(TracePoint point, vec3 direction) {
  const float side = dot(direction, point.normal) < 0.0 ? -1.0 : 1.0;
  return point.position + (side * point.error_m) * point.normal;
}
