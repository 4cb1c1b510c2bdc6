#pragma once
// To either side of a pixel, y down: a share of the layer's motion, whose y points up, no longer than `most`.
vec2 motion_px(vec2 layer, float share, float most) {
  const vec2 motion = layer * vec2(share, -share);
  const float length_px = length(motion);
  return length_px > most ? motion * (most / length_px) : motion;
}
