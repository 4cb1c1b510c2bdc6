#version 460
layout(location = 0) flat in uint layer;
layout(location = 0) out vec4 color;
void main() { color = vec4(layer + 1, gl_FragCoord.xy, 1); }
