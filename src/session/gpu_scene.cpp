#include "session/gpu_scene.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <cstring>

#include "base/clock.h"
#include "base/files.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"
#include "plan/upload_table.h"
#include "scene/scene_images.h"
#include "scene/texture_slots.h"
#include "session/changed_ranges.h"
#include "session/mip_chain.h"
#include "sky/split_sum.h"

namespace candela {
namespace {

constexpr VkBufferUsageFlags storage_usage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

VkSamplerAddressMode address_mode(Wrap w) {
  return w == Wrap::repeat  ? VK_SAMPLER_ADDRESS_MODE_REPEAT
         : w == Wrap::clamp ? VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE
                            : VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
}

// Anisotropy is for footprints wider than a texel; nearest filtering asks for texels as they are.
VkSamplerCreateInfo sampler_info(const Sampler& s, int anisotropy = 1) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = s.mag == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.minFilter = s.min == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.mipmapMode =
      s.mipmaps && s.mip == Filter::linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = address_mode(s.wrap_u);
  info.addressModeV = address_mode(s.wrap_v);
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  info.anisotropyEnable =
      anisotropy > 1 && s.mipmaps && s.mag == Filter::linear && s.min == Filter::linear && s.mip == Filter::linear;
  info.maxAnisotropy = info.anisotropyEnable ? float(anisotropy) : 1.0f;
  // 0.25 without mipmaps: the specification's way to keep both filters and level 0 alone.
  info.maxLod = s.mipmaps ? VK_LOD_CLAMP_NONE : 0.25f;
  return info;
}

}  // namespace

GpuScene::GpuScene(gpu::Device& device, gpu::Bindless& bindless, const Scene& scene, const GeometryLayout& layout,
                   const DevicePose& on_device)
    : device_(device),
      bindless_(bindless),
      scene_(scene),
      layout_(layout),
      sky_(device, bindless),
      probes_(device, bindless) {
  for (const Material& m : scene.materials)
    for_each_slot(m, [&](const TextureSlot& slot, bool srgb) {
      if (slot) mipmapped_[{slot.image, srgb}] |= scene.samplers[size_t(slot.sampler)].mipmaps;
    });
  gpu::Uploader uploader(device);
  const auto load = [&](const char* name, const auto& values, VkBufferUsageFlags usage = 0) {
    const auto bytes = std::as_bytes(std::span(values));
    gpu::Buffer& buffer = scene_buffers_[name];
    buffer = gpu::Buffer(device, bytes.size(), storage_usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT | usage,
                         gpu::Buffer::Memory::device, gpu::Device::Purpose::scene, name);
    uploader.to_buffer(buffer, 0, bytes);
  };
  if (layout.vertex_words > 0) {
    std::vector<uint32_t> words(layout.vertex_words), indices(layout.index_count);
    pack_geometry(scene, layout, words, indices);
    load("scene.vertices", words);
    load("scene.indices", indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
  }
  if (on_device.lights && on_device.lights->instance_count > 0)
    load("scene.light_instances", pack_light_instances(scene, *on_device.lights));
  if (on_device.instances && on_device.instances->instance_count > 0)
    load("scene.mesh_instances", pack_mesh_instances(*on_device.instances));
  uploader.flush();
}

GpuScene::~GpuScene() {
  for (const auto& [key, loaded] : textures_)
    if (loaded.index != shared::absent) bindless_.remove_sampled(loaded.index);
  if (split_sum_index_ != shared::absent) bindless_.remove_sampled(split_sum_index_);
}

void GpuScene::set_samplers(const TextureKnobs& knobs) {
  if (!samplers_.empty() && knobs.anisotropy == texture_knobs_.anisotropy) return;
  texture_knobs_ = knobs;
  samplers_.clear();
  for (const Sampler& s : scene_.samplers)
    samplers_.push_back(bindless_.add_sampler(sampler_info(s, knobs.anisotropy)));
}

// Once, for the first frame with ambient light on a surface, or with reflections.
void GpuScene::load_split_sum(const PlannedFrame& frame) {
  const bool wanted = frame.facts.environment || frame.request.neutral_light || frame.facts.probes > 0 ||
                      frame.request.draws_reflections();
  if (!wanted || !frame.facts.takes_light() || split_sum_index_ != shared::absent) return;
  constexpr uint32_t columns = shared::split_sum_columns, rows = shared::split_sum_rows;
  std::vector<uint16_t> texels;
  for (uint32_t i = 0; i < columns * rows; ++i)
    texels.insert(texels.end(),
                  {split_sum_table[2 * i], split_sum_table[2 * i + 1], split_sum_grazing[i % columns], uint16_t(0)});
  gpu::TextureData data{VK_FORMAT_R16G16B16A16_UNORM, columns, rows, {}};
  const auto bytes = std::as_bytes(std::span(texels));
  data.levels.emplace_back(bytes.begin(), bytes.end());
  split_sum_ = gpu::Texture(device_, data, "split_sum");
  gpu::Uploader uploader(device_);
  uploader.to_texture(split_sum_, data);
  uploader.flush();
  split_sum_index_ = bindless_.add_sampled(split_sum_.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  Sampler sampler;
  sampler.wrap_u = sampler.wrap_v = Wrap::clamp;
  sampler.mipmaps = false;
  split_sum_sampler_ = bindless_.add_sampler(sampler_info(sampler));
}

void GpuScene::load_textures(const PlannedFrame& frame, Uploaded& uploaded) {
  // Only what the frame's visible materials use, and only what is not here yet.
  normals_stray_ = frame.surfaces.specular_aa == SurfaceKnobs::maps;
  std::map<TextureKey, bool> wanted;  // -> whether some sampler wants mipmaps
  for (size_t m = 0; m < frame.pose.materials.size(); ++m) {
    if (!frame.facts.material_used[m]) continue;
    const Material& material = frame.pose.materials[m];
    for_each_shown_slot(material, [&](const TextureSlot& slot, bool srgb) {
      if (!slot || !frame.facts.image_used[size_t(slot.image)]) return;
      const TextureKey key{slot.image, srgb, normals_stray_ && is_normal_map(material, slot)};
      if (!textures_.contains(key)) wanted[key] = mipmapped_.at({slot.image, srgb});
    });
  }
  if (wanted.empty()) return;
  const auto start = Clock::now();
  std::map<TextureKey, LoadedTexture> loaded;                      // after an error none of them is kept
  const auto uploader = std::make_shared<gpu::Uploader>(device_);  // its end waits: before the textures go
  // What is decoded goes to the device, one after the other in the order of keys, while others are being decoded.
  struct Decoded {
    TextureKey key;
    Expected<gpu::TextureData> data;
    std::vector<std::string> warnings;
  };
  const size_t at_once = 2 * size_t(tbb::this_task_arena::max_concurrency());
  using Result = std::shared_ptr<Decoded>;
  const std::vector<std::pair<TextureKey, bool>> list(wanted.begin(), wanted.end());
  size_t next = 0;
  const auto take = [&](tbb::flow_control& control) {
    if (next == list.size()) control.stop();
    return next < list.size() ? next++ : next;
  };
  const auto decode = [&](size_t i) {
    const auto& [key, mipmapped] = list[i];
    auto texture = decode_scene_image(scene_, key.image);
    if (!texture) return std::make_shared<Decoded>(key, std::unexpected(texture.error()));
    return std::make_shared<Decoded>(key, make_mip_chain(texture->image, key.srgb, mipmapped, key.normals),
                                     std::move(texture->warnings));
  };
  const auto load = [&](const Result& decoded) {
    if (!decoded->data) throw gpu::GpuError(VK_ERROR_OUT_OF_HOST_MEMORY, decoded->data.error().text());
    uploaded.warnings.insert(uploaded.warnings.end(), decoded->warnings.begin(), decoded->warnings.end());
    LoadedTexture& made = loaded[decoded->key];
    const std::string& place = scene_.images[size_t(decoded->key.image)].place;
    try {
      made.texture = gpu::Texture(device_, *decoded->data, place.c_str());
      uploader->to_texture(made.texture, *decoded->data);
    } catch (gpu::GpuError& e) {
      e.place = place;
      throw;
    }
  };
  tbb::parallel_pipeline(at_once, tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, take) &
                                      tbb::make_filter<size_t, Result>(tbb::filter_mode::parallel, decode) &
                                      tbb::make_filter<Result, void>(tbb::filter_mode::serial_in_order, load));
  for (auto& [key, made] : loaded)
    made.index = bindless_.add_sampled(made.texture.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  uploader->submit();
  uploaded.keep.push_back(uploader);
  textures_.merge(loaded);
  uploaded.decode_ms = ms_since(start);
}

shared::TextureRef GpuScene::texture_ref(const TextureSlot& slot, bool srgb, bool normals) const {
  shared::TextureRef ref{shared::absent, 0, 0, 0, {1, 0, 0}, {0, 1, 0}};
  if (!slot) return ref;
  const auto found = textures_.find({slot.image, srgb, normals});
  if (found == textures_.end()) return ref;
  ref.texture = found->second.index;
  ref.sampler_index = samplers_[size_t(slot.sampler)];
  ref.uv_set = uint32_t(slot.uv_set);
  // KHR_texture_transform: translation * rotation * scale, rotation counter-clockwise in UV space with v down.
  const float c = std::cos(slot.rotation_rad), s = std::sin(slot.rotation_rad);
  ref.u_row = {c * slot.scale.x, s * slot.scale.y, slot.offset.x};
  ref.v_row = {-s * slot.scale.x, c * slot.scale.y, slot.offset.y};
  return ref;
}

void GpuScene::set_textures(const Material& m, shared::Material& out) const {
  out.base_texture = texture_ref(m.base_color_texture, true);
  out.orm_texture = texture_ref(m.orm_texture, false);
  out.occlusion_texture = texture_ref(m.occlusion_texture, false);
  out.normal_texture = texture_ref(m.normal_texture, false, normals_stray_);
  out.emissive_texture = texture_ref(m.emissive_texture, true);
  out.specular_texture = texture_ref(m.specular_texture, false);
  out.specular_color_texture = texture_ref(m.specular_color_texture, true);
}

void GpuScene::set_lobe_textures(const Material& m, shared::MaterialLobes& out) const {
  out.coat_texture = texture_ref(m.clearcoat.texture, false);
  out.coat_roughness_texture = texture_ref(m.clearcoat.roughness_texture, false);
  out.coat_normal_texture = texture_ref(m.clearcoat.normal_texture, false, normals_stray_);
  out.sheen_texture = texture_ref(m.sheen.color_texture, true);
  out.sheen_roughness_texture = texture_ref(m.sheen.roughness_texture, false);
  out.film_texture = texture_ref(m.iridescence.texture, false);
  out.film_thickness_texture = texture_ref(m.iridescence.thickness_texture, false);
  out.anisotropy_texture = texture_ref(m.anisotropy.texture, false);
  out.passing_texture = texture_ref(m.diffuse_transmission.texture, false);
  out.passing_color_texture = texture_ref(m.diffuse_transmission.color_texture, true);
  out.glass.transmission_texture = texture_ref(m.transmission_texture, false);
  out.glass.thickness_texture = texture_ref(m.thickness_texture, false);
}

std::shared_ptr<GpuScene::Buffers> GpuScene::free_buffers() {
  for (const auto& buffers : frame_buffers_)
    if (buffers.use_count() == 1) return buffers;
  return frame_buffers_.emplace_back(std::make_shared<Buffers>());
}

// A larger buffer replaces one that the row does not fit into. The copy of what it holds is compared with and not the
// buffer, which may be slow to read.
void GpuScene::fill(FrameBuffer& target, const UploadRow& row) {
  gpu::Buffer& buffer = target.buffer;
  const uint64_t least = std::max<uint64_t>(row.bytes.size(), row.size_bytes);
  if (!buffer || buffer.size() < least) {
    target.held.clear();
    buffer = gpu::Buffer(device_, std::max(least, buffer ? buffer.size() * 2 : least),
                         storage_usage | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT,
                         gpu::Buffer::Memory::upload, gpu::Device::Purpose::frame, row.name);
  }
  changed_ranges(target.held, row.bytes, changed_);
  target.held.resize(std::max(target.held.size(), row.bytes.size()));
  for (const ByteRange& range : changed_) {
    std::memcpy(target.held.data() + range.first, row.bytes.data() + range.first, range.count);
    std::memcpy(buffer.mapped() + range.first, row.bytes.data() + range.first, range.count);
    device_.count_uploaded(range.count);
  }
}

// Of what passes of the frame fill.
void GpuScene::make_room(FrameBuffer& target, const UploadRow& row) {
  if (target.buffer.size() >= row.size_bytes) return;
  target.buffer = gpu::Buffer(device_, row.size_bytes,
                              storage_usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                              gpu::Buffer::Memory::device, gpu::Device::Purpose::frame, row.name);
}

// One that has the content, else one that no frame in flight uses gets what is different.
std::shared_ptr<GpuScene::SharedBuffer> GpuScene::shared_buffer(const UploadRow& row, Uploaded& uploaded) {
  auto& buffers = shared_buffers_[row.name];
  auto found = std::ranges::find_if(
      buffers, [&](const auto& b) { return b->key == *row.key && b->buffer.size() >= row.size_bytes; });
  if (found == buffers.end()) {
    found = std::ranges::find_if(buffers, [](const auto& b) { return b.use_count() == 1; });
    if (found == buffers.end()) found = buffers.insert(found, std::make_shared<SharedBuffer>());
    SharedBuffer& target = **found;
    const bool fits = target.buffer.size() >= row.size_bytes;
    changed_ranges(fits ? target.held : std::span<const std::byte>(), row.bytes, changed_);
    target.key = {}, target.held = {}, target.owner = {};  // until all of it is there
    target.structures =
        row.on_device ? std::make_unique<gpu::AccelerationStructures>(device_, *row.on_device) : nullptr;
    if (!fits)
      target.buffer = gpu::Buffer(device_, row.size_bytes, storage_usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                  gpu::Buffer::Memory::device, gpu::Device::Purpose::frame, row.name);
    const auto uploader = std::make_shared<gpu::Uploader>(device_);
    for (const ByteRange& range : changed_)
      uploader->to_buffer(target.buffer, range.first, row.bytes.subspan(range.first, range.count));
    if (target.structures) {
      uploader->flush();  // over the place that is written now
      static_assert(offsetof(shared::TraceScene, acceleration) == 0);
      const uint64_t address = target.structures->address();
      uploader->to_buffer(target.buffer, 0, std::as_bytes(std::span(&address, 1)));
    }
    uploader->submit();
    uploaded.keep.push_back(uploader);
    target.key = *row.key, target.held = row.bytes, target.owner = row.owner;
  }
  uploaded.keep.push_back(*found);
  return *found;
}

void GpuScene::upload(PlannedFrame& frame, Uploaded& uploaded) {
  uploaded.imports.clear(), uploaded.keep.clear(), uploaded.warnings.clear();
  uploaded.decode_ms = 0;
  set_samplers(frame.textures);
  load_textures(frame, uploaded);
  load_split_sum(frame);
  const auto start = Clock::now();
  const std::shared_ptr<Buffers> own = free_buffers();
  uploaded.keep.push_back(own);
  static const Material plain;
  for (size_t m = 0; m < frame.upload.materials.size(); ++m)
    set_textures(m < frame.pose.materials.size() ? frame.pose.materials[m] : plain, frame.upload.materials[m]);
  for (size_t m = 0; m < frame.pose.materials.size(); ++m) {
    const Relief& relief = frame.pose.materials[m].relief;
    if (frame.upload.materials[m].relief == 0) continue;
    const Sampler& sampler = scene_.samplers[size_t(relief.texture.sampler)];
    static_assert(uint32_t(Wrap::repeat) == shared::wrap_repeat && uint32_t(Wrap::clamp) == shared::wrap_clamp &&
                  uint32_t(Wrap::mirror) == shared::wrap_mirror);
    const Relief& before = frame.upload.reliefs_before.empty() ? relief : frame.upload.reliefs_before[m];
    const shared::TextureRef heights_before = texture_ref(before.texture, false);
    shared::ReliefRecord record{texture_ref(relief.texture, false), relief.depth, before.depth, heights_before.u_row,
                                heights_before.v_row};
    record.heights.wraps = uint32_t(sampler.wrap_u) | uint32_t(sampler.wrap_v) << 2;
    std::memcpy(static_cast<void*>(&frame.upload.materials[frame.upload.materials[m].relief]), &record, sizeof record);
  }
  for (size_t m = 0; m < frame.pose.materials.size() && !frame.upload.lobes.empty(); ++m) {
    const uint32_t word = frame.upload.lobes[m];
    if (word == shared::absent) continue;
    shared::MaterialLobes lobes;
    std::memcpy(&lobes, &frame.upload.lobes[word], sizeof lobes);
    set_lobe_textures(frame.pose.materials[m], lobes);
    std::memcpy(&frame.upload.lobes[word], &lobes, sizeof lobes);
  }
  shared::FrameConstants& c = frame.upload.constants;
  sky_.load(frame, c, uploaded.keep);
  if (frame.facts.probes > 0) probes_.write(c.probes);
  c.split_sum_texture = split_sum_index_;
  c.split_sum_sampler = split_sum_sampler_;
  upload_table(frame, layout_, frame.rows);
  const std::vector<UploadRow>& rows = frame.rows;
  const std::vector<int>& resources = frame.made->imports;
  for (size_t i = 0; i < rows.size(); ++i) {
    const UploadRow& row = rows[i];
    if (resources[i] < 0) continue;
    // lavapipe 25.0.7 loads from an address that is the same in all lanes even where no lane takes the branch: it must
    // be valid.
    if (c.grid.globals == 0 && &row == &rows.back())
      c.grid.globals = address_in(*own, frame.upload.light_groups.empty() ? "frame.lights" : "frame.light_groups");
    if (row.key) {
      uploaded.imports[resources[i]] = &shared_buffer(row, uploaded)->buffer;
      continue;
    }
    FrameBuffer* const filled = row.bytes.empty() && !row.to_fill ? nullptr : &(*own)[row.name];
    if (row.to_fill)
      make_room(*filled, row);
    else if (filled)
      fill(*filled, row);
    const gpu::Buffer& buffer = filled ? filled->buffer : scene_buffers_[row.name];
    uploaded.imports[resources[i]] = &buffer;
    if (row.address_offset == UploadRow::no_address) continue;
    const uint64_t address = buffer.address();
    std::memcpy(reinterpret_cast<std::byte*>(&c) + row.address_offset, &address, sizeof address);
  }
  uploaded.upload_ms = ms_since(start);
}

uint64_t GpuScene::address_in(const Buffers& buffers, const char* name) {
  const auto found = buffers.find(name);
  return found == buffers.end() ? 0 : found->second.buffer.address();
}

}  // namespace candela
