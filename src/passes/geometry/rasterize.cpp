#include "passes/geometry/rasterize.h"

#include "passes/geometry/features.h"
#include "shared/visibility.h"

namespace candela {
namespace {
// Triangles that the list holds: beyond it each is its thread's own.
constexpr uint32_t most_large = 1u << 18;
constexpr uint32_t most_groups = 65535;  // of a dimension, on every device
}  // namespace

std::span<const Knob<Rasterize::Knobs>> Rasterize::Knobs::table() {
  static const Knob<Knobs> table[] = {
      {.name = "small_px",
       .member = &Knobs::small_px,
       .unit = "px",
       .lowest = 1,
       .highest = 64,
       .ladder = {8},
       .trades = "triangles up to this many pixels wide and high are one thread's; changes time, never the image",
       .kind = Trades::time,
       .walk = {1, 8, 64},
       .passes = {"rasterize"}},
  };
  return table;
}

Need Rasterize::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.lit_items + facts.unlit_items > 0, "the scene has no opaque or masked surface");
}

Rasterize::Out Rasterize::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {s.vertices, s.indices, s.items, s.transforms, s.geometries, s.materials, s.batches})
    builder.read(b, Access::compute_read, "the scene");
  builder.read(in.masks, Access::compute_read, "the items that stay");
  builder.read_optional(in.deformed, Access::compute_read);
  bool any_masked = false;
  for (const DrawRun& run : *s.runs) any_masked |= run.solid() && run.alpha == AlphaMode::mask;
  std::vector<SpecConstant> constants = {{30, "SAMPLES", s.samples}};
  if (any_masked) {
    constants.push_back({31, "HAS_MASKS", 1});
    if (in.masks_by_sample && s.samples > 1) constants.push_back({32, "MASKS_BY_SAMPLE", 1});
  }
  for (const SpecConstant& c : base_color_constants(s.features))
    if (any_masked || Feature(c.id) == Feature::subsample) constants.push_back(c);
  const uint64_t samples = uint64_t(s.width_px) * s.height_px * s.samples;
  BufferDesc keys{"keys", samples * sizeof(uint64_t)};
  keys.zeroed = true;
  BufferDesc large{"rasterize.large", 8 + (uint64_t(most_large) + 1) * sizeof(shared::LargeTriangle)};
  large.zeroed = large.unordered = true;
  Out out;
  out.keys = builder.create(keys);
  out.large = builder.create(large);
  out.groups = builder.create(BufferDesc{"rasterize.groups", sizeof(shared::TileGroups)});
  out.batches = builder.pipeline(ComputePipelineDesc{"rasterize.comp", constants});
  out.count = builder.pipeline(ComputePipelineDesc{"rasterize_tiles.comp", {}});
  out.tiles = builder.pipeline(ComputePipelineDesc{"rasterize_large.comp", constants});
  builder.begin_step();
  out.keys = builder.write(out.keys, Access::compute_write);
  out.large = builder.write(out.large, Access::compute_write);
  builder.begin_step();
  builder.read(out.large, Access::compute_read, "large triangles");
  out.groups = builder.write(out.groups, Access::compute_write);
  builder.begin_step();
  builder.read(out.large, Access::compute_read, "large triangles");
  builder.read(out.groups, Access::indirect_read, "how many tiles there are");
  out.keys = builder.write(out.keys, Access::compute_write);
  return out;
}

void Rasterize::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& s = in.scene;
  shared::RasterizePush push{};
  push.large = commands.address(out.large);
  push.most_large = most_large;
  if (commands.step() == 1) {
    push.groups = commands.address(out.groups);
    commands.bind(out.count);
    commands.push(push);
    commands.dispatch(1);
    return;
  }
  push.deformed = in.deformed ? commands.address(in.deformed) : 0;
  push.indices = commands.address(s.indices);
  push.batches = commands.address(s.batches);
  push.masks = commands.address(in.masks);
  push.keys = commands.address(out.keys);
  push.subsample_ndc = s.subsample_ndc;
  push.subsample_footprint = s.subsample_footprint;
  push.batch_count = s.batch_count;
  push.small_px = uint32_t(knobs.small_px);
  commands.bind(commands.step() == 0 ? out.batches : out.tiles);
  commands.push(push);
  if (commands.step() == 2) return commands.dispatch_indirect(out.groups);
  const uint32_t row = std::min(s.batch_count, most_groups);
  commands.dispatch(row * shared::triangle_batch_size, (s.batch_count + row - 1) / row);
}

KeyDepth::Out KeyDepth::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.keys, Access::fragment_read, "keys");
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "background.vert";
  desc.fragment_shader = "key_depth.frag";
  if (in.samples > 1) desc.constants = {{0, "SAMPLES", in.samples}};
  desc.depth_format = depth_format;
  desc.samples = in.samples;
  desc.depth_test = desc.depth_write = true;
  desc.depth_compare = VK_COMPARE_OP_ALWAYS;
  Out out;
  out.pipeline = builder.pipeline(desc);
  out.depth = builder.write(builder.create(ImageDesc{"depth", depth_format, in.width_px, in.height_px, in.samples}),
                            Access::depth_attachment);
  return out;
}

void KeyDepth::record(CommandList& commands, const In& in, const Out& out) const {
  commands.begin_rendering({}, out.depth);
  commands.bind(out.pipeline);
  commands.set_cull(false, false);
  for (uint32_t sample = 0; sample < in.samples; ++sample) {
    commands.push(shared::SamplesPush{commands.address(in.keys), in.width_px, sample});
    commands.draw(3);
  }
  commands.end_rendering();
}

}  // namespace candela
