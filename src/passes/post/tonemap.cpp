#include "passes/post/tonemap.h"

#include "shared/draw.h"

namespace candela {

std::span<const std::string_view> tone_curve_names() {
  static constexpr std::string_view names[] = {"none",   "agx",     "reinhard", "aces", "neutral", "reinhard-luminance",
                                               "rec709", "agx-2020"};
  return names;
}

Need Tonemap::needed(const SceneFacts&, const FrameRequest& request) const {
  if (!request.want_display) return {false, "no display output (PNG, video) is wanted"};
  return needed_if(request.view_is_light, "display output shows what is no light (--view)");
}

Tonemap::Out Tonemap::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.color, Access::sampled_compute, "color");
  Out out;
  const VkFormat format = in.bits == 8 ? VK_FORMAT_R8G8B8A8_UNORM : VK_FORMAT_R16G16B16A16_UNORM;
  out.display = builder.write(builder.create(ImageDesc{"display", format, in.width_px, in.height_px}),
                              Access::storage_image_write);
  std::vector<SpecConstant> constants = {{0, "CURVE", uint32_t(in.curve)}};
  if (builder.read_optional(in.automatic, Access::compute_read)) constants.push_back({1, "AUTOMATIC", 1});
  if (in.covers) constants.push_back({2, "COVERS", 1});
  if (in.behind_rgb && !in.covers) constants.push_back({4, "BEHIND", 1u << 24 | *in.behind_rgb});
  if (in.samples > 1) constants.push_back({3, "SAMPLES", in.samples});
  out.pipeline = builder.pipeline(ComputePipelineDesc{"tonemap.comp", std::move(constants)});
  return out;
}

void Tonemap::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::TonemapPush push{};
  push.source = commands.sampled(in.color);
  push.target = commands.storage(out.display);
  push.size_px = {in.width_px, in.height_px};
  push.exposure = *in.exposure;
  push.dither_levels = in.dither && in.bits == 8 ? 255u : 0u;
  push.seed = *in.seed;
  if (in.automatic) push.automatic = commands.address(in.automatic);
  push.agx_min_ev = *in.agx_min_ev, push.agx_max_ev = *in.agx_max_ev;
  commands.push(push);
  commands.dispatch_picture(in.width_px, in.height_px);
}

}  // namespace candela
