#pragma once
// The kinds of graph images beyond lib/bindless.glsl, for the shaders that use them: a step declares the view, and
// commands.sampled and commands.storage give its place in whichever of these arrays has that kind. And the samplers.
#include "lib/bindless.glsl"
#include "shared/samplers.h"

layout(set = 0, binding = 2) uniform sampler graph_samplers[SAMPLER_COUNT];  // sampler2D(image, graph_samplers[...])
layout(set = 0, binding = 2) uniform samplerShadow graph_shadow_samplers[SAMPLER_COUNT];  // SAMPLER_SHADOW_...

layout(set = 1, binding = 0) uniform texture2DArray pass_array_images[16];
layout(set = 1, binding = 0) uniform textureCube pass_cube_images[16];
layout(set = 1, binding = 0) uniform texture3D pass_volume_images[16];
#ifdef USES_CUBE_ARRAYS  // a feature of the device: imageCubeArray
layout(set = 1, binding = 0) uniform textureCubeArray pass_cube_array_images[16];
#endif

// Read and written, by imageLoad and imageStore; the format is the image's own.
layout(set = 1, binding = 1) uniform image2D storage_read_images[8];
layout(set = 1, binding = 1) uniform uimage2D storage_uint_images[8];
layout(set = 1, binding = 1) uniform image2DArray storage_array_images[8];  // arrays, and cubes: a face is a layer
layout(set = 1, binding = 1) uniform image3D storage_volume_images[8];
