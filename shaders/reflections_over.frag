#version 460
// Over the picture, added: what reflections of the scene put in place of the sky's.
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { ReflectionsOverPush pc; };
#include "lib/frame.glsl"
#include "lib/bindless.glsl"
#include "lib/reflections_over.glsl"

// Of beauty; or of two of its terms, each defined as its attachment's number among so many, which all get something:
// llvmpipe 25.0.7 draws nothing where the first attachment is masked.
#ifdef TERMS
layout(location = 0) out vec4 out_terms[TERMS];
#else
layout(location = 0) out vec4 out_radiance;
#endif

void main() {
  vec3 gained, taken;
  find_reflected(ivec2(gl_FragCoord.xy), gained, taken);
#ifdef TERMS
  for (int i = 0; i < TERMS; ++i) out_terms[i] = vec4(0.0);
#ifdef AMBIENT_SPECULAR
  out_terms[AMBIENT_SPECULAR] = vec4(-taken, 0.0);
#endif
#ifdef REFLECTIONS
  out_terms[REFLECTIONS] = vec4(gained, 0.0);
#endif
#else
  out_radiance = vec4(gained - taken, 0.0);
#endif
}
