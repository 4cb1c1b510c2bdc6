#include "scene/draw_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/scratch.h"

namespace candela {

bool is_unlit(const MeshSection& section, const Material* material) {
  return (material && material->unlit) || (section.normal.empty() && section.metaballs < 0);
}

bool refracts(const MeshSection& section, const Material& material) {
  return section.topology == Topology::triangles && !is_unlit(section, &material) && material.has(Lobe::transmission);
}

bool has_relief(const MeshSection& section, const Material& material) {
  return section.topology == Topology::triangles && material.has_relief();
}

namespace {

constexpr uint32_t draw_ranks = 2 * 3 * 2 * 3 * 2 * 2 + 1;

// How an item is drawn; items of one section at many places share it.
DrawBatch state_of(const Scene& scene, const Pose& pose, const DrawItem& item, bool refraction) {
  const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
  const Material* material = item.material >= 0 ? &pose.materials[size_t(item.material)] : nullptr;
  DrawBatch s;
  s.topology = section.topology;
  s.alpha = material ? material->alpha_mode : AlphaMode::opaque;
  s.unlit = is_unlit(section, material);
  s.cull_back = section.topology == Topology::triangles && !(material && material->double_sided);
  s.mirrored = item.mirrored;
  s.refracts = refraction && material && refracts(section, *material);
  if (s.refracts && s.alpha == AlphaMode::blend) s.alpha = AlphaMode::opaque;  // its shader covers by alpha
  s.relief = material && has_relief(section, *material);
  return s;
}

// In the order of drawing; blended ones are the last.
uint32_t rank_of(const DrawBatch& s) {
  if (s.alpha == AlphaMode::blend) return draw_ranks - 1;
  uint32_t rank = s.refracts;
  rank = rank * 3 + (s.relief ? 2 : uint32_t(s.alpha == AlphaMode::mask));  // a relief is opaque
  rank = rank * 2 + uint32_t(s.unlit);
  rank = rank * 3 + uint32_t(s.topology);
  rank = rank * 2 + uint32_t(!s.cull_back);
  return rank * 2 + uint32_t(s.mirrored);
}

// Those of a group's sections that are drawn alike.
struct GroupPart {
  size_t group = 0;
  uint32_t before = 0;  // of the host's items of the same rank, those that come first
  DrawBatch state;
  uint32_t sections = 0;  // of those of the rank, behind those of the parts before
};

class Lister {
 public:
  Lister(const Scene& scene, const Pose& pose, const FrameData& frame, bool refraction, DrawList& list)
      : scene_(scene), pose_(pose), frame_(frame), refraction_(refraction), list_(list) {
    list.clear();
    sort_items();
    for (uint32_t rank = 0; rank + 1 < draw_ranks; ++rank) add_rank(rank);
    add_blended();
  }

 private:
  DrawBatch state(const DrawItem& item) const { return state_of(scene_, pose_, item, refraction_); }

  // The host's items by rank, and what of groups stands between them.
  void sort_items() {
    const std::vector<DrawItem>& items = frame_.items;
    ScratchVector<uint8_t> ranks(items.size(), &scratch_);
    size_t group = 0;
    for (size_t i = 0; i < items.size(); ++i) {
      for (; group < frame_.item_groups.size() && frame_.item_groups[group].before <= i; ++group) add_parts(group);
      const bool same = i > 0 && items[i].mesh == items[i - 1].mesh && items[i].section == items[i - 1].section &&
                        items[i].material == items[i - 1].material && items[i].mirrored == items[i - 1].mirrored;
      ranks[i] = same ? ranks[i - 1] : uint8_t(rank_of(state(items[i])));
      ++count_[ranks[i]];
    }
    for (; group < frame_.item_groups.size(); ++group) add_parts(group);
    std::exclusive_scan(count_.begin(), count_.end(), first_.begin(), 0u);
    std::array<uint32_t, draw_ranks> next = first_;
    list_.order.resize(items.size());
    for (size_t i = 0; i < items.size(); ++i) list_.order[next[ranks[i]]++] = uint32_t(i);
    // Blended items by depth, farthest first, equal ones in item order. What is no number counts as farthest, for a
    // sort needs an order.
    const auto depth_of = [&](uint32_t i) {
      const double depth_m = items[i].view_depth_m;
      return std::isnan(depth_m) ? std::numeric_limits<double>::infinity() : depth_m;
    };
    std::sort(list_.order.begin() + first_.back(), list_.order.end(), [&](uint32_t a, uint32_t b) {
      const double depth_a = depth_of(a), depth_b = depth_of(b);
      return depth_a > depth_b || (depth_a == depth_b && a < b);
    });
  }

  void add_parts(size_t g) {
    const ItemGroup& group = frame_.item_groups[g];
    for (const uint32_t section : group.set->sections) {
      DrawItem item{.mesh = group.mesh, .section = section, .node = group.node};
      item.material = scene_.meshes[group.mesh].sections[section].material;
      item.mirrored = group.mirrored;
      const DrawBatch how = state(item);
      const uint32_t rank = rank_of(how);
      ScratchVector<GroupPart>& parts = parts_[rank];
      if (parts.empty() || parts.back().group != g) parts.push_back({g, count_[rank], how, 0});
      ++parts.back().sections;
      sections_[rank].push_back(section);
    }
  }

  void add_rank(uint32_t rank) {
    uint32_t host = 0;
    auto sections = sections_[rank].begin();
    for (const GroupPart& part : parts_[rank]) {
      add_host(rank, host, part.before);
      host = part.before;
      const uint32_t count = frame_.item_groups[part.group].set->count * part.sections;
      add_span({list_.item_count(), count, int(part.group), uint32_t(list_.sections.size()), part.sections},
               part.state);
      list_.sections.insert(list_.sections.end(), sections, sections + part.sections);
      sections += part.sections;
    }
    add_host(rank, host, count_[rank]);
  }

  void add_host(uint32_t rank, uint32_t from, uint32_t to) {
    if (from == to) return;
    const uint32_t source = first_[rank] + from;
    add_span({list_.item_count(), to - from, -1, source, 0}, state(frame_.items[list_.order[source]]));
  }

  // Of one state.
  void add_span(const DrawSpan& span, const DrawBatch& how) {
    if (list_.batches.empty() || !list_.batches.back().same_state(how)) {
      list_.batches.push_back(how);
      list_.batches.back().first = span.first;
      list_.batches.back().count = 0;
    }
    list_.batches.back().count += span.count;
    DrawSpan* const last = list_.spans.empty() ? nullptr : &list_.spans.back();
    if (last && last->group < 0 && span.group < 0)
      last->count += span.count;
    else
      list_.spans.push_back(span);
  }

  void add_blended() {
    for (uint32_t source = first_.back(); source < list_.order.size(); ++source)
      add_span({list_.item_count(), 1, -1, source, 0}, state(frame_.items[list_.order[source]]));
  }

  const Scene& scene_;
  const Pose& pose_;
  const FrameData& frame_;
  const bool refraction_;
  std::array<uint32_t, draw_ranks> count_{}, first_{};  // of the host's items, by rank
  Scratch scratch_;
  ScratchVector<ScratchVector<GroupPart>> parts_{draw_ranks, &scratch_};    // by rank
  ScratchVector<ScratchVector<uint32_t>> sections_{draw_ranks, &scratch_};  // of all parts of a rank
  DrawList& list_;
};

}  // namespace

void make_draw_list(const Scene& scene, const Pose& pose, const FrameData& frame, bool refraction, DrawList& list) {
  Lister(scene, pose, frame, refraction, list);
}

}  // namespace candela
