#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "graph/handle.h"
#include "graph/image_range.h"
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

  struct Attachment {
    ImageHandle image;      // the first write of its range clears, later ones load
    ImageHandle resolve{};  // optional
    ImageRange range{};     // of image; as for sampled
  };
  // Viewport and scissor: the whole mip. Several layers: the vertex shader chooses with gl_Layer.
  virtual void begin_rendering(std::span<const Attachment> colors, ImageHandle depth, ImageRange depth_range = {}) = 0;
  virtual void end_rendering() = 0;
  // cull: none, or back faces; mirrored: front faces are clockwise (negative determinant).
  virtual void set_cull(bool cull_back, bool mirrored) = 0;
  virtual void draw(uint32_t vertices, uint32_t instances = 1) = 0;
  virtual void bind_index_buffer(BufferHandle indices) = 0;  // 32-bit
  virtual void draw_indexed_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                           uint64_t counts_offset, uint32_t max_draws) = 0;

  // Tightly packed: mip by mip, and within a mip layer by layer.
  virtual void copy_to_buffer(ImageHandle image, BufferHandle buffer, ImageRange range = {}) = 0;
};

}  // namespace candela
