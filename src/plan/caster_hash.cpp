#include "plan/caster_hash.h"

#include <tbb/parallel_for.h>

#include <cstring>

#include "base/scratch.h"
#include "plan/frame_views.h"
#include "scene/glow.h"

namespace candela {
namespace {

// Bytes of what is laid out for the device, which has no padding, and of single numbers.
class Bytes {
 public:
  explicit Bytes(std::pmr::memory_resource* memory) : bytes_(memory) {}
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 8);
    const size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
  }
  Hash128 hash() const { return hash128(bytes_); }

 private:
  std::pmr::vector<std::byte> bytes_;
};

void add_mask(const Material& m, Bytes& out) {
  out.add(m.base_color.w);
  out.add(m.alpha_cutoff);
  const TextureSlot& slot = m.base_color_texture;
  out.add(slot.image);
  out.add(slot.sampler);
  out.add(slot.uv_set);
  out.add(slot.offset);
  out.add(slot.scale);
  out.add(slot.rotation_rad);
}

void add_relief(const Material& m, Bytes& out) {
  out.add(m.relief.depth);
  out.add(uint32_t(m.relief.silhouettes));
  const TextureSlot& slot = m.relief.texture;
  out.add(slot.image);
  out.add(slot.sampler);
  out.add(slot.uv_set);
  out.add(slot.offset);
  out.add(slot.scale);
  out.add(slot.rotation_rad);
}

void add_material(const Pose& pose, uint32_t index, const DrawBatch& run, Bytes& out) {
  static const Material plain;
  const Material& material = index < pose.materials.size() ? pose.materials[index] : plain;
  out.add(uint32_t(glows_all_over(material)));
  if (run.alpha == AlphaMode::mask) add_mask(material, out);
  if (run.relief) add_relief(material, out);
}

// What is said of all that a run draws.
void add_run(const DrawBatch& run, Bytes& out) {
  for (const bool is : {run.alpha == AlphaMode::mask, run.cull_back, run.mirrored}) out.add(uint32_t(is));
}

void add_item(const FrameUpload& upload, const Pose& pose, const DrawBatch& run, const shared::Item& item, Bytes& out) {
  out.add(upload.geometries[item.geometry]);
  out.add(item.first_index);
  out.add(item.index_count);
  add_material(pose, item.material, run, out);
}

// What a group draws at each of its places.
void add_sections(const FrameUpload& upload, const Pose& pose, const DrawBatch& run, const DrawSpan& span, Bytes& out) {
  for (uint32_t s = span.source; s < span.source + span.sections; ++s) {
    const shared::ItemSection& section = upload.item_sections[s];
    out.add(upload.geometries[section.geometry]);
    out.add(section.first_index);
    out.add(section.index_count);
    add_material(pose, section.material, run, out);
  }
}

// Each run with the groups that a pass poses in it, and then the host's items in it, from the first to before the last.
template <class Group, class Items>
void walk_runs(const DrawList& draws, const Group& group, const Items& items) {
  size_t at = 0;      // among spans, of which one of the host's may reach over several runs
  uint32_t host = 0;  // items of the host before the run
  for (const DrawBatch& run : draws.batches) {
    const uint32_t run_end = run.first + run.count, first_of_host = host;
    host += run.count;
    for (; at < draws.spans.size() && draws.spans[at].first < run_end; ++at) {
      const DrawSpan& span = draws.spans[at];
      if (span.group < 0 && span.first + span.count > run_end) break;  // the next run's too
      if (span.group < 0) continue;
      host -= span.count;
      group(run, span);
    }
    items(run, first_of_host, host);
  }
}

CasterHash hash_of(const Bytes& bytes) {
  const Hash128 hash = bytes.hash();
  return {hash.lo, hash.hi};
}

}  // namespace

void caster_hashes(const FrameData& data, const DrawList& draws, const FrameUpload& upload, const Pose& pose,
                   CasterHashes& out) {
  out.items.assign(upload.items.size(), {});
  out.clusters.clear();
  const auto hash_item = [&](uint32_t i, const DrawBatch& run) {
    const shared::Item& item = upload.items[i];
    const shared::Transform& t = upload.transforms[item.transform];
    Scratch scratch;
    Bytes bytes(&scratch);
    add_run(run, bytes);
    for (const glm::vec4& row : {t.row0, t.row1, t.row2}) bytes.add(glm::vec3(row));
    bytes.add(upload.places[item.transform]);
    add_item(upload, pose, run, item, bytes);
    out.items[i] = hash_of(bytes);
    out.items[i].deformed = upload.geometries[item.geometry].flags & shared::geometry_deformed;
  };
  const auto hash_group = [&](const DrawBatch& run, const DrawSpan& span) {
    const ItemGroup& group = data.item_groups[size_t(span.group)];
    Scratch scratch;
    Bytes bytes(&scratch);
    add_run(run, bytes);
    for (int c = 0; c < 3; ++c) bytes.add(glm::dvec3(group.relative_from_node[c]));
    bytes.add(group.world_origin);
    bytes.add(group.node);
    add_sections(upload, pose, run, span, bytes);
    const Hash128 of_group = bytes.hash();
    for (uint32_t cluster = 0; cluster < group.set->clusters.size(); ++cluster) {
      Bytes of_cluster(&scratch);
      of_cluster.add(of_group);
      of_cluster.add(cluster);
      out.clusters.push_back(hash_of(of_cluster));
    }
  };
  walk_runs(draws, hash_group, [&](const DrawBatch& run, uint32_t first, uint32_t end) {
    if (casts_shadows(run))
      tbb::parallel_for(tbb::blocked_range<uint32_t>(first, end, 256), [&](const auto& range) {
        for (uint32_t i = range.begin(); i < range.end(); ++i) hash_item(i, run);
      });
  });
}

std::optional<Hash128> caster_hash(const DrawList& draws, const FrameUpload& upload, const Pose& pose,
                                   const TextureKnobs& textures, const ReliefKnobs& relief) {
  Scratch scratch;
  Bytes out(&scratch);
  bool deformed = false;
  // Of instances that a pass poses, where their node is and which they are.
  const auto add_group = [&](const DrawBatch& run, const DrawSpan& span) {
    if (!casts_shadows(run)) return;
    out.add(upload.item_groups[size_t(span.group) + 1]);
    add_sections(upload, pose, run, span, out);
  };
  walk_runs(draws, add_group, [&](const DrawBatch& run, uint32_t first, uint32_t end) {
    if (!casts_shadows(run)) return;
    out.add(uint32_t(run.alpha));
    out.add(run.count);
    for (uint32_t i = first; i < end; ++i) {
      const shared::Item& item = upload.items[i];
      deformed |= (upload.geometries[item.geometry].flags & shared::geometry_deformed) != 0;
      out.add(item.bounds_centre);
      out.add(item.bounds_extent);
      out.add(upload.transforms[item.transform]);
      add_item(upload, pose, run, item, out);
    }
  });
  if (deformed) return std::nullopt;
  for (const Knob& row : TextureKnobs::table()) out.add(row.value(&textures));
  const bool any_relief = std::ranges::any_of(draws.batches, &DrawBatch::relief);
  for (const Knob& row : ReliefKnobs::table())
    if (any_relief) out.add(row.value(&relief));
  return out.hash();
}

Hash128 depth_views_key(const Hash128& casters, const ViewImage& image) {
  Scratch scratch;
  Bytes out(&scratch);
  out.add(casters);
  out.add(hash128(image.name));
  out.add(image.size_px);
  out.add(image.layers);
  for (const shared::View& view : image.views) out.add(view);
  return out.hash();
}

}  // namespace candela
