#pragma once
#include "passes/shared/blended.h"

namespace candela {

// Blended surfaces, back to front by the depth of their bounds' centres, premultiplied "over", tested
// against the opaque depth and not written to it. Leaves wrong: surfaces that intersect or contain each other, and the
// triangles of one section among themselves, blend in the wrong order.
struct Transparent {
  static constexpr std::string_view name = "transparent", method = "sorted";
  using SharedKnobs = BlendedKnobs;
  using In = BlendedIn;
  struct Out {
    ImageHandle color;
    BatchPipelines drawn;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool behind = false;  // draws what lies behind surfaces that refract, whatever the method of the rest
};

}  // namespace candela
