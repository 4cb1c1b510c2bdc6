#version 460
// Writes the triangles of each block to their places, three vertices each: positions in the lattice's space, normals of
// the field, turned by noise, and where motion is asked for the positions of the time before. One workgroup a block:
// each thread finds the triangles of a row of cells, and then all share them evenly.
#include "shared/metaballs.h"
layout(push_constant, scalar) uniform Push { MetaballsPush pc; };
layout(local_size_x = 64) in;
// 1: positions of the time before are written too.
layout(constant_id = 0) const int HAS_BEFORE = 0;
#include "lib/metaballs.glsl"
#include "lib/metaball_normal.glsl"

shared uint count_of_row[64];

MetaballBody body;
MetaballBlock block;

// What the ball's kernel leaves of 1 - q^2, at least 0.
float left_of(LatticeBall b, vec3 from_centre) {
  return max(1.0 - dot(from_centre, from_centre) * b.inverse_square_radius, 0.0);
}
LatticeBall ball_at(uint i) {
  return LatticeBallsRef(pc.balls).b[body.first_ball + WordsRef(pc.lists).w[block.first + i]];
}

// The field's outward direction, of unit length. Where it has no slope, as at the ends of kernels, away from the ball
// whose kernel ends last.
vec3 outwards(vec3 p, vec3 otherwise) {
  vec3 sum = vec3(0.0), away = otherwise;
  float nearest = 1e30;
  for (uint i = 0u; i < block.count; ++i) {
    const LatticeBall b = ball_at(i);
    const vec3 d = p - b.centre;
    const float u = left_of(b, d), square = dot(d, d) * b.inverse_square_radius;
    sum += (b.strength * b.inverse_square_radius * u * u) * d;
    if (b.strength > 0.0 && square > 0.0 && square < nearest) {
      nearest = square;
      away = normalize(d);
    }
  }
  const float largest = max(abs(sum.x), max(abs(sum.y), abs(sum.z)));
  return largest > 1e-30 && !isinf(largest) ? normalize(sum / largest) : away;
}

float field_before(vec3 p, out vec3 slope) {
  float sum = 0.0;
  slope = vec3(0.0);
  for (uint i = 0u; i < body.ball_count; ++i) {
    const LatticeBall b = LatticeBallsBeforeRef(pc.balls_before).b[body.first_ball + i].ball;
    const vec3 d = p - b.centre;
    const float u = left_of(b, d);
    sum += b.strength * (u * u * u);
    slope -= (6.0 * b.strength * b.inverse_square_radius * u * u) * d;
  }
  return sum - body.before_threshold;
}
float field_now(vec3 p) {
  float sum = 0.0;
  for (uint i = 0u; i < body.ball_count; ++i) {
    const LatticeBall b = LatticeBallsRef(pc.balls).b[body.first_ball + i];
    const float u = left_of(b, p - b.centre);
    sum += b.strength * (u * u * u);
  }
  return sum - body.threshold;
}

// Where the point was: moved and scaled with the balls, by their kernels there, then along the slope to where the field
// had the value that it has here (Newton). That it lay on the surface is certain; along it a surface has no points of
// its own, and the balls' mean is taken.
vec3 place_before(vec3 p) {
  vec3 moved = vec3(0.0);
  float weights = 0.0;
  for (uint i = 0u; i < body.ball_count; ++i) {
    const LatticeBall b = LatticeBallsRef(pc.balls).b[body.first_ball + i];
    const LatticeBallBefore before = LatticeBallsBeforeRef(pc.balls_before).b[body.first_ball + i];
    const vec3 d = p - b.centre;
    const float u = left_of(b, d), weight = abs(b.strength) * (u * u * u);
    moved += weight * (b.centre - before.ball.centre + d * before.shrunk);
    weights += weight;
  }
  vec3 q = weights > 0.0 ? p - moved / weights : p;
  const float value = field_now(p);
  for (int i = 0; i < 4; ++i) {
    vec3 slope;
    const float off = field_before(q, slope) - value, square = dot(slope, slope);
    if (!(square > 1e-30)) break;
    const vec3 step = slope * (off / square);
    // No step is longer than a cell: beyond it the slope says nothing.
    q -= step * min(1.0, inversesqrt(max(dot(step, step), 1e-30)));
  }
  return q;
}

// A word of a triangle's place, until its vertices are there: which it is.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TriangleCodesRef { uint w[]; };
uint first_word(uint vertex) {
  const uint chunk = vertex / (3u * chunk_triangles), in_chunk = vertex - chunk * 3u * chunk_triangles;
  return body.positions + chunk * body.chunk_words + 3u * in_chunk;
}

void store3(uint64_t buffer_address, uint word, vec3 v) {
  MetaballVerticesRef out_words = MetaballVerticesRef(buffer_address);
  out_words.f[word] = v.x;
  out_words.f[word + 1u] = v.y;
  out_words.f[word + 2u] = v.z;
}

// How far the surface may lie above a triangle: of a ball above the middle of an equilateral one, a sixth of what the
// normals turn by along a side, times that side. More than what roundings may leave of the point below its triangle.
float lift_of(vec3 p0, vec3 p1, vec3 p2, vec3 n0, vec3 n1, vec3 n2) {
  const vec3 a = p1 - p0, b = p2 - p1, c = p0 - p2;
  const float turned = max(dot(a, n1 - n0), max(dot(b, n2 - n1), dot(c, n0 - n2)));
  const float side = sqrt(max(dot(a, a), max(dot(b, b), dot(c, c))));
  return max(turned * (1.0 / 6.0), side * (1.0 / 256.0));
}

// n: the field's; lift: as lib/rounded.glsl has it.
void store_vertex(uint vertex, vec3 p, vec3 n, float lift) {
  const uint word = first_word(vertex);
  precise vec3 p_m = p * body.cell_m;
  store3(pc.deformed, word, p_m);
  if (HAS_BEFORE != 0) store3(pc.deformed_before, word, place_before(p) * body.cell_m + body.before_shift);
  if (body.normals == absent) return;
  const uint rounded = word + 2u * body.normals + vertex % (3u * chunk_triangles);  // four words each, not three
  store3(pc.deformed, rounded, n);
  MetaballVerticesRef(pc.deformed).f[rounded + 3u] = lift;
  if (body.noise_amplitude > 0.0)
    n = turned_normal(n, p * body.noise_frequency + body.noise_origin, body.noise_amplitude);
  store3(pc.deformed, word + body.normals, n);
}

void main() {
  const uint t = gl_LocalInvocationIndex, b = gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x;
  if (b >= pc.block_count) return;  // the whole workgroup
  block = MetaballBlocksRef(pc.blocks).b[b];
  body = MetaballBodiesRef(pc.bodies).b[block.body];
  fill_field(body, block, t, 64u);
  barrier();
  uint count = 0u;
  for (int x = 0; x < block_cells; ++x) count += triangles_of_cell(ivec3(x, t & 7u, t >> 3));
  count_of_row[t] = count;
  barrier();
  // The host knows a bound of the triangles: none lies beyond the room.
  const uint room = body.chunk_count * chunk_triangles, first = MetaballSumsRef(pc.sums).n[pc.block_count + b];
  uint triangle = first, end = first;
  for (uint i = 0u; i < 64u; ++i) {
    if (i < t) triangle += count_of_row[i];
    end += count_of_row[i];
  }
  end = min(end, room);
  for (int x = 0; x < block_cells && count > 0u; ++x)
    for (uint tetrahedron = 0u; tetrahedron < 6u; ++tetrahedron) {
      const uint inside = inside_of(ivec3(x, t & 7u, t >> 3), tetrahedron), cell = uint(x) + 8u * t;
      for (uint k = 0u; k < triangles_of(inside); ++k, ++triangle)
        if (triangle < room)
          TriangleCodesRef(pc.deformed).w[first_word(3u * triangle)] =
              cell | tetrahedron << 9 | k << 12 | inside << 13;
    }
  memoryBarrierBuffer();
  barrier();
  for (triangle = first + t; triangle < end; triangle += 64u) {
    const uint code = TriangleCodesRef(pc.deformed).w[first_word(3u * triangle)];
    const ivec3 cell = ivec3(code & 7u, code >> 3 & 7u, code >> 6 & 7u);
    const uint tetrahedron = code >> 9 & 7u, edges = cut_edges[code >> 13] >> (12u * (code >> 12 & 1u));
    vec3 p[3];
    for (uint i = 0u; i < 3u; ++i) p[i] = vertex_of(body, block, cell, tetrahedron, edges >> (4u * i) & 15u);
    const vec3 across = cross(p[1] - p[0], p[2] - p[0]);
    const float area = length(across);
    const vec3 face_normal = area > 0.0 ? across / area : vec3(0.0, 1.0, 0.0);
    const vec3 n0 = outwards(p[0], face_normal), n1 = outwards(p[1], face_normal), n2 = outwards(p[2], face_normal);
    const float lift = body.cell_m * lift_of(p[0], p[1], p[2], n0, n1, n2);
    for (uint i = 0u; i < 3u; ++i) store_vertex(3u * triangle + i, p[i], i == 0u ? n0 : i == 1u ? n1 : n2, lift);
  }
}
