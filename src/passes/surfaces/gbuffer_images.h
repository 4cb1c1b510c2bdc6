#pragma once
#include <array>
#include <string>

#include "gpu/command_list.h"
#include "graph/builder.h"
#include "passes/shared/knob_tables.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"

namespace candela {

// What surfaces are shaded from in a G-buffer's images, each of four 32-bit words a texel and multisampled as the
// frame.
struct GBufferImages {
  using MadeBy = std::tuple<GBufferKnobs, SurfaceKnobs, ReliefKnobs, ResolveKnobs, SupersampleKnobs>;
  static constexpr size_t most = 14;
  std::array<ImageHandle, most> images;  // empty behind the last; which relief it is, and lobes last
  uint32_t count = 0;
  bool reliefs = false;     // their light is looked for on the way through their layers (relief.light_steps)
  std::string definitions;  // of shaders that include lib/gbuffer.glsl
};

// What a pass reads of a G-buffer, and the places of its images among the pass's, 4 bits each.
void read_gbuffer(GraphBuilder& builder, const GBufferImages& gbuffer, Access access);
uint64_t gbuffer_places(CommandList& commands, const GBufferImages& gbuffer);
// What finding a relief's triangle takes, where there are any.
void read_gbuffer_reliefs(GraphBuilder& builder, const GBufferImages& gbuffer, const SceneInputs& scene,
                          BufferHandle deformed, Access access);

// Knobs of passes that shade it.
using GBufferShadingKnobs = std::tuple<LightRangeKnobs, IblKnobs, ProbeKnobs>;

}  // namespace candela
