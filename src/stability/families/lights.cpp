// Lights: intensities over fifteen orders of magnitude, ranges from a millimetre to a thousand kilometres, cones from a
// hundredth of a degree to a half space, lights where a direction or an inverse square has no value, and ten thousand
// in one place.
#include "stability/stage.h"
#include "testscenes/light_arrays.h"

namespace candela::stability {
namespace {

using Fill = std::function<void(GlbWriter& out)>;
StabilityScene room_with(StabilityInput& in, const Fill& lights) {
  GlbWriter out;
  room(out, in.rng);
  room_camera(out);
  lights(out);
  return scene_of(out);
}

// Pictures of one room differ by the factor of their only light.
StabilityScene intensity(StabilityInput& in, double candela) {
  return room_with(in, [&](GlbWriter& out) { point(out, {-0.5, 2.5, 2.5}, candela); });
}

StabilityScene range(StabilityInput& in, double range_m, glm::dvec3 at, double candela) {
  StabilityScene scene = room_with(in, [&](GlbWriter& out) {
    point(out, at, candela, {{"range", range_m}});
    point(out, {2, 2, 2}, 0.5);
  });
  return scene;
}

void add(Recipes& all, std::string name, std::string what, const Fill& lights, double bound = 1e-3) {
  all.push_back({"lights", std::move(name), std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = room_with(in, lights);
                   scene.bound = bound;
                   return scene;
                 }});
}

// Beside a light of 1: what a camera's exposure is for.
void add_places(Recipes& all) {
  add(all, "on a surface", "in the floor's plane: light along it, and an inverse square of 0", [](GlbWriter& out) {
    point(out, {0, 0, 1}, 5);
  });
  // Places are floats relative to the camera: 1e-7 m is what they resolve here, so a thousandth of the height is lost
  // at 1e-4 m.
  add(
      all, "a hair above a surface", "1e-4 m over the floor",
      [](GlbWriter& out) {
        point(out, {0, 1e-4, 1}, 5);
      },
      5e-3);
  add(all, "at a vertex", "at the floor's corner and at the cube's", [](GlbWriter& out) {
    point(out, {4, 0, 4}, 5);
    point(out, {1.375, 0.75, -0.125}, 1);
  });
  add(all, "at the camera", "light and view direction are the same", [](GlbWriter& out) {
    point(out, {0.5, 1.75, 4.5}, 20);
  });
  add(all, "behind the camera", "and far behind it", [](GlbWriter& out) {
    point(out, {0.5, 2.5, 9}, 60);
    point(out, {0, 500, 4000}, 1e7);
  });
  add(all, "inside the ball", "everything in front is lit from behind", [](GlbWriter& out) {
    point(out, {-1, 0.5, 0}, 5);
    point(out, {2, 1, 2}, 0.5);
  });
  add(all, "opposite the view", "light from straight behind what is seen: no half vector", [](GlbWriter& out) {
    const glm::dvec3 eye(0.5, 1.75, 4.5), target(0, 0.5, 0);
    point(out, target + (target - eye), 20);
  });
  add(all, "1,000 km off", "1e12 cd from 1e6 m", [](GlbWriter& out) { point(out, {6e5, 7e5, 4e5}, 3e12); });
  add(all, "farther than floats can square", "1e20 m off beside a lamp", [](GlbWriter& out) {
    point(out, {0, 1e20, 0}, 1e38);
    point(out, {-0.5, 2.5, 2.5}, 20);
  });
}

StabilityScene crowd(StabilityInput& in, bool spots, int count) {
  const glm::dvec3 at(-0.5, 2.5, 2.5), target(0, 0, 0);
  const json cone = {{"type", "spot"}, {"range", 30}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.7}}}};
  const json kind = spots ? cone : json{{"type", "point"}, {"range", 30}};
  const auto fill = [&](GlbWriter& out, int lights, Rng rng) {
    room(out, rng);
    room_camera(out);
    LightArrays all;
    for (int i = 0; i < lights; ++i) {
      all.add(at, {1, 1, 1}, 20.0 / lights, 30, {0, 1, 0});
      if (spots) all.aim(glm::normalize(target - at));
    }
    all.write(out, "crowd", out.light(kind));
  };
  GlbWriter out, plain;
  fill(out, count, in.rng);
  fill(plain, 1, in.rng);
  StabilityScene scene = scene_of(out);
  scene.plain = plain.bytes();
  scene.plain_bound = 2e-4;  // ten thousand roundings in a row, half an ulp each at worst
  scene.bound = 1e-3;
  scene.reference = false;  // the plain scene's picture is the reference's too (intensity 20)
  return scene;
}

StabilityScene cone(StabilityInput& in, double inner_deg, double outer_deg) {
  // Straight down on the floor in front, from a height at which the cone covers some pixels.
  const double reach = std::tan(std::min(outer_deg, 80.0) * pi / 180);
  const double height = std::clamp(0.8 / reach, 1.0, 5000.0);
  StabilityScene scene = room_with(in, [&](GlbWriter& out) {
    spot(out, {0.25, height, 1}, {0.25, 0, 1}, 5 * height * height, inner_deg * pi / 180, outer_deg * pi / 180);
  });
  return scene;
}

}  // namespace

void add_lights(Recipes& all) {
  for (const auto& [name, candela] : {std::pair("1e-6 cd", 1e-6), std::pair("1e9 cd", 1e9), std::pair("1e30 cd", 1e30)})
    all.push_back({"lights", name, "one lamp over the room", [=](StabilityInput& in) {
                     StabilityScene scene = intensity(in, candela);
                     scene.clamps = candela > 1e6;
                     return scene;
                   }});
  add(all, "1e-6 cd beside 1e9 cd",
      "the strong one must not swallow the room, nor the weak one vanish where it is alone", [](GlbWriter& out) {
        point(out, {-3, 0.5, 3}, 1e-6);
        point(out, {3, 40, -3}, 1e9, {{"range", 39.9}});
      });
  all.push_back({"lights", "range 1e-3 m", "half a millimetre over the floor, beside a lamp", [](StabilityInput& in) {
                   return range(in, 1e-3, {0, 5e-4, 1}, 5);
                 }});
  all.push_back({"lights", "range 1e-6 m", "on the floor, beside a lamp", [](StabilityInput& in) {
                   return range(in, 1e-6, {0, 0, 1}, 5);
                 }});
  all.push_back({"lights", "range 1e6 m", "over the room", [](StabilityInput& in) {
                   return range(in, 1e6, {0, 3, 2}, 20);
                 }});
  all.push_back({"lights", "range 1e30 m", "its square is no float", [](StabilityInput& in) {
                   return range(in, 1e30, {0, 3, 2}, 20);
                 }});
  all.push_back({"lights", "range's end in view", "the window falls to 0 on the floor", [](StabilityInput& in) {
                   return range(in, 2.5, {0, 1, 1}, 20);
                 }});
  add(all, "sun of 1e-6 lux", "", [](GlbWriter& out) { sun(out, {1, 2, 1}, 1e-6); });
  add(all, "sun of 1e9 lux", "", [](GlbWriter& out) { sun(out, {1, 2, 1}, 1e9); });
  add(all, "sun along the floor", "at 0.001 degrees over it", [](GlbWriter& out) {
    sun(out, {1, 1.7453e-5, 0.2}, 1e5);
  });
  add_places(all);
}

void add_cones_and_crowds(Recipes& all) {
  for (const auto& [name, inner, outer] :
       {std::tuple("cone of 0.01 degrees", 0.0, 0.01), std::tuple("cone of 0.01 degrees, sharp", 0.0099, 0.01),
        std::tuple("cone of 0.1 degrees", 0.0, 0.1), std::tuple("cone of 1 degree", 0.5, 1.0),
        std::tuple("cone of 90 degrees", 0.0, 90.0), std::tuple("cone of 90 degrees, sharp", 89.999, 90.0)})
    all.push_back(
        {"lights", name, "half angle, straight down", [=](StabilityInput& in) { return cone(in, inner, outer); }});
  all.push_back({"lights", "10,000 points in one place", "as bright as one",
                 [](StabilityInput& in) { return crowd(in, false, 10'000); }});
  all.push_back({"lights", "10,000 spots in one place", "as bright as one",
                 [](StabilityInput& in) { return crowd(in, true, 10'000); }});
  all.push_back({"lights", "none but dark ones", "intensity and colour 0: exactly black", [](StabilityInput& in) {
                   StabilityScene scene = room_with(in, [](GlbWriter& out) {
                     point(out, {0, 2, 2}, 0);
                     point(out, {0, 2, 2}, 5, {{"color", {0, 0, 0}}});
                   });
                   scene.black = true;
                   return scene;
                 }});
}

}  // namespace candela::stability
