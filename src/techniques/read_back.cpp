#include <algorithm>
#include <cmath>

#include "graph/formats.h"
#include "passes/post/pack.h"
#include "passes/post/readback.h"
#include "passes/shared/frame_request.h"
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// Depths, counts, ids and pixels.
bool is_exact(const std::string& layer) {
  const LayerForm form = layer_form(layer);
  return form == LayerForm::distance || form == LayerForm::motion || form == LayerForm::matte ||
         layer.starts_with("heatmap_");
}

uint32_t components_of(const std::string& layer, VkFormat format) {
  if (layer == "beauty" || layer == "display" || layer_form(layer) == LayerForm::matte) return 4;
  return std::min(format_channels(format), 3u);
}

Packing packing_of(const FrameRequest& request, const FrameOutput& output) {
  if (!request.for_files || output.format == VK_FORMAT_R32_UINT) return Packing::texels;
  if (output.layer == "display") return request.display_alpha() ? Packing::texels : Packing::rgb;
  const bool exact = request.exr_float || output.exact || request.shown_alone(output.layer);
  return exact ? Packing::float_planes : Packing::half_planes;
}

// What is read back or looked at, in the order in which outputs are told.
struct Wanted {
  FrameOutput output;
  ImageHandle image;
  bool stored = true;
};

}  // namespace

void read_back(Frame& frame, const SceneInputs& scene, ImageHandle beauty, ImageHandle display) {
  const FrameRequest& request = frame.request;
  std::vector<Wanted> wanted;
  const auto want = [&](const std::string& layer, ImageHandle image, bool stored) {
    if (!image) return;
    FrameOutput output{layer};
    output.part = uint32_t(std::ranges::count(wanted, layer, [](const Wanted& w) { return w.output.layer; }));
    output.format = std::get<ImageDesc>(frame.builder.resources()[size_t(image.resource)].desc).format;
    output.exact = is_exact(layer);
    output.components = components_of(layer, output.format);
    output.carries_exposure = layer != "display" && layer_form(layer) == LayerForm::light;
    output.packing = packing_of(request, output);
    wanted.push_back({output, image, stored});
  };
  if (request.want_linear || request.look_nonfinite) want("beauty", beauty, request.want_linear);
  want("display", display, true);
  for (const auto& [layer, image] : frame.builder.published())
    if (request.has_layer(layer) && !(request.view_is_light && request.shown_alone(layer))) want(layer, image, true);

  const PixelRect part = request.region.value_or(PixelRect{0, 0, int(scene.width_px), int(scene.height_px)});
  Pack::In packed{{}, uint32_t(part.width), uint32_t(part.height), {part.x, part.y}};
  Readback::In copied{{}, request.region};
  for (Wanted& each : wanted) {
    FrameOutput& output = each.output;
    const std::string name =
        layer_form(output.layer) == LayerForm::matte ? fmt::format("{}{:02}", output.layer, output.part) : output.layer;
    if (output.packing == Packing::texels) {
      const uint64_t bytes = uint64_t(part.width) * uint64_t(part.height) * format_bytes(output.format);
      copied.sources.push_back({name, each.image, bytes});
      continue;
    }
    Pack::In::Source source{name, each.image, output.format};
    if (each.stored) source.packing = output.packing;
    source.components = output.components;
    if (output.carries_exposure) source.scale = Live<float>::of(frame.values.stored_scale);
    source.look = request.look_nonfinite && output.layer != "display";
    source.cover = output.layer == "beauty" && request.shows_through;
    source.depth = output.layer == "depth";
    output.counts = int(packed.sources.size());
    packed.sources.push_back(std::move(source));
  }
  std::vector<BufferHandle> packs, copies;
  if (!packed.sources.empty() || !request.for_files) {
    const Pack::Out out = frame.add(Pack{}, packed);
    packs = out.buffers;
    frame.counts = out.counts.resource;
  } else {
    frame.builder.leave_out(std::string(Pack::name), "no picture has to be packed");
  }
  if (!copied.sources.empty())
    copies = frame.add(Readback{}, copied).buffers;
  else
    frame.builder.leave_out(std::string(Readback::name), "files hold nothing as it lies in images");
  size_t next_copy = 0;
  for (Wanted& each : wanted) {
    FrameOutput& output = each.output;
    if (output.packing == Packing::texels)
      output.resource = copies[next_copy++].resource;
    else if (each.stored)
      output.resource = packs[size_t(output.counts)].resource;
    frame.outputs.push_back(std::move(output));
  }
}

}  // namespace candela
