#include "render/step_pictures.h"

#include <algorithm>
#include <cmath>

#include "base/names.h"
#include "graph/formats.h"
#include "image/io.h"
#include "job/job_look.h"
#include "passes/shared/pass.h"
#include "reference/display.h"
#include "render/count_view.h"
#include "render/dump.h"
#include "render/frame_layers.h"
#include "render/frame_names.h"
#include "render/view_picture.h"

namespace candela {
namespace {

constexpr int most_px = 960, least_px = 160;  // of a file's longer side

struct Shown {
  DisplayImage picture;
  std::string how;
};

// Every so many texels, or each texel as a square.
DisplayImage fitted(const DisplayImage& image) {
  const int longer = std::max(image.width, image.height);
  if (longer <= most_px && longer >= least_px) return image;
  const double scale = longer > most_px ? double(most_px) / longer : std::ceil(double(least_px) / longer);
  DisplayImage out{.width = std::max(1, int(image.width * scale)), .height = std::max(1, int(image.height * scale))};
  out.channels = image.channels, out.bits = image.bits;
  out.pixels.resize(row_bytes(out) * size_t(out.height));
  const size_t pixel = size_t(image.channels) * size_t(image.bits / 8);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const size_t from_x = size_t(x) * size_t(image.width) / size_t(out.width),
                   from_y = size_t(y) * size_t(image.height) / size_t(out.height);
      std::copy_n(&image.pixels[from_y * row_bytes(image) + from_x * pixel], pixel,
                  &out.pixels[size_t(y) * row_bytes(out) + size_t(x) * pixel]);
    }
  return out;
}

// Reversed depth of the camera in metres along its axis.
Shown depth(FloatImage image, const View& view) {
  Channel& z = image.channels.front();
  for (float& value : z.f) {
    const double d = double(value);
    const double metres = view.perspective ? view.near_m / d : view.far_m - d * (view.far_m - view.near_m);
    value = d > 0 && metres < background_depth_m ? float(metres) : background_depth_m;
  }
  return {layer_view(image, LayerForm::distance, "depth"), "metres along the view axis"};
}

Shown light(const FloatImage& image, const FrameResult& frame, const Job& job) {
  const DisplayLook look = display_look(job, frame.request.look);
  const reference::DisplaySettings display{.curve = look.curve,
                                           .exposure_ev = look.exposure_ev,
                                           .agx_min_ev = look.agx_min_ev,
                                           .agx_max_ev = look.agx_max_ev,
                                           .dither = false};
  std::vector<glm::dvec4> pixels(image.channels.front().f.size(), glm::dvec4(1));
  for (size_t i = 0; i < pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const double value = double(image.channels[c].f[i]) / frame.pre_exposure;
      pixels[i][int(c)] = std::isfinite(value) ? value : 0;
    }
  return {reference::display_image(pixels, image.width, display),
          fmt::format("light, through exposure and the curve {}", look.curve)};
}

Shown shown(const FrameDump& dump, const FloatImage& image, const FrameResult& frame, const Job& job) {
  const ImageDesc& desc = dump.image;
  const bool of_picture =
      int(desc.width_px) == frame.request.width_px && int(desc.height_px) == frame.request.height_px;
  const bool metres = image.channels.size() == 1 && desc.name == "layers.depth";
  const bool counts = desc.name.find("heat") != std::string::npos;
  if (is_depth_format(desc.format) && of_picture && desc.layers == 1) return depth(image, frame.view);
  if (metres) return {layer_view(image, LayerForm::distance, desc.name), "metres along the view axis"};
  if (counts && image.channels.size() == 1 && image.channels.front().type != ChannelType::uint32)
    return {count_view(image.channels.front().f, image.width, image.height, count_title("heatmap_lights")),
            "counts, with a scale"};
  if (image.channels.front().type == ChannelType::uint32)
    return {image_view(image, image.width, image.height, desc.name), "a colour for each number"};
  if (image.channels.size() >= 3 && format_name(desc.format).ends_with("SFLOAT")) return light(image, frame, job);
  if (image.channels.size() >= 3) return {layer_view(image, LayerForm::fraction, desc.name), "values from 0 to 1"};
  FloatImage first = image;
  first.channels.resize(1);
  return {image_view(first, image.width, image.height, desc.name), "the first channel, from its least to its largest"};
}

std::string part_of(const FrameDump& dump) {
  std::string part;
  if (dump.image.mips > 1) part = fmt::format("mip {}", dump.request.mip);
  const bool volume = dump.image.kind == ImageKind::d3;
  if (volume || dump.image.layers > 1)
    part += fmt::format("{}{} {} of {}", part.empty() ? "" : ", ", volume ? "slice" : "layer", dump.request.layer,
                        volume ? dump.image.depth_px : dump.image.layers);
  return part;
}

}  // namespace

Expected<std::vector<StepPicture>> write_step_pictures(const FrameResult& frame, const Job& job,
                                                       const std::filesystem::path& folder) {
  std::vector<StepPicture> pictures;
  for (size_t i = 0; i < frame.dumps.size(); ++i) {
    const FrameDump& dump = frame.dumps[i];
    const FloatImage image = dump_image(dump, frame.readbacks.at(dump.resource)->bytes());
    const Shown made = shown(dump, image, frame, job);
    const DisplayImage file = fitted(made.picture);
    StepPicture picture{dump.pass, dump.image.name, part_of(dump), {}, made.how, file.width, file.height};
    const std::string name = file_name_parts({fmt::format("{}.{}", dump.pass, dump.image.name)}).front();
    picture.file = fmt::format("{:03}_{}.png", i + 1, name);
    if (auto written = write_png(folder / picture.file, file); !written) return std::unexpected(written.error());
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace candela
