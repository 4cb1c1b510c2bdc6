#include "plan/frame_rays.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <span>

#include "base/check.h"
#include "passes/shared/bvh_knobs.h"
#include "plan/pack_nodes.h"
#include "reference/accel_trees.h"
#include "scene/draw_list.h"
#include "scene/geometry_layout.h"
#include "scene/glow.h"
#include "shared/trace.h"

namespace candela {
namespace {

class Hashed {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <class T>
  void add_all(const std::vector<T>& values) {
    add(uint64_t(values.size()));
    const auto bytes = std::as_bytes(std::span(values));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  Hash128 hash() const { return hash128(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

const Material* material_of(const Pose& pose, const DrawItem& item) {
  return item.material >= 0 ? &pose.materials[size_t(item.material)] : nullptr;
}

// Tables one behind the other.
class Tables {
 public:
  // Places a table, never an empty one; returns where, in units of trace_table_align.
  uint32_t place(size_t bytes) {
    const size_t at = (end_ + shared::trace_table_align - 1) / shared::trace_table_align;
    end_ = at * shared::trace_table_align + std::max<size_t>(bytes, shared::trace_table_align);
    CHECK_MSG(at <= UINT32_MAX, "trees for rays");
    return uint32_t(at);
  }
  size_t end() const { return end_; }

 private:
  size_t end_ = sizeof(shared::TraceScene);
};

template <class T, class Rays>
T* table(Rays& rays, uint32_t at) {
  return reinterpret_cast<T*>(rays.bytes.data() + size_t(at) * shared::trace_table_align);
}

// Blocks of triangles as rays test them, one by one. name(id, triangle) says which it is.
template <class Name>
void copy_blocks(const WideTree& tree, shared::TraceTriangle* out, const Name& name) {
  tbb::parallel_for(size_t(0), tree.blocks.size(), [&](size_t b) {
    const TriangleBlock& block = tree.blocks[b];
    for (size_t lane = 0; lane < block_triangles; ++lane) {
      shared::TraceTriangle& t = out[block_triangles * b + lane];
      t = {};
      t.item = shared::no_trace;
      if (block.id[lane] == no_triangle) continue;
      for (size_t axis = 0; axis < 3; ++axis) {
        t.a[int(axis)] = block.corner[0][axis][lane];
        t.b[int(axis)] = block.corner[1][axis][lane];
        t.c[int(axis)] = block.corner[2][axis][lane];
      }
      name(block.id[lane], t);
    }
  });
}

glm::vec2 transformed(const TextureSlot& slot, glm::vec2 given) {
  const glm::dvec2 uv = glm::dvec2(slot.scale) * glm::dvec2(given);
  const double c = std::cos(double(slot.rotation_rad)), s = std::sin(double(slot.rotation_rad));
  return {c * uv.x + s * uv.y + double(slot.offset.x), -s * uv.x + c * uv.y + double(slot.offset.y)};
}

// Of reliefs: where they end, and then the triangles. to_tree: from the mesh's space into that of the tree.
void fill_relief_corners(const MeshSection& section, const std::vector<glm::vec3>& positions, const Material& material,
                         const glm::mat3& to_tree, shared::TraceCorners* out) {
  const std::vector<glm::vec2>& uv = material.relief.texture.uv_set == 1 ? section.uv1 : section.uv0;
  const UvBounds bounds = uv_bounds(uv);
  *out = {};
  out->uv[0] = bounds.least, out->uv[1] = bounds.most;
  out->alpha.x = material.relief.silhouettes && !uv.empty() ? 1.0f : 0.0f;
  tbb::parallel_for(size_t(0), section.index.size() / 3, [&](size_t t) {
    shared::TraceCorners& c = out[1 + t];
    glm::vec3 p[3];
    for (size_t k = 0; k < 3; ++k) {
      const size_t v = section.index[3 * t + k];
      c.uv[k] = uv.empty() ? glm::vec2(0) : uv[v];
      p[k] = positions[v];
    }
    const glm::dvec3 front = glm::cross(glm::dvec3(p[1] - p[0]), glm::dvec3(p[2] - p[0]));
    const double length = glm::length(front);
    const glm::dvec3 below = length > 0 ? front * (-double(material.relief.depth) / length) : glm::dvec3(0);
    c.alpha = to_tree * glm::vec3(below);
  });
}

// Of a section's triangles with a material, whose coverage differs from place to place.
void fill_corners(const MeshSection& section, const Material& material, shared::TraceCorners* out) {
  const TextureSlot& slot = material.base_color_texture;
  const std::vector<glm::vec2>& uv = slot.uv_set == 1 ? section.uv1 : section.uv0;
  tbb::parallel_for(size_t(0), section.index.size() / 3, [&](size_t t) {
    for (size_t k = 0; k < 3; ++k) {
      const size_t v = section.index[3 * t + k];
      out[t].uv[k] = slot && !uv.empty() ? transformed(slot, uv[v]) : transformed(slot, glm::vec2(0));
      out[t].alpha[int(k)] = section.color.empty() ? 1.0f : section.color[v].w;
    }
  });
}

glm::vec4 row_of(const glm::mat4& m, int r) { return {m[0][r], m[1][r], m[2][r], m[3][r]}; }

shared::TraceInstance shared_instance(const AccelInstance& from, const glm::mat4& relative_from_local, uint32_t root) {
  shared::TraceInstance out{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      const double exact = from.local_from_relative[c][r];
      out.local_row[r][c] = float(exact);
      out.local_rest[r][c] = float(exact - double(out.local_row[r][c]));
    }
    out.relative_row[r] = row_of(relative_from_local, r);
  }
  out.item = from.item, out.root = root;
  return out;
}

BvhBuilder builder_of(int choice) {
  switch (choice) {
    case BvhKnobs::equal_counts:
      return BvhBuilder::equal_counts;
    case BvhKnobs::sbvh:
      return BvhBuilder::sbvh;
    case BvhKnobs::spatial_only:
      return BvhBuilder::spatial_only;
    default:
      return BvhBuilder::sah;
  }
}

class LayOut {
 public:
  LayOut(const Accel& accel, const Scene& scene, const Pose& pose, const FrameData& data, bool refraction,
         bool open_sides, bool on_device)
      : accel_(accel),
        trees_(accel.trees()),
        scene_(scene),
        pose_(pose),
        data_(data),
        refraction_(refraction),
        open_sides_(open_sides),
        on_device_(on_device) {}

  FrameRays run() {
    place();
    rays_.bytes.resize(tables_.end());
    std::memcpy(rays_.bytes.data(), &head_, sizeof head_);
    fill_items();
    fill_trees();
    fill_instances();
    if (on_device_) fill_on_device();
    tbb::parallel_for(size_t(0), corner_uses_.size(), [&](size_t i) {
      const auto& [section, material, first, item] = corner_uses_[i];
      shared::TraceCorners* const out = table<shared::TraceCorners>(rays_, head_.corners) + first;
      if (material->has_relief())
        fill_relief_corners(*section, trees_.positions_of(data_.items[item]), *material, relief_space(item), out);
      else
        fill_corners(*section, *material, out);
    });
    uint32_t below = 0;
    for (const AccelPart& part : trees_.parts) below = std::max(below, part.tree.depth);
    // One entry a level; a leaf of instances takes one too.
    rays_.stack = std::max({trees_.world.depth, trees_.top.nodes.empty() ? 0 : trees_.top.depth + 1 + below, 1u});
    rays_.statistics = trees_.statistics;
    rays_.ranges = std::make_shared<const std::vector<TreeRange>>(std::move(ranges_));
    return std::move(rays_);
  }

 private:
  void place() {
    size_t nodes = trees_.world.nodes.size() + trees_.top.nodes.size();
    size_t blocks = trees_.world.blocks.size();
    for (const AccelPart& part : trees_.parts) nodes += part.tree.nodes.size(), blocks += part.tree.blocks.size();
    CHECK_MSG(blocks <= leaf_first_mask && nodes < leaf_bit && trees_.instances.size() <= leaf_first_mask,
              "more triangles than a tree's 32-bit references reach");
    head_.nodes = tables_.place(nodes * sizeof(shared::TraceNode));
    head_.triangles = tables_.place(blocks * block_triangles * sizeof(shared::TraceTriangle));
    head_.items = tables_.place(data_.items.size() * sizeof(shared::TraceItem));
    head_.instances = tables_.place(trees_.top.indices.size() * sizeof(shared::TraceInstance));
    head_.world_root = trees_.world.nodes.empty() ? shared::no_trace : 0;
    head_.top_root = trees_.top.nodes.empty() ? shared::no_trace : uint32_t(trees_.world.nodes.size());
    place_corners();
  }

  // One table serves all items that show a section with the same texture coordinates.
  void place_corners() {
    std::map<std::tuple<uint32_t, uint32_t, int>, uint32_t> known;  // mesh, section, material
    size_t corners = 0;
    for (uint32_t i = 0; i < data_.items.size(); ++i) {
      const DrawItem& item = data_.items[i];
      first_corner_.push_back(shared::no_trace);
      const Material* material = material_of(pose_, item);
      const MeshSection& section = trees_.section_of(item);
      if (!material || section.topology != Topology::triangles) continue;
      if (material->has_relief()) {
        // Each its own: the way to the floor is in the space of the triangles, which items pose.
        first_corner_.back() = uint32_t(corners);
        corner_uses_.emplace_back(&section, material, corners, i);
        corners += 1 + section.index.size() / 3;
        CHECK_MSG(corners < shared::no_trace, "triangles of reliefs");
        continue;
      }
      if (material->alpha_mode == AlphaMode::opaque) continue;
      const auto [at, is_new] = known.try_emplace({item.mesh, item.section, item.material}, uint32_t(corners));
      first_corner_.back() = at->second;
      if (!is_new) continue;
      corner_uses_.emplace_back(&section, material, corners, i);
      corners += section.index.size() / 3;
      CHECK_MSG(corners < shared::no_trace, "masked triangles");
    }
    head_.corners = tables_.place(corners * sizeof(shared::TraceCorners));
    if (on_device_) {
      head_.geometries = tables_.place(data_.items.size() * sizeof(shared::TraceGeometry));
      head_.places = tables_.place(triangle_count() * sizeof(uint32_t));
    }
    head_.end = tables_.place(0);
  }

  // Triangles of instances are in the mesh's space, those of skins in relative space however they are placed.
  glm::mat3 relief_space(uint32_t item) const {
    const bool instanced =
        std::ranges::any_of(trees_.instances, [&](const AccelInstance& i) { return i.item == item; });
    if (instanced || trees_.is_skinned(data_.items[item])) return glm::mat3(1);
    return glm::mat3(data_.relative_from_local[data_.items[item].transform]);
  }

  // Of the world tree, then of the parts; not those with corners that are no numbers.
  size_t triangle_count() const {
    size_t count = trees_.world_item.size();
    for (const AccelInstance& instance : first_of_parts()) count += triangles_of(instance.item);
    return count;
  }
  uint32_t triangles_of(uint32_t item) const { return uint32_t(trees_.section_of(data_.items[item]).index.size() / 3); }
  // An instance of each part.
  std::vector<AccelInstance> first_of_parts() const {
    std::vector<AccelInstance> first(trees_.parts.size());
    for (const AccelInstance& instance : trees_.instances) first[instance.part] = instance;
    return first;
  }

  void fill_items() {
    shared::TraceItem* const items = table<shared::TraceItem>(rays_, head_.items);
    for (size_t i = 0; i < data_.items.size(); ++i) {
      const DrawItem& item = data_.items[i];
      const Material* material = material_of(pose_, item);
      shared::TraceItem out{};
      out.material = uint32_t(material ? size_t(item.material) : pose_.materials.size());
      out.first_corner = first_corner_[i];
      out.flags = item.mirrored ? shared::trace_mirrored : 0;
      if (trees_.section_of(item).metaballs >= 0) out.flags |= shared::trace_rounded;
      if (material) {
        if (material->alpha_mode == AlphaMode::mask) out.flags |= shared::trace_masked;
        if (has_relief(trees_.section_of(item), *material)) out.flags |= shared::trace_relief_bit;
        const bool passes = refraction_ && refracts(trees_.section_of(item), *material);
        const bool blended = material->alpha_mode == AlphaMode::blend && !passes;
        if (blended) out.flags |= shared::trace_blended;
        if (glows_all_over(*material)) out.flags |= shared::trace_glows;
        if (passes) out.flags |= shared::trace_refracts;
        rays_.blended |= blended;
      }
      const bool is_body = (out.flags & shared::trace_refracts) != 0;
      if (open_sides_ && !is_body && !(material && material->double_sided)) out.flags |= shared::trace_single;
      items[i] = out;
    }
  }
  uint32_t named(uint32_t item) const {
    const bool asks = (table<const shared::TraceItem>(rays_, head_.items)[item].flags & ~shared::trace_rounded) != 0;
    return item | (asks ? shared::trace_asked : 0);
  }

  void fill_trees() {
    shared::TraceNode* const nodes = table<shared::TraceNode>(rays_, head_.nodes);
    shared::TraceTriangle* const triangles = table<shared::TraceTriangle>(rays_, head_.triangles);
    copy_nodes(trees_.world, 0, 0, nodes);
    copy_nodes(trees_.top, trees_.world.nodes.size(), 0, nodes);
    add_range(0, trees_.world, shared::no_trace, false);
    add_range(trees_.world.nodes.size(), trees_.top, shared::no_trace, true);
    copy_blocks(trees_.world, triangles, [&](uint32_t id, shared::TraceTriangle& t) {
      Hit hit;
      hit.item = trees_.world_item[id];
      hit.primitive = id - trees_.item_first[hit.item];
      t.item = named(hit.item), t.primitive = hit.primitive;
      t.error_m = accel_.surface(hit).error_m;
    });
    size_t node = trees_.world.nodes.size() + trees_.top.nodes.size(), block = trees_.world.blocks.size();
    for (const AccelPart& part : trees_.parts) {
      copy_nodes(part.tree, node, block, nodes);
      copy_blocks(part.tree, triangles + block_triangles * block,
                  [](uint32_t id, shared::TraceTriangle& t) { t.item = shared::trace_asked, t.primitive = id; });
      roots_.push_back(part.tree.nodes.empty() ? shared::no_trace : uint32_t(node));
      node += part.tree.nodes.size(), block += part.tree.blocks.size();
    }
  }
  static void copy_nodes(const WideTree& tree, size_t first_node, size_t first_leaf, shared::TraceNode* nodes) {
    tbb::parallel_for(size_t(0), tree.nodes.size(), [&](size_t n) {
      nodes[first_node + n] = packed_node(tree.nodes[n], uint32_t(first_node), uint32_t(first_leaf));
    });
  }

  // In the order in which the leaves of the top tree name them.
  void fill_instances() {
    shared::TraceInstance* const out = table<shared::TraceInstance>(rays_, head_.instances);
    for (size_t i = 0; i < trees_.top.indices.size(); ++i) {
      const AccelInstance& instance = trees_.instances[trees_.top.indices[i]];
      out[i] = shared_instance(instance, data_.relative_from_local[data_.items[instance.item].transform],
                               roots_[instance.part]);
      out[i].item = named(instance.item);
      add_range(roots_[instance.part], trees_.parts[instance.part].tree, uint32_t(i), false);
    }
  }

  // Corners are those of the trees' blocks, so that both have the same triangles, bit for bit.
  void fill_on_device() {
    AccelerationInput& out = rays_.on_device;
    const size_t count = triangle_count();
    out.corners.assign(3 * count, glm::vec3(std::numeric_limits<float>::quiet_NaN()));
    uint32_t* const places = table<uint32_t>(rays_, head_.places);
    std::fill_n(places, count, 0);
    const auto take_blocks = [&](const WideTree& tree, size_t first_block, size_t first_triangle) {
      for (size_t b = tree.blocks.size(); b-- > 0;)
        for (uint32_t lane = 0; lane < 4; ++lane) {
          const TriangleBlock& block = tree.blocks[b];
          if (block.id[lane] == no_triangle) continue;
          const size_t triangle = first_triangle + block.id[lane];
          places[triangle] = uint32_t(4 * (first_block + b) + lane);
          for (size_t k = 0; k < 3; ++k)
            for (size_t a = 0; a < 3; ++a) out.corners[3 * triangle + k][int(a)] = block.corner[k][a][lane];
        }
    };
    shared::TraceGeometry* geometry = table<shared::TraceGeometry>(rays_, head_.geometries);
    uint32_t numbers = 0;
    const auto add = [&](shared::TraceGeometry g) { geometry[numbers++] = g; };

    take_blocks(trees_.world, 0, 0);
    AccelerationInput::Level world;
    std::vector<bool> is_instance(data_.items.size());
    for (const AccelInstance& instance : trees_.instances) is_instance[instance.item] = true;
    for (uint32_t i = 0; i < data_.items.size(); ++i) {
      const bool traced = trees_.section_of(data_.items[i]).topology == Topology::triangles;
      if (!traced || is_instance[i] || triangles_of(i) == 0) continue;
      world.push_back({trees_.item_first[i], triangles_of(i), asks_nothing(i)});
      add({i, trees_.item_first[i], shared::no_trace});
    }
    if (!world.empty()) {
      out.levels.push_back(std::move(world));
      out.instances.push_back({0, 0, false, {glm::vec4(1, 0, 0, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0)}});
    }
    const size_t first_level = out.levels.size();
    std::vector<uint32_t> first_triangle;
    size_t block = trees_.world.blocks.size(), triangle = trees_.world_item.size();
    const std::vector<AccelInstance> shown_by = first_of_parts();
    for (size_t p = 0; p < trees_.parts.size(); ++p) {
      take_blocks(trees_.parts[p].tree, block, triangle);
      first_triangle.push_back(uint32_t(triangle));
      const uint32_t triangles = triangles_of(shown_by[p].item);
      out.levels.push_back({{uint32_t(triangle), triangles, false}});
      block += trees_.parts[p].tree.blocks.size(), triangle += triangles;
    }
    for (size_t i = 0; i < trees_.top.indices.size(); ++i) {
      const AccelInstance& instance = trees_.instances[trees_.top.indices[i]];
      const shared::TraceInstance& placed = table<shared::TraceInstance>(rays_, head_.instances)[i];
      out.instances.push_back({uint32_t(first_level + instance.part),
                               numbers,
                               asks_nothing(instance.item),
                               {placed.relative_row[0], placed.relative_row[1], placed.relative_row[2]}});
      add({instance.item, first_triangle[instance.part], uint32_t(i)});
    }
  }
  // No ray asks more of its triangles than where they are.
  bool asks_nothing(uint32_t item) const {
    return (table<const shared::TraceItem>(rays_, head_.items)[item].flags &
            (shared::trace_masked | shared::trace_glows | shared::trace_refracts | shared::trace_single |
             shared::trace_relief_bit)) == 0;
  }

  void add_range(size_t first_node, const WideTree& tree, uint32_t instance, bool holds_instances) {
    if (!tree.nodes.empty())
      ranges_.push_back({uint32_t(first_node), uint32_t(tree.nodes.size()), instance, holds_instances});
  }

  const Accel& accel_;
  const Accel::Trees& trees_;
  const Scene& scene_;
  const Pose& pose_;
  const FrameData& data_;
  const bool refraction_, open_sides_, on_device_;
  FrameRays rays_;
  shared::TraceScene head_{};
  Tables tables_;
  std::vector<uint32_t> first_corner_, roots_;  // by item; by part
  std::vector<TreeRange> ranges_;
  std::vector<std::tuple<const MeshSection*, const Material*, size_t, uint32_t>> corner_uses_;
};

}  // namespace

Hash128 rays_key(const Scene& scene, const Pose& pose, const FrameData& data, bool refraction, bool open_sides,
                 const BvhKnobs& knobs) {
  Hashed out;
  out.add(uint32_t(open_sides));
  for (const Knob& row : BvhKnobs::table()) out.add(row.value(&knobs));
  for (const DrawItem& item : data.items) {
    for (const uint32_t n :
         {item.mesh, item.section, uint32_t(item.material), uint32_t(item.mirrored), uint32_t(item.deformed)})
      out.add(n);
    out.add(data.relative_from_local[item.transform]);
    const Material* m = material_of(pose, item);
    if (!m) continue;
    const bool passes = refraction && refracts(scene.meshes[item.mesh].sections[item.section], *m);
    out.add(uint32_t(m->alpha_mode) | uint32_t(m->double_sided) << 4 | uint32_t(glows_all_over(*m)) << 5 |
            uint32_t(passes) << 6);
    if (m->has_relief()) out.add(m->relief.depth), out.add(uint32_t(m->relief.silhouettes));
    if (m->has_relief()) out.add(m->relief.texture.uv_set);
    if (m->alpha_mode == AlphaMode::opaque) continue;
    const TextureSlot& slot = m->base_color_texture;
    out.add(slot.image), out.add(slot.uv_set), out.add(slot.offset), out.add(slot.scale), out.add(slot.rotation_rad);
  }
  for (const Deformation& d : data.deformations)
    for (const uint32_t n : {d.mesh, d.section, d.first_joint, d.joint_count, d.first_weight, d.weight_count})
      out.add(n);
  out.add_all(data.joint_matrices);
  out.add_all(data.morph_weights);
  for (const PosedMetaballs& body : data.metaballs) {
    out.add(body.threshold), out.add(body.lattice.cell_m), out.add(body.lattice.origin_cell);
    out.add_all(body.balls);
  }
  return out.hash();
}

FrameRays lay_out_rays(const Accel& accel, const Scene& scene, const Pose& pose, const FrameData& data, bool refraction,
                       bool open_sides, bool on_device) {
  static_assert(leaf_bit == shared::trace_leaf_bit && leaf_count_shift == shared::trace_leaf_shift &&
                no_child == shared::no_trace && block_triangles == shared::trace_block);
  return LayOut(accel, scene, pose, data, refraction, open_sides, on_device).run();
}

std::shared_ptr<const FrameRays> make_frame_rays(const Scene& scene, const Pose& pose, const FrameData& data,
                                                 bool refraction, bool open_sides, const BvhKnobs& knobs) {
  AccelOptions options;
  options.tree = {.builder = builder_of(knobs.builder),
                  .buckets = knobs.buckets,
                  .split_budget = knobs.budget,
                  .max_leaf = uint32_t(knobs.max_leaf),
                  .depth = uint32_t(knobs.depth),
                  .block_shift = uint32_t(knobs.block),
                  .node_cost = knobs.node_cost};
  options.repeated_triangles = size_t(knobs.repeated);
  FrameRays rays =
      lay_out_rays(Accel(scene, pose, data, options), scene, pose, data, refraction, open_sides, knobs.on_device());
  rays.key = rays_key(scene, pose, data, refraction, open_sides, knobs);
  return std::make_shared<const FrameRays>(std::move(rays));
}

}  // namespace candela
