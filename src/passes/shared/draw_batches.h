#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "gpu/command_list.h"
#include "passes/shared/scene_inputs.h"
#include "shared/cull.h"
#include "shared/draw.h"
#include "shared/visibility.h"

namespace candela {

// Drawing the scene's runs, shared by the passes that rasterise it. Not a pass.
struct BatchPipelines {
  std::vector<PipelineHandle> by_run;  // parallel to SceneInputs::runs; empty: this pass does not draw the run
};

// Declares the scene reads of a drawing pass and one pipeline for each distinct state among the runs that `draws`
// accepts. desc is completed with topology and the run's constants; a masked run gets `masked_fragment` where the
// opaque one has none.
struct BatchPipelineChoice {
  GraphicsPipelineDesc desc;
  std::string masked_fragment;       // for depth-only passes; empty: desc.fragment_shader serves all
  std::string relief_fragment = {};  // likewise
};
BatchPipelines declare_batches(GraphBuilder& builder, const SceneInputs& scene, const Draws& draws,
                               BufferHandle deformed, const std::function<bool(const DrawBatch&)>& accepts,
                               const BatchPipelineChoice& choice);

// What layers beside beauty are drawn with: the nearest opaque or masked surface at the pixel's centre, one sample, in
// a depth buffer of its own, `pass`.z.
struct NearestSurface {
  BatchPipelines pipelines;
  ImageHandle depth;
};
NearestSurface declare_nearest_surface(GraphBuilder& builder, const SceneInputs& scene, const Draws& draws,
                                       BufferHandle deformed, std::string_view pass, std::string fragment_shader,
                                       std::vector<VkFormat> color_formats, std::vector<SpecConstant> constants = {},
                                       std::string vertex_shader = "draw.vert");

// Puts a buffer's samples, one for each of the image that is drawn into (shaders/lib/sample_of_buffer.glsl), into that
// image: a pipeline without formats, and its draw, inside begin_rendering; tiles: how many, 0: all of the picture.
GraphicsPipelineDesc samples_pipeline(std::string fragment_shader, uint32_t samples);
void record_samples(CommandList& commands, PipelineHandle pipeline, const shared::SamplesPush& push,
                    uint32_t tiles = 0);

// The colour image of a shading pass: `color` written again, or a new one where there is none yet. It is not cleared:
// sky or background cover what no surface does.
ImageHandle write_color(GraphBuilder& builder, const SceneInputs& scene, ImageHandle color);

// What a pass alone reads, and has declared.
struct OwnInputs {
  BufferHandle table, deformed_before;  // optional: of DrawPush
  uint64_t word = 0;                    // in the place of a table: places among images, or numbers
  uint32_t number = 0;
  bool backs = false;        // of surfaces that are drawn: back faces alone
  uint64_t first_count = 0;  // into the counts of the draws, in bytes
};
// What compute passes declare that take surfaces from the keys of a visibility buffer, but for lights and fog.
void declare_keyed_surfaces(GraphBuilder& builder, const SceneInputs& scene, BufferHandle keys, BufferHandle deformed);
// What compute passes declare that shade surfaces where rays meet them (shaders/lib/shade_hit.glsl), and the constants
// of their pipelines.
void declare_met_surfaces(GraphBuilder& builder, const SceneInputs& scene, BufferHandle deformed, const Lighting& met);
std::vector<SpecConstant> met_constants(const SceneInputs& scene, const Lighting& met);
// The push constants of passes that shade the scene. lists, fog: as for record_batches.
shared::DrawPush draw_push(CommandList& commands, const SceneInputs& scene, BufferHandle deformed,
                           const Lighting* lists, const Lighting* fog, const OwnInputs& own);
// One vkCmdDrawIndexedIndirectCount a run, inside begin_rendering. lists: of a pass that declared lights. fog: of one
// that declared fog.
void record_batches(CommandList& commands, const SceneInputs& scene, const Draws& draws, BufferHandle deformed,
                    const BatchPipelines& pipelines, const Lighting* lists = nullptr, const Lighting* fog = nullptr,
                    const OwnInputs& own = {});

// The push constants of what is drawn behind everything, seen through the fog of the lists where there is any.
shared::SkyPush sky_push(CommandList& commands, const SceneInputs& scene, const Lighting& lists);

// The same for a view of the range that the draws are of, by its number there: surfaces from both sides, or with
// open_sides single-sided ones from their fronts alone.
template <class Push>
void record_view_runs(CommandList& commands, const SceneInputs& scene, const Draws& draws,
                      const BatchPipelines& pipelines, uint32_t number, const Push& push, bool open_sides = false) {
  commands.bind_index_buffer(scene.indices);
  for (size_t r = 0; r < scene.draw_batches->size(); ++r) {
    const size_t region = number * scene.draw_batches->size() + r;
    const uint32_t first = (*draws.first_command)[region], room = (*draws.first_command)[region + 1] - first;
    if (!pipelines.by_run[r] || room == 0) continue;
    commands.bind(pipelines.by_run[r]);
    commands.push(push);
    const DrawBatch& run = (*scene.draw_batches)[r];
    commands.set_cull(open_sides && run.cull_back, run.mirrored);
    commands.draw_indexed_indirect_count(draws.commands, uint64_t(first) * sizeof(shared::DrawCommand), draws.counts,
                                         region * sizeof(uint32_t), room);
  }
}
// The depth of what casts shadows in it.
void record_view_depth(CommandList& commands, const SceneInputs& scene, const Draws& draws, BufferHandle deformed,
                       const BatchPipelines& pipelines, uint32_t number, const shared::View& view);

// The specialization constants that say what such a pass finds.
std::vector<SpecConstant> light_constants(const Lighting& lists);

// A shader's name with the definition that has it take coloured shadows, where there are any.
std::string with_shadow_colors(std::string shader, const ShadowColors& colors);
// The same of blended surfaces, and of the light that is left at each distance. Rays tell themselves.
std::string with_deep_shadows(std::string shader, const Lighting& lists);

// What a pass that shades under lights reads besides.
void declare_lights(GraphBuilder& builder, const SceneInputs& scene, const Lighting& lists, const ReadBy& by = {});

// Whether opaque or masked lines or points are among the runs.
bool draws_lines(const SceneInputs& scene);

}  // namespace candela
