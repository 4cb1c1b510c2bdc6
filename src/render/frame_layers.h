#pragma once
#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "passes/post/pack.h"
#include "render/outputs.h"
#include "session/session.h"

namespace candela {

// What the depth layer holds where there is nothing: what Blender's and Nuke's readers take for that. Infinity breaks
// filters that blend depths.
inline constexpr float background_depth_m = 1e10f;

// Of one output of a frame: how it lies in its read-back, those bytes, and the channels of a file that it fills.
PackLayout layout_of(const FrameResult& frame, const FrameOutput& output);
std::span<const std::byte> readback_bytes(const FrameResult& frame, const FrameOutput& output);
std::vector<std::string> channel_names(const FrameOutput& output);

// Adds the channels of an output that was read back as texels. Pre-exposure is removed.
void add_id_layer(FloatImage& image, const FrameOutput& output, std::span<const std::byte> bytes);
void add_depth_layer(FloatImage& image, const FrameResult& frame, const FrameOutput& output, NonFinite& nonfinite);
void add_color_layer(FloatImage& image, const FrameResult& frame, const FrameOutput& output, bool as_float,
                     NonFinite& nonfinite);

// A layer that is no light, alone, however it was read back.
FloatImage layer_image(const FrameResult& frame, const FrameOutput& output);

}  // namespace candela
