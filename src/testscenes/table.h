#pragma once
#include "base/rng.h"
#include "testscenes/glb_writer.h"

// One function a scene, grouped by what the scenes exercise. make_scene.cpp holds the table of names.
namespace candela {

struct SceneOptions {
  Rng rng;
  int lights;  // 0: the scene's own choice
};

void make_unlit_box(GlbWriter& out, SceneOptions& options);
void make_spheres(GlbWriter& out, SceneOptions& options);
void make_lobes(GlbWriter& out, SceneOptions& options);
void make_alpha(GlbWriter& out, SceneOptions& options);
void make_glass(GlbWriter& out, SceneOptions& options);
void make_panes(GlbWriter& out, SceneOptions& options);
void make_stained(GlbWriter& out, SceneOptions& options);
void make_caustics(GlbWriter& out, SceneOptions& options);
void make_normal_mapped(GlbWriter& out, SceneOptions& options);
void make_texture_transform(GlbWriter& out, SceneOptions& options);
void make_emissive_strength(GlbWriter& out, SceneOptions& options);

void make_skinned(GlbWriter& out, SceneOptions& options);
void make_morph(GlbWriter& out, SceneOptions& options);
void make_instanced(GlbWriter& out, SceneOptions& options);
void make_primitive_modes(GlbWriter& out, SceneOptions& options);

void make_near_world(GlbWriter& out, SceneOptions& options);
void make_far_world(GlbWriter& out, SceneOptions& options);
void make_triangles(GlbWriter& out, SceneOptions& options);
void make_cuboid(GlbWriter& out, SceneOptions& options);
void make_depth_complexity_1(GlbWriter& out, SceneOptions& options);
void make_depth_complexity_4(GlbWriter& out, SceneOptions& options);
void make_depth_complexity_16(GlbWriter& out, SceneOptions& options);

void make_orthographic(GlbWriter& out, SceneOptions& options);
void make_animation_pointer(GlbWriter& out, SceneOptions& options);

void make_sheets(GlbWriter& out, SceneOptions& options);
void make_crossing(GlbWriter& out, SceneOptions& options);
void make_relief(GlbWriter& out, SceneOptions& options);
void make_scattering(GlbWriter& out, SceneOptions& options);
void make_foliage(GlbWriter& out, SceneOptions& options);
void make_hair(GlbWriter& out, SceneOptions& options);
void make_windows(GlbWriter& out, SceneOptions& options);
void make_smoke(GlbWriter& out, SceneOptions& options);

void make_metaballs(GlbWriter& out, SceneOptions& options);
void make_metaballs_glass(GlbWriter& out, SceneOptions& options);
void make_cave(GlbWriter& out, SceneOptions& options);
void make_room(GlbWriter& out, SceneOptions& options);
void make_lamp_paths(GlbWriter& out, SceneOptions& options);
void make_animated(GlbWriter& out, SceneOptions& options);

void make_street(GlbWriter& out, SceneOptions& options);
void make_street_dense(GlbWriter& out, SceneOptions& options);
void make_lights_stacked(GlbWriter& out, SceneOptions& options);
void make_light_field(GlbWriter& out, SceneOptions& options);

// Parts that several scenes use.
json pbr(glm::dvec4 base_color, double metallic, double roughness);
json pbr_textured(int base_color_texture, double metallic, double roughness);
glm::dquat rotation_about(glm::dvec3 axis, double angle_rad);
// A directional light that shines from `from` to the origin.
void add_sun(GlbWriter& out, glm::dvec3 from, glm::dvec3 color, double lux);
void add_point_light(GlbWriter& out, glm::dvec3 at, glm::dvec3 color, double candela);
std::vector<std::byte> checker_png(int size, int cells, glm::dvec3 dark, glm::dvec3 light);

}  // namespace candela
