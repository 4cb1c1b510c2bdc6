#pragma once
#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <string>
#include <vector>

// What a pass asks of the compiler: shader files below shaders/, with preprocessor definitions where an interface
// differs
// ("layers.frag#DEPTH=0#NORMAL=1"; everything else is a specialization constant). Plain values, part of the plan,
// hashed and printed. One pipeline layout serves all: the bindless set and 128 bytes of push constants.
namespace candela {

struct SpecConstant {
  uint32_t id;
  std::string name;  // for the print-out: HAS_LIGHTS
  uint32_t value;    // bits of an int, uint, bool or float
  bool operator==(const SpecConstant&) const = default;
};

struct ComputePipelineDesc {
  std::string shader;  // file below shaders/, "cull.comp"
  std::vector<SpecConstant> constants;
  bool operator==(const ComputePipelineDesc&) const = default;
};

// A ray's way from its first shader to what it meets, or misses: one group of each kind. Rays are sent from the first
// alone. Any hit asks of what is not opaque whether it is there.
struct RayPipelineDesc {
  std::string raygen_shader, miss_shader, closest_hit_shader, any_hit_shader;
  std::vector<SpecConstant> constants;  // all stages
  bool operator==(const RayPipelineDesc&) const = default;
};

// coverage: channel by channel, what is covered already or by this: 1 - (1 - old) (1 - new). greatest: the larger one.
enum class Blend : uint8_t { none, premultiplied_over, additive, coverage, greatest };

// Of one colour attachment: how it blends, and which channels are written (bit 0 red to bit 3 alpha).
struct AttachmentState {
  Blend blend = Blend::none;
  uint8_t write_mask = 0xf;
  bool operator==(const AttachmentState&) const = default;
};

// Both faces alike. What the test does with the stored value: it compares (reference & mask) with (stored & mask). The
// reference is dynamic state: CommandList::set_stencil_reference.
struct StencilState {
  VkCompareOp compare = VK_COMPARE_OP_ALWAYS;
  VkStencilOp fail = VK_STENCIL_OP_KEEP, depth_fail = VK_STENCIL_OP_KEEP, pass = VK_STENCIL_OP_KEEP;
  uint8_t read_mask = 0xff, write_mask = 0xff;
  bool operator==(const StencilState&) const = default;
};

struct GraphicsPipelineDesc {
  std::string vertex_shader, fragment_shader;  // fragment empty: depth only
  std::vector<SpecConstant> constants;         // both stages
  VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  std::vector<VkFormat> color_formats;
  VkFormat depth_format = VK_FORMAT_UNDEFINED;
  uint32_t samples = 1;
  VkCompareOp depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;  // reversed depth
  bool depth_test = false, depth_write = false;
  Blend blend = Blend::none;                 // of every colour attachment, unless `attachments` says more
  std::vector<AttachmentState> attachments;  // empty, or one for each colour attachment
  bool stencil_test = false;                 // the depth format holds stencil
  StencilState stencil;
  // Added to depth: constant in units of the format's precision (floats: of the largest depth's exponent), slope in the
  // larger derivative. Depth is reversed, so away from the camera is negative.
  float depth_bias_constant = 0, depth_bias_slope = 0;
  bool depth_clamp = false;  // nothing is clipped at the near and far plane; a feature of the device
  // cull mode and front face are dynamic state: CommandList::set_cull.
  bool operator==(const GraphicsPipelineDesc&) const = default;
};

// Place in the list of the pass that declared it: the executor binds plan.pipelines[plan.passes[i].pipelines[index]].
// So a pass can only bind what it declared, and pruning and merging never invalidate a handle that a recording closure
// holds.
struct PipelineHandle {
  int index = -1;
  explicit operator bool() const { return index >= 0; }
};

}  // namespace candela
