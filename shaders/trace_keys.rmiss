#version 460
// Nothing is found: the payload says so already.
#extension GL_EXT_ray_tracing : require
void main() {}
