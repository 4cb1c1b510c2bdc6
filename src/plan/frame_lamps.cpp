#include "plan/frame_lamps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/room.h"
#include "base/scratch.h"
#include "passes/geometry/depth_views.h"
#include "plan/frame_suns.h"
#include "plan/lamp_faces.h"

namespace candela {
namespace {

constexpr uint32_t usual_layer_px = 2048;

std::string_view why_none(const SceneFacts& facts, const FrameRequest& request, const LampKnobs& knobs,
                          bool see_through) {
  if (facts.point_lights + facts.spot_lights == 0) return "no point or spot light shines";
  if (!facts.takes_light() && !request.draws_fog() && !request.draws_volumetric())
    return "nothing that is drawn takes light";
  const bool traced = knobs.traced();
  if (facts.opaque_items + facts.mask_items + (traced || see_through ? facts.blend_items : 0) +
          (see_through ? facts.refracting_items : 0) ==
      0)
    return "nothing that is drawn casts a shadow";
  if (!request.wants_true(DepthViews::effect)) return "shadows are not wanted (--effects, --quality)";
  if (request.neutral_light) return "the neutral light casts no shadows";
  if (knobs.lights == LampKnobs::none && !traced) return "local.lights is none";
  return {};
}

// A light that may light the picture.
struct Candidate {
  size_t light = 0;
  Lamp lamp;
  uint32_t size_px = 0, wished_px = 0;
  std::array<int, 6> face{};  // those that matter to the picture
  uint32_t face_count = 0;
  std::span<const int> faces() const { return std::span(face).first(face_count); }
};

// What a light can add to the picture: its light on what it stands before, where it gives near_lux, in the fraction of
// the picture that this takes; where the light is outside of the view, no nearer than the view is. 0: it lights nothing
// of it.
constexpr double near_lux = 100;
double importance_of(const LightItem& light, const View& view, const FrustumPlanes& planes) {
  const glm::dvec3 position(light.position);
  const double candela = glm::dot(glm::dvec3(light.intensity), glm::dvec3(0.2126, 0.7152, 0.0722));
  double outside_m = 0;
  for (const glm::dvec4& plane : planes)
    outside_m = std::max(outside_m, -(glm::dot(glm::dvec3(plane), position) + plane.w));
  const double near_m = std::max(std::sqrt(candela / near_lux), 1e-30);
  const double away_m = view.perspective ? glm::length(position) : near_m;
  if (!(outside_m < double(light.range_m)) || !std::isfinite(away_m)) return 0;
  const double importance =
      near_lux * std::pow(near_m / std::max(away_m, near_m) * near_m / std::max(outside_m, near_m), 2);
  return std::isfinite(importance) ? std::max(importance, 0.0) : 0;
}

// What lights are ordered by: they are many, and few of them become candidates.
struct Ranked {
  bool marked = false;  // by the look
  double importance = 0;
  uint32_t light = 0;
};

// Point and spot lights that may light the picture, in the order of lights.
ScratchVector<Ranked> ranked_lights(const Scene& scene, const FrameData& data, const View& view,
                                    const FrustumPlanes& planes, std::span<const std::string> marked,
                                    std::pmr::memory_resource* memory) {
  ScratchVector<Ranked> out(data.lights.size(), memory);
  Scratch scratch;
  ScratchVector<uint8_t> marked_nodes(scene.nodes.size(), uint8_t(0), &scratch);
  for (size_t n = 0; n < marked_nodes.size() && !marked.empty(); ++n)
    marked_nodes[n] = std::ranges::find(marked, scene.nodes[n].name) != marked.end();
  tbb::parallel_for(tbb::blocked_range<size_t>(0, out.size(), 1024), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const LightItem& light = data.lights[i];
      if (light.type == LightType::directional || light.inner_m > 0) continue;  // stand-ins have no maps
      out[i] = {marked_nodes[light.node] != 0, importance_of(light, view, planes), uint32_t(i)};
    }
  });
  std::erase_if(out, [](const Ranked& r) { return r.importance == 0; });
  return out;
}

// Whether one comes before another: equal ones in the order of lights.
bool comes_first(const Ranked& a, const Ranked& b) {
  if (a.marked != b.marked) return a.marked;
  return a.importance != b.importance ? a.importance > b.importance : a.light < b.light;
}

// Layers of the image that hold the maps, and their side: less than usual where all fit into one.
struct Room {
  uint32_t layer_px = 0, layers = 0;
  uint64_t bytes() const { return uint64_t(layer_px) * layer_px * layers * sizeof(float); }
};
Room room_of(std::span<const Candidate> lamps) {
  uint64_t texels = 0;
  uint32_t largest = 1;
  for (const Candidate& c : lamps) {
    if (c.face_count > 0) largest = std::max(largest, c.size_px);
    texels += uint64_t(c.face_count) * c.size_px * c.size_px;
  }
  Room room;
  room.layer_px = std::max(largest, usual_layer_px);
  while (room.layer_px > largest && texels <= uint64_t(room.layer_px / 2) * (room.layer_px / 2)) room.layer_px /= 2;
  const uint64_t layer_texels = uint64_t(room.layer_px) * room.layer_px;
  room.layers = uint32_t((texels + layer_texels - 1) / layer_texels);
  return room;
}

// In powers of two as far as the budget reaches: maps that come and go do not change the plan.
uint32_t layers_within(const Room& room, uint64_t bytes) {
  const uint64_t most = bytes * room.layers / room.bytes();
  return uint32_t(std::clamp<uint64_t>(std::bit_ceil(room.layers), room.layers, std::max<uint64_t>(most, room.layers)));
}

// Halves maps, the least important light's first, round after round, until all fit; then leaves out lights.
void fit_budget(ScratchVector<Candidate>& lamps, uint64_t bytes) {
  bool shrank = true;
  while (shrank && room_of(lamps).bytes() > bytes) {
    shrank = false;
    for (size_t i = lamps.size(); i-- > 0 && room_of(lamps).bytes() > bytes;)
      if (lamps[i].size_px > least_lamp_px) lamps[i].size_px /= 2, shrank = true;
  }
  while (!lamps.empty() && room_of(lamps).bytes() > bytes) lamps.pop_back();
}

// Maps that outlive frames may take as much memory as this many frames' own.
constexpr uint64_t kept_budgets = 2;
constexpr uint32_t pool_layer_px = 1024;

// Of a map that later frames may use; nothing: of what changes from frame to frame.
std::optional<Hash128> map_key(const Lamp& lamp, int face, uint32_t size_px, const CasterHash& casters,
                               const MapOptions& options, bool open_sides) {
  if (casters.deformed) return std::nullopt;
  Scratch scratch;
  ScratchVector<double> values(&scratch);
  for (const Knob& row : TextureKnobs::table()) values.push_back(row.value(&options.textures));
  for (const Knob& row : ReliefKnobs::table()) values.push_back(row.value(&options.relief));
  const Hash128 knobs = hash128(std::as_bytes(std::span(values))), place = lamp_face_key(lamp, face, size_px);
  const std::array<uint64_t, 7> all{place.lo, place.hi, casters.low, casters.high, open_sides, knobs.lo, knobs.hi};
  return hash128(std::as_bytes(std::span(all)));
}

// A bit for each node whose shadow moves; none where nothing does.
void add_moving_casters(const Scene& scene, std::span<const uint8_t> moving, const FrameUpload& upload,
                        std::vector<uint32_t>& bits) {
  bits.assign((moving.size() + 31) / 32, 0);
  bool any = false;
  const auto add = [&](uint32_t node) { any = true, bits[node / 32] |= 1u << (node % 32); };
  for (uint32_t n = 0; n < moving.size(); ++n)
    if (moving[n] && scene.nodes[n].mesh >= 0) add(n);
  for (const shared::Item& item : upload.items)
    if (upload.geometries[item.geometry].flags & shared::geometry_deformed) add(item.object_id);
  if (!any) bits.clear();
}

// Maps of lights that stand, in which something moves: they may be drawn as what moves over what stands. By their
// places among the views, to which those of what moves are added.
ScratchVector<uint32_t> add_over(std::span<const ViewCasters::OfView> casters, std::span<const uint8_t> lamp_moves,
                                 ViewImage& image, std::pmr::memory_resource* memory) {
  ScratchVector<uint32_t> split(memory), sizes(memory);
  for (uint32_t v = 0; v < image.views.size(); ++v)
    if (!lamp_moves[v] && !casters[v].moving_counts.empty()) split.push_back(v);
  for (const uint32_t v : split) sizes.push_back(image.views[v].size_px.x);
  const ScratchVector<LampTile> places = pack_lamp_tiles(sizes, image.size_px, memory);
  for (size_t i = 0; i < split.size(); ++i) {
    shared::View view = image.views[split[i]];
    view.flags |= shared::view_skips_standing;
    view.origin_px = places[i].origin_px;
    view.layer = image.layers + places[i].layer;
    image.views.push_back(view);
  }
  image.over = uint32_t(split.size());
  // In powers of two: what moves does not change the plan.
  image.texel_layers = image.layers;
  if (image.in_parts) image.texel_layers += std::bit_ceil(places.empty() ? 1 : places.back().layer + 1);
  return split;
}

// As place_lamps(), of maps in any order.
bool place_views_of(const KeptLamps& kept, std::span<const LampMap> maps, bool floats, uint32_t layer_px,
                    uint64_t most_bytes, PlacedLamps& placed) {
  Scratch scratch;
  ScratchVector<uint32_t> order(maps.size(), &scratch);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
    return maps[a].size_px != maps[b].size_px ? maps[a].size_px > maps[b].size_px : a < b;
  });
  ScratchVector<LampMap> sorted(&scratch);
  sorted.reserve(maps.size());
  for (const uint32_t m : order) sorted.push_back(maps[m]);
  if (!place_lamps(kept.pool, sorted, floats, layer_px, most_bytes, placed)) return false;
  const ScratchVector<LampTile> tiles(placed.tiles.begin(), placed.tiles.end(), &scratch);
  for (size_t i = 0; i < order.size(); ++i) placed.tiles[order[i]] = tiles[i];
  for (uint32_t& drawn : placed.drawn) drawn = order[drawn];
  std::ranges::sort(placed.drawn);
  return true;
}

// Of the views those that are drawn. split: as of add_over().
void keep_drawn(const ViewImage& image, std::span<const uint32_t> split, std::span<const ViewCasters::OfView> casters,
                size_t runs, FrameViews& out) {
  Scratch scratch;
  const ScratchVector<uint32_t> first_command(out.first_command.begin(), out.first_command.end(), &scratch);
  out.table.clear();
  out.first_command.assign(1, 0);
  for (const uint32_t v : image.drawn) {
    const shared::View& view = image.views[v];
    const uint32_t of_all = v < image.first_over() ? v : split[v - image.first_over()];
    out.table.push_back(view);
    for (size_t r = 0; r < runs; ++r) {
      const uint32_t* first = &first_command[of_all * runs + r];
      const bool parts = (view.flags & (shared::view_skips_moving | shared::view_skips_standing)) != 0;
      const uint32_t moving = parts ? casters[of_all].moving_counts[r] : 0;
      const uint32_t count = view.flags & shared::view_skips_standing ? moving : first[1] - first[0] - moving;
      out.first_command.push_back(out.first_command.back() + count);
    }
  }
  if (out.table.empty()) out.table.emplace_back();  // a buffer holds something
}

// The lights' nodes, neighbours as a range.
void add_nodes_of(const FrameData& data, std::span<const uint32_t> lights, Notes& notes) {
  constexpr size_t most_ranges = 32;
  Scratch scratch;
  ScratchVector<uint32_t> nodes(&scratch);
  for (const uint32_t light : lights) nodes.push_back(data.lights[light].node);
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  size_t ranges = 0, named = 0;
  for (auto first = nodes.begin(); first != nodes.end() && ranges < most_ranges; ++ranges) {
    auto last = first;
    while (std::next(last) != nodes.end() && *std::next(last) == *last + 1) ++last, ++named;
    ++named;
    notes.extend("{}{}", ranges == 0 ? "" : ", ", *first);
    if (first != last) notes.extend("-{}", *last);
    first = std::next(last);
  }
  if (named < nodes.size()) notes.extend(" and {} more", nodes.size() - named);
}

}  // namespace

Expected<void> plan_lamps(const Scene& scene, const SurveyedFrame& frame, const PackedFrame& packed,
                          const LampKnobs& knobs, int rows, const MapOptions& options, FrameLamps& out) {
  const FrameData& data = frame.data;
  const View& view = frame.view;
  const SceneFacts& facts = frame.facts;
  const FrameRequest& request = frame.request;
  out.clear();
  out.shadows.clear(), out.moving.clear(), out.pool.reset();
  out.maps = 0;
  out.absence = why_none(facts, request, knobs, options.see_through);
  if (!out.absence.empty()) return {};
  out.traced = knobs.traced();
  out.by_voxels = knobs.method == LampKnobs::by_voxels;
  const bool in_air = request.draws_fog() || request.draws_volumetric();
  if (out.traced &&
      (!in_air || (!options.see_through && facts.opaque_items + facts.mask_items == 0) || knobs.lights == 0)) {
    fmt::format_to(std::back_inserter(out.absence), "local.method is {}: shading sends rays",
                   out.by_voxels ? "voxels" : "traced");
    return {};
  }
  const FrustumPlanes planes = frustum_planes(view.clip_from_relative);
  const uint32_t most_px =
      std::min(std::bit_floor(uint32_t(knobs.size_px)), most_map_px(options.longer_side_px, request.quality) / 2);
  const std::span<const std::string> marked = request.look.shadows.lights;
  for (const std::string& name : marked)
    if (std::ranges::none_of(data.lights, [&](const LightItem& l) {
          return l.type != LightType::directional && !(l.inner_m > 0) && scene.nodes[l.node].name == name;
        }))
      out.notes.add("the look marks '{}' for shadows, and no point or spot light that shines is at a node of that name",
                    name);
  Scratch scratch;
  ScratchVector<Ranked> ranked = ranked_lights(scene, data, view, planes, marked, &scratch);
  ScratchVector<Candidate> lamps(&scratch);
  ScratchVector<uint32_t> without(&scratch);
  // A heap gives the first ones without sorting all.
  const auto comes_last = [](const Ranked& a, const Ranked& b) { return comes_first(b, a); };
  std::ranges::make_heap(ranked, comes_last);
  while (!ranked.empty()) {
    const Ranked next = ranked.front();
    if (knobs.lights == LampKnobs::marked_alone ? !next.marked : lamps.size() == size_t(knobs.lights)) break;
    std::ranges::pop_heap(ranked, comes_last);
    ranked.pop_back();
    Candidate c;
    c.light = next.light;
    c.lamp = lamp_of(data.lights[c.light]);
    c.size_px = c.wished_px = lamp_size_px(c.lamp, view, rows, most_px);
    for (int face = 0; face < c.lamp.faces(); ++face)
      // As wide as the smallest map's face: sizes are not final yet.
      if (lamp_face_is_seen(c.lamp, face, least_lamp_px, planes)) c.face[c.face_count++] = face;
    if (c.face_count > 0) lamps.push_back(c);
  }
  for (const Ranked& r : ranked) without.push_back(r.light);
  std::ranges::sort(without);  // nodes one after the other
  if (lamps.empty()) {
    out.absence = without.empty() ? "no point or spot light reaches what the camera sees"
                                  : "the look marks no point or spot light that reaches what the camera sees "
                                    "(local.lights = marked)";
    return {};
  }
  const ScratchVector<Candidate> chosen(lamps, &scratch);
  fit_budget(lamps, uint64_t(knobs.budget_mb) << 20);
  for (size_t i = lamps.size(); i < chosen.size(); ++i) without.push_back(uint32_t(chosen[i].light));
  if (!without.empty()) {
    out.notes.add(
        "{} of {} point and spot lights that may light the picture cast no shadows, those that add least "
        "(local.lights = ",
        without.size(), without.size() + lamps.size());
    if (knobs.lights == LampKnobs::marked_alone)
      out.notes.extend("marked");
    else
      out.notes.extend("{}", knobs.lights);
    out.notes.extend(", local.budget_mb = {}); they are of the nodes ", knobs.budget_mb);
    add_nodes_of(data, without, out.notes);
  }
  if (const auto smaller = std::ranges::count_if(lamps, [](const auto& c) { return c.size_px < c.wished_px; }))
    out.notes.add("the shadow maps of {} point and spot lights are smaller than they should be (local.budget_mb = {})",
                  smaller, knobs.budget_mb);
  if (lamps.empty()) {
    out.absence = "no shadow map of a point or spot light fits into local.budget_mb";
    return {};
  }

  struct Face {
    size_t lamp;
    int face;
  };
  ScratchVector<Face> faces(&scratch);
  for (size_t i = 0; i < lamps.size(); ++i)
    for (const int face : lamps[i].faces()) faces.push_back({i, face});
  std::ranges::sort(faces, [&](const Face& a, const Face& b) {
    const uint32_t size_a = lamps[a.lamp].size_px, size_b = lamps[b.lamp].size_px;
    if (size_a != size_b) return size_a > size_b;
    return a.lamp != b.lamp ? a.lamp < b.lamp : a.face < b.face;
  });
  ScratchVector<uint32_t> sizes(&scratch);
  for (const Face& f : faces) sizes.push_back(lamps[f.lamp].size_px);
  const Room room = room_of(lamps);
  const ScratchVector<LampTile> tiles = pack_lamp_tiles(sizes, room.layer_px, &scratch);
  for (const Candidate& c : lamps) {
    out.shadows.push_back(lamp_shadow(c.lamp, c.size_px, room.layer_px));
    out.shadows.back().form |= uint32_t(knobs.pixel_places) << 1;
    out.lights.push_back(uint32_t(c.light));
  }
  ViewImage& image = out.image.emplace();
  image.clear();
  image.name = "local.maps";
  for (size_t f = 0; f < faces.size(); ++f) {
    const auto [lamp, face] = faces[f];
    image.views.push_back(place_lamp_face(lamps[lamp].lamp, face, sizes[f], tiles[f], out.shadows[lamp]));
  }
  image.layers = room.layers;
  image.size_px = room.layer_px;
  image.most_px = most_px;
  image.apart = !options.see_through;
  const bool keeps = image.apart && options.kept_lamps;
  const bool tells_moving = image.apart && !options.moving.empty();
  if (tells_moving) add_moving_casters(scene, options.moving, packed.upload, out.moving);
  CasterHashes hashes(&scratch);
  hashes.items.reserve(packed.upload.items.size());
  size_t clusters = 0;
  for (const DrawSpan& span : packed.draws.spans)
    if (span.group >= 0) clusters += data.item_groups[size_t(span.group)].set->clusters.size();
  hashes.clusters.reserve(clusters);  // before others ask
  if (keeps) caster_hashes(data, packed.draws, packed.upload, frame.pose, hashes);
  ViewCasters casters(keeps ? &hashes : nullptr, out.moving, &scratch);
  if (auto placed = place_maps(out, data, packed.draws, packed.upload.items, options, knobs.draws, "local.draws",
                               image.apart ? &casters : nullptr);
      !placed)
    return placed;
  out.maps = uint32_t(faces.size());
  if (!image.apart) return {};
  image.layers = layers_within(room, uint64_t(knobs.budget_mb) << 20);
  image.in_parts = !out.moving.empty();
  image.commands = out.views.first_command.back();
  ScratchVector<uint8_t> lamp_moves(&scratch);
  for (const Face& f : faces)
    lamp_moves.push_back(tells_moving && options.moving[data.lights[lamps[f.lamp].light].node]);
  const ScratchVector<uint32_t> split = add_over(casters.of_view, lamp_moves, image, &scratch);
  image.drawn.resize(faces.size());
  std::iota(image.drawn.begin(), image.drawn.end(), 0u);
  if (keeps) {
    const auto key_of = [&](uint32_t view, const CasterHash& seen) {
      const Face& f = faces[view];
      return map_key(lamps[f.lamp].lamp, f.face, sizes[view], seen, options, request.open_sides);
    };
    const uint64_t most_bytes =
        std::min(options.kept_lamps->most_bytes, kept_budgets * (uint64_t(knobs.budget_mb) << 20));
    // in_parts: what moves over what stands; else all of them as one map each.
    const auto keep = [&](bool in_parts) {
      ScratchVector<LampMap> maps(&scratch);
      for (uint32_t f = 0; f < faces.size(); ++f) {
        CasterHash seen = casters.of_view[f].standing;
        if (!in_parts || lamp_moves[f]) seen.add(casters.of_view[f].moving);
        maps.push_back({sizes[f], key_of(f, seen), lamp_moves[f] || !casters.of_view[f].moving_counts.empty()});
      }
      for (const uint32_t f : in_parts ? std::span(split) : std::span<const uint32_t>()) {
        CasterHash seen = casters.of_view[f].standing;
        seen.add(casters.of_view[f].moving);
        maps[f].passing = false;
        maps.push_back({sizes[f], key_of(f, seen), true});
      }
      return place_views_of(*options.kept_lamps, maps, options.floats, std::max(most_px, pool_layer_px), most_bytes,
                            out.placed);
    };
    const bool in_parts = keep(true);
    if (in_parts || (!split.empty() && keep(false))) {
      const PlacedLamps& placed = out.placed;
      for (shared::LampShadow& shadow : out.shadows) shadow.uv_per_texel = float(1.0 / placed.pool.layer_px);
      const auto move = [&](size_t view, size_t face) {
        move_lamp_face(faces[face].face, sizes[face], placed.tiles[view], image.views[view],
                       out.shadows[faces[face].lamp]);
      };
      for (size_t f = 0; f < faces.size(); ++f) move(f, f);
      for (size_t i = 0; in_parts && i < split.size(); ++i) {
        shared::View &stands = image.views[split[i]], &over = image.views[faces.size() + i];
        stands.flags |= shared::view_skips_moving;
        over.under_px = stands.tile_px, over.under_layer = stands.tile_layer;
        move(faces.size() + i, split[i]);
      }
      make_room(image.drawn, placed.drawn.size());
      image.drawn = placed.drawn;
      image.outlives = true;
      copy_pool(placed.pool, out.pool.emplace());
    }
  }
  keep_drawn(image, split, casters.of_view, packed.draws.batches.size(), out.views);
  return {};
}

}  // namespace candela
