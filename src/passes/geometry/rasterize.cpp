#include "passes/geometry/rasterize.h"

#include <algorithm>

#include "passes/shared/draw_batches.h"
#include "passes/shared/features.h"
#include "passes/shared/keys_buffer.h"
#include "shared/visibility.h"

namespace candela {
namespace {
constexpr uint32_t most_groups = 65535;  // of a dimension, on every device
}  // namespace

std::span<const Knob> RasterKnobs::table() {
  static const Knob table[] = {
      {.name = "small_px",
       .member = &RasterKnobs::small_px,
       .unit = "px",
       .lowest = 1,
       .highest = shared::raster_most_small_px,
       .levels = {32},
       .description = "triangles up to this many pixels wide and high, with several samples a pixel up to half as "
                      "many, are rasterized by one thread; changes time, never the image",
       .kind = Trades::time,
       .sweep = {1, 8, 64, 32}},
      {.name = "list",
       .member = &RasterKnobs::list,
       .lowest = 1,
       .highest = 1048576,
       .levels = {524288},
       .description = "how many larger triangles are shared out tile by tile; further ones are rasterized by one "
                      "thread each; changes time, never the image",
       .kind = Trades::time,
       .sweep = {1024, 524288}},
  };
  return table;
}

namespace {

// The first steps of both passes: they write `target` twice. defined: behind the shaders' names.
RasterSteps declare_steps(GraphBuilder& builder, const SceneInputs& s, BufferHandle masks, BufferHandle deformed,
                          BufferHandle& target, const RasterKnobs& knobs, const std::string& defined,
                          std::vector<SpecConstant> constants) {
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {s.vertices, s.indices, s.items, s.transforms, s.geometries, s.materials, s.batches})
    builder.read(b, Access::compute_read, "the scene");
  builder.read(masks, Access::compute_read, "the items that stay");
  builder.read_optional(deformed, Access::compute_read);
  const bool any_masked =
      std::ranges::any_of(*s.draw_batches, [](const DrawBatch& r) { return r.solid() && r.alpha == AlphaMode::mask; });
  if (any_masked) constants.push_back({31, "HAS_MASKS", 1});
  if (s.open_sides) constants.push_back({33, "OPEN_SIDES", 1});
  const bool any_relief = std::ranges::any_of(*s.draw_batches, &DrawBatch::relief);
  const std::string with = defined + (any_relief ? "#RELIEFS=1" : "");
  for (const SpecConstant& c : base_color_constants(s.features))
    if (any_masked || any_relief || Feature(c.id) == Feature::subsample) constants.push_back(c);
  BufferDesc large{"rasterize.large", 8 + (uint64_t(knobs.list) + 1) * sizeof(shared::LargeTriangle)};
  large.zeroed = large.unordered = true;
  RasterSteps steps;
  steps.large = builder.create(large);
  steps.groups = builder.create(BufferDesc{"rasterize.groups", sizeof(shared::TileGroups)});
  steps.batches = builder.pipeline(ComputePipelineDesc{"rasterize.comp" + with, constants});
  steps.count = builder.pipeline(ComputePipelineDesc{"rasterize_tiles.comp", {}});
  steps.tiles = builder.pipeline(ComputePipelineDesc{"rasterize_large.comp" + with, constants});
  builder.begin_step();
  target = builder.write(target, Access::compute_write);
  steps.large = builder.write(steps.large, Access::compute_write);
  builder.begin_step();
  builder.read(steps.large, Access::compute_read, "large triangles");
  steps.groups = builder.write(steps.groups, Access::compute_write);
  builder.begin_step();
  builder.read(steps.large, Access::compute_read, "large triangles");
  builder.read(steps.groups, Access::indirect_read, "how many tiles there are");
  target = builder.write(target, Access::compute_write);
  return steps;
}

// push: with what is the pass's own.
void record_step(CommandList& commands, const SceneInputs& s, BufferHandle masks, BufferHandle deformed,
                 BufferHandle target, const RasterSteps& steps, const RasterKnobs& knobs, uint32_t views,
                 shared::RasterizePush push) {
  push.large = commands.address(steps.large);
  push.most_large = uint32_t(knobs.list);
  // Of several samples a pixel costs a thread more. Measured on an H200: docs/understanding/visibility.md.
  push.small_px = uint32_t(s.samples > 1 && push.views == 0 ? std::max(knobs.small_px / 2, 1) : knobs.small_px);
  if (commands.step() == 1) {
    push.groups = commands.address(steps.groups);
    commands.bind(steps.count);
    commands.push(push);
    return commands.dispatch(1);
  }
  push.deformed = deformed ? commands.address(deformed) : 0;
  push.indices = commands.address(s.indices);
  push.batches = commands.address(s.batches);
  push.masks = commands.address(masks);
  push.keys = commands.address(target);
  push.batch_count = s.batch_count;
  commands.bind(commands.step() == 0 ? steps.batches : steps.tiles);
  commands.push(push);
  if (commands.step() == 2) return commands.dispatch_indirect(steps.groups);
  const uint32_t of_group = push.views && views >= shared::raster_many_views ? shared::raster_view_batches : 1;
  const uint32_t groups = (s.batch_count + of_group - 1) / of_group, row = std::min(groups, most_groups);
  commands.dispatch(row * shared::triangle_batch_size, (groups + row - 1) / row, views);
}

}  // namespace

Need Rasterize::needed(const SceneFacts& facts, const FrameRequest&) const { return needed_for_solid_surfaces(facts); }

Rasterize::Out Rasterize::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  std::vector<SpecConstant> constants = {{30, "SAMPLES", s.samples}};
  if (in.masks_by_sample && s.samples > 1) constants.push_back({32, "MASKS_BY_SAMPLE", 1});
  BufferDesc keys = keys_buffer(s);
  keys.zeroed = true;
  Out out;
  out.keys = in.keys ? in.keys : builder.create(keys);
  out.steps = declare_steps(builder, s, in.masks, in.deformed, out.keys, knobs, {}, std::move(constants));
  const PixelRect whole{0, 0, int(s.width_px), int(s.height_px)};
  out.part = builder.picture_parts() ? builder.picture_parts()->seen : whole;
  return out;
}

void Rasterize::record(CommandList& commands, const In& in, const Out& out) const {
  shared::RasterizePush push{};
  push.subsample_ndc = in.scene.subsample_ndc();
  push.subsample_footprint = in.scene.subsample_footprint;
  push.part_first = {out.part.x, out.part.y}, push.part_end = {out.part.end_x(), out.part.end_y()};
  record_step(commands, in.scene, in.masks, in.deformed, out.keys, out.steps, knobs, 1, push);
}

Need RasterizeViews::needed(const SceneFacts& facts, const FrameRequest& request) const {
  return Rasterize{}.needed(facts, request);
}

RasterizeViews::Out RasterizeViews::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.views.table, Access::compute_read, "the views");
  const ViewImage& image = *in.image;
  const uint64_t layers = std::max(image.layers, image.texel_layers);
  BufferDesc texels{"rasterize_views.texels", layers * image.size_px * image.size_px * 4};
  texels.zeroed = true;
  Out out;
  out.texels = builder.create(texels);
  if (image.apart) builder.read(in.scene.places, Access::compute_read, "where things are in the world");
  out.steps = declare_steps(builder, in.scene, in.masks, in.deformed, out.texels, knobs,
                            image.apart ? "#VIEWS=1#LAMPS=1" : "#VIEWS=1", {});
  const auto view = image.apart ? std::optional(ImageKind::d2_array) : std::nullopt;
  if (image.apart) {
    out.depth = builder.create(image_desc(image, float_format));
    // By a dispatch: an H200 clears an image of floats at 53 GB a second.
    out.clear = builder.pipeline(ComputePipelineDesc{"view_tiles.comp", {{0, "CLEARS", 1}}});
    builder.begin_step();
    out.cleared = out.depth = builder.write(out.depth, Access::storage_image_write, {}, view);
  }
  builder.begin_step();
  builder.read(out.texels, in.floats ? Access::compute_read : Access::transfer_source, "the views' depths");
  if (!image.apart) out.depth = builder.create(image_desc(image, in.floats ? float_format : depth_format));
  if (in.floats)
    out.store = builder.pipeline(ComputePipelineDesc{image.apart ? "view_tiles.comp" : "view_texels.comp", {}});
  out.depth =
      builder.write(out.depth, in.floats ? Access::storage_image_write : Access::transfer_destination, {}, view);
  if (image.in_parts) {
    out.store_over = builder.pipeline(ComputePipelineDesc{"view_tiles.comp", {{1, "OVER", 1}}});
    builder.begin_step();
    builder.read(out.texels, Access::compute_read, "the depths of what moves");
    out.depth = builder.write(out.depth, Access::storage_image_read_write, {}, view);
  }
  return out;
}

namespace {
// Views that are equally large follow one another. over: those that are drawn over others, or these.
void store_tiles(CommandList& commands, const RasterizeViews::In& in, const RasterizeViews::Out& out, bool over) {
  const ViewImage& image = *in.image;
  const uint32_t split = uint32_t(std::ranges::lower_bound(image.drawn, image.first_over()) - image.drawn.begin());
  const uint32_t last = over ? uint32_t(image.drawn.size()) : split;
  const auto size_of = [&](uint32_t drawn) { return image.views[image.drawn[drawn]].size_px.x; };
  shared::ViewTilesPush push{};
  push.texels = commands.address(out.texels);
  push.views = commands.address(in.views.table) + in.views.first * sizeof(shared::View);
  push.image_px = image.size_px;
  push.image = commands.storage(out.depth);
  commands.bind(over ? out.store_over : out.store);
  for (uint32_t first = over ? split : 0, end = first; first < last; first = end) {
    while (end < last && size_of(end) == size_of(first)) ++end;
    push.first_view = first, push.size_px = size_of(first);
    commands.push(push);
    commands.dispatch(push.size_px / 4, push.size_px, end - first);
  }
}
}  // namespace

void RasterizeViews::record(CommandList& commands, const In& in, const Out& out) const {
  if (in.views.drawn() == 0) return;
  if (in.image->apart && commands.step() == 3) {
    if (in.image->outlives) return;
    shared::ViewTilesPush push{};
    push.image = commands.storage(out.cleared);
    push.size_px = in.image->size_px;
    commands.bind(out.clear);
    commands.push(push);
    return commands.dispatch(push.size_px / 4, push.size_px, in.image->layers);
  }
  if (commands.step() >= 4) return store_tiles(commands, in, out, commands.step() == 5);
  if (commands.step() == 3) {
    if (!in.floats) return commands.copy_to_image(out.texels, out.depth);
    commands.bind(out.store);
    commands.push(shared::ViewTexelsPush{commands.address(out.texels), in.image->size_px, commands.storage(out.depth)});
    return commands.dispatch(in.image->size_px / 4, in.image->size_px, in.image->layers);
  }
  shared::RasterizePush push{};
  push.subsample_footprint = 1;
  push.views = commands.address(in.views.table) + in.views.first * sizeof(shared::View);
  push.view_masks = in.scene.cull_group_count * shared::cull_group_size;
  push.image_px = in.image->size_px;
  if (in.image->apart) push.places = commands.address(in.scene.places);
  record_step(commands, in.scene, in.masks, in.deformed, out.texels, out.steps, knobs, in.views.drawn(), push);
}

}  // namespace candela
