#include "passes/geometry/key_depth.h"

#include "passes/shared/draw_batches.h"
#include "shared/visibility.h"

namespace candela {

namespace {
uint32_t tiles_across(uint32_t px) { return (px + shared::depth_tile_px - 1) / shared::depth_tile_px; }
uint32_t tile_count(uint32_t width_px, uint32_t height_px) { return tiles_across(width_px) * tiles_across(height_px); }
}  // namespace

BlendedTiles::Out BlendedTiles::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {s.items, s.cull_groups}) builder.read(b, Access::compute_read, "the scene");
  builder.read(in.kept_items, Access::compute_read, "the items in view");
  BufferDesc tiles{"blended_tiles.tiles", uint64_t(tile_count(s.width_px, s.height_px)) * sizeof(uint32_t)};
  tiles.zeroed = true;
  Out out;
  out.tiles = builder.write(builder.create(tiles), Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"blended_tiles.comp", {}});
  return out;
}

void BlendedTiles::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::BlendedTilesPush push{};
  push.groups = commands.address(in.scene.cull_groups);
  push.kept = commands.address(in.kept_items);
  push.tiles = commands.address(out.tiles);
  push.subsample_ndc = in.scene.subsample_ndc();
  push.group_count = in.scene.cull_group_count;
  commands.push(push);
  const glm::uvec2 threads = shared::cull_threads(in.scene.cull_group_count);
  commands.dispatch(threads.x, threads.y);
}

std::span<const Knob> KeyDepth::Knobs::table() {
  static const Knob table[] = {
      {.name = "tiles",
       .member = &Knobs::tiles,
       .lowest = 0,
       .highest = 1,
       .levels = {1},
       .description =
           "depths of a visibility buffer are put into an image where blended surfaces may be, and not in all of "
           "the picture",
       .kind = Trades::time,
       .sweep = {0, 1}},
  };
  return table;
}

KeyDepth::Out KeyDepth::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.keys, Access::fragment_read, "keys");
  GraphicsPipelineDesc desc = samples_pipeline("key_depth.frag", in.samples);
  if (builder.read_optional(in.tiles, Access::vertex_read)) desc.vertex_shader = "key_depth.vert";
  desc.depth_format = depth_format;
  desc.depth_test = desc.depth_write = true;
  desc.depth_compare = VK_COMPARE_OP_ALWAYS;
  Out out;
  out.pipeline = builder.pipeline(desc);
  out.depth = builder.write(builder.create(ImageDesc{"depth", depth_format, in.width_px, in.height_px, in.samples}),
                            Access::depth_attachment);
  return out;
}

void KeyDepth::record(CommandList& commands, const In& in, const Out& out) const {
  commands.begin_picture({}, out.depth, PicturePart::seen);
  shared::SamplesPush push{};
  push.source = commands.address(in.keys);
  push.size_px = {in.width_px, in.height_px};
  if (in.tiles) push.tiles = commands.address(in.tiles);
  record_samples(commands, out.pipeline, push, in.tiles ? tile_count(in.width_px, in.height_px) : 0);
  commands.end_rendering();
}

}  // namespace candela
