#version 460
// One for each light's volume, which blending counts.
layout(location = 0) in flat uint in_light;
layout(location = 0) out float out_count;

void main() { out_count = 1.0; }
