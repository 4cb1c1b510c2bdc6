#include "render/frame_layers.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "image/half.h"
#include "render/cryptomatte.h"

namespace candela {
namespace {

// Component c of pixel i of a float or half image.
struct FloatReader {
  const std::byte* bytes;
  int components;
  bool half;
  float operator()(size_t i, int c) const {
    const size_t at = i * size_t(components) + size_t(c);
    if (!half) {
      float value;
      std::memcpy(&value, bytes + at * 4, 4);
      return value;
    }
    uint16_t value;
    std::memcpy(&value, bytes + at * 2, 2);
    return half_to_float(value);
  }
};

FloatReader reader_of(const FrameOutput& output, const std::byte* bytes) {
  switch (output.format) {
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return {bytes, 4, false};
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return {bytes, 4, true};
    case VK_FORMAT_R32G32_SFLOAT:
      return {bytes, 2, false};
    case VK_FORMAT_R32_SFLOAT:
      return {bytes, 1, false};
    default:
      CHECK_MSG(false, "the layer " + output.layer + " has a format that no file can hold");
      return {};
  }
}

void count_nonfinite(const FrameResult& frame, const std::string& layer, size_t pixel, NonFinite& nonfinite) {
  if (nonfinite.count++ == 0) {
    nonfinite.x = int(pixel % size_t(frame.width_px));
    nonfinite.y = int(pixel / size_t(frame.width_px));
    nonfinite.layer = layer;
  }
}

// As the device packed it, in planes.
void add_packed_layer(FloatImage& image, const FrameResult& frame, const FrameOutput& output) {
  const PackLayout layout = layout_of(frame, output);
  const std::byte* bytes = readback_bytes(frame, output).data();
  const bool half = output.packing == Packing::half_planes;
  const std::vector<std::string> names = channel_names(output);
  for (size_t c = 0; c < names.size(); ++c) {
    Channel& channel = image.channels.emplace_back();
    channel.name = names[c];
    channel.type = half ? ChannelType::half : ChannelType::float32;
    channel.f.reserve(size_t(image.width) * size_t(image.height));
    for (size_t y = 0; y < size_t(image.height); ++y) {
      const FloatReader read{bytes + c * layout.plane_bytes + y * layout.row_bytes, 1, half};
      for (size_t x = 0; x < size_t(image.width); ++x) channel.f.push_back(read(x, 0));
    }
  }
}

}  // namespace

PackLayout layout_of(const FrameResult& frame, const FrameOutput& output) {
  return pack_layout(output.packing, output.format, output.components, uint32_t(frame.width_px),
                     uint32_t(frame.height_px));
}

std::span<const std::byte> readback_bytes(const FrameResult& frame, const FrameOutput& output) {
  const auto found = frame.readbacks.find(output.resource);
  CHECK_MSG(found != frame.readbacks.end(), output.layer);
  const std::span<const std::byte> bytes = found->second->bytes();
  CHECK_MSG(bytes.size() >= layout_of(frame, output).bytes, output.layer);
  return bytes;
}

std::vector<std::string> channel_names(const FrameOutput& output) {
  const std::string& layer = output.layer;
  if (layer == "beauty") return {"R", "G", "B", "A"};
  if (is_cryptomatte(layer)) return matte_channels(layer, output.part);
  if (layer == "depth") return {"depth.Z"};
  if (output.format == VK_FORMAT_R32_SFLOAT) return {layer + ".Y"};
  if (output.format == VK_FORMAT_R32_UINT) return {layer + ".X"};
  if (layer == "motion") return {"motion.X", "motion.Y"};
  if (layer == "normal") return {"normal.X", "normal.Y", "normal.Z"};
  return {layer + ".R", layer + ".G", layer + ".B"};
}

void add_id_layer(FloatImage& image, const FrameOutput& output, std::span<const std::byte> bytes) {
  Channel& channel = image.channels.emplace_back();
  channel.name = channel_names(output).front();
  channel.type = ChannelType::uint32;
  channel.u.resize(size_t(image.width) * size_t(image.height));
  std::memcpy(channel.u.data(), bytes.data(), channel.u.size() * 4);
}

void add_depth_layer(FloatImage& image, const FrameResult& frame, const FrameOutput& output, NonFinite& nonfinite) {
  const FloatReader read = reader_of(output, readback_bytes(frame, output).data());
  Channel& channel = image.channels.emplace_back();
  channel.name = "depth.Z";
  channel.f.resize(size_t(image.width) * size_t(image.height));
  for (size_t i = 0; i < channel.f.size(); ++i) {
    const float z = read(i, 0);
    if (std::isnan(z)) count_nonfinite(frame, output.layer, i, nonfinite);
    channel.f[i] = z >= background_depth_m ? background_depth_m : z;  // the background is at infinity
  }
}

void add_color_layer(FloatImage& image, const FrameResult& frame, const FrameOutput& output, bool as_float,
                     NonFinite& nonfinite) {
  const FloatReader read = reader_of(output, readback_bytes(frame, output).data());
  const std::vector<std::string> names = channel_names(output);
  const size_t first = image.channels.size(), count = size_t(image.width) * size_t(image.height);
  for (const std::string& name : names) {
    Channel& channel = image.channels.emplace_back();
    channel.name = name;
    channel.type = as_float ? ChannelType::float32 : ChannelType::half;
    channel.f.resize(count);
  }
  const float scale = output.carries_exposure ? float(1.0 / frame.pre_exposure) : 1.0f;
  std::array<float*, 4> planes{};
  for (size_t c = 0; c < names.size(); ++c) planes[c] = image.channels[first + c].f.data();
  const size_t components = names.size();
  const float most = as_float ? std::numeric_limits<float>::max() : 65504;
  for (size_t i = 0; i < count; ++i) {
    bool finite = true;
    for (size_t c = 0; c < components; ++c) {
      const float value = read(i, int(c));
      finite = finite && std::isfinite(value);
      const float stored = c == 3 ? value : value * scale;  // alpha carries no light
      planes[c][i] = stored;
      if (std::abs(stored) > most && std::isfinite(stored)) ++nonfinite.clamped;
    }
    if (!finite) count_nonfinite(frame, output.layer, i, nonfinite);
  }
}

FloatImage layer_image(const FrameResult& frame, const FrameOutput& output) {
  FloatImage image;
  image.width = frame.width_px;
  image.height = frame.height_px;
  NonFinite ignored;
  if (output.format == VK_FORMAT_R32_UINT)
    add_id_layer(image, output, readback_bytes(frame, output));
  else if (output.packing == Packing::texels && output.layer == "depth")
    add_depth_layer(image, frame, output, ignored);
  else if (output.packing == Packing::texels)
    add_color_layer(image, frame, output, true, ignored);
  else
    add_packed_layer(image, frame, output);
  return image;
}

}  // namespace candela
