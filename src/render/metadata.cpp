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

std::string time_code(int64_t frame, FrameRate rate) {
  const int64_t nominal = (rate.numerator + rate.denominator - 1) / rate.denominator;
  constexpr int64_t most_per_s = 30, day_s = 24 * 60 * 60;  // the two digits of SMPTE ST 12-1
  if (frame < 0 || nominal > most_per_s || frame >= nominal * day_s) return {};
  const int64_t s = frame / nominal;
  return fmt::format("{:02}:{:02}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60, frame % nominal);
}

Job without_folders(const Job& job) {
  Job plain = job;
  const auto file_name = [](std::string& file) {
    if (const std::filesystem::path path = file; path.is_absolute()) file = path.filename().string();
  };
  file_name(plain.scene), file_name(plain.sky), file_name(plain.look);
  for (PathRequest& path : plain.paths) file_name(path.points), file_name(path.times);
  for (InstancesRequest& instances : plain.instances) file_name(instances.file);
  return plain;
}

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
    metadata.push_back(
        number_entry("captureRate", MetadataEntry::Kind::number, double(rate.numerator) / double(rate.denominator)));
    if (const std::string code = time_code(*frame_number, rate); !code.empty())
      metadata.push_back(text_entry("timeCode", code));
    metadata.push_back(text_entry("candela:frame", fmt::format("{}", *frame_number)));
    metadata.push_back(text_entry("candela:fps", rate.text()));
  }
  metadata.push_back(number_entry("candela:time", MetadataEntry::Kind::number, time_s));
}

}  // namespace candela
