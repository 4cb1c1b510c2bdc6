#pragma once
#include <cmath>
#include <vector>

#include "bvh/build.h"
#include "bvh/trace.h"
#include "bvh/wide_tree.h"
#include "reference/accel.h"
#include "reference/metaballs.h"

namespace candela {

inline bool finite(glm::vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Geometry that several items show: a tree in mesh space.
struct AccelPart {
  WideTree tree;
};

struct AccelInstance {
  uint32_t item = 0, part = 0;
  glm::dmat4x3 local_from_relative{1};
  Aabb bounds;  // relative, of the part's triangles and a margin for the rounding of rays
};

// What an Accel is made of.
struct Accel::Trees {
  const Scene* scene = nullptr;
  const FrameData* frame = nullptr;
  const Kernels* kernels = &best_kernels();
  std::vector<DeformedVertices> deformed;
  // Bodies that rays meet as implicit surfaces, and the items that stand for them; of other chunks' items there is
  // nothing.
  struct Implicit {
    uint32_t item;
    MetaballSurface surface;
  };
  std::vector<Implicit> implicit;
  bool meets_implicit = false;
  std::vector<uint8_t> ask;       // per item: bit 0, the filter is asked about fronts; bit 1, about backs
  std::vector<uint8_t> mirrored;  // per item

  WideTree world;                     // triangles of single items, in relative space
  std::vector<uint32_t> world_item;   // per triangle id of `world`
  std::vector<uint8_t> world_doubts;  // of KernelTree, per triangle id; empty: all have world_doubt
  uint8_t world_doubt = 0;
  std::vector<uint32_t> item_first;  // per item: the id of its first triangle in `world`
  WideTree top;                      // over `instances`
  std::vector<AccelInstance> instances;
  std::vector<AccelPart> parts;
  AccelStatistics statistics;

  Trees(const Scene& scene, const Pose& pose, const FrameData& frame, const AccelOptions& options);

  const MeshSection& section_of(const DrawItem& item) const { return scene->meshes[item.mesh].sections[item.section]; }
  bool is_implicit(const DrawItem& item) const { return meets_implicit && section_of(item).metaballs >= 0; }
  bool is_skinned(const DrawItem& item) const {
    return item.deformed >= 0 && frame->deformations[size_t(item.deformed)].joint_count > 0;
  }
  const std::vector<glm::vec3>& positions_of(const DrawItem& item) const {
    return item.deformed >= 0 ? deformed[size_t(item.deformed)].position : section_of(item).position;
  }
};

}  // namespace candela
