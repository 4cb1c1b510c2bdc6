#include "render/outputs.h"

#include <array>
#include <cstring>
#include <deque>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/files.h"
#include "frame/timings.h"
#include "image/exr.h"
#include "image/png_text.h"
#include "image/prepare.h"
#include "passes/surfaces/terms.h"
#include "render/count_view.h"
#include "render/cryptomatte.h"
#include "render/frame_names.h"
#include "render/id_names.h"
#include "render/metadata.h"
#include "render/prepare_outputs.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

// What Blender and Nuke's readers take for "nothing here"; infinity breaks filters that blend depths.
constexpr float background_depth_m = 1e10f;

float half_to_float(uint16_t h) {
  const uint32_t sign = uint32_t(h >> 15) << 31, exponent = (h >> 10) & 31, mantissa = h & 1023;
  if (exponent == 0) return (sign ? -1.0f : 1.0f) * std::ldexp(float(mantissa), -24);
  const uint32_t bits =
      exponent == 31 ? sign | 0x7f800000u | mantissa << 13 : sign | (exponent + 112) << 23 | mantissa << 13;
  return std::bit_cast<float>(bits);
}

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

FloatReader reader_of(const OutputImage& output, const std::byte* bytes) {
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

PackLayout layout_of(const FrameResult& frame, const OutputImage& output) {
  return pack_layout(output.packing, output.format, output.components, uint32_t(frame.width_px),
                     uint32_t(frame.height_px));
}

std::span<const std::byte> readback_bytes(const FrameResult& frame, const OutputImage& output) {
  const auto found = frame.readbacks.find(output.resource);
  CHECK_MSG(found != frame.readbacks.end(), output.layer);
  const std::span<const std::byte> bytes = found->second->bytes();
  CHECK_MSG(bytes.size() >= layout_of(frame, output).bytes, output.layer);
  return bytes;
}

void count_nonfinite(const FrameResult& frame, const std::string& layer, size_t pixel, NonFinite& nonfinite) {
  if (nonfinite.count++ == 0) {
    nonfinite.x = int(pixel % size_t(frame.width_px));
    nonfinite.y = int(pixel / size_t(frame.width_px));
    nonfinite.layer = layer;
  }
}

std::vector<std::string> channel_names(const OutputImage& output) {
  const std::string& layer = output.layer;
  if (layer == "beauty") return {"R", "G", "B", "A"};
  if (is_cryptomatte(layer)) return matte_channels(layer, output.part);
  if (layer == "depth") return {"depth.Z"};
  if (output.format == VK_FORMAT_R32_SFLOAT) return {layer + ".Y"};
  if (layer == "motion") return {"motion.X", "motion.Y"};
  if (layer == "normal") return {"normal.X", "normal.Y", "normal.Z"};
  return {layer + ".R", layer + ".G", layer + ".B"};
}

void add_id_layer(FloatImage& image, const OutputImage& output, std::span<const std::byte> bytes) {
  Channel& channel = image.channels.emplace_back();
  channel.name = output.layer;
  channel.type = ChannelType::uint32;
  channel.u.resize(size_t(image.width) * size_t(image.height));
  std::memcpy(channel.u.data(), bytes.data(), channel.u.size() * 4);
}

void add_depth_layer(FloatImage& image, const FrameResult& frame, const OutputImage& output, NonFinite& nonfinite) {
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

void add_color_layer(FloatImage& image, const FrameResult& frame, const OutputImage& output, bool as_float,
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

// False where all samples, those of unused components too, are finite: seen by their exponents, many at a time.
bool may_hold_nonfinite(const FrameResult& frame, const OutputImage& output) {
  if (output.format == VK_FORMAT_R32_UINT) return false;
  const std::span<const std::byte> all = readback_bytes(frame, output);
  const size_t size = size_t(frame.width_px) * size_t(frame.height_px) * format_bytes(output.format);
  const auto any = [&]<class Word>(Word exponent) {
    constexpr size_t block = 1024;
    for (size_t at = 0; at < size; at += block) {
      std::array<Word, block / sizeof(Word)> words{};
      std::memcpy(words.data(), all.data() + at, std::min(block, size - at));
      Word found = 0;
      for (const Word word : words) found |= Word((word & exponent) == exponent);
      if (found) return true;
    }
    return false;
  };
  return output.format == VK_FORMAT_R16G16B16A16_SFLOAT ? any(uint16_t(0x7c00)) : any(uint32_t(0x7f800000));
}

// Whether the file of all layers has to be made to tell which pixels are not finite. Background depth is infinite.
bool may_hold_nonfinite(const FrameResult& frame) {
  return std::ranges::any_of(frame.outputs, [&](const OutputImage& output) {
    return output.layer != "display" && may_hold_nonfinite(frame, output);
  });
}

std::vector<MetadataEntry> metadata_of(const FrameResult& frame, const Job& job, const Session& session,
                                       std::optional<int64_t> frame_number, FrameRate rate) {
  FloatImage image;
  add_view_metadata(image, frame.view, frame.time_s, frame_number, rate);
  std::vector<MetadataEntry> metadata = std::move(image.metadata);
  metadata.push_back(text_entry("candela:job", job_json(job)));
  metadata.push_back(text_entry("candela:plan", frame.plan_hash.hex()));
  metadata.push_back(text_entry("candela:device", session.device().info().name));
  metadata.push_back(text_entry("candela:driver", session.device().info().driver));
  metadata.push_back(text_entry("candela:version", CANDELA_VERSION));
  metadata.push_back(text_entry("software", "candela " CANDELA_VERSION));
  metadata.push_back(text_entry(identity_name, file_identity(job, session, frame.time_s, frame_number, rate)));
  if (job.timings_in_metadata)
    metadata.push_back(text_entry("candela:timings", timings_json(frame, job, session).dump()));
  return metadata;
}

// What names the ids of the file's Cryptomatte layers.
void add_cryptomattes(std::vector<MetadataEntry>& metadata, const FrameResult& frame, const Scene& scene) {
  for (const OutputImage& output : frame.outputs)
    if (is_cryptomatte(output.layer) && output.part == 0) add_cryptomatte(metadata, scene, output.layer);
}

// Display output is no layer, and a layer that only --view asks for is in no file.
bool in_exr(const OutputImage& output, const Job& job) {
  if (output.layer == "display" || output.resource < 0) return false;
  return job.view == "beauty" || output.layer != job.view ||
         std::find(job.layers.begin(), job.layers.end(), job.view) != job.layers.end();
}

void add_clamped(std::vector<MetadataEntry>& metadata, const NonFinite& nonfinite) {
  if (nonfinite.clamped > 0) metadata.push_back(text_entry("candela:clamped", fmt::format("{}", nonfinite.clamped)));
}

// What the device counted.
NonFinite counted(const FrameResult& frame, const Job& job) {
  NonFinite found;
  for (const OutputImage& output : frame.outputs) {
    if (output.counts < 0) continue;
    const shared::PackCounts& counts = frame.counts.at(size_t(output.counts));
    if (in_exr(output, job)) found.clamped += counts.clamped;
    if (counts.nonfinite == 0) continue;
    if (found.count == 0) {
      const uint32_t pixel = ~counts.first_from_end;
      found.x = int(pixel % uint32_t(frame.width_px)), found.y = int(pixel / uint32_t(frame.width_px));
      found.layer = output.layer;
    }
    found.count += counts.nonfinite;
  }
  return found;
}

// A frame for EXR, whose planes lie in its read-back or here.
struct LinearFile {
  PictureView view;
  std::deque<std::vector<float>> scaled;
};

// What the device does not scale: bits of floats are stored as they are where no exposure is in them.
const std::byte* without_exposure(LinearFile& file, const std::byte* plane, size_t count, float scale) {
  std::vector<float>& values = file.scaled.emplace_back(count);
  std::memcpy(values.data(), plane, count * sizeof(float));
  for (float& value : values) value *= scale;
  return reinterpret_cast<const std::byte*>(values.data());
}

void add_planes(LinearFile& file, const FrameResult& frame, const OutputImage& output) {
  const PackLayout layout = layout_of(frame, output);
  const std::byte* bytes = readback_bytes(frame, output).data();
  if (output.format == VK_FORMAT_R32_UINT) {
    file.view.planes.push_back({output.layer, ChannelType::uint32, bytes, layout.row_bytes});
    return;
  }
  const bool half = output.packing == Packing::half_planes;
  const float scale = output.carries_exposure ? float(1.0 / frame.pre_exposure) : 1.0f;
  const std::vector<std::string> names = channel_names(output);
  CHECK_MSG(names.size() == output.components, output.layer);
  for (size_t c = 0; c < names.size(); ++c) {
    const std::byte* plane = bytes + c * layout.plane_bytes;
    if (!half && scale != 1 && c < 3) plane = without_exposure(file, plane, layout.plane_bytes / sizeof(float), scale);
    file.view.planes.push_back({names[c], half ? ChannelType::half : ChannelType::float32, plane, layout.row_bytes});
  }
}

}  // namespace

FloatImage linear_image(const FrameResult& frame, const Job& job, const Session& session,
                        std::optional<int64_t> frame_number, FrameRate rate, NonFinite& nonfinite) {
  FloatImage image;
  image.width = frame.width_px;
  image.height = frame.height_px;
  for (const OutputImage& output : frame.outputs) {
    if (!in_exr(output, job)) continue;
    CHECK_MSG(output.packing == Packing::texels, output.layer);
    if (output.format == VK_FORMAT_R32_UINT)
      add_id_layer(image, output, readback_bytes(frame, output));
    else if (output.layer == "depth")
      add_depth_layer(image, frame, output, nonfinite);
    else
      add_color_layer(image, frame, output, job.exr_float || output.exact, nonfinite);
  }
  image.metadata = metadata_of(frame, job, session, frame_number, rate);
  add_id_names(image, session.scene());
  add_cryptomattes(image.metadata, frame, session.scene());
  add_clamped(image.metadata, nonfinite);
  return image;
}

namespace {
DisplayImage view_image(const FrameResult& frame, const Job& job) {
  for (const OutputImage& output : frame.outputs) {
    if (output.layer != job.view) continue;
    std::vector<float> counts(size_t(frame.width_px) * size_t(frame.height_px));
    std::memcpy(counts.data(), readback_bytes(frame, output).data(), counts.size() * sizeof(float));
    DisplayImage image = count_view(counts, frame.width_px, frame.height_px, count_title(job.view));
    if (job.png_bits == 8) return image;
    DisplayImage wide = {.width = image.width, .height = image.height, .channels = image.channels, .bits = 16};
    for (const std::byte b : image.pixels) wide.pixels.insert(wide.pixels.end(), 2, b);  // times 257
    return wide;
  }
  CHECK_MSG(false, "the frame has no " + job.view);
}
}  // namespace

DisplayImage display_image(const FrameResult& frame, const Job& job) {
  if (job.view != "beauty") return view_image(frame, job);
  DisplayImage image;
  image.width = frame.width_px;
  image.height = frame.height_px;
  image.channels = shows_through(job, frame.request.look) ? 4 : 3;
  for (const OutputImage& output : frame.outputs) {
    if (output.layer != "display") continue;
    CHECK(output.format == VK_FORMAT_R8G8B8A8_UNORM || output.format == VK_FORMAT_R16G16B16A16_UNORM);
    image.bits = output.format == VK_FORMAT_R8G8B8A8_UNORM ? 8 : 16;
    const std::byte* bytes = readback_bytes(frame, output).data();
    const PackLayout layout = layout_of(frame, output);
    const size_t sample = size_t(image.bits) / 8, to = sample * size_t(image.channels), row = row_bytes(image);
    const size_t from = output.packing == Packing::rgb ? to : sample * 4;
    image.pixels.resize(row * size_t(image.height));
    for (size_t y = 0; y < size_t(image.height); ++y) {
      if (from == to) {
        std::memcpy(image.pixels.data() + y * row, bytes + y * layout.row_bytes, row);
        continue;
      }
      for (size_t x = 0; x < size_t(image.width); ++x)
        std::memcpy(image.pixels.data() + y * row + x * to, bytes + y * layout.row_bytes + x * from, to);
    }
  }
  CHECK_MSG(!image.pixels.empty(), "the frame has no display output");
  return image;
}

namespace {

// A display picture, which lies in the frame's read-back where that has the file's form.
struct DisplayFile {
  DisplayView view;
  DisplayImage own;
};
DisplayFile display_file(const FrameResult& frame, const Job& job, bool owned) {
  DisplayFile file;
  const auto display =
      std::ranges::find_if(frame.outputs, [](const OutputImage& output) { return output.layer == "display"; });
  const bool alpha = shows_through(job, frame.request.look);
  if (!owned && job.view == "beauty" && display != frame.outputs.end() && (display->packing == Packing::rgb) != alpha) {
    file.view = {frame.width_px,
                 frame.height_px,
                 alpha ? 4 : 3,
                 display->format == VK_FORMAT_R8G8B8A8_UNORM ? 8 : 16,
                 readback_bytes(frame, *display).data(),
                 layout_of(frame, *display).row_bytes};
    return file;
  }
  file.own = display_image(frame, job);
  file.view = view_of(file.own);
  return file;
}

// One of the two, as the frame has its pictures.
struct LinearPicture {
  LinearFile file;
  FloatImage image;
};
LinearPicture linear_picture(const FrameResult& frame, const Job& job, const Session& session,
                             std::optional<int64_t> frame_number, FrameRate rate, bool wanted, NonFinite& nonfinite) {
  LinearPicture picture;
  if (!frame.request.for_files) {
    if (wanted || (!job.allow_nonfinite && may_hold_nonfinite(frame)))
      picture.image = linear_image(frame, job, session, frame_number, rate, nonfinite);
    return picture;
  }
  nonfinite = counted(frame, job);
  if (!wanted || (nonfinite.count > 0 && !job.allow_nonfinite)) return picture;
  PictureView& view = picture.file.view;
  view.width = frame.width_px, view.height = frame.height_px;
  for (const OutputImage& output : frame.outputs)
    if (in_exr(output, job)) add_planes(picture.file, frame, output);
  view.metadata = metadata_of(frame, job, session, frame_number, rate);
  for (const PlaneView& plane : view.planes)
    add_id_names(view.metadata, session.scene(), plane, view.width, view.height);
  add_cryptomattes(view.metadata, frame, session.scene());
  add_clamped(view.metadata, nonfinite);
  return picture;
}

}  // namespace

std::string file_identity(const Job& job, const Session& session, double time_s, std::optional<int64_t> frame_number,
                          FrameRate rate) {
  const gpu::DeviceInfo& device = session.device().info();
  return file_identity(job, session.scene_content().hex(), device.name, device.driver, time_s, frame_number, rate);
}

std::string file_identity(const Job& job, const std::string& scene_content, const std::string& device,
                          const std::string& driver, double time_s, std::optional<int64_t> frame_number,
                          FrameRate rate) {
  const Hash128 picture = frame_identity(job, scene_content, device + "\n" + driver, time_s);
  return hash128(picture.hex() + "\n" + (frame_number ? fmt::format("{} at {}", *frame_number, rate.text()) : ""))
      .hex();
}

bool holds_frame(const fs::path& path, const std::string& identity) {
  const auto format = output_format(path);
  std::error_code failed;
  if (!format || !fs::is_regular_file(path, failed)) return false;
  const auto bytes = read_file(path);
  if (!bytes) return false;
  if (*format == OutputFormat::png) {
    const auto text = png_text(*bytes, identity_name, path.string());
    return text && *text == identity;
  }
  const auto image = decode_exr(*bytes, path.string(), true);
  if (!image) return false;
  for (const MetadataEntry& entry : image->metadata)
    if (entry.name == identity_name) return entry.text == identity;
  return false;
}

Expected<PreparedOutputs> prepare_outputs(FrameResult& frame, const Job& job, const Session& session,
                                          std::optional<int64_t> frame_number, FrameRate rate,
                                          const std::vector<fs::path>& paths, bool display_wanted) {
  std::vector<OutputFormat> formats;
  for (const fs::path& path : paths) {
    const auto format = output_format(path);
    if (!format) return std::unexpected(format.error());
    formats.push_back(*format);
  }
  const bool any_png = std::find(formats.begin(), formats.end(), OutputFormat::png) != formats.end();
  const bool any_exr = std::find(formats.begin(), formats.end(), OutputFormat::exr) != formats.end();
  LinearPicture linear;
  DisplayFile display;
  PreparedOutputs prepared;
  {
    StageTimer timer(frame.timings, "read_back", "encode");
    NonFinite nonfinite;
    linear = linear_picture(frame, job, session, frame_number, rate, any_exr, nonfinite);
    if (nonfinite.count > 0 && !job.allow_nonfinite)
      return fail(ErrorKind::nonfinite, "",
                  "{} pixels are not finite, the first at x {}, y {} of layer {}; nothing was written", nonfinite.count,
                  nonfinite.x, nonfinite.y, nonfinite.layer);
    if (nonfinite.clamped > 0 && any_exr)
      frame.warnings.push_back(fmt::format(
          "{} values are beyond what half floats hold and are stored as 65504 (--exr-type float keeps them)",
          nonfinite.clamped));
    if (any_png || display_wanted) display = display_file(frame, job, display_wanted);
  }
  StageTimer timer(frame.timings, "encode", "encode");
  const std::string identity = file_identity(job, session, frame.time_s, frame_number, rate);
  for (size_t i = 0; i < paths.size(); ++i) {
    auto file = formats[i] != OutputFormat::exr ? prepare_png(paths[i], display.view, {{identity_name, identity}})
                : frame.request.for_files       ? prepare_exr(paths[i], linear.file.view, job.exr_compression)
                                                : prepare_exr(paths[i], linear.image, job.exr_compression);
    if (!file) return std::unexpected(file.error());
    prepared.files.push_back(std::move(*file));
  }
  prepared.display = std::move(display.own);
  return prepared;
}

Expected<void> write_outputs(FrameResult& frame, const Job& job, const Session& session,
                             std::optional<int64_t> frame_number, FrameRate rate, const std::vector<fs::path>& paths) {
  auto prepared = prepare_outputs(frame, job, session, frame_number, rate, paths);
  if (!prepared) return std::unexpected(prepared.error());
  for (PreparedFile& file : prepared->files)
    if (auto placed = file.put_in_place(); !placed) return placed;
  return {};
}

}  // namespace candela
