#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "gpu/device.h"
#include "gpu/resources.h"

namespace candela::gpu {

// Triangles for the device's own trees. A triangle's corners follow each other; one whose first corner is not a number
// is never met.
struct AccelerationInput {
  struct Geometry {  // of triangles that stand together
    uint32_t first_triangle, triangles;
    bool opaque;  // met without asking a shader
  };
  using Level = std::vector<Geometry>;  // of one bottom level
  struct Instance {
    uint32_t level;                      // among `levels`
    uint32_t number;                     // that shaders read
    bool opaque;                         // whatever its geometries are
    std::array<glm::vec4, 3> world_row;  // of world_from_level; shaders' rays are in this world
  };
  std::vector<glm::vec3> corners;
  std::vector<Level> levels;
  std::vector<Instance> instances;
};

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
