#pragma once
// A sample of a buffer that has as many for each pixel as the image that is drawn into. Needs SamplesPush as pc.
layout(constant_id = 0) const int SAMPLES = 1;

// Of this thread's sample. Always in the buffer: llvmpipe runs lanes beside the picture too, and loads for them.
uint place_of_sample() {
  const uvec2 p = min(uvec2(gl_FragCoord.xy), pc.size_px - 1u);
  return (p.y * pc.size_px.x + p.x) * uint(SAMPLES) + uint(gl_SampleID);
}
