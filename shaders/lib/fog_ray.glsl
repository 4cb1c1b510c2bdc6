#pragma once
// Rays of the camera through fog, and the depths at which their light is kept. Needs lib/fog_medium.glsl.
struct FogRay {
  vec3 origin, direction;
  float along;  // metres of the ray for a metre of depth
};
// Through a place of the picture, y down.
FogRay fog_ray(vec2 ndc) {
  const vec3 across = ndc.x * frame.tan_half.x * frame.camera_right - ndc.y * frame.tan_half.y * frame.camera_up;
  if (frame.perspective == 0u) return FogRay(across, -frame.camera_back, 1.0);
  const vec3 towards = across - frame.camera_back;
  const float along = length(towards);
  return FogRay(vec3(0.0), towards / along, along);
}
// Of a node, from 0; the last is at the end of all.
float fog_node_depth(int k) {
  return k + 1 >= int(frame.fog.nodes.z) ? FOG_FAR : k < 0 ? 0.0
      : frame.fog.nearest_m * exp2(float(k) * frame.fog.log2_ratio);
}
