#include "gpu/shader_table.h"

#include <cstring>

namespace candela::gpu {

// One handle of each kind, each where a table may begin.
std::shared_ptr<const ShaderTable> make_shader_table(Device& device, VkPipeline pipeline) {
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR limits{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &limits};
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  const auto aligned = [](uint64_t value, uint64_t to) { return (value + to - 1) / to * to; };
  const uint64_t size = limits.shaderGroupHandleSize, base = limits.shaderGroupBaseAlignment;
  const uint64_t stride = aligned(aligned(size, limits.shaderGroupHandleAlignment), base);
  constexpr uint32_t kinds = 3;
  std::vector<std::byte> handles(kinds * size);
  VK_CHECK(device.function<PFN_vkGetRayTracingShaderGroupHandlesKHR>("vkGetRayTracingShaderGroupHandlesKHR")(
      device.handle(), pipeline, 0, kinds, handles.size(), handles.data()));
  const auto table = std::make_shared<ShaderTable>();
  table->handles = Buffer(device, kinds * stride + base,
                          VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                          Buffer::Memory::upload, Device::Purpose::frame, "shader table");
  const uint64_t begin = aligned(table->handles.address(), base);
  VkStridedDeviceAddressRegionKHR* const regions[kinds] = {&table->raygen, &table->miss, &table->hit};
  for (uint32_t i = 0; i < kinds; ++i) {
    *regions[i] = {begin + i * stride, stride, stride};
    std::memcpy(table->handles.mapped() + (begin - table->handles.address()) + i * stride, handles.data() + i * size,
                size);
  }
  return table;
}

}  // namespace candela::gpu
