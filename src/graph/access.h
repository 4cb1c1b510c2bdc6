#pragma once
#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <string_view>

// The one table that says what a use of a resource means to Vulkan. Pure; no device.
namespace candela {

enum class Access : uint8_t {
  // images
  color_attachment,    // written; cleared by its first writer (ImageDesc::covered: not even that), loaded (and blended)
                       // by later ones
  depth_attachment,    // tested and written
  depth_test,          // tested only (EQUAL after a pre-pass); may be shared with sampling
  resolve_attachment,  // written by the end of a multisampled rendering
  sampled_fragment,
  sampled_compute,
  storage_image_write,  // compute
  storage_image_read_write,
  transfer_source,  // images and buffers
  transfer_destination,
  // buffers
  vertex_read,  // storage buffer read in the vertex shader (vertices are pulled)
  fragment_read,
  graphics_read,  // vertex and fragment shader
  uniform_read,   // the one block of uniforms that all shaders of the pass read (lib/frame.glsl)
  compute_read,
  compute_write,   // and read: a storage buffer written by compute
  fragment_write,  // integer atomics from fragment shaders (counters)
  index_read,
  indirect_read,
  host_read,           // after the frame, by the CPU
  storage_image_read,  // images, compute: texels without a sampler, in the layout that a write in the same step has
  sampled_graphics,    // images, vertex and fragment shader
  rays_read,           // storage buffer read by the shaders of a pipeline of rays
  rays_write,          // and written
};
constexpr int access_count = int(Access::rays_write) + 1;

struct AccessInfo {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 mask;
  VkImageLayout layout;             // UNDEFINED for buffer-only accesses; see image_layout
  VkImageUsageFlags image_usage;    // 0 for buffer-only accesses
  VkBufferUsageFlags buffer_usage;  // 0 for image-only accesses
  bool writes;
  std::string_view name;
};
const AccessInfo& access_info(Access access);

// The layout an image of this format has under an access; barriers, attachments and descriptors must all agree on it.
// As in the table, except that a depth image is sampled in the layout that depth_test uses, so one pass can test and
// sample it.
VkImageLayout image_layout(Access access, VkFormat format);
bool is_sampled(Access access);
bool is_depth_format(VkFormat format);
bool has_stencil(VkFormat format);

}  // namespace candela
