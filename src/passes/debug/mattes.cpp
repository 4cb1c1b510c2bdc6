#include "passes/debug/mattes.h"

#include "shared/mattes.h"

namespace candela {
namespace {

Need wanted(Matte matte, const FrameRequest& request) {
  const std::string_view layer = matte_layers[size_t(matte)].name;
  return needed_if(request.has_layer(layer), fmt::format("the layer {} is not wanted (--layers)", layer));
}

// "object" of "crypto_object".
std::string_view short_name(Matte matte) {
  const std::string_view layer = matte_layers[size_t(matte)].name;
  return layer.substr(layer.find('_') + 1);
}

// The images of the graph's ids: which layer this picture draws into.
ImageRange range_of(const SceneInputs& scene) { return ImageRange::layer(scene.supersample); }

}  // namespace

Need MatteIds::needed(const SceneFacts&, const FrameRequest& request) const { return wanted(matte, request); }

MatteIds::Out MatteIds::declare(GraphBuilder& builder, const In& in) const {
  const bool objects = matte == Matte::object;
  builder.read(objects ? in.scene.object_mattes : in.scene.material_mattes, Access::vertex_read, "ids of names");
  const bool tested = builder.read_optional(in.depth, Access::depth_test);
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = objects ? "matte_ids.vert" : "matte_ids.vert#MATERIALS=1";
  choice.desc.fragment_shader = "matte_ids.frag";
  choice.desc.color_formats = {VK_FORMAT_R32_SFLOAT};
  choice.desc.depth_format = tested ? depth_format : VK_FORMAT_UNDEFINED;
  choice.desc.samples = in.scene.samples;
  choice.desc.depth_test = tested;
  choice.desc.depth_compare = VK_COMPARE_OP_EQUAL;
  Out out;
  out.pipelines = declare_batches(
      builder, in.scene, in.draws, in.deformed, [](const DrawBatch& r) { return r.alpha != AlphaMode::blend; }, choice);
  ImageHandle ids = in.ids;
  if (!ids) {
    ImageDesc desc{fmt::format("mattes.{}.ids", short_name(matte)), VK_FORMAT_R32_SFLOAT, in.scene.width_px,
                   in.scene.height_px, in.scene.samples};
    desc.layers = in.scene.subsamples;
    if (in.scene.samples == 1) desc.kind = ImageKind::d2_array;
    ids = builder.create(desc);
  }
  out.ids = builder.write(ids, Access::color_attachment, range_of(in.scene));
  return out;
}

void MatteIds::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment ids{out.ids, {}, range_of(in.scene)};
  commands.begin_picture(std::span(&ids, 1), in.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.pipelines, nullptr, nullptr,
                 {matte == Matte::object ? in.scene.object_mattes : in.scene.material_mattes, {}});
  commands.end_rendering();
}

std::span<const Knob> MatteRanks::Knobs::table() {
  static const Knob table[] = {
      {.name = "ranks",
       .member = &Knobs::ranks,
       .lowest = 1,
       .highest = 64,
       .levels = {6, 6, 6, 64},
       .description =
           "ids a pixel of Cryptomatte layers, at most one a sample: 8 bytes a pixel each against ids that are lost",
       .sweep = {2, 4, 6, 64}},
  };
  return table;
}

std::vector<std::string> MatteRanks::warnings(const Report& report) const {
  if (report.pixels == 0) return {};
  return {
      fmt::format("{}: {} pixels hold more ids than its {} ranks, up to {}; the least of them are LOST (--set "
                  "cryptomatte.ranks={} keeps all)",
                  matte_layers[size_t(matte)].name, report.pixels, knobs.ranks, report.most, report.most)};
}

Need MatteRanks::needed(const SceneFacts&, const FrameRequest& request) const { return wanted(matte, request); }

MatteRanks::Out MatteRanks::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  if (ranks(in) < in.samples) {
    const std::string name = fmt::format("mattes.{}.lost", short_name(matte));
    out.report = builder.write(builder.create(BufferDesc{name, sizeof(Report), BufferMemory::host_read, true}),
                               Access::compute_write);
    builder.sink(out.report);
  }
  ComputePipelineDesc desc{in.multisampled ? "matte_ranks.comp#MULTISAMPLED=1" : "matte_ranks.comp",
                           {{0, "SAMPLES", in.samples}}};
  out.pipeline = builder.pipeline(desc);
  const uint32_t levels = (ranks(in) + 1) / 2;
  for (uint32_t level = 0; level < levels; ++level) {
    if (level % MATTE_LEVELS_A_STEP == 0) {
      builder.begin_step();
      builder.read(in.ids, Access::sampled_compute, "ids at the samples", {},
                   in.multisampled ? std::optional<ImageKind>{} : ImageKind::d2_array);
    }
    const std::string name = fmt::format("mattes.{}.{:02}", short_name(matte), level);
    out.levels.push_back(
        builder.write(builder.create(ImageDesc{name, VK_FORMAT_R32G32B32A32_SFLOAT, in.width_px, in.height_px}),
                      Access::storage_image_write));
    builder.publish(std::string(matte_layers[size_t(matte)].name), out.levels.back());
  }
  return out;
}

void MatteRanks::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  const uint32_t first = commands.step() * MATTE_LEVELS_A_STEP;
  shared::MatteRanksPush push{};
  push.report = out.report && first == 0 ? commands.address(out.report) : 0;
  push.size_px = {in.width_px, in.height_px};
  push.source = commands.sampled(in.ids);
  push.first_rank = 2 * first;
  push.ranks = ranks(in);
  for (uint32_t i = 0; i < MATTE_LEVELS_A_STEP && first + i < out.levels.size(); ++i)
    push.targets[i] = commands.storage(out.levels[first + i]);
  commands.push(push);
  commands.dispatch_picture(in.width_px, in.height_px);
}

}  // namespace candela
