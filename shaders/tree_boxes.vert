#version 460
// The twelve edges of a box of a tree for rays, two vertices each. An instance is a child of a node, eight a node; the
// last one is the box of the root. Boxes of the other kind than is drawn, and absent ones, come to nothing.
#include "shared/visibility.h"
#include "shared/trace.h"
layout(push_constant, scalar) uniform Push { TreeBoxesPush pc; };
#include "lib/frame.glsl"
layout(location = 0) out flat uint out_is_leaf;

struct Box {
  vec3 low, high;
  bool is_leaf;
};
uint64_t node_at(TraceScene s, uint node) {
  return pc.trees + uint64_t(s.nodes) * trace_table_align + 96ul * uint64_t(node);
}
Box child_box(uint64_t node, uint lane, uint child) {
  Box b;
  const vec4 head = TraceVec4Ref(node).v;
  for (int a = 0; a < 3; ++a) {
    const float step_m = uintBitsToFloat((floatBitsToUint(head.w) >> 8 * a & 255u) << 23u);
    const uvec4 rows = TraceUvec4Ref(node + 16ul + 16ul * uint64_t(a)).v;
    const uint shift = 8u * (lane & 3u);
    b.low[a] = head[a] + step_m * float(rows[lane / 4u] >> shift & 255u);
    b.high[a] = head[a] + step_m * float(rows[2u + lane / 4u] >> shift & 255u);
  }
  b.is_leaf = pc.holds_instances == 0u && (child & trace_leaf_bit) != 0u;
  return b;
}

void main() {
  const TraceScene s = TraceSceneRef(pc.trees).s;
  const uint number = gl_InstanceIndex, inner = number / 8u;
  Box box;
  bool drawn = true;
  if (inner < pc.nodes) {
    const uint64_t node = node_at(s, pc.first_node + inner);
    const uint child = TraceUintRef(node + 64ul + 4ul * uint64_t(number % 8u)).u;
    drawn = child != no_trace;
    box = child_box(node, number % 8u, child);
  } else {
    const uint64_t node = node_at(s, pc.first_node);
    box = Box(vec3(3e38), vec3(-3e38), false);
    for (uint lane = 0u; lane < 8u; ++lane) {
      const uint child = TraceUintRef(node + 64ul + 4ul * uint64_t(lane)).u;
      if (child == no_trace) continue;
      const Box part = child_box(node, lane, child);
      box.low = min(box.low, part.low);
      box.high = max(box.high, part.high);
    }
  }
  out_is_leaf = box.is_leaf ? 1u : 0u;
  // Edge e runs along axis e / 4, from the corner that the two bits of e % 4 choose on the others.
  const uint edge = gl_VertexIndex / 2u, axis = edge / 4u;
  uvec3 upper;
  upper[axis] = gl_VertexIndex % 2u;
  upper[(axis + 1u) % 3u] = edge & 1u;
  upper[(axis + 2u) % 3u] = edge >> 1u & 1u;
  vec3 corner = mix(box.low, box.high, notEqual(upper, uvec3(0u)));
  if (pc.instance != no_trace) {
    const TraceInstance i =
        TraceInstanceRef(pc.trees + uint64_t(s.instances) * trace_table_align + 152ul * uint64_t(pc.instance)).i;
    corner = vec3(dot(i.relative_row[0], vec4(corner, 1.0)), dot(i.relative_row[1], vec4(corner, 1.0)),
        dot(i.relative_row[2], vec4(corner, 1.0)));
  }
  corner = (corner - frame.trace_shift) - frame.trace_shift_rest;
  gl_Position = frame.clip_from_relative * vec4(corner, 1.0);
  if (!drawn || box.is_leaf != (pc.leaves != 0u)) gl_Position = vec4(0.0, 0.0, 0.0, -1.0);  // outside
}
