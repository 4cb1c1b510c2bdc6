#pragma once
#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "math/bounds.h"

// A glTF file as plain data. Loading fills it; nothing changes it afterwards. Indices are into the vectors of Scene; -1
// is none. Units: metres, radians, seconds, candela (point, spot), lux (directional). Colours are linear Rec.709.
namespace candela {

struct SceneImage {
  std::string name, place;         // place: for messages ("scene.glb: /images/2 'bricks'")
  std::vector<std::byte> encoded;  // PNG or JPEG bytes as stored; empty when no material uses the image
  // An ORM texture made of two images, as indices into Scene::images; then encoded is empty. decode_scene_image makes
  // it.
  int merge_occlusion = -1, merge_metallic_roughness = -1;
  // An ORM texture whose roughness is 1 - factor * alpha of another image (KHR_materials_pbrSpecularGlossiness).
  int glossiness_of = -1;
  float glossiness_factor = 1;
};

enum class Wrap : uint8_t { repeat, clamp, mirror };
enum class Filter : uint8_t { nearest, linear };
struct Sampler {
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  Filter mag = Filter::linear, min = Filter::linear, mip = Filter::linear;
  bool mipmaps = true;  // false: min filter NEAREST or LINEAR, which the glTF specification samples from level 0 alone
  bool operator==(const Sampler&) const = default;
};

// A texture slot of a material. KHR_texture_transform: uv' = T(offset) R(rotation) S(scale) uv.
struct TextureSlot {
  int image = -1;   // into Scene::images; -1: no texture
  int sampler = 0;  // into Scene::samplers (there is always a default one at 0)
  int uv_set = 0;   // 0 or 1
  glm::vec2 offset{0}, scale{1};
  float rotation_rad = 0;
  explicit operator bool() const { return image >= 0; }
};

enum class AlphaMode : uint8_t { opaque, mask, blend };

// What a material may have besides its metallic-roughness base, each by the Khronos extension of its name. Textures
// multiply factors.
enum class Lobe : uint8_t { clearcoat, sheen, iridescence, anisotropy, transmission, diffuse_transmission, scattering };
inline constexpr int lobe_count = 7;

// A second, colourless dielectric layer on top (f0 0.04), with a normal of its own: that of the mesh, or a texture's.
struct Clearcoat {
  float factor = 0, roughness = 0, normal_scale = 1;
  TextureSlot texture, roughness_texture, normal_texture;  // R; G; tangent space
};
// Fibres that stand up from cloth.
struct Sheen {
  glm::vec3 color{0};
  float roughness = 0;
  TextureSlot color_texture, roughness_texture;  // sRGB; A
};
// A thin film, between two thicknesses by its texture; without one as thick as the larger.
struct Iridescence {
  float factor = 0, ior = 1.3f, least_nm = 100, most_nm = 400;
  TextureSlot texture, thickness_texture;  // R; G
};
// Facets that are smoother across a direction: that of the tangent, turned counter-clockwise.
struct Anisotropy {
  bool stated = false;  // the file has it, so that surfaces have tangents: the strength may be animated
  float strength = 0, rotation_rad = 0;
  TextureSlot texture;  // RG: direction in tangent space, from -1 to 1; B: strength
};
// The fraction of diffuse light that comes out on the other side.
struct DiffuseTransmission {
  float factor = 0;
  glm::vec3 color{1};
  TextureSlot texture, color_texture;  // A; sRGB
};

// KHR_materials_volume_scatter: the medium of a body scatters a part of the light that it weakens, by the phase
// function of Henyey and Greenstein. How much it weakens is the volume's attenuation. What lets light into the body is
// its transmission, of either kind.
struct Scattering {
  bool stated = false;   // the file has it, so that the surface bounds a body: its colour may be animated
  glm::vec3 color{0};    // what a deep body of it reflects diffusely (multi-scatter albedo)
  float anisotropy = 0;  // mean cosine of the angle by which light is turned, within most_anisotropy
};
inline constexpr float most_anisotropy = 0.999f;  // the extension's range is open at 1

// A lobe instead of facets (Blinn 1977): of the exponent that goes with the roughness, or as the file states it
// (CANDELA_materials_blinn_phong), then by the specular texture's A.
struct BlinnPhong {
  bool shades = false, stated = false;
  float exponent = 32;
};

// CANDELA_relief (docs/understanding/relief.md): the surface lies below the mesh, by the height that a texture has
// there as a depth.
struct Relief {
  TextureSlot texture;      // R: 0 is the mesh's own surface, 1 the floor
  float depth = 0;          // of the floor, in the mesh's space along its triangles' normals
  bool silhouettes = true;  // the surface ends where the section's texture coordinates do; else it goes on
};

// Metallic-roughness material (glTF 2.0 appendix B) with ior, specular, emissive_strength, unlit and the lobes above.
struct Material {
  std::string name;
  glm::vec4 base_color{1};
  float metallic = 1, roughness = 1;
  float normal_scale = 1, occlusion_strength = 1;
  glm::vec3 emissive{0};  // emissiveFactor
  float emissive_strength = 1;
  float ior = 1.5f;  // 0 means f0 = 1 (KHR_materials_ior)
  float specular = 1;
  glm::vec3 specular_color{1};
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false, unlit = false;
  // orm: R occlusion, G roughness, B metallic; merged at load when the file has separate images. `occlusion` is used
  // only when occlusion could not be merged (other UV set or transform); then has_orm_occlusion is false.
  TextureSlot base_color_texture, orm_texture, occlusion_texture, normal_texture, emissive_texture, specular_texture,
      specular_color_texture;
  bool orm_has_occlusion = false, orm_has_metallic_roughness = false;
  // KHR_materials_transmission: the fraction of the light that the diffuse base would reflect which goes through
  // instead. By its texture's R.
  float transmission = 0;
  TextureSlot transmission_texture;
  // KHR_materials_volume. Thickness 0: a sheet that does not bend light; else the surface bounds a body. How thick it
  // is, in the mesh's space and by its texture's G, is for techniques that cannot ask geometry.
  float thickness_m = 0;
  TextureSlot thickness_texture;
  float attenuation_distance_m =
      std::numeric_limits<float>::infinity();  // white light has the attenuation colour after this way
  glm::vec3 attenuation_color{1};
  float dispersion = 0;  // KHR_materials_dispersion: 20 over the Abbe number
  Clearcoat clearcoat;
  Sheen sheen;
  Iridescence iridescence;
  Anisotropy anisotropy;
  DiffuseTransmission diffuse_transmission;
  Scattering scattering;
  BlinnPhong blinn_phong;
  Relief relief;

  // Of opaque surfaces alone (the reader leaves others without a texture).
  bool has_relief() const { return relief.texture && relief.depth > 0; }
  bool wants_tangents() const { return !unlit && (normal_texture || clearcoat.normal_texture || anisotropy.stated); }
  // The texture coordinates along which they lie.
  int tangent_uv_set() const {
    return normal_texture             ? normal_texture.uv_set
           : clearcoat.normal_texture ? clearcoat.normal_texture.uv_set
                                      : anisotropy.texture.uv_set;
  }
  // Whether it shows the lobe.
  bool has(Lobe lobe) const {
    if (unlit) return false;
    switch (lobe) {
      case Lobe::clearcoat:
        return clearcoat.factor > 0;
      case Lobe::sheen:
        return sheen.color != glm::vec3(0);
      case Lobe::iridescence:
        return iridescence.factor > 0;
      case Lobe::anisotropy:
        return anisotropy.strength > 0;
      case Lobe::transmission:
        return transmission > 0;
      case Lobe::diffuse_transmission:
        return diffuse_transmission.factor > 0;
      case Lobe::scattering:
        return scattering.stated && thickness_m > 0 && (transmission > 0 || diffuse_transmission.factor > 0);
    }
    return false;
  }
};

enum class Topology : uint8_t { triangles, lines, points };

struct MorphTarget {  // deltas; each array is empty or vertex_count long
  std::vector<glm::vec3> position, normal, tangent;
};

// CANDELA_metaballs: a surface where a sum of kernels about the origins of nodes is the threshold (metaballs.h).
struct Metaball {
  int node = -1;
  float radius_m = 1;  // of its kernel's support, in the space of the body's node
  float strength = 1;  // of its kernel at the centre; negative ones hollow out
};
struct Metaballs {
  int node = -1;  // that shows it; the balls' nodes are below it
  float threshold = 0.5f;
  float cell_m = 0;                                      // of its polygons' lattice at the knob metaballs.cell = 1
  float noise_amplitude = 0, noise_frequency_per_m = 1;  // by which normals are turned
  std::vector<Metaball> balls;
};

struct DeformationBounds;  // deformation_bounds.h
class KeptViewHulls;       // view_hulls.h

// One glTF primitive, expanded: strips, fans and loops become lists, missing indices become 0..n-1. Attribute arrays
// are empty or vertex_count long. Positions in mesh space; quantized and normalised attributes are already floats.
struct MeshSection {
  std::string place;  // "/meshes/3/primitives/0"
  Topology topology = Topology::triangles;
  int material = -1;  // -1: the glTF default material
  std::vector<glm::vec3> position;
  std::vector<glm::vec3> normal;   // lines and points may have none (then they are unlit, as the specification says)
  std::vector<glm::vec4> tangent;  // only where the material wants them; w is the bitangent's sign
  std::vector<glm::vec2> uv0, uv1;
  std::vector<glm::vec4> color;  // linear, alpha 1 where the file had three components
  std::vector<glm::u16vec4> joints0, joints1;
  std::vector<glm::vec4> weights0, weights1;  // sum of both sets is 1 for every vertex
  std::vector<uint32_t> index;
  // Into Scene::metaballs, or -1. Then there are no vertices: each frame makes its own, and `index` numbers those of
  // one chunk of them (metaballs.h).
  int metaballs = -1;
  std::vector<MorphTarget> morph;
  Aabb bounds;  // of position, computed, not trusted from the file
  // Per joint and per morph target, made once after loading by prepare_deformation_bounds; null: made anew where
  // needed.
  std::shared_ptr<const DeformationBounds> deformation_bounds;
};

struct Mesh {
  std::string name;
  std::vector<MeshSection> sections;
  std::vector<float> default_weights;  // one per morph target
};

struct Camera {
  std::string name;
  bool perspective = true;
  double yfov_rad = 0.7853981633974483, aspect = 0;  // aspect 0: not given
  double near_m = 0.01, far_m = std::numeric_limits<double>::infinity();
  double xmag = 1, ymag = 1;  // orthographic half sizes
};

enum class LightType : uint8_t { directional, point, spot };
struct Light {  // KHR_lights_punctual
  std::string name;
  LightType type = LightType::point;
  glm::vec3 color{1};
  float intensity = 1;                                     // cd, or lux for directional
  float range_m = std::numeric_limits<float>::infinity();  // infinity: not given
  float inner_cone_rad = 0, outer_cone_rad = 0.78539816f;
  // CANDELA_light_size: of the sphere that a point or spot light is. 0: a point; nothing: what the look says, else 0.
  std::optional<float> radius_m;
};

struct Instances {  // EXT_mesh_gpu_instancing; each array is empty or count long
  size_t count = 0;
  std::vector<glm::vec3> translation, scale;
  std::vector<glm::quat> rotation;
};

struct LightInstances;  // light_instances.h
struct ScenePaths;      // scene_path.h

struct Node {
  std::string name;
  int parent = -1;
  std::vector<int> children;
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};  // w, x, y, z
  bool has_matrix = false;          // then `matrix` stands instead of TRS (such nodes may not be animated)
  glm::dmat4 matrix{1.0};
  int mesh = -1, skin = -1, camera = -1, light = -1;
  std::vector<float> weights;                             // empty: the mesh's default weights
  std::shared_ptr<const Instances> instances;             // null: one plain instance
  std::shared_ptr<const LightInstances> light_instances;  // null: none; drawn beside `light`
  bool visible = true;                                    // KHR_node_visibility
};

struct Skin {
  std::string name;
  std::vector<int> joints;               // nodes
  std::vector<glm::dmat4> inverse_bind;  // as many as joints; identity where the file gave none
};

enum class Interpolation : uint8_t { linear, step, cubic_spline };
// What a channel drives. TRS and weights are glTF core, the rest KHR_animation_pointer.
enum class TargetPath : uint8_t {
  node_translation,
  node_rotation,
  node_scale,
  node_weights,
  node_visible,
  material_base_color,
  material_metallic,
  material_roughness,
  material_emissive,
  material_alpha_cutoff,
  material_normal_scale,
  material_occlusion_strength,
  material_emissive_strength,
  material_ior,
  material_specular,
  material_specular_color,
  material_clearcoat,
  material_clearcoat_roughness,
  material_clearcoat_normal_scale,
  material_sheen_color,
  material_sheen_roughness,
  material_iridescence,
  material_iridescence_ior,
  material_iridescence_least,
  material_iridescence_most,
  material_anisotropy,
  material_anisotropy_rotation,
  material_transmission,
  material_thickness,
  material_attenuation_distance,
  material_attenuation_color,
  material_dispersion,
  material_diffuse_transmission,
  material_diffuse_transmission_color,
  material_multiscatter_color,
  material_scatter_anisotropy,
  material_blinn_phong_specular,
  material_blinn_phong_exponent,
  material_relief_depth,
  texture_offset,
  texture_rotation,
  texture_scale,  // of material `object`, slot `element`
  light_color,
  light_intensity,
  light_range,
  light_inner_cone,
  light_outer_cone,
  camera_yfov,
  camera_aspect,
  camera_near,
  camera_far,
  camera_xmag,
  camera_ymag,
  metaballs_threshold,
  metaballs_radius,    // of body `object`, ball `element`
  metaballs_strength,  // the same
};
enum class TextureSlotName : int {
  base_color,
  orm,
  occlusion,
  normal,
  emissive,
  specular,
  specular_color,
  clearcoat,
  clearcoat_roughness,
  clearcoat_normal,
  sheen_color,
  sheen_roughness,
  iridescence,
  iridescence_thickness,
  anisotropy,
  transmission,
  thickness,
  diffuse_transmission,
  diffuse_transmission_color,
  relief,
};
struct AnimationChannel {
  TargetPath path = TargetPath::node_translation;
  int object = -1;  // node, material, light or camera index
  int element =
      -1;  // texture slot (TextureSlotName), a component (base_color alpha: 3) or a single morph weight; -1: all
  Interpolation interpolation = Interpolation::linear;
  int components = 3;          // values per key (weights: the target count)
  std::vector<float> times_s;  // strictly usable: sorted, finite
  std::vector<float> values;   // keys * components, cubic splines 3 * that in the order in-tangent, value, out-tangent
};
struct Animation {
  std::string name;
  std::vector<AnimationChannel> channels;
  double end_s = 0;  // last key of all channels
};

enum class Support : uint8_t { supported, approximated, ignored };
struct ExtensionUse {
  std::string name;
  bool required = false;
  Support support = Support::ignored;
  bool traced = false;      // ignored here, but not where paths are traced
  std::string consequence;  // for approximated and ignored: what the picture lacks ("clear coat layer is not drawn")
  std::vector<std::string> users;  // JSON paths with names, at most 8, of what uses it
};

struct Scene {
  std::string path;                // as given
  std::vector<std::string> files;  // every file read, for job identity and watch
  std::vector<SceneImage> images;
  std::vector<Sampler> samplers;  // [0] is the default
  std::vector<Material> materials;
  Material default_material;  // of surfaces without one
  std::vector<Mesh> meshes;
  std::vector<Metaballs> metaballs;
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  std::vector<Node> nodes;
  std::vector<Skin> skins;
  std::vector<Animation> animations;
  std::vector<int> roots;             // root nodes of the default scene (scene 0 when none is named)
  std::vector<int> order;             // nodes reachable from roots, parents before children
  int probe_node = -1;                // probe.h
  std::vector<std::string> variants;  // of materials, by name (KHR_materials_variants)
  int variant = -1;                   // the one that meshes have
  std::vector<ExtensionUse> extensions;
  std::vector<std::string> warnings;          // one line each, with place
  std::shared_ptr<const ScenePaths> paths;    // that drive nodes; null: none
  std::shared_ptr<KeptViewHulls> view_hulls;  // what films are framed by; null: nothing is kept
};

// Whether some material lets light through (KHR_materials_transmission).
inline bool has_transmission(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.has(Lobe::transmission); });
}

}  // namespace candela
