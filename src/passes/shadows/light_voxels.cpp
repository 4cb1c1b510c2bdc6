#include "passes/shadows/light_voxels.h"

#include <algorithm>

#include "passes/shared/draw_batches.h"
#include "passes/shared/features.h"
#include "shared/draw.h"
#include "shared/voxels.h"

namespace candela {
namespace {

// How many tiles and cells there are.
struct Shape {
  glm::uvec2 tiles;
  uint32_t words = 0, capacity = 0, all_cells = 0;
  uint64_t points_bytes = 0, bytes = 0;
};
Shape shape_of(const SceneInputs& scene, const FillLightVoxels::Knobs& knobs) {
  Shape s;
  const uint32_t side = uint32_t(knobs.size_px);
  s.tiles = {(scene.width_px + side - 1) / side, (scene.height_px + side - 1) / side};
  s.words = (scene.light_room + shared::voxel_lights_a_word - 1) / shared::voxel_lights_a_word;
  const uint64_t tiles = uint64_t(s.tiles.x) * s.tiles.y, state_bytes = 4ull * s.words;
  s.all_cells = uint32_t(std::min<uint64_t>(tiles * shared::voxel_tile_cells, UINT32_MAX / 2));
  const uint64_t fitting = (uint64_t(knobs.budget_mb) << 20) / (state_bytes + 4);
  s.capacity = uint32_t(std::clamp<uint64_t>(fitting, 1, s.all_cells));
  s.points_bytes = tiles * shared::voxel_tile_cells * uint64_t(knobs.points) * sizeof(uint32_t);
  s.bytes = shared::voxel_grid_bytes + tiles * sizeof(shared::VoxelTile) + s.capacity * (state_bytes + 4);
  return s;
}

}  // namespace

std::span<const Knob> LightVoxelKnobs::table() {
  constexpr std::string_view in_use = "local.method=voxels sun.mode=voxels";
  static const Knob rows[] = {
      {.name = "size_px",
       .member = &LightVoxelKnobs::size_px,
       .unit = "px",
       .lowest = 1,
       .highest = 32,
       .levels = {16, 8, 8, 1},
       .description = "side in pixels of the cells that store which lights are seen from them; larger cells miss more "
                      "small shadows. 1: each point sends its own rays, as traced",
       .sweep = {32, 16, 8, 4, 1},
       .only = {1, 4, 8, 16, 32},
       .required = in_use},
      {.name = "points",
       .member = &LightVoxelKnobs::points,
       .lowest = 1,
       .highest = int(shared::most_voxel_points),
       .levels = {4, 4, 4, 8},
       .description = "points of a cell that send rays to its lights; fewer miss more of what is small",
       .sweep = {1, 2, 4, 8},
       .required = in_use},
      {.name = "edges",
       .member = &LightVoxelKnobs::edges,
       .lowest = 0,
       .highest = 1,
       .levels = {1},
       .description = "where a cell's points differ: half of the light, or a ray from each point",
       .choices = {"half", "rays"},
       .sweep = {0, 1},
       .required = in_use},
      {.name = "budget_mb",
       .member = &LightVoxelKnobs::budget_mb,
       .unit = "MB",
       .lowest = 1,
       .highest = 16384,
       .levels = {64, 64, 64, 1024},
       .description =
           "most memory for what cells know; points of cells without room send their own rays, which a note says",
       .sweep = {16, 64, 256, 1024},
       .required = in_use},
  };
  return rows;
}

std::vector<std::string> FillLightVoxels::notes(const Report& report) const {
  if (report.without == 0) return {};
  return {
      fmt::format("{} of {} cells that would know which lights are seen from them have no room (voxels.budget_mb = "
                  "{}): their points send their own rays",
                  report.without, report.cells, knobs.budget_mb)};
}

Need FillLightVoxels::needed(const SceneFacts& facts, const FrameRequest&) const {
  if (!wanted) return {false, "no light's shadows are by cells of the view (local.method, sun.mode)"};
  if (knobs.size_px == 1) return {false, "cells of one pixel: each point sends its own rays (voxels.size_px)"};
  return needed_for_solid_surfaces(facts);
}

FillLightVoxels::Out FillLightVoxels::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const Shape shape = shape_of(s, knobs);
  Out out;
  BufferHandle& states = out.voxels.states;
  out.voxels.halve = knobs.edges == Knobs::halve;
  states = builder.create(BufferDesc{"light.voxels", shape.bytes, BufferMemory::device, true});
  out.points = builder.create(BufferDesc{"light.voxel_points", shape.points_bytes});
  out.groups = builder.create(BufferDesc{"light.voxel_groups", 3 * sizeof(uint32_t)});
  if (shape.capacity < shape.all_cells)
    out.report = builder.create(BufferDesc{"light.voxel_report", sizeof(Report), BufferMemory::host_read});
  const std::vector<SpecConstant> shapes = {
      {30, "SAMPLES", s.samples}, {31, "TILE_PX", uint32_t(knobs.size_px)}, {32, "POINTS", uint32_t(knobs.points)}};
  builder.read(s.constants, Access::uniform_read, "the frame's constants");

  builder.begin_step();
  read_depth(builder, in.depth);
  states = builder.write(states, Access::compute_write);
  out.points = builder.write(out.points, Access::compute_write);
  out.find = builder.pipeline(ComputePipelineDesc{with_depth("light_voxels.comp", in.depth), shapes});

  builder.begin_step();
  builder.read(s.ray_settings, Access::compute_read, "how rays are sent");
  states = builder.write(states, Access::compute_write);
  out.groups = builder.write(out.groups, Access::compute_write);
  if (out.report) {
    out.report = builder.write(out.report, Access::compute_write);
    builder.sink(out.report);
  }
  out.number = builder.pipeline(ComputePipelineDesc{"light_voxels_number.comp", shapes});

  builder.begin_step();
  builder.read(out.groups, Access::indirect_read, "groups of threads");
  builder.read(out.points, Access::compute_read, "the cells' points");
  builder.read(s.materials, Access::compute_read, "the scene");
  declare_lights(builder, s, in.lists, ReadBy::compute());
  states = builder.write(states, Access::compute_write);
  ComputePipelineDesc fill{"light_voxels_fill.comp", light_constants(in.lists)};
  fill.shader += surface_definitions(fill.constants);
  fill.constants.insert(fill.constants.end(), shapes.begin(), shapes.end());
  fill.constants.push_back(light_voxels_constant(s.rays.suns_by_voxels, s.rays.lamps_by_voxels, false));
  out.fill = builder.pipeline(fill);
  return out;
}

void FillLightVoxels::record(CommandList& commands, const In& in, const Out& out) const {
  const Shape shape = shape_of(in.scene, knobs);
  if (commands.step() == 2) {
    OwnInputs own;
    own.table = out.points;
    own.deformed_before = out.voxels.states;
    commands.bind(out.fill);
    commands.push(draw_push(commands, in.scene, {}, &in.lists, nullptr, own));
    commands.dispatch_indirect(out.groups);
    return;
  }
  shared::VoxelPush push{};
  push.voxels = commands.address(out.voxels.states);
  push.tiles = shape.tiles;
  push.words = shape.words, push.capacity = shape.capacity;
  if (commands.step() == 0) {
    push_depth(commands, in.depth, push);
    push.points = commands.address(out.points);
    commands.bind(out.find);
    commands.push(push);
    commands.dispatch(shape.tiles.x * 64, shape.tiles.y);
  } else {
    push.settings = commands.address(in.scene.ray_settings);
    push.groups = commands.address(out.groups);
    if (out.report) push.report = commands.address(out.report);
    commands.bind(out.number);
    commands.push(push);
    commands.dispatch(1);
  }
}

}  // namespace candela
