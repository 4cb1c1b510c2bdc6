#pragma once
#include <cstdint>
#include <vector>

#include "bvh/acceleration_input.h"
#include "gpu/device.h"
#include "gpu/resources.h"

namespace candela::gpu {

// Acceleration structures of VK_KHR_acceleration_structure, built once on the device, to be traced fast: a bottom level
// for each of the input's, and a top level over the instances. What is submitted to the main queue later sees them.
// Frames that trace them must have ended before they go.
class AccelerationStructures {
 public:
  // Waits for the device. Throws GpuError: memory, or more instances and triangles than the device takes.
  AccelerationStructures(Device& device, const AccelerationInput& input);
  ~AccelerationStructures();
  AccelerationStructures(const AccelerationStructures&) = delete;
  AccelerationStructures& operator=(const AccelerationStructures&) = delete;
  uint64_t address() const { return address_; }  // of the top level, for shaders

 private:
  class Builder;
  void destroy();
  Device& device_;
  Buffer levels_, top_;
  std::vector<VkAccelerationStructureKHR> handles_;
  uint64_t address_ = 0;
};

}  // namespace candela::gpu
