#include "plan/frame_upload.h"

#include <cmath>
#include <cstring>

#include "base/check.h"
#include "base/scratch.h"
#include "plan/pack_metaballs.h"
#include "plan/packed_values.h"
#include "scene/blinn_phong.h"
#include "scene/matte_names.h"

namespace candela {
namespace {

constexpr double most_extinction_per_m = 1e15;  // of attenuation colours of 0

shared::Transform shared_transform(const glm::mat4& m) {
  return {
      {m[0][0], m[1][0], m[2][0], m[3][0]}, {m[0][1], m[1][1], m[2][1], m[3][1]}, {m[0][2], m[1][2], m[2][2], m[3][2]}};
}

shared::Geometry static_geometry(const SectionLayout& l) {
  return {l.position, l.normal, l.tangent, l.uv0, l.uv1, l.color, 0};
}

// Places a deformed section's vertices in the deformed buffer and describes the work that fills them.
void add_deformation(const Scene& scene, const Deformation& d, const SectionLayout& l, FrameUpload& upload) {
  const MeshSection& section = scene.meshes[d.mesh].sections[d.section];
  const uint32_t vertices = uint32_t(d.body >= 0 ? section.index.size() : section.position.size());
  const auto take = [&](bool present, uint32_t words_each) {
    if (!present) return shared::absent;
    const uint32_t at = upload.deformed_words;
    upload.deformed_words += vertices * words_each;
    return at;
  };
  shared::Geometry g = static_geometry(l);
  g.flags = shared::geometry_deformed;
  g.position = take(true, 3);
  const Material* material = section.material >= 0 ? &scene.materials[size_t(section.material)] : nullptr;
  g.normal = take(d.body >= 0 ? !is_unlit(section, material) : l.normal != shared::absent, 3);
  if (d.body >= 0 && take(g.normal != shared::absent, shared::rounded_words) != shared::absent)
    g.flags |= shared::geometry_rounded;
  g.tangent = take(l.tangent != shared::absent, 4);
  upload.geometries.push_back(g);
  if (d.body >= 0) return;  // made by passes/geometry/metaballs.h
  upload.deform_jobs.push_back(
      {vertices, l.position, l.normal, l.tangent, l.joints0, l.weights0, l.joints1, l.weights1, l.morph_table,
       std::min(d.weight_count, uint32_t(scene.meshes[d.mesh].sections[d.section].morph.size())), d.first_joint,
       d.joint_count, d.first_weight, g.position, g.normal, g.tangent});
}

// Farther off than floats can square, a light shines as one nearer by in the same direction does that is weaker by the
// square.
LightItem brought_nearer(LightItem l) {
  constexpr double farthest_m = 1e15;
  const double distance = glm::length(glm::dvec3(l.position));
  if (l.type == LightType::directional || !(distance > farthest_m) || !std::isfinite(distance)) return l;
  const double by = farthest_m / distance;
  l.position = glm::vec3(glm::dvec3(l.position) * by);
  l.intensity = glm::vec3(glm::dvec3(l.intensity) * (by * by));
  l.range_m = float(double(l.range_m) * by);
  l.radius_m = float(double(l.radius_m) * by);
  l.inner_m = float(double(l.inner_m) * by);
  return l;
}

double one_minus_cosine(double angle) { return 2 * std::pow(std::sin(angle / 2), 2); }

shared::Light shared_light(const LightItem& given) {
  const LightItem l = brought_nearer(given);
  shared::Light out{};
  out.position = l.position;
  out.direction = l.direction;
  out.intensity = l.intensity;
  out.type = l.type == LightType::directional ? shared::light_directional
             : l.inner_m > 0                  ? shared::light_stand_in
             : l.type == LightType::point     ? shared::light_point
                                              : shared::light_spot;
  out.inverse_range = inverse_range(l.range_m);
  // KHR_lights_punctual's recommended spot angle attenuation, (cos - cos outer) / (cos inner - cos outer), with 1 - cos
  // for each cosine: those of a narrow cone are all 1 as floats.
  const double inner = one_minus_cosine(double(l.inner_cone_rad)), outer = one_minus_cosine(double(l.outer_cone_rad));
  const double scale = 1.0 / std::max(0.001, outer - inner);
  out.spot_scale = float(scale / 2);
  out.spot_offset = float(outer * scale);
  if (l.inner_m > 0) out.spot_scale = inverse_range(l.inner_m);
  out.radius_m = l.type == LightType::directional ? float(l.radius_rad) : l.radius_m;
  if (!l.is_hard) out.sun_height = float(one_minus_cosine(l.radius_rad));
  return out;
}

// Of all lights, where a pass poses some.
void add_light_groups(const FrameData& data, std::vector<shared::LightGroup>& groups) {
  uint32_t first = 0, posed = 0;
  const auto add_posed = [&](uint32_t end) {
    if (end == posed) return;
    shared::LightGroup out{};
    out.first = first, out.count = end - posed, out.source = posed, out.posed = 1;
    groups.push_back(out);
    first += out.count, posed = end;
  };
  for (const LightGroup& group : data.light_groups) {
    add_posed(group.before);
    shared::LightGroup out{};
    out.origin = group.origin;
    out.x_axis = group.linear[0], out.y_axis = group.linear[1], out.z_axis = group.linear[2];
    out.candela = group.candela;
    out.light = shared_light(group.light);
    out.light.intensity = group.color;
    out.first = first, out.count = group.set->count, out.source = group.set->first;
    groups.push_back(out);
    first += out.count;
  }
  if (!groups.empty()) add_posed(uint32_t(data.lights.size()));
}

void add_items(const FrameData& data, const DrawList& draws, const GeometryLayout& layout, uint32_t default_material,
               FrameUpload& upload) {
  const float unbounded = std::numeric_limits<float>::infinity();
  for (const uint32_t index : draws.order) {
    const DrawItem& item = data.items[index];
    const SectionLayout& l = layout.sections[item.mesh][item.section];
    shared::Item out{};
    out.bounds_centre = item.bounds_relative.centre();
    out.bounds_extent = item.bounds_relative.extent();
    const bool finite = std::isfinite(out.bounds_centre.x + out.bounds_centre.y + out.bounds_centre.z) &&
                        std::isfinite(out.bounds_extent.x + out.bounds_extent.y + out.bounds_extent.z);
    if (!finite) out.bounds_centre = glm::vec3(0), out.bounds_extent = glm::vec3(unbounded);
    out.transform = item.transform;
    out.geometry = item.deformed >= 0 ? layout.geometry_count + uint32_t(item.deformed) : l.geometry;
    out.first_index = l.first_index;
    out.index_count = l.index_count;
    out.material = item.material >= 0 ? uint32_t(item.material) : default_material;
    out.object_id = item.node;
    upload.items.push_back(out);
  }
}

// What a pass poses items from.
void add_item_groups(const Scene& scene, const FrameData& data, const DrawList& draws, const GeometryLayout& layout,
                     uint32_t default_material, FrameUpload& upload) {
  upload.item_count = draws.item_count();
  upload.transform_count = uint32_t(upload.transforms.size());
  if (data.item_groups.empty() && upload.metaball_bodies.empty()) return;
  shared::ItemGroup posed{};
  posed.transform_count = upload.transform_count, posed.posed = 1;
  upload.item_groups.push_back(posed);
  for (const ItemGroup& group : data.item_groups) {
    upload.item_groups.push_back({wide(group.relative_from_node), upload.transform_count, group.set->count,
                                  group.set->first, 0, group.world_origin});
    upload.transform_count += group.set->count;
  }
  for (const DrawSpan& span : draws.spans) {
    upload.item_spans.push_back({span.first, span.count, uint32_t(span.group + 1), span.source, span.sections});
    if (span.group < 0) continue;
    const ItemGroup& group = data.item_groups[size_t(span.group)];
    for (uint32_t s = 0; s < span.sections; ++s) {
      const MeshSection& section = scene.meshes[group.mesh].sections[draws.sections[span.source + s]];
      const SectionLayout& l = layout.sections[group.mesh][draws.sections[span.source + s]];
      upload.item_sections.push_back({section.bounds.min, section.bounds.max, l.geometry, l.first_index, l.index_count,
                                      section.material >= 0 ? uint32_t(section.material) : default_material,
                                      group.node});
    }
  }
}

void add_groups(const DrawList& draws, FrameUpload& upload) {
  for (uint32_t r = 0; r < draws.batches.size(); ++r) {
    const DrawBatch& run = draws.batches[r];
    const uint32_t first_group = uint32_t(upload.groups.size());
    for (uint32_t at = 0; at < run.count; at += shared::cull_group_size) {
      const uint32_t count = std::min(shared::cull_group_size, run.count - at);
      upload.groups.push_back({run.first + at, count, r, first_group, at + count == run.count ? 1u : 0u,
                               run.solid() && !run.is_lines() ? 1u : 0u, run.alpha == AlphaMode::blend ? 1u : 0u});
    }
  }
}

void set_view(const View& view, const FrameRequest& request, shared::FrameConstants& c) {
  c.clip_from_relative = glm::mat4(view.clip_from_relative);
  const FrustumPlanes planes = frustum_planes(view.clip_from_relative);
  for (size_t p = 0; p < 5; ++p) c.planes[p] = glm::vec4(planes[p]);
  const glm::dmat3 relative_from_view = glm::transpose(glm::dmat3(view.view_from_relative));
  c.camera_right = glm::vec3(relative_from_view[0]);
  c.camera_up = glm::vec3(relative_from_view[1]);
  c.camera_back = glm::vec3(relative_from_view[2]);
  c.tan_half = {float(view.tan_x), float(view.tan_y)};
  c.size_px = {uint32_t(request.width_px), uint32_t(request.height_px)};
  c.perspective = view.perspective ? 1 : 0;
  c.pre_exposure = std::exp2(request.pre_exposure_ev);
  const double turn = glm::radians(request.look.sky.rotation_deg);
  c.sky_turn = glm::vec2(std::cos(turn), std::sin(turn));
  c.sky_intensity = float(request.look.sky.intensity);
}

// Without its textures' indices, which only a device knows.
shared::Material shared_material(const Material& m, uint32_t id) {
  shared::Material out{};
  out.base_color = m.base_color;
  out.emissive = m.unlit ? glm::vec3(0) : m.emissive * m.emissive_strength;
  out.alpha_cutoff = m.alpha_cutoff;
  out.metallic = m.metallic;
  out.roughness = float(stated_roughness(m));
  out.normal_scale = m.normal_scale;
  out.occlusion_strength = m.occlusion_strength;
  out.specular = m.specular;
  const float ratio = m.ior == 0 ? 1.0f : (m.ior - 1) / (m.ior + 1);
  out.ior_f0 = ratio * ratio;
  out.specular_color = m.specular_color;
  out.id = id;
  out.flags = (m.alpha_mode == AlphaMode::mask ? shared::material_masked : 0u) |
              (m.alpha_mode == AlphaMode::blend ? shared::material_blended : 0u) |
              (m.double_sided ? shared::material_double_sided : 0u) | (m.unlit ? shared::material_unlit : 0u) |
              (m.orm_has_occlusion ? shared::material_orm_occlusion : 0u) |
              (m.orm_has_metallic_roughness ? shared::material_orm_metallic_roughness : 0u) |
              (m.blinn_phong.shades ? shared::material_blinn_phong : 0u) |
              (m.blinn_phong.stated ? shared::material_exponent_texture : 0u) |
              (m.has_relief() && m.relief.silhouettes ? shared::material_relief_ends : 0u);
  return out;
}

// Without its textures' indices, like all of these.
shared::Glass shared_glass(const Material& m) {
  shared::Glass out{};
  if (!m.has(Lobe::transmission)) return out;
  out.transmission = m.transmission;
  out.thickness_m = m.thickness_m;
  out.ior = m.ior;
  out.dispersion = m.dispersion;
  for (int c = 0; c < 3; ++c) {
    const double left = std::min(double(m.attenuation_color[c]), 1.0);
    // Of colour 0 nothing is left on any way.
    const double per_m = left < 1 ? -std::log(left) / double(m.attenuation_distance_m) : 0;
    out.absorption[c] = float(std::min(per_m, 1e30));
  }
  return out;
}

// The extension's single-scattering albedo (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks",
// 2017); of two streams, those of even light: 3/4 of the reduced scattering is turned back, twice the absorption lost.
shared::BodyLight shared_body(const Material& m) {
  shared::BodyLight out{};
  if (!m.has(Lobe::scattering)) return out;
  out.thickness_m = m.thickness_m;
  for (int c = 0; c < 3; ++c) {
    const double color = std::clamp(double(m.attenuation_color[c]), 0.0, 1.0), multi = m.scattering.color[c];
    const double extinction =
        color < 1 ? std::min(-std::log(color) / double(m.attenuation_distance_m), most_extinction_per_m) : 0;
    const double root = 4.09712 + 4.20863 * multi - std::sqrt(9.59217 + 41.6808 * multi + 17.7126 * multi * multi);
    const double single = std::clamp(1 - root * root, 0.0, 1.0);
    const double turned = 0.75 * extinction * single * (1 - double(m.scattering.anisotropy)),
                 lost = 2 * extinction * (1 - single);
    out.extinction[c] = float(extinction), out.turned[c] = float(turned), out.lost[c] = float(lost);
    out.depth[c] = float(std::sqrt(lost * (lost + 2 * turned)));
  }
  return out;
}

shared::MaterialLobes shared_lobes(const Material& m, bool refraction) {
  shared::MaterialLobes out{};
  if (refraction) out.glass = shared_glass(m);
  if (m.has(Lobe::clearcoat)) {
    out.coat = m.clearcoat.factor;
    out.coat_roughness = m.clearcoat.roughness;
    out.coat_normal_scale = m.clearcoat.normal_scale;
  }
  if (m.has(Lobe::sheen)) {
    out.sheen = m.sheen.color;
    out.sheen_roughness = m.sheen.roughness;
  }
  if (m.has(Lobe::iridescence)) {
    out.film = m.iridescence.factor;
    out.film_ior = m.iridescence.ior;
    out.film_least_nm = m.iridescence.least_nm;
    out.film_most_nm = m.iridescence.most_nm;
  }
  if (m.has(Lobe::anisotropy)) {
    out.anisotropy = m.anisotropy.strength;
    out.anisotropy_turn = {std::cos(m.anisotropy.rotation_rad), std::sin(m.anisotropy.rotation_rad)};
  }
  if (m.has(Lobe::diffuse_transmission)) {
    out.passing = m.diffuse_transmission.factor;
    out.passing_color = m.diffuse_transmission.color;
  }
  return out;
}

uint32_t lobes_of(const Material& m) {
  uint32_t lobes = 0;
  for (int i = 0; i < lobe_count; ++i)
    if (m.has(Lobe(i))) lobes |= 1u << i;
  return lobes;
}

// Nothing where no visible material shows a lobe that the frame shades.
void add_lobes(const Scene& scene, const std::vector<Material>& materials, const FrameData& data, const DrawList& draws,
               std::vector<uint32_t>& words) {
  const bool refraction = std::ranges::any_of(draws.batches, &DrawBatch::refracts);
  const uint32_t shaded = shared::shaded_lobes | (refraction ? 1u << uint32_t(Lobe::transmission) : 0u);
  Scratch scratch;
  ScratchVector<uint8_t> shows(materials.size(), uint8_t(0), &scratch);
  bool any = false;
  bool scatters = false;
  const auto look_at = [&](int material) {
    if (material < 0) return;
    const uint32_t lobes = lobes_of(materials[size_t(material)]);
    scatters |= (lobes & 1u << uint32_t(Lobe::scattering)) != 0;
    if ((lobes & shaded) != 0) shows[size_t(material)] = 1, any = true;
  };
  for (const DrawItem& item : data.items) look_at(item.material);
  for (const ItemGroup& group : data.item_groups)
    for (const uint32_t section : group.set->sections) look_at(scene.meshes[group.mesh].sections[section].material);
  if (!any) return;
  words.assign(materials.size(), shared::absent);
  for (size_t i = 0; i < materials.size(); ++i) {
    if (!shows[i]) continue;
    words[i] = uint32_t(words.size());
    words.resize(words.size() + sizeof(shared::MaterialLobes) / 4);
    const shared::MaterialLobes lobes = shared_lobes(materials[i], refraction);
    std::memcpy(&words[words[i]], &lobes, sizeof lobes);
    if (!scatters) continue;
    const shared::BodyLight body = shared_body(materials[i]);
    const uint32_t* first = reinterpret_cast<const uint32_t*>(&body);
    words.insert(words.end(), first, first + sizeof body / 4);
  }
}

}  // namespace

void FrameUpload::clear() {
  constants = {};
  item_count = transform_count = batch_count = deformed_words = 0;
  const auto empty = [](auto&... tables) { (tables.clear(), ...); };
  empty(transforms, places, geometries, items, item_groups, item_spans, item_sections, materials, lobes, lights,
        light_groups, groups, batches, batch_spans, triangle_numbers, drawn_items, deform_jobs, object_mattes,
        material_mattes, motion, joints_before, weights_before, metaball_bodies, metaballs, metaball_blocks,
        metaball_lists, metaballs_before, reliefs_before);
  // A table that is not named above would keep the last frame's.
  static_assert(sizeof(FrameUpload) == sizeof(shared::FrameConstants) + 28 * sizeof(std::vector<int>) + 3 * 8);
}

void make_frame_upload(const Scene& scene, const Pose& pose, const View& view, const FrameData& data,
                       const DrawList& draws, const GeometryLayout& layout, const FrameRequest& request,
                       const AmbientSh& ambient, FrameUpload& upload) {
  upload.clear();
  set_view(view, request, upload.constants);
  for (size_t i = 0; i < 9; ++i) upload.constants.ambient_sh[i] = glm::vec4(ambient[i], 0);
  for (const glm::mat4& m : data.relative_from_local) upload.transforms.push_back(shared_transform(m));
  for (const glm::dvec3& origin : data.world_origins) {
    const glm::vec3 place(origin);
    upload.places.push_back({place, glm::vec3(origin - glm::dvec3(place))});
  }
  upload.geometries.resize(layout.geometry_count);
  for (const auto& mesh : layout.sections)
    for (const SectionLayout& l : mesh) upload.geometries[l.geometry] = static_geometry(l);
  for (const Deformation& d : data.deformations) add_deformation(scene, d, layout.sections[d.mesh][d.section], upload);
  add_items(data, draws, layout, uint32_t(pose.materials.size()), upload);
  add_metaballs(data, draws, upload);
  add_item_groups(scene, data, draws, layout, uint32_t(pose.materials.size()), upload);
  add_groups(draws, upload);
  for (size_t m = 0; m < pose.materials.size(); ++m)
    upload.materials.push_back(shared_material(pose.materials[m], uint32_t(m)));
  upload.materials.push_back(shared_material(scene.default_material, shared::absent));
  for (size_t m = 0; m < pose.materials.size(); ++m) {
    if (!pose.materials[m].has_relief()) continue;
    upload.materials[m].relief = uint32_t(upload.materials.size());
    upload.materials.emplace_back();  // a ReliefRecord, filled in by GpuScene
  }
  add_lobes(scene, pose.materials, data, draws, upload.lobes);
  for (const LightItem& l : data.lights) upload.lights.push_back(shared_light(l));
  if (request.has_layer("crypto_object")) upload.object_mattes = matte_ids(node_names(scene));
  if (request.has_layer("crypto_material")) upload.material_mattes = matte_ids(material_names(scene));
  add_light_groups(data, upload.light_groups);
  upload.constants.light_count = uint32_t(data.light_count());
  upload.constants.item_count = upload.item_count;
}

namespace {

uint32_t batches_of(uint32_t index_count) {
  return (index_count / 3 + shared::triangle_batch_size - 1) / shared::triangle_batch_size;
}

// Of a span's items from `first` to before `end`, which a run draws. cull_bit: of the first of them.
void add_host_batches(const DrawSpan& span, uint32_t first, uint32_t end, uint32_t cull_bit, uint32_t flags,
                      FrameUpload& upload) {
  for (uint32_t place = first; place < end; ++place) {
    const uint32_t batches = batches_of(upload.items[span.source + place - span.first].index_count);
    for (uint32_t b = 0; b < batches; ++b)
      upload.batches.push_back({place, b * shared::triangle_batch_size, cull_bit + place - first, flags});
  }
}

}  // namespace

void add_batches(const DrawList& draws, FrameUpload& upload) {
  size_t at = 0;  // among spans, of which one of the host's may reach over several runs
  uint32_t first_group = 0;
  for (const DrawBatch& run : draws.batches) {
    const uint32_t flags = (run.cull_back ? shared::batch_cull_back : 0u) |
                           (run.mirrored ? shared::batch_mirrored : 0u) |
                           (run.alpha == AlphaMode::mask ? shared::batch_masked : 0u) |
                           (run.unlit ? shared::batch_unlit : 0u) | (run.relief ? shared::batch_relief : 0u);
    const uint32_t run_end = run.first + run.count;
    for (; at < draws.spans.size() && draws.spans[at].first < run_end; ++at) {
      const DrawSpan& span = draws.spans[at];
      const uint32_t first = std::max(span.first, run.first), end = std::min(span.first + span.count, run_end);
      shared::BatchSpan batches{upload.batch_count,
                                0,
                                uint32_t(at),
                                0,
                                uint32_t(upload.batches.size()),
                                first_group * shared::cull_group_size + first - run.first,
                                flags};
      if (run.solid() && !run.is_lines()) {
        if (span.group < 0) {
          add_host_batches(span, first, end, batches.cull_bit, flags, upload);
          batches.count = uint32_t(upload.batches.size()) - batches.source;
        } else {
          for (uint32_t s = 0; s < span.sections; ++s)
            batches.per_instance += batches_of(upload.item_sections[span.source + s].index_count);
          batches.count = batches.per_instance * (span.count / span.sections);
        }
      }
      if (batches.count > 0 && !upload.item_groups.empty()) upload.batch_spans.push_back(batches);
      upload.batch_count += batches.count;
      if (span.first + span.count > run_end) break;  // the next run's too
    }
    first_group += (run.count + shared::cull_group_size - 1) / shared::cull_group_size;
  }
}

void add_triangle_numbers(const DrawList& draws, FrameUpload& upload) {
  upload.triangle_numbers.assign(draws.order.size(), shared::absent);
  for (size_t b = upload.batches.size(); b-- > 0;)  // the first batch of an item stays
    upload.triangle_numbers[draws.order[upload.batches[b].item]] = uint32_t(b) * shared::triangle_batch_size;
}

void add_drawn_items(const DrawList& draws, FrameUpload& upload) {
  upload.drawn_items.resize(draws.order.size());
  for (size_t i = 0; i < draws.order.size(); ++i) upload.drawn_items[draws.order[i]] = uint32_t(i);
}

namespace {
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
}  // namespace

void add_reliefs_before(const Pose& now, const Pose& before, FrameUpload& upload) {
  const auto same = [](const Material& a, const Material& b) {
    const TextureSlot &s = a.relief.texture, &t = b.relief.texture;
    return !a.has_relief() || (a.relief.depth == b.relief.depth && s.offset == t.offset && s.scale == t.scale &&
                               s.rotation_rad == t.rotation_rad);
  };
  if (std::ranges::equal(now.materials, before.materials, same)) return;
  for (const Material& m : before.materials) upload.reliefs_before.push_back(m.relief);
}

void add_motion(const FrameData& now, const View& view, const FrameData& before, const View& view_before,
                FrameUpload& upload) {
  CHECK(before.relative_from_local.size() == now.relative_from_local.size());
  CHECK(before.joint_matrices.size() == now.joint_matrices.size());
  CHECK(before.morph_weights.size() == now.morph_weights.size());
  const bool reforms = !same_metaballs(now.metaballs, before.metaballs);
  const bool deforms = reforms || !same_bits(before.joint_matrices, now.joint_matrices) ||
                       !same_bits(before.morph_weights, now.morph_weights);
  const glm::mat4 clip(view.clip_from_relative), clip_before(view_before.clip_from_relative);
  if (!deforms && upload.reliefs_before.empty() && std::memcmp(&clip, &clip_before, sizeof clip) == 0 &&
      same_bits(now.relative_from_local, before.relative_from_local))
    return;
  for (int column = 0; column < 4; ++column) upload.motion.push_back(clip_before[column]);
  for (const glm::mat4& m : before.relative_from_local) {
    const shared::Transform t = shared_transform(m);
    upload.motion.insert(upload.motion.end(), {t.row0, t.row1, t.row2});
  }
  // Both have one buffer of vertices.
  if (deforms || !upload.metaball_bodies.empty())
    upload.joints_before = before.joint_matrices, upload.weights_before = before.morph_weights;
  if (!upload.metaball_bodies.empty()) add_metaballs_before(now, before, upload);
}

}  // namespace candela
