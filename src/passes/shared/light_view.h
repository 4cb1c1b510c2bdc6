#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/views.h"
#include "shared/draw.h"

namespace candela {

// What passes share that draw see-through surfaces into the views of a light's shadow maps. Not a pass.
bool is_blended_to_light(const DrawBatch& run);
bool is_glass_to_light(const DrawBatch& run);

// What all views of an image have in common. drawn_px: along a side of what is drawn to.
shared::ColoredShadowPush light_view_push(CommandList& commands, BufferHandle deformed, uint32_t drawn_px);
// The runs of each view of the layer, with the view's own place and light in `push`.
void draw_light_views(CommandList& commands, const SceneInputs& scene, const Draws& draws,
                      const BatchPipelines& pipelines, const ViewImage& image, uint32_t layer,
                      shared::ColoredShadowPush push);

}  // namespace candela
