#pragma once
// Rays of the camera. Needs lib/scene.glsl or lib/frame.glsl, IS_SUBSAMPLE and pc.subsample_ndc.

// Through a place of the picture, in pixels from its upper left corner; with what one pixel to the right and one down
// change of it. Its length along the view axis is 1.
struct ViewRay {
  vec3 origin, direction, across, down;
};
ViewRay view_ray(vec2 place) {
  vec2 ndc = 2.0 * place / vec2(frame.size_px) - 1.0;
  if (IS_SUBSAMPLE != 0) ndc += pc.subsample_ndc;
  const vec3 right = frame.tan_half.x * frame.camera_right, up = frame.tan_half.y * frame.camera_up;
  const vec3 off = ndc.x * right - ndc.y * up;
  ViewRay r;
  r.across = right * (2.0 / float(frame.size_px.x));
  r.down = -up * (2.0 / float(frame.size_px.y));
  r.origin = frame.perspective != 0u ? vec3(0.0) : off;
  r.direction = (frame.perspective != 0u ? off : vec3(0.0)) - frame.camera_back;
  return r;
}

#ifdef PIXEL_MIDDLE
// Unit, through the middle of the pixel. Interpolated positions would tell it less exactly: over a large triangle some
// devices keep 20 bits.
vec3 direction_to_viewer() {
  if (frame.perspective == 0u) return frame.camera_back;
  vec2 ndc = 2.0 * PIXEL_MIDDLE / vec2(frame.size_px) - 1.0;
  if (IS_SUBSAMPLE != 0) ndc += pc.subsample_ndc;
  return normalize(frame.camera_back - ndc.x * frame.tan_half.x * frame.camera_right +
      ndc.y * frame.tan_half.y * frame.camera_up);
}
#endif
