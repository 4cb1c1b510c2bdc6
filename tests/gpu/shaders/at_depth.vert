#version 460
// A triangle that covers the whole image at a given depth.
layout(push_constant) uniform Push { vec4 color; float depth; } push;
void main() { gl_Position = vec4(vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2) * 2.0 - 1.0, push.depth, 1.0); }
