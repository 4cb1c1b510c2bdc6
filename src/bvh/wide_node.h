#pragma once
// Plain layouts that the builder writes and the vector kernels read. Nothing else may be included here: the kernels are
// compiled for other instruction sets than the rest (see simd.h).
#include <cstdint>

namespace candela {

constexpr uint32_t wide_children = 8, block_triangles = 4;

// Child references: an inner node's index; or leaf_bit, the number of blocks (or indices) less one, and the first one.
constexpr uint32_t leaf_bit = 0x80000000u, leaf_count_shift = 26, leaf_first_mask = (1u << leaf_count_shift) - 1;
constexpr uint32_t largest_leaf = 1u << (31 - leaf_count_shift);  // blocks or indices
constexpr uint32_t no_child = 0xffffffffu, no_triangle = 0xffffffffu;
constexpr uint32_t first_of_leaf(uint32_t child) { return child & leaf_first_mask; }
constexpr uint32_t count_of_leaf(uint32_t child) { return ((child & ~leaf_bit) >> leaf_count_shift) + 1; }
constexpr uint32_t leaf_child(uint32_t first, uint32_t count) {
  return leaf_bit | (count - 1) << leaf_count_shift | first;
}

// Boxes axis by axis: low x, high x, low y, high y, low z, high z. Absent children have low +inf, high -inf.
// Four lines of cache, found by a shift.
struct alignas(64) WideNode {
  float bounds[6][wide_children];
  uint32_t child[wide_children];
  uint32_t unused[wide_children];  // 0
};

// Corners by corner and axis; absent triangles (always the last ones) have id no_triangle.
struct alignas(16) TriangleBlock {
  float corner[3][3][block_triangles];
  uint32_t id[block_triangles];
};

}  // namespace candela
