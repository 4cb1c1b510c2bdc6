#include "render/metadata.h"

#include "math/transforms.h"

namespace candela {
namespace {

// OpenEXR multiplies row vectors from the left, so its row-major matrix has the same 16 numbers as GLM's column-major
// one.
MetadataEntry matrix_entry(const char* name, const glm::dmat4& m) {
  MetadataEntry entry{.name = name, .kind = MetadataEntry::Kind::matrix44};
  for (int i = 0; i < 16; ++i) entry.matrix.push_back(float(m[i / 4][i % 4]));
  return entry;
}

}  // namespace

MetadataEntry text_entry(const char* name, std::string text) { return {.name = name, .text = std::move(text)}; }
MetadataEntry number_entry(const char* name, MetadataEntry::Kind kind, double number) {
  return {.name = name, .kind = kind, .number = number};
}

void add_view_metadata(FloatImage& image, const View& view, double time_s, std::optional<int64_t> frame_number,
                       FrameRate rate) {
  const glm::dmat4 relative = relative_from_world(view.position);
  // NDC as OpenEXR means it: (0,0) and (1,1) are the upper left and lower right corners. Clip space has y down already.
  glm::dmat4 ndc_from_clip(1.0);
  ndc_from_clip[0][0] = ndc_from_clip[1][1] = 0.5;
  ndc_from_clip[3][0] = ndc_from_clip[3][1] = 0.5;
  auto& metadata = image.metadata;
  metadata.push_back(matrix_entry("worldToCamera", view.view_from_relative * relative));
  metadata.push_back(matrix_entry("worldToNDC", ndc_from_clip * view.clip_from_relative * relative));
  metadata.push_back(text_entry("candela:camera", view.name));
  if (frame_number) {
    metadata.push_back(number_entry("framesPerSecond", MetadataEntry::Kind::number,
                                    double(rate.numerator) / double(rate.denominator)));
    metadata.push_back(text_entry("candela:frame", fmt::format("{}", *frame_number)));
    metadata.push_back(text_entry("candela:fps", rate.text()));
  }
  metadata.push_back(number_entry("candela:time", MetadataEntry::Kind::number, time_s));
}

}  // namespace candela
