#pragma once
// What a pixel covers of the plane that is seen in its middle. Needs lib/scene.glsl, IS_SUBSAMPLE and the push
// constants of DrawPush.

// Metres from one side of the pixel to the other, in the plane: to the right and down. Where the plane is seen so
// aslant that they would be more than eight times as long as across the view, they are that.
struct PixelSpan {
  vec3 across, down;
};
const float MOST_STRETCH = 8.0;
vec3 along_plane(vec3 step, vec3 ahead, vec3 normal) {
  const float towards = dot(normal, ahead), most = MOST_STRETCH * length(step);
  precise vec3 along = step * towards - ahead * dot(normal, step);  // times the cosine
  const float long_ = length(along);
  return along * (sign(towards) / max(abs(towards), max(long_ / most, 1e-30)));
}
// position: relative, on the plane.
PixelSpan pixel_span(vec3 position, vec3 normal) {
  const bool perspective = frame.perspective != 0u;
  const float ahead_m = perspective ? -dot(position, frame.camera_back) : 1.0;
  const float side = IS_SUBSAMPLE != 0 ? pc.subsample_footprint : 1.0;
  const vec2 pixel = 2.0 * frame.tan_half / vec2(frame.size_px) * (ahead_m * side);
  const vec3 ahead = perspective ? position : -frame.camera_back;
  return PixelSpan(along_plane(pixel.x * frame.camera_right, ahead, normal),
      along_plane(-pixel.y * frame.camera_up, ahead, normal));
}

// A linear map of the unit disc, symmetric: to an ellipse with the variance of a disc of this radius and that of the
// parallelogram with sides a and b about its middle together, but no longer than `most`.
struct Ellipse {
  float xx, xy, yy;
};
Ellipse ellipse_of(float radius, vec2 a, vec2 b, float most) {
  // Variances, times 4: of a disc its radius squared, of a side a third of its square.
  precise float xx = radius * radius + (a.x * a.x + b.x * b.x) * (1.0 / 3.0);
  precise float yy = radius * radius + (a.y * a.y + b.y * b.y) * (1.0 / 3.0);
  precise float xy = (a.x * a.y + b.x * b.y) * (1.0 / 3.0);
  precise float area = sqrt(max(xx * yy - xy * xy, 0.0));
  precise float scale = 1.0 / sqrt(xx + yy + 2.0 * area);
  precise float fits = min(most / sqrt(xx + yy), 1.0);  // the longer axis is at most that
  precise float each = scale * fits;
  return Ellipse((xx + area) * each, xy * each, (yy + area) * each);
}
vec2 on_ellipse(Ellipse e, vec2 p) {
  precise vec2 at = vec2(e.xx * p.x + e.xy * p.y, e.xy * p.x + e.yy * p.y);
  return at;
}
