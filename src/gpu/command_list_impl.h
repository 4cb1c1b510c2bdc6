#pragma once
#include <initializer_list>
#include <map>
#include <vector>

#include "gpu/bindless.h"
#include "gpu/command_list.h"
#include "gpu/physical.h"
#include "gpu/pipelines.h"
#include "graph/builder.h"
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
// Every step of a pass, each after its barriers.
void record_steps(const FrameContext& frame, size_t pass, const RecordFunction& record, VkCommandBuffer commands);

class CommandListImpl final : public CommandList {
 public:
  CommandListImpl(const FrameContext& frame, size_t pass, uint32_t step, VkCommandBuffer commands);
  ~CommandListImpl() override = default;
  uint32_t step() const override { return step_; }
  uint32_t sampled(ImageHandle image, ImageRange range, View view) override;
  uint32_t storage(ImageHandle image, ImageRange range, View view) override;
  uint64_t address(BufferHandle buffer) override;
  glm::uvec2 size(ImageHandle image, uint32_t mip) override;
  glm::uvec3 size_3d(ImageHandle image, uint32_t mip) override;
  void bind(PipelineHandle pipeline) override;
  void push_bytes(const void* data, uint32_t bytes) override;
  void dispatch(uint32_t threads_x, uint32_t threads_y, uint32_t threads_z) override;
  void begin_rendering(std::span<const Attachment> colors, ImageHandle depth, ImageRange depth_range) override;
  void end_rendering() override;
  void set_cull(bool cull_back, bool mirrored) override;
  void draw(uint32_t vertices, uint32_t instances) override;
  void bind_index_buffer(BufferHandle indices) override;
  void draw_indexed_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                   uint64_t counts_offset, uint32_t max_draws) override;
  void copy_to_buffer(ImageHandle image, BufferHandle buffer, ImageRange range) override;
  bool rendering() const { return rendering_; }

 private:
  struct Wanted {  // of a resource; range and view as the caller gave them
    int resource, version;
    ImageRange range{};
    View view{};
  };
  // The use that the step declared with one of these accesses. Stops, naming pass and resource, where there is none,
  // and where several parts are declared and the caller names none.
  const PlanUse& use_of(const Wanted& wanted, std::initializer_list<Access> accesses) const;
  const PlanUse& use_of(ImageHandle image, std::initializer_list<Access> accesses, ImageRange range = {},
                        View view = {}) const {
    return use_of(Wanted{image.resource, image.version, range, view}, accesses);
  }
  const PlanUse& use_of(BufferHandle buffer, std::initializer_list<Access> accesses) const {
    return use_of(Wanted{buffer.resource, buffer.version}, accesses);
  }
  const ImageDesc& desc_of(int resource) const;
  VkRenderingAttachmentInfo attachment(const PlanUse& use) const;
  const Buffer& buffer(int resource) const;

  const FrameContext& frame_;
  const PlanPass& pass_;
  const uint32_t step_;
  const StepImages& images_;
  VkCommandBuffer commands_;
  const Pipeline* bound_ = nullptr;
  bool rendering_ = false;
};

}  // namespace candela::gpu
