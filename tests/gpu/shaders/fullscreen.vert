#version 460
// A triangle that covers the whole image at depth 0.5, from the vertex index alone.
void main() { gl_Position = vec4(vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2) * 2.0 - 1.0, 0.5, 1.0); }
