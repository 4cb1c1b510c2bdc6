#include "passes/surfaces/shade_visible.h"

#include "passes/shared/draw_batches.h"
#include "passes/shared/features.h"

namespace candela {

Need ShadeVisible::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_for_solid_surfaces(facts);
}

namespace {
// Whether the pixels of a workgroup share the work on all triangles but their first: with four samples that takes
// 15,364 bytes of shared memory, of which every device has 16,384, and with more it takes more.
bool shares_triangles(const SceneInputs& s) { return s.samples > 1 && s.samples <= 4; }
}  // namespace

ShadeVisible::Out ShadeVisible::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  declare_keyed_surfaces(builder, s, in.keys, in.deformed);
  declare_lights(builder, s, in.lists, ReadBy::compute());
  declare_fog(builder, s, in.lists, true, ReadBy::compute());
  const auto pipeline = [&](const Lighting& lists, std::string_view store) {
    ComputePipelineDesc desc{with_shadow_colors(with_fog("shade_visible.comp", lists), lists.shadow_colors),
                             light_constants(lists)};
    desc.constants.insert(desc.constants.end(), s.features.begin(), s.features.end());
    desc.constants.push_back({30, "SAMPLES", s.samples});
    desc.shader += surface_definitions(desc.constants);
    if (in.draws_sky) desc.shader += "#SKY=1";
    desc.shader += store;
    return desc;
  };
  Out out;
  std::string store;
  if (in.whole) {
    store = "#WHOLE=1";
    out.color = builder.write(builder.create(ImageDesc{"color", color_format, s.width_px, s.height_px}),
                              Access::storage_image_write);
  } else {
    out.samples = declare_sample_store(builder, s, name, store);
  }
  if (!in.lists.records.words) {
    if (shares_triangles(s)) store += fmt::format("#SHARED={}", s.samples);
    out.pipeline = builder.pipeline(pipeline(in.lists, store));
    return out;
  }
  Lighting recorded = in.lists, without = in.lists;
  recorded.records.suffice = true, without.records = {};
  out.pipeline = builder.pipeline(pipeline(recorded, store + "#LIGHT_RECORDS=1"));
  if (!in.lists.records.suffice) out.rest = builder.pipeline(pipeline(without, store + "#WITHOUT_RECORDS=1"));
  return out;
}

void ShadeVisible::record(CommandList& commands, const In& in, const Out& out) const {
  OwnInputs own;
  own.table = in.keys;
  if (in.whole)
    own.number = commands.storage(out.color);
  else
    push_sample_store(commands, out.samples, own);
  for (const PipelineHandle pipeline : {out.pipeline, out.rest}) {
    if (!pipeline) continue;
    commands.bind(pipeline);
    commands.push(draw_push(commands, in.scene, in.deformed, &in.lists, &in.lists, own));
    commands.dispatch_picture(in.scene.width_px, in.scene.height_px);
  }
}

}  // namespace candela
