#pragma once
#include <memory>

#include "gpu/device.h"
#include "gpu/resources.h"

namespace candela::gpu {

// Of a pipeline of rays: its groups' handles, and where each kind stands among them.
struct ShaderTable {
  Buffer handles;
  VkStridedDeviceAddressRegionKHR raygen{}, miss{}, hit{};
};
// Of a pipeline whose groups are one of each kind, in this order. Throws GpuError.
std::shared_ptr<const ShaderTable> make_shader_table(Device& device, VkPipeline pipeline);

}  // namespace candela::gpu
