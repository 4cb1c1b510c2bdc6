#include "passes/volumes/fog.h"

#include "passes/shared/push_lights.h"
#include "shared/fog.h"

namespace candela {
namespace {

constexpr uint32_t slices_a_thread = 4;  // FOG_RUN

// Slices of the lights' grid, four an octave, in which a thread's lie, where the fog's reach over twelve octaves.
uint32_t most_cells(uint32_t depths) { return (slices_a_thread * 48 + depths - 3) / (depths - 2) + 1; }

}  // namespace

Need FogGrid::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (Need any = fog_light_needed(facts, request); !any) return any;
  return needed_if(knobs.method == FogKnobs::froxels, "fog.method is not froxels");
}

FogGrid::Out FogGrid::declare(GraphBuilder& builder, const In& in) const {
  const glm::uvec3 nodes = knobs.nodes(in.scene.width_px, in.scene.height_px);
  Out out;
  out.light = builder.create(ImageDesc{.name = "fog.light",
                                       .format = color_format,
                                       .width_px = nodes.x,
                                       .height_px = nodes.y,
                                       .covered = true,
                                       .kind = ImageKind::d3,
                                       .depth_px = nodes.z});
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  std::string shader = "fog_light.comp";
  if (in.media > 0) shader += fmt::format("#FOG_MEDIA={}", in.media);
  if (in.ambient) shader += "#FOG_AMBIENT=1";
  shader += fmt::format("#FOG_CELLS={}u", most_cells(nodes.z));
  const bool lamps = in.lists.lamp_maps && knobs.local_shadows > 0;
  shader += fog_shadows(in.lists, knobs.local_shadows, knobs.sun_points);
  out.scatter = builder.pipeline(ComputePipelineDesc{shader, {}});
  out.sum = builder.pipeline(ComputePipelineDesc{"fog_sum.comp", {}});
  builder.begin_step();
  for (const BufferHandle b : {in.scene.lights, in.scene.light_globals, in.lists.cells, in.lists.entries})
    builder.read_optional(b, Access::compute_read);
  if (in.lists.sun_maps) {
    builder.read(in.lists.sun_maps, Access::sampled_compute, "the suns' maps");
    builder.read(in.scene.suns, Access::compute_read, "the suns' cascades");
  }
  if (in.lists.sun_maps) builder.read_optional(in.lists.deep.suns, Access::sampled_compute);
  if (lamps) {
    builder.read_optional(in.lists.deep.lamps, Access::sampled_compute);
    builder.read(in.lists.lamp_maps, Access::sampled_compute, "the local lights' maps");
    builder.read(in.scene.lamps, Access::compute_read, "the local lights' tiles");
  }
  out.light = builder.write(out.light, Access::storage_image_write);
  builder.begin_step();
  out.light = builder.write(out.light, Access::storage_image_read_write);
  return out;
}

void FogGrid::record(CommandList& commands, const In& in, const Out& out) const {
  const glm::uvec3 nodes = commands.size_3d(out.light);
  if (commands.step() == 1) {
    commands.bind(out.sum);
    commands.push(shared::FogSumPush{commands.storage(out.light)});
    commands.dispatch(nodes.x * nodes.y);
    return;
  }
  shared::FogLightPush push{};
  Lighting lists = in.lists;
  lists.tiles = {};  // air lies before and behind what tiles know the depths of
  if (knobs.local_shadows == 0) lists.lamp_maps = lists.deep.lamps = {};
  if (!lists.sun_maps) lists.deep.suns = {};
  push_light_lists(commands, in.scene, lists, push);
  push.target = commands.storage(out.light);
  commands.bind(out.scatter);
  commands.push(push);
  commands.dispatch(nodes.x, nodes.y, (nodes.z + slices_a_thread - 1) / slices_a_thread);
}

}  // namespace candela
