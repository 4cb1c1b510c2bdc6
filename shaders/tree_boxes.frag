#version 460
// Linear colours: leaves orange, inner nodes blue.
layout(location = 0) in flat uint in_is_leaf;
layout(location = 0) out vec4 out_color;
void main() { out_color = in_is_leaf != 0u ? vec4(1.0, 0.35, 0.02, 1.0) : vec4(0.05, 0.25, 1.0, 1.0); }
