#pragma once
#include "passes/shared/pass.h"

namespace candela {

// One subresource of an image, as it stands where the pass is, for the host: `render --dump`. Of a 3D image all slices
// of a mip; of a multisampled image every sample, as 32-bit words, for such images cannot be copied.
struct Dump {
  static constexpr std::string_view name = "dump";
  struct In {
    ImageHandle image;
    uint32_t mip = 0, layer = 0;
  };
  struct Out {
    BufferHandle bytes;
    uint32_t width_px = 0, height_px = 0, samples = 1;
    PipelineHandle pipeline;  // of multisampled images
  };
  Need needed(const SceneFacts&, const FrameRequest&) const { return {}; }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
