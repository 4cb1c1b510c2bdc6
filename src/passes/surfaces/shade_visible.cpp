#include "passes/surfaces/shade_visible.h"

#include "passes/geometry/draw_runs.h"
#include "passes/geometry/features.h"

namespace candela {

Need ShadeVisible::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_for_solid_surfaces(facts);
}

ShadeVisible::Out ShadeVisible::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {s.vertices, s.indices, s.items, s.transforms, s.geometries, s.materials, s.batches})
    builder.read(b, Access::compute_read, "the scene");
  builder.read(in.keys, Access::compute_read, "keys");
  builder.read_optional(s.lobes, Access::compute_read);
  builder.read_optional(in.deformed, Access::compute_read);
  declare_lights(builder, s, in.lists, ReadBy::compute());
  declare_fog(builder, s, in.lists, true, ReadBy::compute());
  ComputePipelineDesc desc{with_shadow_colors(with_fog("shade_visible.comp", in.lists), in.lists.shadow_colors),
                           light_constants(in.lists)};
  desc.constants.insert(desc.constants.end(), s.features.begin(), s.features.end());
  desc.constants.push_back({30, "SAMPLES", s.samples});
  desc.shader += surface_definitions(desc.constants);
  Out out;
  if (in.whole) {
    desc.shader += "#WHOLE=1";
    if (in.draws_sky) desc.shader += "#SKY=1";
    out.color = builder.write(builder.create(ImageDesc{"color", color_format, s.width_px, s.height_px}),
                              Access::storage_image_write);
  } else {
    const uint64_t samples = uint64_t(s.width_px) * s.height_px * s.samples;
    out.samples =
        builder.write(builder.create(BufferDesc{"shade_visible.samples", samples * 16}), Access::compute_write);
  }
  out.pipeline = builder.pipeline(desc);
  return out;
}

void ShadeVisible::record(CommandList& commands, const In& in, const Out& out) const {
  OwnInputs own;
  own.table = in.keys;
  own.deformed_before = out.samples;
  if (in.whole) own.number = commands.storage(out.color);
  commands.bind(out.pipeline);
  commands.push(draw_push(commands, in.scene, in.deformed, &in.lists, &in.lists, own));
  commands.dispatch(in.scene.width_px, in.scene.height_px);
}

PutSamples::Out PutSamples::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.samples, Access::fragment_read, "the shaded samples");
  GraphicsPipelineDesc desc = samples_pipeline("put_samples.frag", in.scene.samples);
  desc.color_formats = {color_format};
  Out out;
  out.pipeline = builder.pipeline(desc);
  out.color = write_color(builder, in.scene, {});
  return out;
}

void PutSamples::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_rendering({&color, 1}, {});
  record_samples(commands, out.pipeline, in.samples, {in.scene.width_px, in.scene.height_px}, in.scene.samples);
  commands.end_rendering();
}

}  // namespace candela
