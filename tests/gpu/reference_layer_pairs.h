#pragma once
// The layers beside beauty, from the GPU and from the reference: one sample at the centre of each pixel.
#include "reference_parity.h"
#include "render/outputs.h"
#include "render/reference_layers.h"

namespace candela::test {

struct LayerPair {
  FloatImage gpu, reference;
  int w() const { return reference.width; }
  int h() const { return reference.height; }
  const std::vector<uint32_t>& ids(const FloatImage& image, const char* layer) const { return image.find(layer)->u; }
};

class ReferenceLayerPairs : public ReferenceParity {
 protected:
  static LayerPair layers_of(Job job, double time_s, std::vector<std::string> layers) {
    job.exr_float = true;
    job.layers = std::move(layers);
    LayerPair out;
    const auto session = open(job);
    const auto reference = open_reference(job, time_s, {});
    EXPECT_TRUE(session && reference);
    if (!session || !reference) return out;
    EXPECT_TRUE(add_time_before(**reference, job, job.layers));
    NonFinite nonfinite;
    out.gpu = linear_image(render(*session, time_s), job, *session, std::nullopt, {}, nonfinite);
    out.reference = reference_image(reference::Film(job.width_px, job.height_px), **reference, job, "{}", job.layers,
                                    std::nullopt, {});
    return out;
  }
};

}  // namespace candela::test
