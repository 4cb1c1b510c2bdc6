#include "demoscenes/city.h"
#include "demoscenes/demo_scenes.h"
#include "demoscenes/dusk_sky.h"

// The film's look, the same as scenes/city/city.look.json, and the skies that it names.
namespace candela {

std::vector<std::byte> make_city_day_sky(uint64_t seed) {
  return radiance_hdr(128, [seed](glm::dvec3 d) { return city::day_sky_radiance(d, seed); });
}

std::vector<std::byte> make_city_night_sky(uint64_t seed) {
  return radiance_hdr(256, [seed](glm::dvec3 d) { return city::night_sky_radiance(d, seed); });
}

// Sky and sun fall together from 0.6 to 9.8 s; the sky's brightness goes from 1.5 to -2.25 stops, in whole-second keys.
std::string_view city_look() {
  return R"({
  "sky": {
    "image": "SCENE.hdr",
    "extract_sun": false,
    "intensity": {"keys": [[0.6, 2.83], [1.75, 2.04], [2.9, 1.48], [4.05, 1.07], [5.2, 0.77], [6.35, 0.556], [7.5, 0.402], [8.65, 0.29], [9.8, 0.21]]},
    "second": {"image": "SCENE-night.hdr", "weight": {"keys": [[2.6, 0], [4.4, 0.35], [5.8, 0.9], [6.6, 1]], "interpolation": "cubic"}}
  },
  "fog": {
    "extinction": {"keys": [[0.6, [0.00044, 0.00047, 0.00055]], [3.5, [0.0011, 0.0012, 0.0013]], [5.6, [0.0024, 0.0025, 0.0027]], [9.8, [0.0055, 0.0059, 0.0066]]]},
    "albedo": 0.95,
    "anisotropy": 0.3,
    "falloff": 0.035,
    "height": 0
  },
  "exposure": {
    "ev": {"keys": [[3, 0], [9.8, -0.2]]},
    "auto": {
      "target": {"keys": [[2, 0.2], [6, 0.17], [10, 0.11]], "interpolation": "cubic"},
      "low_percent": 40, "high_percent": 95,
      "min_ev": -1.5, "max_ev": {"keys": [[5, 0.6], [10, 1.2]]}
    }
  },
  "tone_mapping": {
    "curve": "agx",
    "agx_min_ev": {"keys": [[4, -12.47393], [10, -12.9]]},
    "agx_max_ev": {"keys": [[4, 4.026069], [10, 5.4]]}
  },
  "bloom": {"strength": {"keys": [[3, 0.025], [10, 0.06]]}, "weights": [1, 1, 1, 1, 1, 1]},
  "occlusion": {"radius_m": 1.5}
}
)";
}

}  // namespace candela
