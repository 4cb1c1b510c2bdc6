#include "passes/volumes/fog.h"

#include "shared/fog.h"

namespace candela {
namespace {

struct GridSize {
  std::string_view name;
  glm::uvec3 nodes;
};
// The seed's, and finer ones.
constexpr GridSize fog_grids[] = {{"32x18x24", {32, 18, 24}},     {"64x36x32", {64, 36, 32}},
                                  {"96x54x48", {96, 54, 48}},     {"128x72x64", {128, 72, 64}},
                                  {"160x90x128", {160, 90, 128}}, {"256x144x256", {256, 144, 256}}};
constexpr int march = int(std::size(fog_grids));

const std::vector<std::string_view> seen_by = {"fog",        "shade_forward", "shade_unlit", "sky",
                                               "background", "transparent",   "fog_layers"};

}  // namespace

std::span<const Knob<FogKnobs>> FogKnobs::table() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const GridSize& size : fog_grids) all.push_back(size.name);
    all.emplace_back("march");
    return all;
  }();
  static const Knob<FogKnobs> table[] = {
      {"grid",
       &FogKnobs::grid,
       "",
       0,
       double(march),
       {0, 2, 3, double(march)},
       "rays across and down and depths at which the light of fog is kept; march: each pixel follows a ray of its own",
       names,
       Trades::error,
       {0, 1, 2, 3, 4, 5, double(march)},
       seen_by},
      {"last",
       &FogKnobs::last,
       "",
       0,
       1,
       {0, 0, 0, 1},
       "the slice in which a surface stands: 0 interpolated, so that lamps behind it shine through; 1 followed by each "
       "pixel through its own lists",
       {},
       Trades::error,
       {0, 1},
       seen_by},
      {"steps",
       &FogKnobs::steps,
       "",
       4,
       65536,
       {64, 128, 128, 512},
       "fog.grid=march: slices of a ray in which light is summed",
       {},
       Trades::error,
       {32, 64, 128, 512},
       seen_by,
       {},
       "fog.grid=march"},
      {"lamp_shadows",
       &FogKnobs::lamp_shadows,
       "",
       0,
       64,
       {0, 1, 1, 4},
       "points of a slice, at least, at which the shadow maps of a lamp are asked; 0: lamps shine through everything "
       "in "
       "the air",
       {},
       Trades::error,
       {0, 1, 2, 4},
       seen_by},
      {"sky_directions",
       &FogKnobs::sky_directions,
       "",
       1,
       4096,
       {4, 16, 16, 256},
       "directions in which the fog before the sky is looked through, for ambient light in fog that has an end; on "
       "surfaces in fog without bounds two elevations for each 16, and no azimuths",
       {},
       Trades::error,
       {1, 4, 16, 64, 256},
       seen_by},
  };
  return table;
}

bool FogKnobs::marches() const { return grid == march; }

glm::uvec3 FogKnobs::nodes(uint32_t width_px, uint32_t height_px) const {
  return marches() ? glm::uvec3(width_px, height_px, steps) : fog_grids[grid].nodes;
}

Need FogGrid::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (!request.look.fog) return {false, "the look has no fog (--look)"};
  if (!request.draws_fog()) return {false, "fog is not wanted (--effects)"};
  if (request.look.fog->scattering_per_m == glm::dvec3(0)) return {false, "the fog scatters nothing"};
  if (facts.lights() == 0 && !facts.environment && !request.neutral_light)
    return {false, "no light is there to be scattered"};
  return needed_if(!knobs.marches(), "fog.grid is march: each pixel follows its own ray");
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
  if (in.ambient) shader += "#FOG_AMBIENT=1";
  const bool lamps = in.lists.lamp_maps && knobs.lamp_shadows > 0;
  shader += fog_shadows(bool(in.lists.sun_maps), lamps, knobs.lamp_shadows);
  out.scatter = builder.pipeline(ComputePipelineDesc{shader, {}});
  out.sum = builder.pipeline(ComputePipelineDesc{"fog_sum.comp", {}});
  builder.begin_step();
  for (const BufferHandle b : {in.scene.lights, in.scene.light_globals, in.lists.cells, in.lists.entries})
    builder.read_optional(b, Access::compute_read);
  if (in.lists.sun_maps) {
    builder.read(in.lists.sun_maps, Access::sampled_compute, "the suns' maps");
    builder.read(in.scene.suns, Access::compute_read, "the suns' cascades");
  }
  if (lamps) {
    builder.read(in.lists.lamp_maps, Access::sampled_compute, "the lamps' maps");
    builder.read(in.scene.lamps, Access::compute_read, "the lamps' tiles");
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
  if (in.scene.lights) {
    // No address is 0, even of a list that is never walked: see shaders/lib/light_list.glsl.
    const auto address = [&](BufferHandle buffer) { return commands.address(buffer ? buffer : in.scene.lights); };
    push.lights = commands.address(in.scene.lights);
    push.light_cells = address(in.lists.cells);
    push.light_entries = address(in.lists.entries);
    push.light_tiles = push.lights;
  }
  if (in.lists.sun_maps) {
    push.suns = commands.address(in.scene.suns);
    push.sun_maps = commands.sampled(in.lists.sun_maps);
  }
  if (in.lists.lamp_maps && knobs.lamp_shadows > 0) {
    push.lamps = commands.address(in.scene.lamps);
    push.lamp_maps = commands.sampled(in.lists.lamp_maps);
  }
  push.target = commands.storage(out.light);
  commands.bind(out.scatter);
  commands.push(push);
  constexpr uint32_t slices_a_thread = 4;  // FOG_RUN
  commands.dispatch(nodes.x, nodes.y, (nodes.z + slices_a_thread - 1) / slices_a_thread);
}

}  // namespace candela
