#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace candela {

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

}  // namespace candela
