#pragma once
#include "bvh/wide_node.h"
#include "shared/trace.h"

namespace candela {

// A node as devices traverse it: boxes on a grid of 255 steps an axis that hold those of `node`, children in the places
// that shared/trace.h describes (assigned greedily, the largest gain first: Ylitie, Karras, Laine, "Efficient
// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017, section 4.2), and their numbers raised by those
// of the first node and the first leaf of the tree among all.
shared::TraceNode packed_node(const WideNode& node, uint32_t first_node, uint32_t first_leaf);

}  // namespace candela
