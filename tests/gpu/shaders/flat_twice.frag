#version 460
layout(push_constant) uniform Push { vec4 color; } push;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {
  first = push.color;
  second = push.color;
}
