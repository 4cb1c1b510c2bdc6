#include "passes/post/subframes.h"

#include "passes/surfaces/terms.h"
#include "passes/volumes/fog_layers.h"
#include "passes/volumes/volumetric.h"
#include "techniques/technique.h"

namespace candela {
namespace {

BufferDesc sum_desc(const SubframePart& part, std::string_view prefix, const std::string& name) {
  return {std::string(prefix) + name, uint64_t(part.width_px) * uint64_t(part.height_px) * sizeof(glm::vec4)};
}

}  // namespace

void add_to_sum(Frame& frame, const SceneInputs&, const std::string& name, ImageHandle image) {
  const SubframePart& part = frame.request.part;
  Subframes::In in{image};
  in.before = frame.builder.import_buffer(sum_desc(part, sum_before, name));
  in.sum = frame.builder.import_buffer(sum_desc(part, sum_after, name), GraphBuilder::Import::to_fill);
  in.first_px = part.first_px;
  in.width_px = uint32_t(part.width_px), in.height_px = uint32_t(part.height_px);
  in.index = Live<uint32_t>::of(frame.values.subframe), in.count = part.count;
  frame.builder.sink(frame.add(Subframes{}, in, name == "beauty" ? "" : name).sum);
}

ImageHandle mean_of(Frame& frame, const SceneInputs&, const std::string& name) {
  const SubframePart& part = frame.request.part;
  const BufferHandle sum = frame.builder.import_buffer(sum_desc(part, sum_before, name));
  return frame
      .add(SubframesMean{}, {sum, uint32_t(part.width_px), uint32_t(part.height_px)}, name == "beauty" ? "" : name)
      .color;
}

bool is_summed(std::string_view layer) {
  const auto among = [&](const auto& layers) {
    return std::ranges::find(layers, layer, &LayerName::name) != std::end(layers);
  };
  return among(Terms::layers) || among(FogLayers::layers) || among(VolumetricLight::layers);
}

}  // namespace candela
