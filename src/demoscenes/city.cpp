#include <algorithm>
#include <cmath>

#include "demoscenes/city.h"
#include "demoscenes/demo_scenes.h"

// A district of a city over twenty seconds: the sun sets, lamps, windows and head lamps come on, a curious body of
// balls wanders over the square, and a saucer takes it along.
namespace candela {
namespace city {

glm::dvec2 block_centre(int column, int row) {
  return {pitch_m * (column - 0.5 * (block_columns - 1)), pitch_m * (0.5 - row)};
}
bool is_square(int column, int row) { return block_centre(column, row) == square_centre; }

void Switches::animate(const std::string& pointer, int components, double on_s) {
  // A third of a second of warming up.
  const std::array times{0.0, on_s, on_s + 0.1, on_s + 0.2, on_s + 0.35};
  std::vector<double> values;
  for (double v : {0.0, 0.0, 0.25, 0.7, 1.0})
    for (int c = 0; c < components; ++c) values.push_back(v);
  out_.animate_pointer(pointer, "LINEAR", times, values, components);
}

int Switches::material(int glowing, double on_s) {
  json copy = out_.root["materials"][size_t(glowing)];
  const std::string name = copy["name"];
  const int material = out_.material(name, std::move(copy));
  animate(fmt::format("/materials/{}/emissiveFactor", material), 3, on_s);
  return material;
}

int Switches::light(json properties, double on_s) {
  const int light = out_.light(std::move(properties));
  animate(fmt::format("/extensions/KHR_lights_punctual/lights/{}/intensity", light), 1, on_s);
  return light;
}

int Switches::mesh_with(int mesh, int from_material, int to_material) {
  json copy = out_.root["meshes"][size_t(mesh)];
  for (json& primitive : copy["primitives"])
    if (primitive["material"] == from_material) primitive["material"] = to_material;
  out_.root["meshes"].push_back(std::move(copy));
  return int(out_.root["meshes"].size()) - 1;
}

int spot(Switches& switches, const char* name, double range_m, double inner_rad, double outer_rad, double on_s) {
  return switches.light({{"name", name},
                         {"type", "spot"},
                         {"range", number(range_m)},
                         {"spot", {{"innerConeAngle", number(inner_rad)}, {"outerConeAngle", number(outer_rad)}}}},
                        on_s);
}

int point(Switches& switches, const char* name, double range_m, double on_s) {
  return switches.light({{"name", name}, {"type", "point"}, {"range", number(range_m)}}, on_s);
}

int add_sampler(GlbWriter& out, std::span<const double> times_s, std::span<const double> values, int components) {
  if (!out.root.contains("animations"))
    out.root["animations"] =
        json::array({{{"name", "main"}, {"channels", json::array()}, {"samplers", json::array()}}});
  json& samplers = out.root["animations"][0]["samplers"];
  const int input = out.shared_float_accessor({times_s.begin(), times_s.end()}, 1, true),
            output = out.shared_float_accessor({values.begin(), values.end()}, components);
  samplers.push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
  return int(samplers.size()) - 1;
}

void play(GlbWriter& out, int sampler, int node, std::string_view path) {
  out.root["animations"][0]["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
}

void animate_places(GlbWriter& out, int node, std::span<const double> times_s, std::span<const glm::dvec3> places) {
  std::vector<double> values;
  for (glm::dvec3 p : places) push(values, p);
  out.animate(node, "translation", "LINEAR", times_s, values, 3);
}

void animate_turns(GlbWriter& out, int node, std::span<const double> times_s, std::span<const glm::dquat> turns) {
  std::vector<double> values;
  for (glm::dquat q : turns) push(values, q);
  out.animate(node, "rotation", "LINEAR", times_s, values, 4);
}

}  // namespace city

void make_city(GlbWriter& out, SceneOptions& options) {
  const uint64_t seed = options.rng.next();
  // In smoother puddles a head lamp that comes towards the camera flashes from frame to frame, and bloom over the
  // picture with it.
  constexpr double least_puddle_roughness = 0.3;
  city::Town town{
      out, Rng(seed), dusk::make_materials(out, seed & 0xffff, least_puddle_roughness, true), city::Switches(out), {}};
  add_city_ground(town);
  add_city_houses(town);
  add_city_lamps(town);
  add_city_square(town);
  add_city_people(town);
  add_city_cars(town);
  add_city_visitors(town);
  add_city_film(town);
  town.instances.write(out, "instances");
}

}  // namespace candela
