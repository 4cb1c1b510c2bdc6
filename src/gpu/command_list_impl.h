#pragma once
#include <initializer_list>
#include <map>
#include <vector>

#include "gpu/bindless.h"
#include "gpu/command_list.h"
#include "gpu/kept_image.h"
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
  std::vector<const Buffer*>& buffers;            // by resource: imported, transient, read back
  std::vector<const KeptImage*>& kept;            // by resource: imported images
  std::vector<VkImageMemoryBarrier2>& barriers;   // room to write them in
  const std::vector<const Pipeline*>& pipelines;  // parallel to plan.pipelines
  std::array<uint32_t, 3> max_groups{};           // of one dispatch
  size_t slot = 0;                                // of the frame in flight: Physical::pass_images
  bool after_another = false;                     // another frame may still use the images
  bool hashed = false;                            // outputs are looked at between passes
  const PhysicalImage& image(int resource) const {
    const KeptImage* own = kept[size_t(resource)];
    return own ? own->image() : physical.image(resource);
  }
  VkImageView view(const ViewKey& key) const {
    const KeptImage* own = kept[size_t(key.resource)];
    return own ? own->view(key) : physical.view(key);
  }
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
  void dispatch_picture(uint32_t threads_x, uint32_t threads_y, PicturePart part, uint32_t texel_px) override;
  glm::uvec2 first_group(PicturePart part) const override;
  void dispatch_indirect(BufferHandle groups, uint64_t offset) override;
  void trace_rays(uint32_t width, uint32_t height) override;
  void begin_rendering(std::span<const Attachment> colors, ImageHandle depth, ImageRange depth_range) override;
  void begin_picture(std::span<const Attachment> colors, ImageHandle depth, PicturePart part) override;
  void end_rendering() override;
  void set_viewport(glm::vec2 corner_px, glm::vec2 size_px) override;
  void set_scissor(glm::uvec2 corner_px, glm::uvec2 size_px) override;
  void set_cull(bool cull_back, bool mirrored) override;
  void clear_depth_layer(uint32_t layer, float depth) override;
  void set_stencil_reference(uint8_t reference) override;
  void draw(uint32_t vertices, uint32_t instances) override;
  void draw_indirect(BufferHandle commands, uint64_t offset, uint32_t draws) override;
  void draw_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts, uint64_t counts_offset,
                           uint32_t max_draws) override;
  void bind_index_buffer(BufferHandle indices) override;
  void draw_indexed(uint32_t indices, uint32_t instances, uint32_t first_index, int32_t vertex_offset) override;
  void draw_indexed_indirect(BufferHandle commands, uint64_t offset, uint32_t draws) override;
  void draw_indexed_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                   uint64_t counts_offset, uint32_t max_draws) override;
  void copy_to_buffer(ImageHandle image, BufferHandle buffer, ImageRange range) override;
  void copy_part_to_buffer(ImageHandle image, BufferHandle buffer, const PixelRect& part) override;
  void copy_to_image(BufferHandle buffer, ImageHandle image, ImageRange range) override;
  void copy_buffer(BufferHandle from, uint64_t from_offset, BufferHandle to, uint64_t to_offset,
                   uint64_t bytes) override;
  void copy_image(ImageHandle from, ImageHandle to, ImageRange from_range, ImageRange to_range) override;
  void copy_tile(ImageHandle from, const Tile& from_tile, ImageHandle to, const Tile& to_tile,
                 uint32_t size_px) override;
  void blit(ImageHandle from, ImageHandle to, bool linear, ImageRange from_range, ImageRange to_range) override;
  void fill_buffer(BufferHandle buffer, uint32_t value, uint64_t offset, uint64_t bytes) override;
  void clear_image(ImageHandle image, glm::vec4 value, ImageRange range) override;
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
  struct Part {  // of an image, to be copied
    const ImageDesc& desc;
    const PhysicalImage& image;
    ImageRange range;
    VkImageLayout layout;
  };
  Part part(ImageHandle image, Access access, ImageRange range) const;
  void check_drawing() const;
  void begin_in(std::span<const Attachment> colors, ImageHandle depth, ImageRange depth_range, const PixelRect* part);
  void bind_sets(VkPipelineBindPoint point);

  const FrameContext& frame_;
  const PlanPass& pass_;
  const uint32_t step_;
  const StepImages& images_;
  VkCommandBuffer commands_;
  const Pipeline* bound_ = nullptr;
  bool rendering_ = false;
  VkExtent2D rendered_{};  // what is drawn to
};

}  // namespace candela::gpu
