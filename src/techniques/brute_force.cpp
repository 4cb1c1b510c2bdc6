#include "passes/clear.h"
#include "passes/cull.h"
#include "passes/cull_compact.h"
#include "passes/deform.h"
#include "passes/depth_prepass.h"
#include "passes/shade_forward.h"
#include "passes/shade_unlit.h"
#include "passes/sky.h"
#include "passes/transparent.h"
#include "techniques/technique.h"

namespace candela {
namespace {
// A pass that draws over an image gives it a new version; one that was left out leaves the old.
ImageHandle newest(ImageHandle made, ImageHandle before) { return made ? made : before; }
}  // namespace

FrameImages brute_force(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs) {
  Cull cull;
  cull.knobs.enabled = knobs.cull_enabled ? 1 : 0;
  const BufferHandle survivors = frame.add(cull, {scene}).survivors;
  const Draws draws = frame.add(CullCompact{}, {scene, survivors, knobs.cull_enabled}).draws;
  const BufferHandle deformed = frame.add(Deform{}, {scene}).deformed;
  const ImageHandle depth = frame.add(DepthPrepass{}, {scene, draws, deformed}).depth;

  ImageHandle color = frame.add(Clear{}, {scene}).color;
  color = newest(frame.add(ShadeForward{}, {scene, draws, deformed, depth, color}).color, color);
  color = newest(frame.add(ShadeUnlit{}, {scene, draws, deformed, depth, color}).color, color);
  color = newest(frame.add(Sky{}, {scene, depth, color}).color, color);
  color = newest(frame.add(Transparent{}, {scene, draws, deformed, depth, color}).color, color);

  Layers::In wanted{scene, draws, deformed};
  for (uint32_t i = 0; i < layer_count; ++i) wanted.wanted[i] = frame.request.has_layer(layer_name_table()[i]);
  return {color, frame.add(Layers{}, wanted).images};
}

}  // namespace candela
