#pragma once
#include <optional>
#include <vector>

#include "passes/shared/pass.h"

namespace candela {

// Copies finished images into host memory, tightly packed: the sinks of the frame.
struct Readback {
  static constexpr std::string_view name = "readback";
  struct In {
    struct Source {
      std::string layer;
      ImageHandle image;
      uint64_t bytes = 0;
    };
    std::vector<Source> sources;
    std::optional<PixelRect> part = {};  // of the picture; absent: all
  };
  struct Out {
    std::vector<BufferHandle> buffers;  // parallel to the sources
  };
  Need needed(const SceneFacts&, const FrameRequest&) const { return {}; }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
