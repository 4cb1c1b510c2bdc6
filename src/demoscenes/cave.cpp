#include "demoscenes/cave.h"

#include "demoscenes/demo_scenes.h"

// The film cave-film, its look, and the files of paths and places that the look names.
namespace candela {

void make_cave_film(GlbWriter& out, SceneOptions& options) {
  const uint64_t seed = options.rng.next() & 0xffff;
  cave::add_rock(out, seed);
  cave::add_bunny(out);
  cave::add_dragon(out);
  cave::add_film(out);
}

std::vector<DemoText> make_cave_texts(uint64_t scene_seed) {
  Rng rng(scene_seed);
  const uint64_t seed = rng.next() & 0xffff;
  std::vector<DemoText> texts;
  const auto line = [](std::string& text, glm::dvec3 v) {
    text += fmt::format("{:.3f} {:.3f} {:.3f}\n", v.x, v.y, v.z);
  };
  for (const cave::Lamp& lamp : cave::lamps()) {
    std::string points = "# control points, metres\n", times = "# seconds, parameter\n";
    for (const glm::dvec3& p : lamp.points) line(points, p);
    for (const auto& [t, parameter] : lamp.times) times += fmt::format("{:.3f} {:.3f}\n", t, parameter);
    texts.push_back({std::string(lamp.suffix) + ".txt", points});
    texts.push_back({std::string(lamp.suffix) + "-times.txt", times});
  }
  for (const cave::Stones& stones : cave::place_stones(seed)) {
    std::string text = "# scale, rotation (degrees, x y z), translation; three lines a stone\n";
    for (const auto& [scale, rotation, translation] : stones.places)
      line(text, scale), line(text, rotation), line(text, translation);
    texts.push_back({stones.suffix, text});
  }
  return texts;
}

// The same as scenes/cave-film/cave-film.look.json.
std::string_view cave_look() {
  return R"({
  "paths": [
    {"target": "light Amber", "points": "SCENE-amber.txt", "closed": true, "times": "SCENE-amber-times.txt", "interpolation": "cubic"},
    {"target": "light Azure", "points": "SCENE-azure.txt", "closed": true, "times": "SCENE-azure-times.txt", "interpolation": "cubic"},
    {"target": "light Rose", "points": "SCENE-rose.txt", "closed": true, "times": "SCENE-rose-times.txt", "interpolation": "cubic"}
  ],
  "instances": [
    {"node": "Boulder 1", "file": "SCENE-boulders-1.txt"},
    {"node": "Boulder 2", "file": "SCENE-boulders-2.txt"},
    {"node": "Boulder 3", "file": "SCENE-boulders-3.txt"},
    {"node": "Pebble", "file": "SCENE-pebbles.txt"},
    {"node": "Dripstone 1", "file": "SCENE-dripstones-1.txt"},
    {"node": "Dripstone 2", "file": "SCENE-dripstones-2.txt"},
    {"node": "Dripstone 3", "file": "SCENE-dripstones-3.txt"},
    {"node": "Standing dripstone", "file": "SCENE-standing.txt"}
  ],
  "sky": {"gradient": {"zenith": [0.045, 0.055, 0.08], "horizon": [0.04, 0.046, 0.065], "ground": [0.036, 0.03, 0.028]}},
  "occlusion": {"radius_m": 2.5},
  "reflections": {},
  "fog": {"extinction": [0.011, 0.011, 0.012], "albedo": 0.95, "anisotropy": 0.35},
  "bloom": {"strength": 0.16, "weights": [1, 1, 1, 1, 1, 1]},
  "exposure": {"ev": {"keys": [[0, 0.55], [4, 0.2], [5, 0.1], [5.01, -0.9], [9.49, -0.9], [9.5, 0.2], [12, 0]]}},
  "tone_mapping": {"curve": "agx", "agx_min_ev": -10, "agx_max_ev": 3.2}
}
)";
}

}  // namespace candela
