#pragma once
#include <optional>
#include <vector>

#include "passes/shared/frame_values.h"
#include "passes/shared/pass.h"
#include "shared/pack.h"

namespace candela {

// How a picture lies in host memory. texels: as the image has them. Planes: one for each channel that a file stores.
// rgb: of a display picture, without its alpha.
enum class Packing { texels, half_planes, float_planes, rgb };

// Where rows and planes lie; of texels and rgb there is one plane.
struct PackLayout {
  uint64_t row_bytes = 0, plane_bytes = 0, bytes = 0;
};
PackLayout pack_layout(Packing packing, VkFormat format, uint32_t components, uint32_t width_px, uint32_t height_px);

// Turns finished pictures into what files hold, in host memory, and counts on the way what a file must not hold: bytes
// are those that the host would make of the texels. Halves are the nearest, to even on a tie; beyond half's range its
// largest. Float planes are not scaled.
struct Pack {
  static constexpr std::string_view name = "pack";
  struct In {
    struct Source {
      std::string layer;
      ImageHandle image;
      VkFormat format = VK_FORMAT_UNDEFINED;
      std::optional<Packing> packing;  // none: it is only looked at
      uint32_t components = 4;         // from red on
      Live<float> scale = 1;           // of colours in half planes; not of alpha
      bool look = false;               // for pixels that are not finite
      bool cover = false;              // whether any alpha is not 0
      bool depth = false;              // infinity is the background
    };
    std::vector<Source> sources;
    uint32_t width_px = 0, height_px = 0;  // of what is packed
    glm::uvec2 corner_px{0};               // where that begins in the picture
  };
  struct Out {
    std::vector<BufferHandle> buffers;  // parallel to the sources; empty of those only looked at
    BufferHandle device_counts;
    BufferHandle counts;  // shared::PackCounts for each source
    std::vector<PipelineHandle> pipelines;
  };
  Need needed(const SceneFacts&, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
