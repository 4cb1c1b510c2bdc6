#pragma once
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "reference/accel.h"
#include "reference/bsdf.h"
#include "reference/glowing_body.h"
#include "reference/light_tree.h"
#include "reference/medium.h"
#include "reference/punctual.h"
#include "reference/ray_differential.h"
#include "reference/relief.h"
#include "reference/sky.h"
#include "reference/texture.h"
#include "scene/environment.h"
#include "scene/view.h"

namespace candela::reference {

// What is traced, as the other modules have it. All but the sky must outlive the World.
struct WorldInput {
  const Scene& scene;
  const Pose& pose;
  const View& view;
  const FrameData& frame;    // its lights are the punctual lights
  Sky sky{};                 // lights the scene
  AmbientSh ambient_sh{};    // of that sky, for the occlusion of the raster techniques' ambient term alone
  bool sky_visible = false;  // camera rays see it; else the background
  double sky_blur_rad = 0;   // standard deviation by which they see it blurred
  glm::dvec4 background{0};  // linear, premultiplied
  AccelOptions accel{};
  bool glass =
      false;  // light goes through transmissive surfaces (paths); else they are opaque, as techniques draw them
  std::optional<Fog> fog{};
  std::vector<Fog> more_fog{};  // media beside the first
  std::optional<Volumetric> volumetric{};
  std::optional<Occlusion> occlusion{};  // in direct, what is farther off does not hide the sky; path knows no such end
  bool reflections = false;              // in direct, opaque surfaces reflect each other; path knows nothing else
  std::vector<uint32_t> light_group_of{};  // of the frame's lights, by their places; behind its end: other_lights
  uint32_t other_lights = 0;
  bool open_sides = false;  // light passes single-sided faces from behind (--sides)
  // Of a perspective camera: radius of its lens's opening (0: a pinhole), and how far its plane of focus lies.
  double lens_radius_m = 0, focus_m = std::numeric_limits<double>::infinity();
};

// A ray with directions in double; the acceleration structure gets it rounded.
struct CameraRay {
  glm::dvec3 origin{0}, direction{0, 0, -1};  // of length 1 along the view axis: t is depth
  double t_min = 0, t_max = std::numeric_limits<double>::infinity();
};

// A triangle that emits, as lights are chosen.
struct EmissiveTriangle {
  uint32_t item = 0, primitive = 0;
  glm::dvec3 corner[3];
  glm::dvec3 normal{0};  // unit, towards the glTF front side
  double area_m2 = 0;
  bool two_sided = false;
};

// A posed scene for one view, in relative space: triangles, materials, textures and lights.
class World {
 public:
  // Textures that cannot be decoded are left out, as on the GPU, with a line in warnings.
  World(const WorldInput& input, std::vector<std::string>& warnings);

  const Accel& accel() const { return accel_; }
  const View& view() const { return input_.view; }
  const Sky& sky() const { return input_.sky; }
  const AmbientSh& ambient_sh() const { return input_.ambient_sh; }
  const std::vector<PunctualLight>& punctual_lights() const { return punctual_; }
  bool has_blend() const { return has_blend_; }
  const std::vector<Medium>& media() const { return media_; }  // whose sum the air is; none: clear air
  const std::optional<Volumetric>& volumetric() const { return input_.volumetric; }
  bool has_reflections() const { return input_.reflections; }
  bool has_near_occlusion() const { return input_.occlusion.has_value(); }
  Occlusion occlusion() const { return input_.occlusion.value_or(Occlusion{}); }
  // What fog leaves of light over a distance in unit direction l, colour by colour; 1 in clear air.
  glm::dvec3 through_fog(glm::dvec3 from, glm::dvec3 l, double distance_m) const {
    glm::dvec3 through(1);
    for (const Medium& medium : media_) through *= medium.transmittance(from, l, distance_m);
    return through;
  }

  CameraRay camera_ray(glm::dvec2 pixel, int width_px, int height_px) const;
  bool has_lens() const { return input_.lens_radius_m > 0 && input_.view.perspective; }
  // The same ray from a point of the lens, two numbers in [0, 1): both meet on the plane of focus (Cook, Porter and
  // Carpenter, "Distributed Ray Tracing", 1984).
  CameraRay through_lens(CameraRay ray, glm::dvec2 u) const;
  // How it changes from pixel to pixel, to the right and down.
  RayDifferential camera_steps(int width_px, int height_px) const;
  glm::dvec4 background(glm::dvec3 direction) const;  // of a camera ray that meets nothing

  // The surface at a hit of the ray (origin, direction), seen along it. The barycentrics are made anew in double from
  // the corners.
  // beside: of the ray, with `direction` as it is, over a part of the image; colours are then the means of their
  // textures over what that part sees.
  Surface surface(const Hit& hit, glm::dvec3 origin, glm::dvec3 direction,
                  const RayDifferential* beside = nullptr) const;
  // Where a ray meets the relief of a triangle that it meets at `candidate`, or below which it begins; nothing: it
  // passes by. t of what is returned may lie before the candidate's, where the ray comes from below.
  std::optional<Hit> meet_relief(const Ray& ray, const Hit& candidate) const;
  std::optional<Hit> leave_relief(const Ray& ray) const;
  bool has_relief() const { return has_relief_; }
  bool has_relief(uint32_t item) const { return items_[item].material->heights != nullptr; }
  // What is needed to leave the surface at a hit.
  SurfacePoint point(const Hit& hit) const;
  // The same seen from a point on either side.
  Surface surface_from(const Hit& hit, glm::dvec3 origin, glm::dvec3 direction, glm::dvec3 eye) const;
  // Those: weights of the second and third corner.
  glm::dvec2 weights(const Hit& hit, glm::dvec3 origin, glm::dvec3 direction) const;
  // The same at given barycentrics (weights of the second and third corner), seen from `to_viewer` (unit).
  // area: the sides of a parallelogram about it, in barycentrics, over which colours are means; null: a point.
  Surface surface_at(uint32_t item, uint32_t primitive, glm::dvec2 barycentrics, bool back, glm::dvec3 to_viewer,
                     const glm::dmat2* area = nullptr) const;
  // How the shading normal there turns with each of the barycentrics.
  std::array<glm::dvec3, 2> turn(const Hit& hit, glm::dvec2 barycentrics, glm::dvec3 to_viewer) const;
  double coverage(const Hit& hit) const;  // 1 opaque, 0 a hole
  bool is_masked(uint32_t item) const;    // by alpha: its holes are holes for every ray
  bool is_blended(uint32_t item) const;
  bool glows_all_over(uint32_t item) const;
  bool opens_sides() const { return input_.open_sides; }
  bool is_double_sided(uint32_t item) const;
  bool has_glass() const { return has_glass_; }
  bool bounds_body(uint32_t item) const;  // of glass: it has an inside, whose walls are seen from both sides

  // Whether there are lamps without a size whose light bodies of smooth glass bend, and a place on those bodies' walls,
  // evenly over their area, from three numbers in [0, 1).
  bool bends_lamps() const { return !bending_.empty(); }
  glm::dvec3 bending_place(double which, glm::dvec2 u) const;
  // A light of the lamp tree, as likely as its fraction of all their power: an index into tree_punctual().
  uint32_t lamp_by_power(double u) const;
  double lamp_power_share(uint32_t lamp) const;

  const std::vector<EmissiveTriangle>& emissive() const { return emissive_; }
  const std::vector<GlowingBody>& glowing() const { return glowing_; }
  // Into emissive(), behind its end into glowing(); -1: not chosen as a light.
  int emissive_of(uint32_t item, uint32_t primitive) const;
  // Lights of the tree: point and spot lights first (indices into tree_punctual()), then emissive triangles and bodies.
  const LightTree& light_tree() const { return tree_; }
  const LightTree& lamp_tree() const { return lamp_tree_; }  // the same without the triangles
  const std::vector<uint32_t>& tree_punctual() const { return tree_punctual_; }
  const std::vector<uint32_t>& directional() const { return directional_; }
  bool has_sized_lights() const { return has_sized_lights_; }  // suns with a disc, lamps with a radius

 private:
  struct TracedMaterial {
    Material material;
    const Texture *base = nullptr, *orm = nullptr, *occlusion = nullptr, *normal = nullptr, *emissive = nullptr,
                  *specular = nullptr, *specular_color = nullptr, *transmission = nullptr;
    // Of lobes that the material shows.
    const Texture *clearcoat = nullptr, *clearcoat_roughness = nullptr, *clearcoat_normal = nullptr,
                  *sheen_color = nullptr, *sheen_roughness = nullptr, *iridescence = nullptr, *film_thickness = nullptr,
                  *anisotropy = nullptr, *diffuse_transmission = nullptr, *transmitted_color = nullptr;
    const Texture* heights = nullptr;  // of a relief
    std::optional<Glass> glass;        // nothing: opaque
    // Where light does not go through, what a body scatters that is taken for a slab, and how thick that is.
    std::optional<BodyMedium> slab;
    const Texture* thickness = nullptr;
  };
  struct TracedItem {
    const MeshSection* section = nullptr;
    const DeformedVertices* deformed = nullptr;
    const TracedMaterial* material = nullptr;
    glm::dmat4 relative_from_local{1};
    double mirrored = 1;  // -1 where the transform turns the tangent frame over
    glm::dmat3 normal_from_local{1};
    bool unlit = false;
    glm::dvec2 least_uv{0}, most_uv{0};  // of the section, where a relief ends
  };
  // What a point has from its vertices.
  struct Vertex {
    glm::dvec3 normal{0};
    glm::dvec4 tangent{0};
    glm::dvec2 uv[2];
    std::optional<std::array<std::array<glm::dvec2, 2>, 2>> uv_sides;  // of an area about it, by set
    glm::dvec4 color{1};
  };
  void add_textures(const Material& material);
  void load_materials(std::vector<std::string>& warnings);
  void add_items();
  void add_lights();
  void add_emissive_triangles(std::vector<LightExtent>& extents);
  void add_glowing_bodies(std::vector<LightExtent>& extents);
  // What the material says of a point. geometric: unit, to either side.
  Surface shaded_surface(const TracedItem& item, const Vertex& v, glm::dvec3 position, glm::dvec3 geometric, bool back,
                         glm::dvec3 to_viewer) const;
  Surface implicit_surface(const MetaballSurface& body, const Hit& hit, glm::dvec3 direction, glm::dvec3 to_viewer,
                           bool back) const;
  Vertex vertex_at(const TracedItem& item, const std::array<uint32_t, 3>& corner, glm::dvec3 weight) const;
  ReliefLayer relief_layer(uint32_t item, uint32_t primitive) const;
  glm::dvec4 fetch(const Texture* texture, const TextureSlot& slot, const Vertex& v) const;
  // The mean over the vertex's area, where it has one.
  glm::dvec4 fetch_colour(const Texture* texture, const TextureSlot& slot, const Vertex& v, bool premultiplied) const;
  glm::dvec4 base_color(const TracedMaterial& m, const Vertex& v) const;
  glm::dvec3 emission_at(const TracedMaterial& m, const Vertex& v) const;
  // nullopt: the material has no lobe here. to_viewer: unit.
  std::optional<Lobes> lobes_at(const TracedMaterial& m, const Vertex& v, glm::dvec3 normal, glm::dvec3 to_viewer,
                                bool back) const;
  glm::dvec3 mapped_normal(const Texture* map, const TextureSlot& slot, double scale, const Vertex& v) const;
  glm::dvec3 normal_at(const TracedMaterial& m, const Vertex& v, bool back, glm::dvec3 to_viewer) const;
  void add_bending_walls();
  void add_relief_bounds(TracedItem& item);
  static void thin_out(BodyMedium& medium, const TracedItem& item);
  static double coverage_of(const Material& m, double alpha);

  WorldInput input_;
  std::vector<Medium> media_;
  Accel accel_;
  std::map<std::pair<int, bool>, std::unique_ptr<Texture>> textures_;  // by image and whether its colours are sRGB
  std::vector<TracedMaterial> materials_;                              // the last is the default material
  std::vector<TracedItem> items_;
  std::vector<PunctualLight> punctual_;
  std::vector<uint32_t> tree_punctual_, directional_;
  std::vector<EmissiveTriangle> emissive_;
  std::vector<GlowingBody> glowing_;
  std::vector<std::vector<int>> emissive_index_;  // per item; empty or one a triangle, of a body one
  LightTree tree_, lamp_tree_;
  struct Wall {
    uint32_t item = 0, primitive = 0;
    double area_to_m2 = 0;  // its own and that of those before it
  };
  std::vector<Wall> bending_;
  std::vector<double> lamp_power_;  // of tree_punctual(), each with those before it
  bool has_blend_ = false, has_glass_ = false, has_relief_ = false, has_sized_lights_ = false;
};

}  // namespace candela::reference
