#pragma once
// What a blended surface stores of itself (passes/transparency/fragments.h). STORED: samples of a pixel. Needs
// lib/frame.glsl and lib/draw.frag.glsl; pc.table is the address of the cells, pc.deformed_before that of the
// fragments, pc.own the round.
#include "shared/transparency.h"
#if STORED > 1
// Which samples passed the depth test.
#extension GL_ARB_post_depth_coverage : require
layout(post_depth_coverage) in;
#else
layout(early_fragment_tests) in;
#endif

// A quad of pixels is of one round: all or none of it goes on, and derivatives are of neighbours that do too.
bool is_put_out() {
  CellWordsRef cells = CellWordsRef(pc.table);
  const uint quad = pixel_number(uvec2(gl_FragCoord.xy), frame.size_px) / 4u;
  return cells.w[first_offset(frame.size_px) + quad] / cells.w[0] == pc.own;
}

void put_out(vec4 premultiplied, vec3 relative_position) {
  const vec2 slope = vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z));
  if (gl_HelperInvocation) return;
  CellWordsRef cells = CellWordsRef(pc.table);
  const uint pixel = pixel_number(uvec2(gl_FragCoord.xy), frame.size_px), quad = pixel / 4u;
  uint place = cells.w[first_offset(frame.size_px) + quad] % cells.w[0];
  for (uint i = 4u * quad; i < pixel; ++i) place += cells.w[first_count + i];
  place += atomicAdd(cells.w[first_cursor(frame.size_px) + pixel], 1u);
  StoredFragment f;
  f.radiance = premultiplied;
  f.depth = gl_FragCoord.z;
  f.slope = slope;
  f.item = in_item;
  f.primitive = uint(gl_PrimitiveID);
#if STORED > 1
  f.covers = uint(gl_SampleMaskIn[0]);
#else
  f.covers = 1u;
#endif
  StoredRef(pc.deformed_before).f[place] = f;
}
