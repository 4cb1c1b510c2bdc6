#pragma once
// Set 0: the scene's textures and all samplers, one bindless array each: sampler2D(textures[t], samplers[s]),
// nonuniformEXT where an index can differ inside a draw. Set 1: the images of the graph that the running pass declared,
// and no others, so that the validation layer sees what a pass really touches.
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_shader_image_load_formatted : require

layout(set = 0, binding = 0) uniform texture2D textures[];
layout(set = 0, binding = 1) uniform sampler samplers[];

layout(set = 1, binding = 0) uniform texture2D pass_images[16];
layout(set = 1, binding = 0) uniform utexture2D pass_uint_images[16];
layout(set = 1, binding = 0) uniform texture2DMS pass_multisampled_images[16];
layout(set = 1, binding = 1) uniform writeonly image2D storage_images[8];
