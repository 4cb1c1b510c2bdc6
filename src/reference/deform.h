#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "scene/frame_data.h"
#include "scene/scene.h"

namespace candela {

// Vertices of a morphed or skinned section at one frame. Skinned ones are in relative space, merely morphed ones in
// mesh space (then the item's transform applies). Normals and tangents are not normalised; arrays the section lacks are
// empty.
struct DeformedVertices {
  std::vector<glm::vec3> position, normal;
  std::vector<glm::vec4> tangent;  // w is the bitangent's sign, turned over where joints mirror
};

// Morph targets, then linear blend skinning, in the order and the 32-bit arithmetic that glTF's rasterizers use, so
// that rays meet the triangles that are drawn.
DeformedVertices deform_vertices(const Scene& scene, const FrameData& frame, const Deformation& deformation);
// Of all of the frame's deformations. polygons: of metaballs too, whose chunks are else empty.
std::vector<DeformedVertices> deform_all(const Scene& scene, const FrameData& frame, bool polygons);

}  // namespace candela
