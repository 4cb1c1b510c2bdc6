#ifndef CANDELA_SHARED_DRAW_H
#define CANDELA_SHARED_DRAW_H
#include "shared/types.h"
SHARED_BEGIN
struct DrawPush {  // every pass that draws the scene
  uint64_t deformed, lights;
  uint64_t light_cells, light_entries, light_tiles;  // shared/lights.h; 0 where the grid has none
  uint64_t suns, lamps;                              // SunShadow, LampShadow; only with shadow maps
  uint64_t trees, rays;                              // TraceScene, RaySettings; only where light is traced
  // Of a supersampled frame: where this sample lies off the pixel's middle, and its side in pixels, by which the
  // footprints of textures shrink.
  vec2 subsample_ndc;
  float subsample_footprint;
  uint sun_maps, lamp_maps;  // the maps' places among the pass's images
  uint fog_light;            // the same of the grid of fog's light
  uint occlusion;            // of ambient occlusion's texels; only where shading reads them
  uint subsample;            // number of this sample of a supersampled frame
  uint64_t table;            // what this pass alone reads: ids of mattes, a Motion, ...
  uint64_t deformed_before;  // deformed vertices of the time before, where there is a Motion
  uint own;                  // what this pass alone reads
  uint shadow_colors;        // places of images, 8 bits each: coloured and deep shadows of the suns, the same of lamps
};
struct DepthViewPush {  // depth as a view sees it
  uint64_t deformed;
  mat4 clip_from_relative;
  vec2 subsample_ndc;  // as in DrawPush, whose functions it serves; 0
  uint flattens;       // what lies before the near plane onto it: parallel views
};
struct DepthLampPush {        // depth as a lamp's view sees it that is drawn apart, whose origin is the light
  uint64_t deformed, places;  // Place (shared/scene.h)
  mat4 clip_from_relative;    // its directions alone
  vec2 subsample_ndc;         // as in DepthViewPush
  vec3 origin, origin_rest;   // of View (shared/cull.h)
  uint layer;
};
// What see-through surfaces leave of the light of a view (passes/transparency/colored_shadows.h); some members as in
// DrawPush, whose functions it serves.
struct ColoredShadowPush {
  uint64_t deformed;
  mat4 clip_from_relative;
  vec4 light;  // direction to it, and 0; or where it is, relative, and how far it reaches
  vec2 subsample_ndc;
  float subsample_footprint;
  uint layer;    // of the maps; bit 31: what lies before the near plane is flattened onto it
  uint images;   // places of the maps and of the back faces' positions and normals, 8 bits each
  uint size_px;  // of the image that is drawn to
  vec4 place;    // of the view in its layer: normalised device coordinates times xy plus zw, 0 to 1
};
// Of what lies behind everything: the members that DrawPush has too are used where it is seen through fog.
struct SkyPush {
  uint64_t lights, light_cells, light_entries, light_tiles, suns, lamps;
  vec2 subsample_ndc;  // by which this sample lies off the pixel's middle (passes/post/supersample.h)
  uint sun_maps, lamp_maps, fog_light;
  uint shadow_colors;  // as in DrawPush
  float subsample_footprint;
};
struct SupersamplePush {
  uint source, before, target;
  float fraction;
  uvec2 size_px;
};
struct SubframesPush {
  uint64_t before, sum;
  uint source;
  float fraction;
  uvec2 first_px;  // of the source
  uvec2 size_px;
  uint adds;  // 0: of the first frame
};
struct SubframesMeanPush {
  uint64_t sum;
  uint target;
  uvec2 size_px;
};
struct BackgroundPush {
  uint64_t lights, light_cells, light_entries, light_tiles, suns, lamps;  // as in SkyPush
  vec4 color;                                                             // premultiplied, pre-exposed
  vec2 subsample_ndc;
  uint sun_maps, lamp_maps, fog_light, shadow_colors;
};
struct TonemapPush {
  uint64_t automatic;   // an ExposureResult, with automatic exposure
  uint source, target;  // bindless
  uvec2 size_px;
  float exposure;      // what is left to apply after pre-exposure
  uint dither_levels;  // 255, 65535, or 0 for none
  uint seed;
  float agx_min_ev, agx_max_ev;  // stops of exposed radiance
};
struct ResolvePush {
  uint source, target;
  uvec2 size_px;
};
SHARED_END
#endif
