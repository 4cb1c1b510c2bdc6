#include "plan/frame_lamps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>

#include "passes/geometry/depth_views.h"
#include "plan/frame_suns.h"
#include "plan/lamp_faces.h"
#include "scene/moving_nodes.h"

namespace candela {
namespace {

constexpr uint32_t usual_layer_px = 2048;

std::string why_none(const SceneFacts& facts, const FrameRequest& request, const LampKnobs& knobs, bool see_through) {
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
  std::vector<int> faces;  // that matter to the picture
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
std::vector<Ranked> ranked_lights(const Scene& scene, const FrameData& data, const View& view,
                                  const FrustumPlanes& planes, const std::set<std::string>& marked) {
  std::vector<bool> marked_nodes(scene.nodes.size());
  for (size_t n = 0; n < marked_nodes.size() && !marked.empty(); ++n)
    marked_nodes[n] = marked.contains(scene.nodes[n].name);
  std::vector<Ranked> out(data.lights.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, out.size(), 1024), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const LightItem& light = data.lights[i];
      if (light.type == LightType::directional || light.inner_m > 0) continue;  // stand-ins have no maps
      out[i] = {marked_nodes[light.node], importance_of(light, view, planes), uint32_t(i)};
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
    if (!c.faces.empty()) largest = std::max(largest, c.size_px);
    texels += c.faces.size() * c.size_px * c.size_px;
  }
  Room room;
  room.layer_px = std::max(largest, usual_layer_px);
  while (room.layer_px > largest && texels <= uint64_t(room.layer_px / 2) * (room.layer_px / 2)) room.layer_px /= 2;
  const uint64_t layer_texels = uint64_t(room.layer_px) * room.layer_px;
  room.layers = uint32_t((texels + layer_texels - 1) / layer_texels);
  return room;
}

// Halves maps, the least important light's first, round after round, until all fit; then leaves out lights.
void fit_budget(std::vector<Candidate>& lamps, uint64_t bytes) {
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
  std::string all = lamp_face_key(lamp, face, size_px).hex();
  all += fmt::format(" {:x} {:x} {}", casters.low, casters.high, open_sides);
  for (const Knob& row : TextureKnobs::table()) all += " " + row.text(row.value(&options.textures));
  for (const Knob& row : ReliefKnobs::table()) all += " " + row.text(row.value(&options.relief));
  return hash128(all);
}

// A bit for each node whose shadow moves; none where nothing does.
std::vector<uint32_t> moving_casters(const Scene& scene, const std::vector<bool>& moving, const FrameUpload& upload) {
  std::vector<uint32_t> bits((moving.size() + 31) / 32);
  bool any = false;
  const auto add = [&](uint32_t node) { any = true, bits[node / 32] |= 1u << (node % 32); };
  for (uint32_t n = 0; n < moving.size(); ++n)
    if (moving[n] && scene.nodes[n].mesh >= 0) add(n);
  for (const shared::Item& item : upload.items)
    if (upload.geometries[item.geometry].flags & shared::geometry_deformed) add(item.object_id);
  if (!any) bits.clear();
  return bits;
}

// Maps of lights that stand, in which something moves: they may be drawn as what moves over what stands. By their
// places among the views, to which those of what moves are added.
std::vector<uint32_t> add_over(std::span<const ViewCasters::OfView> casters, std::span<const uint8_t> lamp_moves,
                               ViewImage& image) {
  std::vector<uint32_t> split, sizes;
  for (uint32_t v = 0; v < image.views.size(); ++v)
    if (!lamp_moves[v] && !casters[v].moving_counts.empty()) split.push_back(v);
  for (const uint32_t v : split) sizes.push_back(image.views[v].size_px.x);
  const std::vector<LampTile> places = pack_lamp_tiles(sizes, image.size_px);
  for (size_t i = 0; i < split.size(); ++i) {
    shared::View view = image.views[split[i]];
    view.flags |= shared::view_skips_standing;
    view.origin_px = places[i].origin_px;
    view.layer = image.layers + places[i].layer;
    image.views.push_back(view);
  }
  image.over = uint32_t(split.size());
  // In powers of two: what moves does not change the plan.
  if (image.over > 0) image.texel_layers = image.layers + std::bit_ceil(places.back().layer + 1);
  return split;
}

// As place_lamps(), of maps in any order.
std::optional<PlacedLamps> place_views_of(const KeptLamps& kept, std::span<const LampMap> maps, bool floats,
                                          uint32_t layer_px, uint64_t most_bytes) {
  std::vector<uint32_t> order(maps.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, std::ranges::greater(), [&](uint32_t m) { return maps[m].size_px; });
  std::vector<LampMap> sorted;
  for (const uint32_t m : order) sorted.push_back(maps[m]);
  auto placed = place_lamps(kept.pool, sorted, floats, layer_px, most_bytes);
  if (!placed) return placed;
  std::vector<LampTile> tiles(maps.size());
  for (size_t i = 0; i < order.size(); ++i) tiles[order[i]] = placed->tiles[i];
  for (uint32_t& drawn : placed->drawn) drawn = order[drawn];
  std::ranges::sort(placed->drawn);
  placed->tiles = std::move(tiles);
  return placed;
}

// Of the views those that are drawn. split: as of add_over().
FrameViews of_drawn(const FrameViews& all, const ViewImage& image, std::span<const uint32_t> split,
                    std::span<const ViewCasters::OfView> casters, size_t runs) {
  FrameViews out;
  out.first_command.push_back(0);
  for (const uint32_t v : image.drawn) {
    const shared::View& view = image.views[v];
    const uint32_t of_all = v < image.first_over() ? v : split[v - image.first_over()];
    out.table.push_back(view);
    for (size_t r = 0; r < runs; ++r) {
      const uint32_t* first = &all.first_command[of_all * runs + r];
      const bool parts = (view.flags & (shared::view_skips_moving | shared::view_skips_standing)) != 0;
      const uint32_t moving = parts ? casters[of_all].moving_counts[r] : 0;
      const uint32_t count = view.flags & shared::view_skips_standing ? moving : first[1] - first[0] - moving;
      out.first_command.push_back(out.first_command.back() + count);
    }
  }
  if (out.table.empty()) out.table.emplace_back();  // a buffer holds something
  return out;
}

// The lights' nodes, neighbours as a range.
std::string nodes_of(const FrameData& data, std::span<const uint32_t> lights) {
  constexpr size_t most_ranges = 32;
  std::set<uint32_t> nodes;
  for (uint32_t last = ~0u; const uint32_t light : lights)
    if (data.lights[light].node != last) nodes.insert(last = data.lights[light].node);
  std::string text;
  size_t ranges = 0, named = 0;
  for (auto first = nodes.begin(); first != nodes.end() && ranges < most_ranges; ++ranges) {
    auto last = first;
    while (std::next(last) != nodes.end() && *std::next(last) == *last + 1) ++last, ++named;
    ++named;
    text +=
        (text.empty() ? "" : ", ") + (first == last ? fmt::format("{}", *first) : fmt::format("{}-{}", *first, *last));
    first = std::next(last);
  }
  if (named < nodes.size()) text += fmt::format(" and {} more", nodes.size() - named);
  return text;
}

}  // namespace

Expected<FrameLamps> plan_lamps(const Scene& scene, const SurveyedFrame& frame, const PackedFrame& packed,
                                const LampKnobs& knobs, int rows, const MapOptions& options) {
  const FrameData& data = frame.data;
  const View& view = frame.view;
  const SceneFacts& facts = frame.facts;
  const FrameRequest& request = frame.request;
  FrameLamps out;
  out.absence = why_none(facts, request, knobs, options.see_through);
  if (!out.absence.empty()) return out;
  out.traced = knobs.traced();
  out.by_voxels = knobs.method == LampKnobs::by_voxels;
  const bool in_air = request.draws_fog() || request.draws_volumetric();
  if (out.traced &&
      (!in_air || (!options.see_through && facts.opaque_items + facts.mask_items == 0) || knobs.lights == 0)) {
    out.absence = fmt::format("local.method is {}: shading sends rays", out.by_voxels ? "voxels" : "traced");
    return out;
  }
  const FrustumPlanes planes = frustum_planes(view.clip_from_relative);
  const uint32_t most_px =
      std::min(std::bit_floor(uint32_t(knobs.size_px)), most_map_px(options.longer_side_px, request.quality) / 2);
  const std::set<std::string> marked(request.look.shadows.lights.begin(), request.look.shadows.lights.end());
  for (const std::string& name : marked)
    if (std::ranges::none_of(data.lights, [&](const LightItem& l) {
          return l.type != LightType::directional && !(l.inner_m > 0) && scene.nodes[l.node].name == name;
        }))
      out.notes.push_back(
          fmt::format("the look marks '{}' for shadows, and no point or spot light that shines is at a "
                      "node of that name",
                      name));
  std::vector<Ranked> ranked = ranked_lights(scene, data, view, planes, marked);
  std::vector<Candidate> lamps;
  std::vector<uint32_t> without;
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
      if (lamp_face_is_seen(c.lamp, face, least_lamp_px, planes)) c.faces.push_back(face);
    if (!c.faces.empty()) lamps.push_back(std::move(c));
  }
  for (const Ranked& r : ranked) without.push_back(r.light);
  std::ranges::sort(without);  // nodes one after the other
  if (lamps.empty()) {
    out.absence = without.empty() ? "no point or spot light reaches what the camera sees"
                                  : "the look marks no point or spot light that reaches what the camera sees "
                                    "(local.lights = marked)";
    return out;
  }
  const std::vector<Candidate> chosen = lamps;
  fit_budget(lamps, uint64_t(knobs.budget_mb) << 20);
  for (size_t i = lamps.size(); i < chosen.size(); ++i) without.push_back(uint32_t(chosen[i].light));
  const std::string lights_text = knobs.lights == LampKnobs::marked_alone ? "marked" : fmt::format("{}", knobs.lights);
  if (!without.empty())
    out.notes.push_back(fmt::format(
        "{} of {} point and spot lights that may light the picture cast no shadows, those that add least "
        "(local.lights "
        "= {}, local.budget_mb = {}); they are of the nodes {}",
        without.size(), without.size() + lamps.size(), lights_text, knobs.budget_mb, nodes_of(data, without)));
  if (const auto smaller = std::ranges::count_if(lamps, [](const auto& c) { return c.size_px < c.wished_px; }))
    out.notes.push_back(
        fmt::format("the shadow maps of {} point and spot lights are smaller than they should be "
                    "(local.budget_mb = {})",
                    smaller, knobs.budget_mb));
  if (lamps.empty()) {
    out.absence = "no shadow map of a point or spot light fits into local.budget_mb";
    return out;
  }

  struct Face {
    size_t lamp;
    int face;
  };
  std::vector<Face> faces;
  for (size_t i = 0; i < lamps.size(); ++i)
    for (const int face : lamps[i].faces) faces.push_back({i, face});
  std::ranges::stable_sort(faces, std::ranges::greater(), [&](const Face& f) { return lamps[f.lamp].size_px; });
  std::vector<uint32_t> sizes;
  for (const Face& f : faces) sizes.push_back(lamps[f.lamp].size_px);
  const Room room = room_of(lamps);
  const std::vector<LampTile> tiles = pack_lamp_tiles(sizes, room.layer_px);
  for (const Candidate& c : lamps) {
    out.shadows.push_back(lamp_shadow(c.lamp, c.size_px, room.layer_px));
    out.shadows.back().pixel_places = uint32_t(knobs.pixel_places);
    out.lights.push_back(uint32_t(c.light));
  }
  ViewImage image;
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
  std::vector<bool> moves(scene.nodes.size());
  if (image.apart && options.animations) {
    moves = moving_nodes(scene, *options.animations);
    out.moving = moving_casters(scene, moves, packed.upload);
  }
  CasterHashes hashes;
  if (keeps) hashes = caster_hashes(data, packed.draws, packed.upload, frame.pose);
  ViewCasters casters{keeps ? &hashes : nullptr, out.moving, {}};
  const bool image_is_apart = image.apart;
  if (auto placed = place_maps(out, std::move(image), data, packed.draws, packed.upload.items, options, knobs.draws,
                               "local.draws", image_is_apart ? &casters : nullptr);
      !placed)
    return std::unexpected(placed.error());
  out.maps = out.most_views = uint32_t(faces.size());
  if (!out.image->apart) return out;
  auto apart = std::make_shared<ViewImage>(*out.image);
  apart->commands = out.views.first_command.back();
  std::vector<uint8_t> lamp_moves;
  for (const Face& f : faces) lamp_moves.push_back(moves[data.lights[lamps[f.lamp].light].node]);
  const std::vector<uint32_t> split = add_over(casters.of_view, lamp_moves, *apart);
  out.most_views = uint32_t(apart->views.size());
  apart->drawn.resize(faces.size());
  std::iota(apart->drawn.begin(), apart->drawn.end(), 0u);
  if (keeps) {
    const auto key_of = [&](uint32_t view, const CasterHash& seen) {
      const Face& f = faces[view];
      return map_key(lamps[f.lamp].lamp, f.face, sizes[view], seen, options, request.open_sides);
    };
    const uint64_t most_bytes =
        std::min(options.kept_lamps->most_bytes, kept_budgets * (uint64_t(knobs.budget_mb) << 20));
    // in_parts: what moves over what stands; else all of them as one map each.
    const auto keep = [&](bool in_parts) {
      std::vector<LampMap> maps;
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
      return place_views_of(*options.kept_lamps, maps, options.floats, std::max(most_px, pool_layer_px), most_bytes);
    };
    auto placed = keep(true);
    const bool in_parts = placed.has_value();
    if (!placed && !split.empty()) placed = keep(false);
    if (placed) {
      for (shared::LampShadow& shadow : out.shadows) shadow.uv_per_texel = float(1.0 / placed->pool.layer_px);
      const auto move = [&](size_t view, size_t face) {
        move_lamp_face(faces[face].face, sizes[face], placed->tiles[view], apart->views[view],
                       out.shadows[faces[face].lamp]);
      };
      for (size_t f = 0; f < faces.size(); ++f) move(f, f);
      for (size_t i = 0; in_parts && i < split.size(); ++i) {
        shared::View &stands = apart->views[split[i]], &over = apart->views[faces.size() + i];
        stands.flags |= shared::view_skips_moving;
        over.under_px = stands.tile_px, over.under_layer = stands.tile_layer;
        move(faces.size() + i, split[i]);
      }
      apart->drawn = std::move(placed->drawn);
      apart->outlives = true;
      out.pool = std::move(placed->pool);
    }
  }
  out.views = of_drawn(out.views, *apart, split, casters.of_view, packed.draws.batches.size());
  out.image = std::move(apart);
  return out;
}

}  // namespace candela
