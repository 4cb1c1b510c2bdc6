#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bvh/options.h"
#include "bvh/ray.h"
#include "math/bounds.h"
#include "reference/deform.h"
#include "scene/frame_data.h"
#include "scene/pose.h"
#include "scene/scene.h"

namespace candela {

struct Kernels;
class MetaballSurface;

struct AccelOptions {
  BvhOptions tree;
  // How many rays are to be traced, nearly: tree.builder is then replaced by the one that pays. Hits do not depend on
  // it.
  std::optional<double> rays;
  // Geometry that items share is repeated for each while that takes no more triangles beyond the first copies, for
  // rays cross one tree faster than a tree of trees. It decides how corners are rounded, so it must not depend on how
  // many rays are traced.
  size_t repeated_triangles = 1u << 19;
  // false: the filter is asked only where the material leaves a doubt: alpha masks and blending, what glows all
  // over (scene/glow.h), and backs of surfaces that are not double sided. true: for every candidate.
  bool always_ask_filter = false;
  bool implicit = false;             // metaballs are met as the surfaces they are; else their polygons
  bool open_sides = false;           // fronts of surfaces that are not double sided leave a doubt too
  bool measure_cost = false;         // fill AccelStatistics::sah_cost
  const Kernels* kernels = nullptr;  // null: the best for this processor (trace.h); all give the same hits
};

// A triangle of an item as it lies in relative space, after morphing and skinning.
struct PosedTriangle {
  std::array<uint32_t, 3> vertex;     // into the arrays of the section (or of Accel::deformed)
  std::array<glm::vec3, 3> position;  // relative, metres
};

// A point on a surface, with what is needed to leave it.
struct SurfacePoint {
  glm::vec3 position{0};          // relative; from the corners, hence closer to the surface than origin + t * direction
  glm::vec3 geometric_normal{0};  // unit, towards the glTF front side; zero for a degenerate triangle
  float error_m = 0;              // a ray that begins this far off along the normal does not meet this triangle again
  uint32_t relief_item = no_relief, relief_primitive = 0;  // of a point on a relief: its triangle
};

struct LeafBox {
  Aabb box;            // relative space (of an instanced tree: the box around its transformed box)
  uint32_t triangles;  // references in the leaf
  uint32_t depth;      // of the wide tree
};

// Spatial splits cost more to build and save a part of what every ray takes.
BvhBuilder builder_that_pays(double rays, double triangles);

struct AccelStatistics {
  BvhBuilder builder = BvhBuilder::sah;
  size_t triangles = 0;      // in all trees, instanced ones once
  size_t references = 0;     // in leaves; above `triangles` by spatial splits
  size_t instances = 0;      // items reached through the top tree
  size_t left_out = 0;       // triangles with non-finite corners
  size_t skipped_items = 0;  // items of points or lines: rays do not meet them
  size_t binary_nodes = 0;   // of the trees as built; instanced ones once
  size_t nodes = 0, bytes = 0;
  double sah_cost = 0;  // of the binary trees (instanced ones once), in tests of four triangles, if asked for
  double build_ms = 0;
};

// The triangles of one posed frame, for rays. Items whose geometry occurs once lie in one tree of relative space, with
// the vertices the rasterizer has; geometry that occurs several times has a tree of its own and a top tree over its
// instances. Points and lines are not traced. Answers do not depend on the number of threads, on the builder (up to
// ties at equal t, which the lower item and primitive wins) nor on the processor's vector width. The scene and the
// frame must outlive it.
class Accel {
 public:
  Accel(const Scene& scene, const Pose& pose, const FrameData& frame, const AccelOptions& options = {});
  ~Accel();
  Accel(Accel&&) noexcept;
  Accel& operator=(Accel&&) noexcept;

  // The nearest accepted hit with t_min <= t <= t_max. No filter accepts everything. Rays with non-finite numbers or no
  // direction hit nothing. Safe to call from many threads.
  std::optional<Hit> closest(const Ray& ray, const HitFilter* filter = nullptr, TraceCounts* counts = nullptr) const;
  // Whether there is any accepted hit.
  bool occluded(const Ray& ray, const HitFilter* filter = nullptr, TraceCounts* counts = nullptr) const;

  // Of many rays what each of them would get alone. Quicker where rays that follow one another run side by side: they
  // share their way down the world tree by sixteens (bvh/trace_packet.h). hits and blocked are as many as the rays.
  void closest(std::span<const Ray> rays, std::span<std::optional<Hit>> hits, const HitFilter* filter = nullptr) const;
  void occluded(std::span<const Ray> rays, std::span<bool> blocked, const HitFilter* filter = nullptr) const;

  PosedTriangle triangle(uint32_t item, uint32_t primitive) const;
  SurfacePoint surface(const Hit& hit) const;
  // The implicit surface that the item is; null: triangles.
  const MetaballSurface* implicit(uint32_t item) const;
  // The vertices of FrameData::deformations[deformation] at this frame.
  const DeformedVertices& deformed(int deformation) const;

  std::vector<LeafBox> leaves() const;
  const AccelStatistics& statistics() const;

  struct Trees;  // accel_trees.h: for tests and tools
  const Trees& trees() const { return *trees_; }

 private:
  std::unique_ptr<Trees> trees_;
};

// The origin of a ray that leaves `point` in `direction` (to either side) without meeting the triangle it comes from.
glm::vec3 leaving_origin(const SurfacePoint& point, glm::vec3 direction);

}  // namespace candela
