#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "gpu/command_list.h"
#include "passes/scene_inputs.h"
#include "shared/draw.h"

namespace candela {

// Drawing the scene's runs, shared by the passes that rasterise it. Not a pass.
struct RunPipelines {
  std::vector<PipelineHandle> by_run;  // parallel to SceneInputs::runs; empty: this pass does not draw the run
};

// Declares the scene reads of a drawing pass and one pipeline for each distinct state among the runs that `draws`
// accepts. desc is completed with topology and the run's constants; a masked run gets `masked_fragment` where the
// opaque one has none.
struct RunPipelineChoice {
  GraphicsPipelineDesc desc;
  std::string masked_fragment;  // for depth-only passes; empty: desc.fragment_shader serves all
};
RunPipelines declare_runs(GraphBuilder& builder, const SceneInputs& scene, const Draws& draws, BufferHandle deformed,
                          const std::function<bool(const DrawRun&)>& accepts, const RunPipelineChoice& choice);

// What layers beside beauty are drawn with: the nearest opaque or masked surface at the pixel's centre, one sample, in
// a depth buffer of its own, `pass`.z.
struct NearestSurface {
  RunPipelines pipelines;
  ImageHandle depth;
};
NearestSurface declare_nearest_surface(GraphBuilder& builder, const SceneInputs& scene, const Draws& draws,
                                       BufferHandle deformed, std::string_view pass, std::string fragment_shader,
                                       std::vector<VkFormat> color_formats, std::vector<SpecConstant> constants = {},
                                       std::string vertex_shader = "draw.vert");

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
// The push constants of passes that shade the scene. lists, fog: as for record_runs.
shared::DrawPush draw_push(CommandList& commands, const SceneInputs& scene, BufferHandle deformed,
                           const CellLists* lists, const CellLists* fog, const OwnInputs& own);
// One vkCmdDrawIndexedIndirectCount a run, inside begin_rendering. lists: of a pass that declared lights. fog: of one
// that declared fog.
void record_runs(CommandList& commands, const SceneInputs& scene, const Draws& draws, BufferHandle deformed,
                 const RunPipelines& pipelines, const CellLists* lists = nullptr, const CellLists* fog = nullptr,
                 const OwnInputs& own = {});

// The push constants of what is drawn behind everything, seen through the fog of the lists where there is any.
shared::SkyPush sky_push(CommandList& commands, const SceneInputs& scene, const CellLists& lists);

// The same for what casts shadows in a view of the range that the draws are of, by its number there: depth alone,
// surfaces from both sides.
void record_view_runs(CommandList& commands, const SceneInputs& scene, const Draws& draws, BufferHandle deformed,
                      const RunPipelines& pipelines, uint32_t number, const shared::View& view);

// The specialization constants that say what such a pass finds.
std::vector<SpecConstant> light_constants(const CellLists& lists);

// What a pass that shades under lights reads besides.
void declare_lights(GraphBuilder& builder, const SceneInputs& scene, const CellLists& lists, const ReadBy& by = {});

// Whether opaque or masked lines or points are among the runs.
bool draws_lines(const SceneInputs& scene);

}  // namespace candela
