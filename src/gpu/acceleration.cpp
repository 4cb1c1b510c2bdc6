#include "gpu/acceleration.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"

namespace candela::gpu {
namespace {

constexpr VkBufferUsageFlags input_usage =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

template <class T>
Buffer input_buffer(Device& device, const std::vector<T>& values, const char* name) {
  Buffer buffer(device, values.size() * sizeof(T), input_usage, Buffer::Memory::upload, Device::Purpose::staging, name);
  if (!values.empty()) std::memcpy(buffer.mapped(), values.data(), values.size() * sizeof(T));
  device.count_uploaded(values.size() * sizeof(T));
  return buffer;
}

uint64_t aligned(uint64_t value, uint64_t to) { return (value + to - 1) / to * to; }

}  // namespace

// One command buffer, with what its builds need until they are done.
class AccelerationStructures::Builder {
 public:
  // What one structure is built of; its geometries point into the input's buffers.
  struct Build {
    std::vector<VkAccelerationStructureGeometryKHR> geometries;
    std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  };

  explicit Builder(AccelerationStructures& target) : target_(target), device_(target.device_) {
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &limits_};
    vkGetPhysicalDeviceProperties2(device_.physical(), &properties);
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = device_.queue_family();
    VK_CHECK(vkCreateCommandPool(device_.handle(), &pool, nullptr, &pool_));
  }
  ~Builder() { vkDestroyCommandPool(device_.handle(), pool_, nullptr); }
  Builder(const Builder&) = delete;
  Builder& operator=(const Builder&) = delete;

  const VkPhysicalDeviceAccelerationStructurePropertiesKHR& limits() const { return limits_; }

  void begin() {
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.commandBufferCount = 1;
    VK_CHECK(vkAllocateCommandBuffers(device_.handle(), &allocate, &commands_));
    device_.set_name(VK_OBJECT_TYPE_COMMAND_BUFFER, uint64_t(commands_), "acceleration structures");
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    VK_CHECK(vkBeginCommandBuffer(commands_, &info));
  }

  // Builds structures side by side in one buffer; what comes later sees them. Returns their addresses.
  std::vector<uint64_t> build(VkAccelerationStructureTypeKHR type, const std::vector<Build>& builds, Buffer& storage) {
    if (builds.empty()) return {};
    std::vector<VkAccelerationStructureBuildGeometryInfoKHR> infos;
    std::vector<const VkAccelerationStructureBuildRangeInfoKHR*> ranges;
    std::vector<uint64_t> places, sizes, scratch_places, addresses;
    constexpr uint64_t step = 256;  // Vulkan's, of a structure in its buffer
    const uint64_t scratch_step = limits_.minAccelerationStructureScratchOffsetAlignment;
    uint64_t end = 0, scratch_end = 0;
    for (const Build& build : builds) {
      VkAccelerationStructureBuildGeometryInfoKHR info{
          VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
      info.type = type;
      info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
      info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
      info.geometryCount = uint32_t(build.geometries.size());
      info.pGeometries = build.geometries.data();
      std::vector<uint32_t> counts;
      for (const auto& range : build.ranges) counts.push_back(range.primitiveCount);
      VkAccelerationStructureBuildSizesInfoKHR needs{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
      get_sizes_(device_.handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, counts.data(), &needs);
      infos.push_back(info);
      ranges.push_back(build.ranges.data());
      places.push_back(end);
      sizes.push_back(needs.accelerationStructureSize);
      scratch_places.push_back(scratch_end);
      end += aligned(needs.accelerationStructureSize, step);
      scratch_end += aligned(needs.buildScratchSize, scratch_step);
    }
    storage = Buffer(device_, end,
                     VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                     Buffer::Memory::device, Device::Purpose::frame, "acceleration structures");
    const Buffer& scratch =
        scratch_.emplace_back(device_, scratch_end + scratch_step,
                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                              Buffer::Memory::device, Device::Purpose::staging, "acceleration structures scratch");
    for (size_t i = 0; i < builds.size(); ++i) {
      VkAccelerationStructureCreateInfoKHR create{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
      create.buffer = storage.handle();
      create.offset = places[i];
      create.size = sizes[i];
      create.type = type;
      VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
      VK_CHECK(create_(device_.handle(), &create, nullptr, &handle));
      target_.handles_.push_back(handle);
      const VkAccelerationStructureDeviceAddressInfoKHR address{
          VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR, nullptr, handle};
      addresses.push_back(get_address_(device_.handle(), &address));
      infos[i].dstAccelerationStructure = handle;
      infos[i].scratchData.deviceAddress = aligned(scratch.address(), scratch_step) + scratch_places[i];
    }
    build_(commands_, uint32_t(infos.size()), infos.data(), ranges.data());
    VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    memory.srcStageMask = VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
    memory.srcAccessMask = VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
    memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    memory.dstAccessMask = VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &memory;
    vkCmdPipelineBarrier2(commands_, &dependency);
    return addresses;
  }

  void run() {
    VK_CHECK(vkEndCommandBuffer(commands_));
    const VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, commands_};
    VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &buffer;
    VK_CHECK(vkQueueSubmit2(device_.queue(), 1, &submit, VK_NULL_HANDLE));
    VK_CHECK(vkQueueWaitIdle(device_.queue()));
  }

 private:
  AccelerationStructures& target_;
  Device& device_;
  VkPhysicalDeviceAccelerationStructurePropertiesKHR limits_{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
  PFN_vkGetAccelerationStructureBuildSizesKHR get_sizes_ =
      device_.function<PFN_vkGetAccelerationStructureBuildSizesKHR>("vkGetAccelerationStructureBuildSizesKHR");
  PFN_vkCreateAccelerationStructureKHR create_ =
      device_.function<PFN_vkCreateAccelerationStructureKHR>("vkCreateAccelerationStructureKHR");
  PFN_vkGetAccelerationStructureDeviceAddressKHR get_address_ =
      device_.function<PFN_vkGetAccelerationStructureDeviceAddressKHR>("vkGetAccelerationStructureDeviceAddressKHR");
  PFN_vkCmdBuildAccelerationStructuresKHR build_ =
      device_.function<PFN_vkCmdBuildAccelerationStructuresKHR>("vkCmdBuildAccelerationStructuresKHR");
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  std::vector<Buffer> scratch_;
};

namespace {

constexpr uint64_t most_numbers = 1 << 24;  // of an instance's, with those of its geometries

void check_counts(const AccelerationInput& input, const VkPhysicalDeviceAccelerationStructurePropertiesKHR& limits) {
  const auto check = [&](uint64_t count, uint64_t most, const char* what) {
    if (count > most)
      throw GpuError(VK_ERROR_TOO_MANY_OBJECTS,
                     fmt::format("{} {} of acceleration structures, the device takes {}", count, what, most));
  };
  uint64_t geometries = 0;
  for (const AccelerationInput::Level& level : input.levels) {
    uint64_t triangles = 0;
    for (const AccelerationInput::Geometry& geometry : level) triangles += geometry.triangles;
    check(triangles, limits.maxPrimitiveCount, "triangles in one level");
    check(level.size(), limits.maxGeometryCount, "geometries in one level");
    geometries += level.size();
  }
  check(input.instances.size(), limits.maxInstanceCount, "instances");
  check(geometries + input.instances.size(), most_numbers, "geometries and instances");
}

VkAccelerationStructureGeometryKHR triangles_of(const AccelerationInput::Geometry& from, const Buffer& corners) {
  VkAccelerationStructureGeometryKHR to{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  to.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  to.flags = from.opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR : 0;
  VkAccelerationStructureGeometryTrianglesDataKHR& triangles = to.geometry.triangles;
  triangles = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR};
  triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  triangles.vertexData.deviceAddress = corners.address() + 3 * sizeof(glm::vec3) * uint64_t(from.first_triangle);
  triangles.vertexStride = sizeof(glm::vec3);
  triangles.maxVertex = 3 * from.triangles - 1;
  triangles.indexType = VK_INDEX_TYPE_NONE_KHR;
  return to;
}

}  // namespace

AccelerationStructures::AccelerationStructures(Device& device, const AccelerationInput& input) : device_(device) {
  Builder builder(*this);
  check_counts(input, builder.limits());
  try {
    const Buffer corners = input_buffer(device, input.corners, "corners of acceleration structures");
    builder.begin();
    std::vector<Builder::Build> levels(input.levels.size());
    for (size_t i = 0; i < levels.size(); ++i)
      for (const AccelerationInput::Geometry& geometry : input.levels[i]) {
        levels[i].geometries.push_back(triangles_of(geometry, corners));
        levels[i].ranges.push_back({geometry.triangles, 0, 0, 0});
      }
    const std::vector<uint64_t> addresses =
        builder.build(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, levels, levels_);

    std::vector<VkAccelerationStructureInstanceKHR> rows;
    for (const AccelerationInput::Instance& from : input.instances) {
      VkAccelerationStructureInstanceKHR& to = rows.emplace_back();
      static_assert(sizeof to.transform == sizeof from.world_row);
      std::memcpy(&to.transform, &from.world_row, sizeof to.transform);
      to.instanceCustomIndex = from.number & (most_numbers - 1);
      to.mask = 0xff;
      to.flags = from.opaque ? VK_GEOMETRY_INSTANCE_FORCE_OPAQUE_BIT_KHR : 0;
      to.accelerationStructureReference = addresses[from.level];
    }
    const Buffer instances = input_buffer(device, rows, "instances of acceleration structures");
    VkAccelerationStructureGeometryKHR top{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
    top.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
    top.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR};
    top.geometry.instances.data.deviceAddress = instances.address();
    const Builder::Build all{{top}, {{uint32_t(rows.size()), 0, 0, 0}}};
    address_ = builder.build(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {all}, top_).front();
    builder.run();
  } catch (...) {
    destroy();
    throw;
  }
}

AccelerationStructures::~AccelerationStructures() { destroy(); }

void AccelerationStructures::destroy() {
  const auto destroy_one = device_.function<PFN_vkDestroyAccelerationStructureKHR>("vkDestroyAccelerationStructureKHR");
  for (const VkAccelerationStructureKHR handle : handles_) destroy_one(device_.handle(), handle, nullptr);
}

}  // namespace candela::gpu
