#version 460
// The dimmed surfaces of a sample, brought to what all together cover.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { SumsPush pc; };
#include "lib/absorbance.glsl"
#include "lib/sample_over.glsl"

layout(location = 0) out vec4 out_radiance;

void main() {
  const vec4 sum = fetch_sample(pc.sum);
  const float covered = coverage_of(fetch_sample(pc.covered).r);
  cover_sample();
  out_radiance = sum.a >= 1.2e-38 ? vec4(sum.rgb / sum.a * covered, covered) : vec4(0.0, 0.0, 0.0, covered);
}
