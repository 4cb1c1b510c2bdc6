#pragma once
#include <string>

#include "gpu/command_list.h"
#include "graph/builder.h"
#include "passes/shared/knob_tables.h"

namespace candela {

// The frame's depth for compute shaders that look samples up (shaders/lib/frame_depth.glsl): an image, or the keys of a
// visibility buffer (passes/geometry/rasterize.h), which have one for each sample too. Not a pass.
struct SampledDepth {
  using MadeBy = SampleCountKnobs;
  ImageHandle image;
  BufferHandle keys;
  explicit operator bool() const { return image || keys; }
};
// Of a shader with the push constants depth and keys: its name with what is compiled for this depth.
inline std::string with_depth(std::string shader, const SampledDepth& depth) {
  return depth.keys ? std::move(shader) + "#KEYS=1" : shader;
}
inline void read_depth(GraphBuilder& builder, const SampledDepth& depth) {
  if (depth.keys)
    builder.read(depth.keys, Access::compute_read, "depth");
  else
    builder.read(depth.image, Access::sampled_compute, "depth");
}
template <class Push>
void push_depth(CommandList& commands, const SampledDepth& depth, Push& push) {
  if (depth.keys)
    push.keys = commands.address(depth.keys);
  else if (depth.image)
    push.depth = commands.sampled(depth.image);
}

}  // namespace candela
