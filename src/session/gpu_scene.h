#pragma once
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gpu/acceleration.h"
#include "gpu/bindless.h"
#include "gpu/device.h"
#include "gpu/resources.h"
#include "plan/plan_frame.h"
#include "plan/upload_table.h"
#include "session/changed_ranges.h"
#include "session/gpu_probes.h"
#include "session/gpu_sky.h"

namespace candela {

// A scene on a device. Vertices and indices are uploaded once; textures when a frame first uses them; the rest for
// every frame, into buffers that the device reads in place and that grow as needed. Of these only what differs from
// what the buffer holds is sent. A frame in flight keeps its buffers: there are as many sets of them as frames were in
// flight at once.
class GpuScene {
 public:
  // on_device: the instances that the device poses.
  GpuScene(gpu::Device& device, gpu::Bindless& bindless, const Scene& scene, const GeometryLayout& layout,
           const DevicePose& on_device);
  ~GpuScene();

  struct Uploaded {
    gpu::Imports imports;                           // for FrameRunner::submit
    std::vector<std::shared_ptr<const void>> keep;  // likewise: while held, the buffers are not written again
    double decode_ms = 0, upload_ms = 0;
    std::vector<std::string> warnings;  // images that are damaged
  };
  // Fills every imported buffer of the plan. An image that no decoder takes is a warning and drawn as scene_images.h
  // says. uploaded: whatever it held, its memory is used again. Throws GpuError.
  void upload(PlannedFrame& frame, Uploaded& uploaded);
  // Frames with reflection probes need them loaded.
  GpuProbes& probes() { return probes_; }

 private:
  struct TextureKey {
    int image;
    bool srgb;
    bool normals = false;  // a normal map whose alpha says how far it strays
    auto operator<=>(const TextureKey&) const = default;
  };
  void set_samplers(const TextureKnobs& knobs);
  void load_split_sum(const PlannedFrame& frame);
  void load_textures(const PlannedFrame& frame, Uploaded& uploaded);
  shared::TextureRef texture_ref(const TextureSlot& slot, bool srgb, bool normals = false) const;
  void set_textures(const Material& material, shared::Material& out) const;
  void set_lobe_textures(const Material& material, shared::MaterialLobes& out) const;

  gpu::Device& device_;
  gpu::Bindless& bindless_;
  const Scene& scene_;
  const GeometryLayout& layout_;
  struct FrameBuffer {
    gpu::Buffer buffer;
    std::vector<std::byte> held;  // what it holds, from its begin
  };
  using Buffers = std::map<std::string_view, FrameBuffer>;  // of the upload table, by name
  std::shared_ptr<Buffers> free_buffers();
  void fill(FrameBuffer& target, const UploadRow& row);
  void make_room(FrameBuffer& target, const UploadRow& row);
  static uint64_t address_in(const Buffers& buffers, const char* name);  // 0: there is no such buffer
  std::map<std::string_view, gpu::Buffer> scene_buffers_;
  std::vector<std::shared_ptr<Buffers>> frame_buffers_;
  // Of content that many frames share; frames in flight hold what they use.
  struct SharedBuffer {
    Hash128 key;
    gpu::Buffer buffer;
    std::span<const std::byte> held;    // what it holds, from its begin
    std::shared_ptr<const void> owner;  // of `held`
    std::unique_ptr<gpu::AccelerationStructures> structures;
  };
  std::shared_ptr<SharedBuffer> shared_buffer(const UploadRow& row, Uploaded& uploaded);
  std::map<std::string_view, std::vector<std::shared_ptr<SharedBuffer>>> shared_buffers_;
  std::vector<ByteRange> changed_;
  struct LoadedTexture {
    gpu::Texture texture;
    uint32_t index = shared::absent;
  };
  std::map<TextureKey, LoadedTexture> textures_;
  std::map<TextureKey, bool> mipmapped_;  // over all materials, so that no frame decides for another
  std::vector<uint32_t> samplers_;        // bindless index of each Scene::samplers, filtered as the knobs say
  TextureKnobs texture_knobs_;
  bool normals_stray_ = false;  // the alpha of normal maps is read (surfaces.specular_aa)
  GpuSky sky_;
  GpuProbes probes_;
  gpu::Texture split_sum_;
  uint32_t split_sum_index_ = shared::absent, split_sum_sampler_ = 0;
};

}  // namespace candela
