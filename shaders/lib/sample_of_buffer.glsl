#pragma once
// A sample of a buffer that has as many for each pixel as the image that is drawn into. Needs SamplesPush as pc.
layout(constant_id = 0) const int SAMPLES = 1;

uint place_of_sample() {
  const uvec2 p = uvec2(gl_FragCoord.xy);
  return (p.y * pc.width_px + p.x) * uint(SAMPLES) + pc.sample_number;
}
void cover_sample() { gl_SampleMask[0] = int(1u << pc.sample_number); }
