#version 460
// The weighted mean of what covers a sample, as much as all together cover it. `moments` takes it too: its weights are
// the transmittances before the surfaces.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { SumsPush pc; };
#include "lib/absorbance.glsl"
#include "lib/sample_over.glsl"

layout(location = 0) out vec4 out_radiance;

void main() {
  const vec4 sum = fetch_sample(pc.sum);
  const float covered = covered_by(fetch_sample(pc.covered).r);
  cover_sample();
  // Weights below the least normal float hold nothing but rounding.
  out_radiance = sum.a >= 1.2e-38 ? vec4(sum.rgb / sum.a * covered, covered) : vec4(0.0, 0.0, 0.0, covered);
}
