#include "render/outputs.h"

#include <array>
#include <cstring>
#include <deque>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/files.h"
#include "image/prepare.h"
#include "image/seal.h"
#include "job/light_groups.h"
#include "passes/post/pack.h"
#include "passes/surfaces/terms.h"
#include "render/cryptomatte.h"
#include "render/dump.h"
#include "render/frame_layers.h"
#include "render/frame_names.h"
#include "render/id_names.h"
#include "render/metadata.h"
#include "render/prepare_outputs.h"
#include "render/view_picture.h"
#include "session/timings.h"
#include "techniques/technique.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

// False where all samples, those of unused components too, are finite: seen by their exponents, many at a time.
bool may_hold_nonfinite(const FrameResult& frame, const FrameOutput& output) {
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
  return std::ranges::any_of(frame.outputs, [&](const FrameOutput& output) {
    return output.layer != "display" && may_hold_nonfinite(frame, output);
  });
}

std::vector<MetadataEntry> metadata_of(const FrameResult& frame, const Job& job, const Session& session,
                                       std::optional<int64_t> frame_number, FrameRate rate) {
  FloatImage image;
  add_view_metadata(image, frame.view, frame.time_s, frame_number, rate);
  std::vector<MetadataEntry> metadata = std::move(image.metadata);
  metadata.push_back(text_entry("candela:job", job_json(without_folders(job))));
  metadata.push_back(text_entry("candela:plan", frame.plan_hash.hex()));
  metadata.push_back(text_entry("candela:device", session.device().info().name));
  metadata.push_back(text_entry("candela:driver", session.device().info().driver));
  metadata.push_back(text_entry("candela:version", CANDELA_VERSION));
  metadata.push_back(text_entry("software", "candela " CANDELA_VERSION));
  metadata.push_back(text_entry(identity_name, file_identity(job, session, frame.time_s, frame_number, rate)));
  metadata.push_back(text_entry(seal_name.data(), open_seal()));
  if (job.timings_in_metadata)
    metadata.push_back(text_entry("candela:timings", timings_json(frame, job, session).dump()));
  return metadata;
}

// Display output is no layer, and a layer that only --view asks for is in no file. Groups of lights are in every one.
bool in_exr(const FrameOutput& output, const Job& job) {
  if (output.layer == "display" || output.resource < 0) return false;
  const std::vector<std::string> groups = light_group_layers(job);
  return job.view == "beauty" || output.layer != job.view ||
         std::find(job.layers.begin(), job.layers.end(), job.view) != job.layers.end() ||
         std::find(groups.begin(), groups.end(), job.view) != groups.end();
}

// What names the ids of the file's Cryptomatte layers.
void add_cryptomattes(std::vector<MetadataEntry>& metadata, const FrameResult& frame, const Job& job,
                      const Scene& scene) {
  for (const FrameOutput& output : frame.outputs)
    if (is_cryptomatte(output.layer) && output.part == 0 && in_exr(output, job))
      add_cryptomatte(metadata, scene, output.layer);
}

void add_clamped(std::vector<MetadataEntry>& metadata, const NonFinite& nonfinite) {
  if (nonfinite.clamped > 0) metadata.push_back(text_entry("candela:clamped", fmt::format("{}", nonfinite.clamped)));
}

// What the device counted.
NonFinite counted(const FrameResult& frame, const Job& job) {
  NonFinite found;
  for (const FrameOutput& output : frame.outputs) {
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

void add_planes(LinearFile& file, const FrameResult& frame, const FrameOutput& output) {
  const PackLayout layout = layout_of(frame, output);
  const std::byte* bytes = readback_bytes(frame, output).data();
  if (output.format == VK_FORMAT_R32_UINT) {
    file.view.planes.push_back({channel_names(output).front(), ChannelType::uint32, bytes, layout.row_bytes});
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
  set_windows(image, frame.window);
  for (const FrameOutput& output : frame.outputs) {
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
  add_cryptomattes(image.metadata, frame, job, session.scene());
  add_clamped(image.metadata, nonfinite);
  return image;
}

namespace {

// A view that is no light.
DisplayImage made_view(const FrameResult& frame, const Job& job) {
  if (image_of_view(job.view)) {
    const FrameDump& dump = frame.dumps.back();
    const FloatImage image = dump_image(dump, frame.readbacks.at(dump.resource)->bytes());
    return image_view(image, frame.width_px, frame.height_px, dump.request.text());
  }
  const auto shown = std::ranges::find_if(frame.outputs, [&](const auto& output) { return output.layer == job.view; });
  return layer_view(layer_image(frame, *shown), layer_form(job.view), job.view);
}

DisplayImage of_bits(DisplayImage image, int bits) {
  if (bits == image.bits) return image;
  DisplayImage wide = {.width = image.width, .height = image.height, .channels = image.channels, .bits = 16};
  for (const std::byte b : image.pixels) wide.pixels.insert(wide.pixels.end(), 2, b);  // times 257
  return wide;
}

// Whether the frame has what the job's pictures show.
bool has_view(const FrameResult& frame, const Job& job) {
  if (image_of_view(job.view)) return true;
  const std::string shown = frame.request.view_is_light ? "display" : job.view;
  return std::ranges::any_of(frame.outputs, [&](const FrameOutput& output) { return output.layer == shown; });
}

}  // namespace

DisplayImage display_image(const FrameResult& frame, const Job& job) {
  if (!has_view(frame, job)) {
    DisplayImage black{.width = frame.width_px, .height = frame.height_px};
    black.pixels.resize(row_bytes(black) * size_t(black.height));
    return of_bits(std::move(black), job.png_bits);
  }
  if (image_of_view(job.view) || !frame.request.view_is_light) return of_bits(made_view(frame, job), job.png_bits);
  DisplayImage image;
  image.width = frame.width_px;
  image.height = frame.height_px;
  image.channels = frame.request.display_alpha() ? 4 : 3;
  for (const FrameOutput& output : frame.outputs) {
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
      std::ranges::find_if(frame.outputs, [](const FrameOutput& output) { return output.layer == "display"; });
  const bool alpha = frame.request.display_alpha();
  if (!owned && frame.request.view_is_light && !image_of_view(job.view) && display != frame.outputs.end() &&
      (display->packing == Packing::rgb) != alpha) {
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
  set_windows(view, frame.window);
  for (const FrameOutput& output : frame.outputs)
    if (in_exr(output, job)) add_planes(picture.file, frame, output);
  view.metadata = metadata_of(frame, job, session, frame_number, rate);
  for (const PlaneView& plane : view.planes)
    add_id_names(view.metadata, session.scene(), plane, view.width, view.height);
  add_cryptomattes(view.metadata, frame, job, session.scene());
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
  auto bytes = read_file(path);
  if (!bytes) return false;
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  return text.find(identity) != text.npos && seal_holds(*bytes);
}

FileState header_state(const fs::path& path, const std::string& identity) {
  std::error_code failed;
  const uint64_t size = fs::file_size(path, failed);
  if (failed) return FileState::missing;
  std::ifstream stream(path, std::ios::binary);
  std::vector<std::byte> head(size_t(256) << 10);
  stream.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
  head.resize(size_t(stream.gcount()));
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  const bool whole = text.find(identity) != text.npos && sealed_length(head) == size;
  return whole ? FileState::whole : FileState::damaged;
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
    if ((any_png || display_wanted) && !has_view(frame, job))
      frame.warnings.push_back(fmt::format("--view: the frame has no {}; the picture is black", job.view));
    if (any_png || display_wanted) display = display_file(frame, job, display_wanted);
  }
  StageTimer timer(frame.timings, "encode", "encode");
  const std::string identity = file_identity(job, session, frame.time_s, frame_number, rate);
  for (size_t i = 0; i < paths.size(); ++i) {
    auto file =
        formats[i] != OutputFormat::exr
            ? prepare_png(paths[i], display.view, {{identity_name, identity}, {std::string(seal_name), open_seal()}})
        : frame.request.for_files ? prepare_exr(paths[i], linear.file.view, job.exr_compression)
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
