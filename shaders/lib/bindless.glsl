// The one descriptor set. Textures are sampled as sampler2D(textures[t], samplers[s]); images of the graph come through the
// same array. nonuniformEXT where an index can differ inside a draw.
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_shader_image_load_formatted : require

layout(set = 0, binding = 0) uniform texture2D textures[];
layout(set = 0, binding = 0) uniform utexture2D uint_textures[];
layout(set = 0, binding = 0) uniform texture2DMS multisampled_textures[];
layout(set = 0, binding = 1) uniform sampler samplers[];
layout(set = 0, binding = 2) uniform writeonly image2D storage_images[];
