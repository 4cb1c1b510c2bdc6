#version 460
#extension GL_ARB_shader_viewport_layer_array : require
// A triangle that covers the whole image, in the layer that the instance names.
layout(location = 0) flat out uint layer;
void main() {
  layer = gl_InstanceIndex;
  gl_Layer = gl_InstanceIndex;
  gl_Position = vec4(vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2) * 2.0 - 1.0, 0.1 * (gl_InstanceIndex + 1), 1);
}
