#ifndef CANDELA_SHARED_REFLECTIONS_H
#define CANDELA_SHARED_REFLECTIONS_H
#include "shared/types.h"

SHARED_BEGIN
// What the pass knows of the surface at a pixel's middle (lib/reflections.glsl says how it is packed), by the images'
// places among those of the step.
struct ReflectedSurfaces {
  uint z, surface, reflectance, sky;
};
struct ReflectionsColorPush {
  uint picture, z, fog, target;
  uvec2 size_px;
};
struct ReflectionsDownPush {
  uint source, target;
  uvec2 target_px;
};
struct ReflectionsTracePush {
  ReflectedSurfaces at;
  uint colors, light;
  uvec2 texels;        // size of the picture in texels
  vec2 subsample_ndc;  // by which this sample lies off the pixel's middle
  vec2 colors_px;      // of the pyramid's first level
  float last_level;
  int samples, steps;  // steps: 0 every pixel
  float thickness;     // parts of the distance
  float fade;          // parts of the picture's size
  float roughest;
  uint first, of;  // of a supersampled frame: which samples are its own
  uvec2 pattern;   // by which the pattern of 4 by 4 texels is moved
};
struct ReflectionsSmoothPush {
  ReflectedSurfaces at;
  uint light, smooth_light;
  uint rays;  // a texel, of all pictures of a supersampled frame
  uvec2 texels;
  vec2 subsample_ndc;
};
struct ReflectionsOverPush {
  ReflectedSurfaces at;
  uint light, depth;  // of the frame, at all its samples
  uvec2 texels;
  vec2 subsample_ndc;
};
// The same onto a picture of one sample, in compute.
struct ReflectionsOverWholePush {
  ReflectedSurfaces at;
  uint light, depth;
  uvec2 texels;
  vec2 subsample_ndc;
  uint64_t keys;  // in the place of depth: whose depths tell the same
  uint color;
};
SHARED_END

// What reflections_surface.comp finds in DrawPush::own: places of images among those that it writes.
#define REFLECTIONS_SURFACE_IMAGES(z, surface, reflectance, sky, fog) \
  ((z) | (surface) << 4 | (reflectance) << 8 | (sky) << 12 | (fog) << 16)
// What reflections_rays.comp finds in DrawPush::table: places of images among those of the step, a byte each; samples
// of this picture, how many pictures a supersampled frame has, and by how much the pattern of 4 by 4 texels is moved.
#define REFLECTIONS_IMAGES(z, surface, reflectance, light) ((z) | (surface) << 8 | (reflectance) << 16 | (light) << 24)
#define REFLECTIONS_SAMPLES(samples, pictures, pattern) ((samples) << 32 | (pictures) << 44 | (pattern) << 60)

#endif
