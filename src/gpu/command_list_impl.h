#pragma once
#include <initializer_list>
#include <map>
#include <vector>

#include "gpu/bindless.h"
#include "gpu/command_list.h"
#include "gpu/physical.h"
#include "gpu/pipelines.h"
#include "graph/plan.h"

namespace candela::gpu {

// What all passes of one run share.
struct FrameContext {
  Device& device;
  Bindless& bindless;
  const FramePlan& plan;
  const Physical& physical;
  std::vector<const Buffer*> buffers;             // by resource: imported, transient, read back
  const std::vector<const Pipeline*>& pipelines;  // parallel to plan.pipelines
  std::array<uint32_t, 3> max_groups{};           // of one dispatch
  size_t slot = 0;                                // of the frame in flight: Physical::pass_images
  bool hashed = false;                            // outputs are looked at between passes
};

void record_barriers(const FrameContext& frame, const PassBarriers& barriers, VkCommandBuffer commands);

class CommandListImpl final : public CommandList {
 public:
  CommandListImpl(const FrameContext& frame, size_t pass, VkCommandBuffer commands);
  ~CommandListImpl() override = default;
  uint32_t sampled(ImageHandle image) override;
  uint32_t storage(ImageHandle image) override;
  uint64_t address(BufferHandle buffer) override;
  glm::uvec2 size(ImageHandle image) override;
  void bind(PipelineHandle pipeline) override;
  void push_bytes(const void* data, uint32_t bytes) override;
  void dispatch(uint32_t threads_x, uint32_t threads_y, uint32_t threads_z) override;
  void begin_rendering(std::span<const Attachment> colors, ImageHandle depth) override;
  void end_rendering() override;
  void set_cull(bool cull_back, bool mirrored) override;
  void draw(uint32_t vertices, uint32_t instances) override;
  void bind_index_buffer(BufferHandle indices) override;
  void draw_indexed_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                   uint64_t counts_offset, uint32_t max_draws) override;
  void copy_to_buffer(ImageHandle image, BufferHandle buffer) override;
  bool rendering() const { return rendering_; }

 private:
  // The use that the pass declared of this resource and version with one of these accesses. Stops, naming both, without
  // one.
  const PlanUse& use_of(int resource, int version, std::initializer_list<Access> accesses) const;
  template <class Handle>
  const PlanUse& use_of(Handle handle, std::initializer_list<Access> accesses) const {
    return use_of(handle.resource, handle.version, accesses);
  }
  const ImageDesc& desc_of(int resource) const;
  VkRenderingAttachmentInfo attachment(const PlanUse& use) const;
  const Buffer& buffer(int resource) const;

  const FrameContext& frame_;
  const PlanPass& pass_;
  const PassImages& images_;
  VkCommandBuffer commands_;
  const Pipeline* bound_ = nullptr;
  bool rendering_ = false;
};

}  // namespace candela::gpu
