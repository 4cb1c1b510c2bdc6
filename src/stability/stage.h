#pragma once
#include <numbers>

#include "stability/scenes.h"
#include "testscenes/glb_writer.h"
#include "testscenes/table.h"

// What the families of extreme scenes are put together from. All digits of numbers are kept: scales of 1e-8 are the
// point here.
namespace candela::stability {

using Recipes = std::vector<StabilityRecipe>;
void add_depth(Recipes& all);
void add_worlds(Recipes& all);
void add_lights(Recipes& all);
void add_cones_and_crowds(Recipes& all);
void add_materials(Recipes& all);
void add_lobes(Recipes& all);
void add_glass(Recipes& all);
void add_transparency(Recipes& all);
void add_textures(Recipes& all);
void add_geometry(Recipes& all);
void add_transforms(Recipes& all);
void add_animation(Recipes& all);
void add_display(Recipes& all);
void add_images(Recipes& all, const std::vector<std::pair<int, int>>& sizes);
void add_fog(Recipes& all);
void add_skies(Recipes& all);
void add_sides(Recipes& all);
void add_occlusion(Recipes& all);
void add_far_lights(Recipes& all);
void add_lobes_under_skies(Recipes& all);
void add_deep_shadows(Recipes& all);
void add_bodies_by_faces(Recipes& all);
void add_mirrors(Recipes& all);
void add_shutter(Recipes& all);
void add_metaballs(Recipes& all);
void add_relief(Recipes& all);
void add_paths(Recipes& all);
void add_regions(Recipes& all);

using std::numbers::pi;

json exact(glm::dvec3 v);
json exact(glm::dquat q);

json lit(glm::dvec3 color, double metallic, double roughness);  // a material, double sided
int place(GlbWriter& out, const Shape& shape, json material, glm::dvec3 at, glm::dvec3 scale = glm::dvec3(1));
void camera(GlbWriter& out, glm::dvec3 eye, glm::dvec3 target, double yfov_rad = 0.8, double near_m = 0.1);
void sun(GlbWriter& out, glm::dvec3 from, double lux);
// A light and its node; `more` is merged into the light.
void point(GlbWriter& out, glm::dvec3 at, double candela, json more = json::object());
void spot(GlbWriter& out, glm::dvec3 at, glm::dvec3 target, double candela, double inner_rad, double outer_rad,
          json more = json::object());
glm::dquat facing(glm::dvec3 direction);  // turns -Z to it

// A floor, a ball and a cube, seen from the front; everything lies on multiples of 1/64 m around `origin` and is
// `scale` times as large, so that both may be taken out again without rounding. `rng` chooses colours and places: the
// same draws, the same room.
struct Room {
  glm::dvec3 origin{0};
  double scale = 1;
  double near_m = 0.1;
  glm::dvec3 at(glm::dvec3 p) const { return origin + scale * p; }
};
void room(GlbWriter& out, Rng& rng, const Room& how = {});
void room_camera(GlbWriter& out, const Room& how = {});
// The room with its camera and one lamp over the viewer's shoulder.
void lit_room(GlbWriter& out, Rng& rng, const Room& how = {});

// 64 by 48 pixels, one sample, lights without a floor of their range, and lists even of one light.
StabilityScene scene_of(const GlbWriter& out);

// The lit room and what `fill` adds; beside it, the lit room and what `fill_plain` adds, of which the picture must be
// the same within `bound`.
using Fill = std::function<void(GlbWriter& out)>;
StabilityScene filled(StabilityInput& in, const Fill& fill);
StabilityScene filled_alike(StabilityInput& in, const Fill& fill, const Fill& fill_plain, double bound);

// The lit room as `how` says with what `fill` adds, and beside it the plain lit room, which must look the same within
// `bound`.
StabilityScene beside_plain(StabilityInput& in, const Room& how, double bound = 0,
                            const std::function<void(GlbWriter& out, Rng& rng)>& fill = {});

FloatImage sky_image(int width, int height, const std::function<glm::vec3(int x, int y)>& radiance);

// A primitive from any numbers, finite or not; normals and UVs where they are given.
json raw_primitive(GlbWriter& out, const std::vector<glm::dvec3>& position, const std::vector<glm::dvec3>& normal,
                   const std::vector<uint32_t>& index);
void raw_node(GlbWriter& out, json primitive, json material, json properties = json::object());

}  // namespace candela::stability
