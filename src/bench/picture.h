#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "bench/row.h"
#include "image/image.h"
#include "session/session.h"

namespace candela {

// The linear colour of a frame, as the GPU left it: RGBA, float or half, rows from the top.
struct Beauty {
  int width_px = 0, height_px = 0;
  size_t pixel_bytes = 0;  // 16 or 8
  std::vector<std::byte> bytes;
};
// Empty when the frame has no linear output.
std::optional<Beauty> beauty_of(const FrameResult& frame);

struct PictureDifference {
  uint64_t differing = 0;     // pixels with any bit that is not the same
  double max_difference = 0;  // over all channels, pre-exposed; infinity when only one of two values is finite
  int first_x = -1, first_y = -1;
};
// The two must have the same size and format.
PictureDifference difference(const Beauty& reference, const Beauty& test);

// Layers of counts that a technique with light lists can show.
inline constexpr const char* listed_layer = "heatmap_lights";
inline constexpr const char* wasted_layer = "heatmap_waste";
inline constexpr const char* missed_layer = "heatmap_missed";
// Those that this build knows.
std::vector<std::string> light_list_layers();
// From the frame's heatmap layers; absent when it has none.
std::optional<LightLists> light_lists(const FrameResult& frame);

// Values of a layer with one float a pixel; empty when the frame has no such layer.
std::vector<float> layer_values(const FrameResult& frame, const std::string& layer);

// A PNG of at most `most_px` pixels a side, each the mean of those it stands for.
std::vector<std::byte> thumbnail_png(const DisplayImage& image, int most_px);
// Counts as colours: 0 is dark violet, from the 95th percentile on yellow.
std::vector<std::byte> heatmap_png(const std::vector<float>& values, int width_px, int height_px, int most_px);

}  // namespace candela
