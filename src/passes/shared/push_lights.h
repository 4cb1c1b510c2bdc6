#pragma once
#include "base/check.h"
#include "gpu/command_list.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Of an image among the pass's, in eight bits.
inline uint32_t image_place(CommandList& commands, ImageHandle image) {
  const uint32_t place = commands.sampled(image);
  CHECK(place < 256);
  return place;
}

// The lights, their lists and their shadow maps into the members that push constants of all shaders which walk lights
// share; suns, sun_maps, lamps and lamp_maps stay 0 where the lists have no such map. No address of a list is 0, even
// of one that is never walked: see shaders/lib/light_list.glsl.
template <class Push>
void push_light_lists(CommandList& commands, const SceneInputs& scene, const Lighting& lists, Push& push) {
  if (!scene.lights) return;
  const auto address = [&](BufferHandle buffer) { return commands.address(buffer ? buffer : scene.lights); };
  push.lights = commands.address(scene.lights);
  push.light_cells = address(lists.cells);
  push.light_entries = address(lists.entries);
  push.light_tiles = address(lists.tiles);
  if constexpr (requires { push.suns; })
    if (lists.sun_maps) {
      push.suns = commands.address(scene.suns);
      push.sun_maps = commands.sampled(lists.sun_maps);
    }
  if constexpr (requires { push.shadow_colors; }) {
    if (lists.deep.suns) push.shadow_colors |= image_place(commands, lists.deep.suns) << 8;
    if (lists.deep.lamps) push.shadow_colors |= image_place(commands, lists.deep.lamps) << 24;
  }
  if (lists.lamp_maps) {
    push.lamps = commands.address(scene.lamps);
    push.lamp_maps = commands.sampled(lists.lamp_maps);
  }
}

}  // namespace candela
