#pragma once
#include "gltf/accessors.h"
#include "scene/scene.h"

// Repairs of vertex data after reading: what the specification leaves to the loader, and small faults of real files.
namespace candela::gltf {
// Unit normals and tangents with signs of +-1. Zero normals become those of the neighbouring triangles.
void repair_normals(Document& document, MeshSection& section, bool stored_as_float);
void repair_tangents(Document& document, MeshSection& section, bool stored_as_float);
// Warns where min and max of the POSITION accessor are not those of its values.
void report_wrong_bounds(Document& document, const MeshSection& section, const tinygltf::Accessor& accessor,
                         const std::string& path);
// Weights of both sets sum to 1; where all are zero the vertex follows the first joint of its first set. Joints without
// weight become 0, so that they need not exist.
void repair_weights(Document& document, MeshSection& section);
}  // namespace candela::gltf
