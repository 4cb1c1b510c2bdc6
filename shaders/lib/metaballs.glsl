#pragma once
// The field of metaballs, and the tetrahedra of its lattice's cells. Sums, differences and products of the field and of
// vertices are those of src/scene/metaballs.cpp in the same order, so that both have the same polygons bit for bit.
#include "shared/metaballs.h"

const int block_cells = 8, block_nodes = block_cells + 1, block_node_count = block_nodes * block_nodes * block_nodes;
const float least_inside = 1e-30;       // F that is inside; 0 is not, nor what a device may flush to it
const int halvings = 4;                 // of an edge, before its vertex is interpolated
const float least_along = 1.0 / 4096.0; // of an edge, before and behind a vertex
const uint chunk_triangles = 4096u;

shared float field_of_block[block_node_count];

int place_of(ivec3 node) { return node.x + block_nodes * (node.y + block_nodes * node.z); }
ivec3 node_at(int place) {
  return ivec3(place % block_nodes, place / block_nodes % block_nodes, place / (block_nodes * block_nodes));
}

float field_at(MetaballBody body, MetaballBlock block, vec3 p) {
  precise float sum = 0.0;
  for (uint i = 0u; i < block.count; ++i) {
    const LatticeBall b = LatticeBallsRef(pc.balls).b[body.first_ball + WordsRef(pc.lists).w[block.first + i]];
    precise float x = p.x - b.centre.x;
    precise float y = p.y - b.centre.y;
    precise float z = p.z - b.centre.z;
    precise float square = x * x + y * y + z * z;
    precise float u = 1.0 - square * b.inverse_square_radius;
    if (u > 0.0) {
      precise float cube = u * u * u;
      precise float more = sum + b.strength * cube;
      sum = more;
    }
  }
  precise float field = sum - body.threshold;
  return field;
}

// Of all nodes of the workgroup's block, by all its threads.
void fill_field(MetaballBody body, MetaballBlock block, uint thread, uint threads) {
  const ivec3 first = ivec3(block.first_x, block.first_y, block.first_z);
  for (int i = int(thread); i < block_node_count; i += int(threads))
    field_of_block[i] = field_at(body, block, vec3(first + node_at(i)));
}

// Freudenthal's six about a cell's diagonal: corners in bits 0 to 2 for x, y and z, the first in the lowest digit.
const uint tetrahedra[6] = uint[](0x7310u, 0x7620u, 0x7540u, 0x7150u, 0x7230u, 0x7460u);
// By which corners are inside: how many triangles, in two bits each, and their corners' edges, corners of the
// tetrahedron a + 4 b, the first in the lowest digit; seen from outside they are counter-clockwise.
const uint cut_triangles = 0x16696994u;
const uint cut_edges[16] = uint[](0x0u, 0xc84u, 0x9d1u, 0x9d8dc8u, 0x62eu, 0xe6c64cu,
    0x2e1ed1u, 0x73bu, 0x37bu, 0x7b4b84u, 0xb39319u,
    0x26eu, 0x372762u, 0xd91u, 0x8c4u, 0x0u);

uint corner_of(uint tetrahedron, uint i) { return tetrahedra[tetrahedron] >> (4u * i) & 7u; }
ivec3 corner_offset(uint corner) { return ivec3(corner & 1u, corner >> 1 & 1u, corner >> 2); }
float field_of_corner(ivec3 cell, uint corner) { return field_of_block[place_of(cell + corner_offset(corner))]; }
uint inside_of(ivec3 cell, uint tetrahedron) {
  uint inside = 0u;
  for (uint i = 0u; i < 4u; ++i)
    if (field_of_corner(cell, corner_of(tetrahedron, i)) > least_inside) inside |= 1u << i;
  return inside;
}
uint triangles_of(uint inside) { return cut_triangles >> (2u * inside) & 3u; }
uint triangles_of_cell(ivec3 cell) {
  uint count = 0u;
  for (uint t = 0u; t < 6u; ++t) count += triangles_of(inside_of(cell, t));
  return count;
}

// By Newton's steps from a guess of the exponent: quotients are not rounded alike everywhere.
float exact_reciprocal(float d) {
  precise float x = uintBitsToFloat(0x7ef311c7u - floatBitsToUint(d));
  for (int i = 0; i < 4; ++i) {
    precise float left = 2.0 - d * x;
    precise float next = x * left;
    x = next;
  }
  return x;
}

// Where F is 0 between two values, were it straight.
float crossing(float low, float high) {
  precise float down = low - high;
  precise float s = low * exact_reciprocal(abs(down));
  if (down < 0.0) s = -s;
  return min(max(s, 0.0), 1.0);
}

// In cells from the lattice's origin. A few halvings find kernels that end within the
// edge, and leave little that is not straight. From the lower corner on: all cells whose edge it is do so.
vec3 vertex_of(MetaballBody body, MetaballBlock block, ivec3 cell, uint tetrahedron, uint edge) {
  const uint i = corner_of(tetrahedron, edge & 3u), j = corner_of(tetrahedron, edge >> 2);
  const uint a = min(i, j), b = max(i, j);
  const vec3 from = vec3(ivec3(block.first_x, block.first_y, block.first_z) + cell + corner_offset(a));
  const vec3 way = vec3(corner_offset(b) - corner_offset(a));
  float low = field_of_corner(cell, a), high = field_of_corner(cell, b);
  const bool is_low_inside = low > least_inside;
  float begin = 0.0, width = 1.0;
  for (int i = 0; i < halvings; ++i) {
    width *= 0.5;
    precise vec3 middle = from + (begin + width) * way;
    const float there = field_at(body, block, middle);
    if ((there > least_inside) == is_low_inside) {
      begin += width;
      low = there;
    } else {
      high = there;
    }
  }
  precise float t = begin + width * crossing(low, high);
  t = min(max(t, least_along), 1.0 - least_along);
  precise vec3 p = from + t * way;
  return p;
}
