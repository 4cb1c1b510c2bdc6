#include "testscenes/make_scene.h"

#include <span>

#include "base/files.h"
#include "base/json.h"
#include "math/transforms.h"
#include "testscenes/demo_scene.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {

namespace {

struct SceneEntry {
  std::string_view name, description;
  void (*make)(GlbWriter&, SceneOptions&);  // null: candela_demoscenes.so makes it (src/demoscenes)
  int most_lights = 0;                      // 0: a fixed set
  bool committed = true, has_sky = false, is_film = false;
};

// A node for each light is 160 bytes of JSON; scenes that write CANDELA_light_instances go further.
constexpr int most_light_nodes = 100000, most_light_instances = 1 << 20;

constexpr SceneEntry table[] = {
    {"animated", "turning, bouncing and orbiting objects on a tiled plaza with lanterns and a moving camera",
     make_animated, most_light_nodes},
    {"alpha", "opaque, masked and blended layers", make_alpha},
    {"glass", "sheets and bodies that let light through, clear, frosted, coloured", make_glass},
    {"animation-pointer", "animated light intensity, base colour and field of view (KHR_animation_pointer)",
     make_animation_pointer},
    {"caustics", "a ball, a lens and a slab of glass that bend a sun's light onto a floor", make_caustics, 0, false},
    {"cave", "a tunnel of rough rock with dripstones and three coloured lamps behind them", make_cave, 0, false},
    {"cave-film",
     "a film of 15 s: a hall of rock with a bunny, a dragon, a wall that moves and three lamps that go round", nullptr,
     0, false, false, true},
    {"city", "a film of 20 s: a district as day turns to night, with cars, people, a curious blob and a saucer",
     nullptr, 0, false, true, true},
    {"crossing", "blended squares through one another", make_crossing, 0, false},
    {"cuboid", "a finely cut cuboid some of whose cells stand out: triangles in the planes of the axes", make_cuboid, 0,
     false},
    {"depth-complexity-1", "a wall of panels, some of them missing, and 144 finely cut balls before it",
     make_depth_complexity_1, 0, false},
    {"depth-complexity-4", "four such layers behind each other, each as large in the picture", make_depth_complexity_4,
     0, false},
    {"depth-complexity-16", "sixteen such layers", make_depth_complexity_16, 0, false},
    {"emissive-strength", "emissive panels of rising strength (KHR_materials_emissive_strength)",
     make_emissive_strength},
    {"far-world", "near-world, moved by a million metres", make_far_world},
    {"foliage", "a crown of a thousand blended leaves", make_foliage, 0, false},
    {"hair", "a thousand strands over a head, one blended mesh", make_hair, 0, false},
    {"instanced", "a field of 500 instances of one mesh (EXT_mesh_gpu_instancing)", make_instanced},
    {"lamp-paths", "coloured lamps, stones and a camera that files of paths and instances move", make_lamp_paths},
    {"light-field", "a few surfaces near and far under lights that are hard to bound, all from the seed",
     make_light_field, most_light_nodes},
    {"lights-stacked", "all lights over the same few tiles: along the view axis and in one place", make_lights_stacked,
     most_light_instances},
    {"lobes", "clear coat, sheen, thin films, anisotropy and passing light of rising strength, and all at once",
     make_lobes},
    {"metaballs", "a body of six balls that meet and part over a tiled floor (CANDELA_metaballs)", make_metaballs},
    {"metaballs-glass", "the same body of clear glass", make_metaballs_glass, 0, false},
    {"morph", "a cube with two morph targets and animated weights", make_morph},
    {"near-world", "a few objects around the origin; the yardstick of far-world", make_near_world},
    {"normal-mapped", "normal maps without tangents, straight and mirrored", make_normal_mapped},
    {"orthographic", "boxes under an orthographic camera", make_orthographic},
    {"panes", "coloured and frosted sheets of glass over each other, slabs, a ball and a lens", make_panes, 0, false},
    {"primitive-modes", "all primitive modes, with vertex colours", make_primitive_modes},
    {"relief", "a brick wall whose relief deepens and flattens, with a ball half in it (CANDELA_relief)", make_relief,
     0, false},
    {"room", "a closed room with a polished floor, walls of different colours and balls of metal", make_room, 0, false},
    {"scattering",
     "bodies that scatter light, dense to thin, lit from before and behind (KHR_materials_volume_scatter)",
     make_scattering, 0, false},
    {"sheets", "blended sheets of eight colours over each other", make_sheets, 0, false},
    {"skinned", "a bending tube with three joints", make_skinned},
    {"smoke", "puffs of smoke over each other, lit from outside and inside", make_smoke, 0, false},
    {"spheres", "metallic by roughness, under directional, point and spot lights", make_spheres},
    {"stained", "a sun and a lamp through coloured sheets onto a floor and a wall", make_stained, 0, false},
    {"street", "a city at night that grows with its lights: street lamps, cars, windows and signs", make_street,
     most_light_instances},
    {"street-dense", "the street's 1,024 lights' worth of city, which more lights make denser", make_street_dense,
     most_light_instances},
    {"street-dusk",
     "a street after sunset and rain with its sky, made for a picture: shops, lamps, cars, trees, people", nullptr, 0,
     false, true},
    {"texture-transform", "KHR_texture_transform, wrap modes, filters and the second UV set", make_texture_transform},
    {"triangles", "five large rectangles aslant: any plane that cuts space cuts them", make_triangles, 0, false},
    {"unlit-box", "a textured unlit box (KHR_materials_unlit)", make_unlit_box},
    {"windows", "houses with panes in front and behind, each house's panes one blended mesh", make_windows, 0, false},
};

const SceneEntry* find(std::string_view name) {
  for (const SceneEntry& entry : table)
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace

std::vector<std::string_view> scene_names() {
  std::vector<std::string_view> names;
  for (const SceneEntry& entry : table) names.push_back(entry.name);
  return names;
}

std::string_view scene_description(std::string_view name) {
  const SceneEntry* entry = find(name);
  return entry ? entry->description : std::string_view{};
}

bool scene_is_committed(std::string_view name) {
  const SceneEntry* entry = find(name);
  return entry && entry->committed;
}

bool scene_has_sky(std::string_view name) {
  const SceneEntry* entry = find(name);
  return entry && entry->has_sky;
}

Expected<std::vector<std::byte>> make_scene_sky(const std::string& name, uint64_t seed) {
  if (!scene_has_sky(name)) return std::vector<std::byte>{};
  return make_demo_scene(name, candela_demo_scene_sky, seed, 0);
}

std::filesystem::path sky_beside(std::filesystem::path scene) { return scene.replace_extension(".hdr"); }
bool scene_is_film(std::string_view name) {
  const SceneEntry* entry = find(name);
  return entry && entry->is_film;
}

namespace {

// A film's look for a file of that name.
std::vector<std::byte> with_stem(std::span<const std::byte> look, const std::filesystem::path& out) {
  std::string text(reinterpret_cast<const char*>(look.data()), look.size());
  constexpr std::string_view stem = "SCENE";
  for (size_t at = text.find(stem); at != std::string::npos; at = text.find(stem, at))
    text.replace(at, stem.size(), out.stem().string());
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Expected<std::vector<SceneFile>> make_files_beside(const std::string& name, uint64_t seed,
                                                   const std::filesystem::path& out) {
  std::vector<SceneFile> files;
  auto sky = make_scene_sky(name, seed);
  if (!sky) return std::unexpected(sky.error());
  if (!sky->empty()) files.push_back({sky_beside(out), std::move(*sky)});
  if (!scene_is_film(name)) return files;
  auto night = make_demo_scene(name, candela_demo_scene_night_sky, seed, 0);
  if (!night) return std::unexpected(night.error());
  if (!night->empty()) files.push_back({out.parent_path() / (out.stem().string() + "-night.hdr"), std::move(*night)});
  auto sound = make_demo_scene(name, candela_demo_scene_sound, seed, 0);
  if (!sound) return std::unexpected(sound.error());
  if (!sound->empty()) files.push_back({std::filesystem::path(out).replace_extension(".wav"), std::move(*sound)});
  const auto look = make_demo_scene(name, candela_demo_scene_look, seed, 0);
  if (!look) return std::unexpected(look.error());
  files.push_back({std::filesystem::path(out).replace_extension(".look.json"), with_stem(*look, out)});
  const auto texts = make_demo_scene(name, candela_demo_scene_texts, seed, 0);
  if (!texts) return std::unexpected(texts.error());
  if (texts->empty()) return files;
  const auto parsed = own_json({reinterpret_cast<const char*>(texts->data()), texts->size()});
  for (const auto& [suffix, value] : parsed.items()) {
    const std::string text = value.get<std::string>();
    const auto bytes = std::as_bytes(std::span(text));
    files.push_back({out.parent_path() / (out.stem().string() + suffix), {bytes.begin(), bytes.end()}});
  }
  return files;
}

Expected<std::vector<std::byte>> make_scene_bytes(const std::string& name, uint64_t seed, int lights) {
  const SceneEntry* entry = find(name);
  if (!entry) {
    std::string names;
    for (const SceneEntry& other : table) names += fmt::format("{}{}", names.empty() ? "" : ", ", other.name);
    return fail(ErrorKind::usage, "", "no scene is named '{}'; there are: {}", name, names);
  }
  if (lights != 0 && entry->most_lights == 0)
    return fail(ErrorKind::usage, "", "the scene '{}' has a fixed set of lights: leave out --lights", name);
  if (lights < 0 || lights > entry->most_lights)
    return fail(ErrorKind::usage, "", "the scene '{}' takes 0 to {} lights, not {}", name, entry->most_lights, lights);
  if (!entry->make) return make_demo_scene(name, candela_demo_scene_glb, seed, lights);
  GlbWriter writer;
  SceneOptions options{Rng(seed), lights};
  entry->make(writer, options);
  return writer.bytes();
}

Expected<void> make_scene(const std::string& name, uint64_t seed, int lights, const std::filesystem::path& out) {
  auto bytes = make_scene_bytes(name, seed, lights);
  if (!bytes) return std::unexpected(bytes.error());
  const auto beside = make_files_beside(name, seed, out);
  if (!beside) return std::unexpected(beside.error());
  for (const SceneFile& file : *beside)
    if (auto written = write_file_atomically(file.path, std::span<const std::byte>(file.bytes)); !written)
      return std::unexpected(written.error());
  return write_file_atomically(out, std::span<const std::byte>(*bytes));
}

json pbr(glm::dvec4 base_color, double metallic, double roughness) {
  return {{"pbrMetallicRoughness",
           {{"baseColorFactor", vector_json({base_color.x, base_color.y, base_color.z, base_color.w})},
            {"metallicFactor", number(metallic)},
            {"roughnessFactor", number(roughness)}}}};
}

json pbr_textured(int base_color_texture, double metallic, double roughness) {
  json out = pbr(glm::dvec4(1), metallic, roughness);
  out["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", base_color_texture}};
  return out;
}

glm::dquat rotation_about(glm::dvec3 axis, double angle_rad) { return glm::angleAxis(angle_rad, glm::normalize(axis)); }

void add_sun(GlbWriter& out, glm::dvec3 from, glm::dvec3 color, double lux) {
  const int light = out.light({{"type", "directional"}, {"color", vector_json(color)}, {"intensity", number(lux)}});
  const glm::dquat rotation = glm::quat_cast(glm::dmat3(look_at_pose(from, {0, 0, 0})));
  out.node("sun",
           {{"rotation", quaternion_json(rotation)}, {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
}

void add_point_light(GlbWriter& out, glm::dvec3 at, glm::dvec3 color, double candela) {
  const int light = out.light({{"type", "point"}, {"color", vector_json(color)}, {"intensity", number(candela)}});
  out.node("lamp", {{"translation", vector_json(at)}, {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
}

std::vector<std::byte> checker_png(int size, int cells, glm::dvec3 dark, glm::dvec3 light) {
  return png_from(size, size, 3, [=](double u, double v) {
    const bool odd = (int(u * cells) + int(v * cells)) % 2 != 0;
    return glm::dvec4(odd ? dark : light, 1);
  });
}

}  // namespace candela
