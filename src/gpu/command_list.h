#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "graph/handle.h"
#include "graph/image_range.h"
#include "graph/picture_parts.h"
#include "graph/pipeline_desc.h"

namespace candela {

// What a pass records into. It gives a resource only if the pass declared it (else it stops and names both); it owns no
// memory and places no barrier. Images and buffers reach shaders by bindless index and by device address, in push
// constants.
class CommandList {
 public:
  virtual ~CommandList() = default;

  // Which step of its pass is recorded; 0 in a pass without steps. What a step did not declare is refused in it.
  virtual uint32_t step() const = 0;

  // Places in the step's own descriptor set (shaders/lib/bindless.glsl and lib/image_kinds.glsl, set 1), for the access
  // that was declared. The range and view are those of the declaration; without them, the only ones that there are.
  using View = std::optional<ImageKind>;
  virtual uint32_t sampled(ImageHandle image, ImageRange range = {}, View view = {}) = 0;  // pass_images, ...
  virtual uint32_t storage(ImageHandle image, ImageRange range = {}, View view = {}) = 0;  // storage_images, ...
  virtual uint64_t address(BufferHandle buffer) = 0;
  virtual glm::uvec2 size(ImageHandle image, uint32_t mip = 0) = 0;
  virtual glm::uvec3 size_3d(ImageHandle image, uint32_t mip = 0) = 0;

  virtual void bind(PipelineHandle pipeline) = 0;
  virtual void push_bytes(const void* data, uint32_t bytes) = 0;
  template <class T>
  void push(const T& constants) {
    static_assert(sizeof(T) <= 128);
    push_bytes(&constants, sizeof(T));
  }

  // Threads, not groups: divided by the workgroup size that the bound shader's SPIR-V states, rounded up.
  virtual void dispatch(uint32_t threads_x, uint32_t threads_y = 1, uint32_t threads_z = 1) = 0;
  // The same over the picture, or over texels of so many pixels a side: only those that hold pixels of the part.
  virtual void dispatch_picture(uint32_t threads_x, uint32_t threads_y, PicturePart part = PicturePart::shaded,
                                uint32_t texel_px = 1) = 0;
  // Which group of threads of the bound pipeline dispatch_picture() begins with.
  virtual glm::uvec2 first_group(PicturePart part = PicturePart::shaded) const = 0;
  // Three counts of groups at an offset, written by an earlier pass or step (indirect_read).
  virtual void dispatch_indirect(BufferHandle groups, uint64_t offset = 0) = 0;

  // A ray's first shader for each place, of the bound pipeline of rays.
  virtual void trace_rays(uint32_t width, uint32_t height) = 0;

  struct Attachment {
    ImageHandle image;      // the first write of its range clears, later ones load
    ImageHandle resolve{};  // optional
    ImageRange range{};     // of image; as for sampled
  };
  // Viewport and scissor: the whole mip. Several layers: the vertex shader chooses with gl_Layer.
  virtual void begin_rendering(std::span<const Attachment> colors, ImageHandle depth, ImageRange depth_range = {}) = 0;
  // The same into images of the picture: scissor, and render area where no depth is cleared, are of the part. Beyond it
  // depth is then that of the background.
  virtual void begin_picture(std::span<const Attachment> colors, ImageHandle depth,
                             PicturePart part = PicturePart::shaded) = 0;
  virtual void end_rendering() = 0;
  // In texels; a part of what begin_rendering set: an atlas's tile, a border. Depth 0 to 1.
  virtual void set_viewport(glm::vec2 corner_px, glm::vec2 size_px) = 0;
  virtual void set_scissor(glm::uvec2 corner_px, glm::uvec2 size_px) = 0;
  // cull: none, or back faces; mirrored: front faces are clockwise (negative determinant).
  virtual void set_cull(bool cull_back, bool mirrored) = 0;
  // What pipelines with a stencil test compare with and write; 0 from begin_rendering on.
  // A layer of the depth that is drawn to, all of it.
  virtual void clear_depth_layer(uint32_t layer, float depth) = 0;
  virtual void set_stencil_reference(uint8_t reference) = 0;
  virtual void draw(uint32_t vertices, uint32_t instances = 1) = 0;
  virtual void draw_indirect(BufferHandle commands, uint64_t offset, uint32_t draws) = 0;
  // A list that may be empty. On lavapipe 25.0.7 the count of an earlier draw limits draw_indirect, which has none.
  virtual void draw_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                   uint64_t counts_offset, uint32_t max_draws) = 0;
  virtual void bind_index_buffer(BufferHandle indices) = 0;  // 32-bit
  virtual void draw_indexed(uint32_t indices, uint32_t instances = 1, uint32_t first_index = 0,
                            int32_t vertex_offset = 0) = 0;
  virtual void draw_indexed_indirect(BufferHandle commands, uint64_t offset, uint32_t draws) = 0;
  virtual void draw_indexed_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                           uint64_t counts_offset, uint32_t max_draws) = 0;

  // Copies: transfer_source and transfer_destination. Without a range, the part that was declared. Texels in buffers
  // are tightly packed: mip by mip, and within a mip layer by layer.
  virtual void copy_to_buffer(ImageHandle image, BufferHandle buffer, ImageRange range = {}) = 0;
  virtual void copy_part_to_buffer(ImageHandle image, BufferHandle buffer, const PixelRect& part) = 0;
  virtual void copy_to_image(BufferHandle buffer, ImageHandle image, ImageRange range = {}) = 0;
  virtual void copy_buffer(BufferHandle from, uint64_t from_offset, BufferHandle to, uint64_t to_offset,
                           uint64_t bytes) = 0;
  // Texel by texel, between parts of equal shape and texel size.
  virtual void copy_image(ImageHandle from, ImageHandle to, ImageRange from_range = {}, ImageRange to_range = {}) = 0;
  // A square: from a corner of a layer, counted from the first of the part, to a corner of a layer of the other.
  struct Tile {
    glm::uvec2 corner_px{0};
    uint32_t layer = 0;
  };
  virtual void copy_tile(ImageHandle from, const Tile& from_tile, ImageHandle to, const Tile& to_tile,
                         uint32_t size_px) = 0;
  // Stretched to the size of the target, a mip to a mip; linear: filtered between texels, without a wider kernel.
  virtual void blit(ImageHandle from, ImageHandle to, bool linear, ImageRange from_range = {},
                    ImageRange to_range = {}) = 0;
  virtual void fill_buffer(BufferHandle buffer, uint32_t value, uint64_t offset = 0, uint64_t bytes = ~0ull) = 0;
  virtual void clear_image(ImageHandle image, glm::vec4 value, ImageRange range = {}) = 0;  // depth: value.x
};

}  // namespace candela
