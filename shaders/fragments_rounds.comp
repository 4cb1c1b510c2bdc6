#version 460
// What each round draws and blends: all, or nothing where the rounds before hold every fragment. Nothing at all where
// the fragments are more than the rounds hold; the report says it.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { FragmentsPush pc; };
layout(local_size_x = 64) in;

void main() {
  CellWordsRef cells = CellWordsRef(pc.cells);
  const uint t = gl_LocalInvocationIndex, total = cells.w[1], most = cells.w[2];
  const bool fit = most <= pc.room && total < fragments_held && (max(total, 1u) - 1u) / pc.room < pc.most_rounds;
  const uint used = fit && total > 0u ? (total - 1u) / pc.room + 1u : 0u;
  CellWordsRef rounds = CellWordsRef(pc.rounds);
  const uvec2 quads = (pc.size_px + 1u) / 2u;
  for (uint r = t; r < pc.most_rounds; r += 64u) {
    rounds.w[3u * r] = r < used ? (4u * quads.x + 63u) / 64u : 0u;
    rounds.w[3u * r + 1u] = r < used ? quads.y : 0u;
    rounds.w[3u * r + 2u] = 1u;
  }
  CellWordsRef counts = CellWordsRef(pc.counts);
  for (uint i = t; i < pc.most_rounds * pc.runs; i += 64u)
    rounds.w[3u * pc.most_rounds + i] = i / pc.runs < used ? counts.w[i % pc.runs] : 0u;
  if (t > 0u) return;
  cells.w[0] = pc.room;
  CellWordsRef report = CellWordsRef(pc.report);
  report.w[0] = total;
  report.w[1] = most;
}
