#include "gltf/extensions.h"

#include <set>

namespace candela::gltf {
namespace {

using enum Support;

struct Known {
  const char* name;
  Support support;
  const char* consequence;
  bool traced = false;  // supported where paths are traced
  // Of those, what direct light lacks.
  const char* direct = "direct light takes the surface as opaque; --mode path follows light through it";
};

constexpr Known known_extensions[] = {
    {"KHR_lights_punctual", supported, ""},
    {"CANDELA_light_instances", supported, ""},
    {"CANDELA_light_size", supported, ""},
    {"CANDELA_materials_blinn_phong", supported, ""},
    {"CANDELA_metaballs", supported, ""},
    {"CANDELA_relief", supported, ""},
    {"KHR_mesh_quantization", supported, ""},
    {"KHR_draco_mesh_compression", supported, ""},
    {"EXT_meshopt_compression", supported, ""},
    {"KHR_meshopt_compression", supported, ""},
    {"EXT_mesh_gpu_instancing", supported, ""},
    {"KHR_texture_transform", supported, ""},
    {"KHR_animation_pointer", supported, ""},
    {"KHR_node_visibility", supported, ""},
    {"KHR_materials_unlit", supported, ""},
    {"KHR_materials_emissive_strength", supported, ""},
    {"KHR_materials_ior", supported, ""},
    {"KHR_materials_specular", supported, ""},
    {"KHR_xmp", supported, ""},
    {"KHR_xmp_json_ld", supported, ""},
    {"KHR_materials_variants", supported, ""},
    {"KHR_materials_clearcoat", supported, ""},
    {"KHR_materials_sheen", supported, ""},
    {"KHR_materials_transmission", approximated,
     "the picture behind the surface is seen through it, without other such surfaces "
     "(docs/understanding/refraction.md)",
     true},
    {"KHR_materials_diffuse_transmission", supported, ""},
    {"KHR_materials_volume", approximated,
     "light goes through the body as through a slab of the file's thickness (docs/understanding/refraction.md)", true},
    {"KHR_materials_volume_scatter", approximated,
     "a body scatters light as a slab of the file's thickness does, and not from place to place "
     "(docs/understanding/materials.md)",
     true, "a body scatters light as a slab of the file's thickness does; --mode path follows it through the body"},
    {"KHR_materials_iridescence", supported, ""},
    {"KHR_materials_anisotropy", supported, ""},
    {"KHR_materials_dispersion", approximated,
     "refraction splits light into three colours (docs/understanding/refraction.md)", true},
    {"KHR_materials_pbrSpecularGlossiness", supported, ""},
    {"KHR_texture_basisu", supported, ""},
    {"EXT_texture_webp", supported, ""},
    {"EXT_texture_avif", ignored, "AVIF images are not read; a texture without another is left out"},
    {"EXT_texture_astc", ignored, "ASTC images are not read; a texture without another is left out"},
    {"MSFT_texture_dds", ignored, "DDS images are not read; a texture without another is left out"},
    {"KHR_texture_video", ignored, "films are not read; a texture without a picture is left out"},
    {"KHR_texture_procedurals", ignored, "textures are not computed; one without an image is left out"},
    {"EXT_lights_image_based", ignored, "the file's own environment does not light the scene"},
    {"EXT_lights_ies", ignored, "local lights of measured profiles do not light the scene"},
    {"KHR_environment_map", ignored, "the file's own environment does not light the scene"},
    {"KHR_gaussian_splatting", ignored, "splats are drawn as plain points"},
    {"KHR_accessor_float64", ignored, "numbers of 64 bits are not read"},
    {"KHR_materials_subsurface", ignored, "light is not scattered below the surface"},
    {"ADOBE_materials_clearcoat_specular", ignored, "the clear coat reflects as one of index 1.5"},
    {"ADOBE_materials_clearcoat_tint", ignored, "the clear coat has no colour"},
    {"ADOBE_materials_thin_transparency", ignored, "the surface is drawn as its other extensions say"},
    {"EXT_mesh_primitive_restart", ignored, "primitives are drawn from their own indices, as files without it have"},
    {"EXT_mesh_primitive_edge_visibility", ignored, "edges of triangles are not drawn as lines"},
    {"CESIUM_primitive_outline", ignored, "edges of triangles are not drawn as lines"},
    {"EXT_mesh_manifold", ignored, "which meshes enclose a volume has no effect on the picture"},
    {"KHR_interactivity", ignored, "the scene's behaviour graph is not run"},
    {"KHR_audio_emitter", ignored, "sounds have no effect on the picture"},
    {"KHR_audio_graph", ignored, "sounds have no effect on the picture"},
    {"KHR_physics_rigid_bodies", ignored, "nothing is simulated; bodies stay where the file puts them"},
    {"KHR_implicit_shapes", ignored, "shapes for simulation are not drawn"},
    {"KHR_collision_shapes", ignored, "shapes for simulation are not drawn"},
    {"KHR_node_selectability", ignored, "nothing in a still picture can be selected"},
    {"KHR_node_hoverability", ignored, "nothing in a still picture can be hovered over"},
    {"MSFT_lod", ignored, "the most detailed level is always drawn"},
    {"EXT_mesh_features", ignored, "feature ids have no effect on the picture"},
    {"EXT_structural_metadata", ignored, "metadata have no effect on the picture"},
    {"KHR_techniques_webgl", ignored, "the file's own shaders are not run"},
};

// Every "extensions" object of the document, by the path of its owner. A stack of our own: JSON may be nested deeply.
std::map<std::string, std::vector<std::string>> users_of_extensions(const Json& root) {
  constexpr size_t most_users = 8;
  struct Open {
    const Json* value;
    std::string path;
  };
  std::map<std::string, std::vector<std::string>> users;
  std::vector<Open> open = {{&root, ""}};
  while (!open.empty()) {
    const Open at = std::move(open.back());
    open.pop_back();
    if (at.value->is_object()) {
      if (const Json* extensions = member(*at.value, "extensions"); extensions && extensions->is_object())
        for (const auto& [name, unused] : extensions->items())
          if (std::vector<std::string>& list = users[name]; list.size() < most_users)
            list.push_back(named(at.path.empty() ? "/" : at.path, *at.value));
      // Backwards, so that the stack gives members in file order.
      for (auto item = at.value->end(); item != at.value->begin();) {
        --item;
        if (item.key() != "extras" && item->is_structured()) open.push_back({&*item, at.path + "/" + item.key()});
      }
    } else if (at.value->is_array()) {
      for (size_t i = at.value->size(); i-- > 0;)
        if ((*at.value)[i].is_structured()) open.push_back({&(*at.value)[i], fmt::format("{}/{}", at.path, i)});
    }
  }
  return users;
}

std::vector<std::string> names_in(const Json& root, const char* key) {
  std::vector<std::string> out;
  if (const Json* list = member(root, key); list && list->is_array())
    for (const Json& name : *list)
      if (name.is_string() && std::find(out.begin(), out.end(), name.get_ref<const std::string&>()) == out.end())
        out.push_back(name);
  return out;
}

ExtensionUse describe(const std::string& name, LoadFor purpose) {
  ExtensionUse use;
  use.name = name;
  for (const Known& known : known_extensions)
    if (name == known.name) {
      // Where it is drawn nothing is lacking.
      if (known.traced && purpose == LoadFor::path_tracing) return {.name = name, .support = supported};
      if (known.traced && purpose == LoadFor::direct_tracing)
        return {.name = name, .support = approximated, .consequence = known.direct};
      use.support = known.support;
      use.traced = known.traced;
      use.consequence = known.consequence;
      return use;
    }
  use.consequence = "unknown to this program; what it adds is not drawn";
  return use;
}

}  // namespace

std::vector<ExtensionUse> survey_extensions(Document& document, LoadFor purpose) {
  std::map<std::string, std::vector<std::string>> users = users_of_extensions(document.json);
  std::vector<std::string> names = names_in(document.json, "extensionsUsed");
  const std::vector<std::string> required = names_in(document.json, "extensionsRequired");
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const std::string& name : required) add(name);
  for (const auto& [name, unused] : users) add(name);

  std::vector<ExtensionUse> out;
  for (const std::string& name : names) {
    ExtensionUse use = describe(name, purpose);
    use.required = std::find(required.begin(), required.end(), name) != required.end();
    use.users = users[name];
    if (use.required && use.support == Support::ignored)
      document.refuse("/extensionsRequired", "the file requires {}, which {} ({}); it is used by {}", name,
                      use.traced ? "only 'reference --mode path' draws" : "this program does not have", use.consequence,
                      use.users.empty() ? "no object of the file" : fmt::format("{}", fmt::join(use.users, ", ")));
    out.push_back(std::move(use));
  }
  return out;
}

}  // namespace candela::gltf
