#include "plan/frame_views.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "base/room.h"
#include "base/scratch.h"
#include "plan/item_tree.h"

namespace candela {

bool casts_shadows(const DrawBatch& run) { return run.solid() && run.topology == Topology::triangles; }

std::pmr::vector<ItemCluster> item_clusters(const FrameData& data, const DrawList& draws,
                                            std::pmr::memory_resource* memory) {
  std::pmr::vector<ItemCluster> clusters(memory);
  uint32_t run = 0;
  for (const DrawSpan& span : draws.spans) {
    if (span.group < 0) continue;
    while (draws.batches[run].first + draws.batches[run].count <= span.first) ++run;
    const ItemGroup& group = data.item_groups[size_t(span.group)];
    for (const InstanceCluster& cluster : group.set->clusters) {
      const DAabb box = relative_box(group, cluster);
      clusters.push_back({run, cluster.count * span.sections, group.node, box.centre(), box.extent()});
    }
  }
  return clusters;
}

Expected<void> place_views(FrameViews& placed, std::span<const shared::Item> items, std::span<const DrawBatch> runs,
                           bool culling, uint64_t budget, std::string_view knob, bool see_through,
                           std::span<const ItemCluster> clusters, ViewCasters* casters) {
  // What is handed out comes before others ask.
  if (casters) casters->of_view.assign(placed.table.size(), {});
  if (casters) casters->counts.assign(casters->moving.empty() ? 0 : placed.table.size() * runs.size(), 0);
  Scratch scratch;
  ScratchVector<uint32_t> counts(placed.table.size() * runs.size(), 0u, &scratch);
  ScratchVector<uint32_t> host(runs.size(), 0u, &scratch);  // items of each run that are not of clusters
  for (size_t r = 0; r < runs.size(); ++r) host[r] = runs[r].count;
  for (const ItemCluster& cluster : clusters) host[cluster.run] -= cluster.count;
  const auto draws = [&](const DrawBatch& run) {
    return casts_shadows(run) || (see_through && run.topology == Topology::triangles);
  };
  // Of each item of the host's the run, where that is drawn.
  ScratchVector<int> run_of(items.size(), -1, &scratch);
  size_t first = 0;
  for (size_t r = 0; r < runs.size(); first += host[r++])
    if (draws(runs[r])) std::fill_n(run_of.begin() + long(first), host[r], int(r));
  std::optional<ItemTree> tree;
  if (culling) tree.emplace(items, run_of, &scratch);
  tbb::parallel_for(size_t(0), placed.table.size(), [&](size_t v) {
    uint32_t* of_view = &counts[v * runs.size()];
    const ViewPlanes planes(placed.table[v]);
    ViewCasters::OfView of_casters;
    const auto add = [&](uint32_t run, uint32_t count, uint32_t node, std::span<const CasterHash> hashes, size_t at) {
      of_view[run] += count;
      if (!casters) return;
      const bool moves = casters->moves(node);
      if (casters->hashes) (moves ? of_casters.moving : of_casters.standing).add(hashes[at]);
      if (!moves) return;
      of_casters.moving_counts = std::span(casters->counts).subspan(v * runs.size(), runs.size());
      of_casters.moving_counts[run] += count;
    };
    static const CasterHashes none;
    const CasterHashes& hashes = casters && casters->hashes ? *casters->hashes : none;
    for (size_t c = 0; c < clusters.size(); ++c)
      if (const ItemCluster& cluster = clusters[c];
          draws(runs[cluster.run]) && (!culling || may_keep(planes, cluster.bounds_centre, cluster.bounds_extent)))
        add(cluster.run, cluster.count, cluster.node, hashes.clusters, c);
    const auto found = [&](uint32_t i) { add(uint32_t(run_of[i]), 1, items[i].object_id, hashes.items, i); };
    if (tree)
      tree->each(planes, found);
    else
      for (uint32_t i = 0; i < items.size(); ++i)
        if (run_of[i] >= 0) found(i);
    if (casters) casters->of_view[v] = of_casters;
  });
  uint64_t needed = 0;
  placed.first_command.clear();
  for (const uint32_t count : counts) {
    placed.first_command.push_back(uint32_t(std::min<uint64_t>(needed, std::numeric_limits<uint32_t>::max())));
    needed += count;
  }
  const uint64_t most = std::min<uint64_t>(budget, std::numeric_limits<uint32_t>::max());
  if (needed > most)
    return fail(ErrorKind::usage, "--set",
                "the frame's {} shadow views need room for {} draw commands, more than {} = {}; set {} "
                "to {} or more ({} bytes each), or have fewer shadows",
                placed.table.size(), needed, knob, budget, knob, needed, sizeof(shared::DrawCommand));
  placed.first_command.push_back(uint32_t(needed));
  return {};
}

Expected<void> place_maps(ShadowMaps& maps, const FrameData& data, const DrawList& draws,
                          std::span<const shared::Item> items, const MapOptions& options, int draws_knob,
                          std::string_view knob_name, ViewCasters* casters) {
  make_room(maps.views.table, maps.image->views.size());
  maps.views.table = maps.image->views;
  if (casters) casters->of_view.reserve(maps.views.table.size());
  if (casters) casters->counts.reserve(casters->moving.empty() ? 0 : maps.views.table.size() * draws.batches.size());
  Scratch scratch;
  return place_views(maps.views, items, draws.batches, options.culling, uint64_t(draws_knob), knob_name,
                     options.see_through, item_clusters(data, draws, &scratch), casters);
}

}  // namespace candela
