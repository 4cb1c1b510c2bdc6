#version 460
layout(location = 0) in flat float in_id;
layout(location = 0) out float out_id;

void main() { out_id = in_id; }
