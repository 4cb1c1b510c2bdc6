#pragma once
// Needs shared/transparency.h and its FragmentsPush as `pc`.
uint plus(uint a, uint b) { return min(a + b, fragments_held); }

// Of four quads that follow each other; 0 beyond the picture.
uvec4 fragments_of_quads(uint first) {
  uvec4 counts = uvec4(0u);
  for (uint q = 0u; q < 4u; ++q) {
    if (first + q >= quad_count(pc.size_px)) break;
    for (uint i = 0u; i < 4u; ++i)
      counts[q] = plus(counts[q], CellWordsRef(pc.cells).w[first_count + 4u * (first + q) + i]);
  }
  return counts;
}
