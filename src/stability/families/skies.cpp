// Skies: air from noon to night and at the ends of its values, colours and images of any brightness, blends, turns and
// blurs, and suns taken out of images at their poles and seam.
#include "stability/stage.h"

namespace candela::stability {
namespace {

// The room without a lamp, whose first light is the sun; towards it at `elevation_deg`, absent: no light at all.
StabilityScene outdoors(StabilityInput& in, const json& sky, std::optional<double> elevation_deg = {},
                        double lux = 10) {
  GlbWriter out;
  room(out, in.rng);
  room_camera(out);
  if (elevation_deg) {
    const double e = *elevation_deg * pi / 180;
    sun(out, {0.6 * std::cos(e), std::sin(e), 0.8 * std::cos(e)}, lux);
  }
  StabilityScene scene = scene_of(out);
  scene.sky_look = json{{"sky", sky}}.dump();
  scene.bound = 2e-3;  // the sky behind is filtered by the device's eight-bit fractions
  return scene;
}
// Air's image has texels of 0.7 degrees: pixels must be smaller, or the device's mean of several is not their middle's.
StabilityScene under_air(StabilityInput& in, const json& atmosphere, std::optional<double> elevation_deg = {},
                         double lux = 10) {
  StabilityScene scene = outdoors(in, {{"atmosphere", atmosphere}}, elevation_deg, lux);
  scene.job.width_px = 160, scene.job.height_px = 120;
  // From 50 km up the horizon's band is a few texels wide: those fractions count for twice as much.
  if (atmosphere.contains("altitude_m")) scene.bound = 4e-3;
  return scene;
}

FloatImage dusk() {
  return sky_image(64, 32, [](int x, int y) {
    return glm::vec3(0.9f, 0.5f, 0.3f) * (1.1f - float(y) / 32) * (1 + 0.2f * float(std::sin(x * 2 * pi / 64)));
  });
}
FloatImage night() {
  return sky_image(64, 32, [](int, int y) { return glm::vec3(0.01f, 0.02f, 0.05f) * (1 + float(y) / 32); });
}

StabilityScene under_image(StabilityInput& in, const json& sky, FloatImage image = dusk()) {
  StabilityScene scene = outdoors(in, sky);
  scene.sky = std::move(image);
  return scene;
}
// The same picture as under the plain image without a word about it in a look, within `bound`.
StabilityScene as_plain(StabilityScene scene, FloatImage plain, double bound) {
  scene.plain = scene.file;
  scene.plain_sky = std::move(plain);
  scene.plain_bound = bound;
  return scene;
}

void add(Recipes& all, std::string name, std::string what, const std::function<StabilityScene(StabilityInput&)>& make) {
  all.push_back({"skies", std::move(name), std::move(what), make});
}

void add_air(Recipes& all) {
  for (const double elevation : {90.0, 5.0, 0.0, -0.3, -6.0, -18.0, -90.0})
    add(all, fmt::format("sun {:g} degrees up", elevation), "air of the Earth",
        [=](StabilityInput& in) { return under_air(in, json::object(), elevation); });
  const auto air = [&](std::string name, std::string what, const json& atmosphere) {
    add(all, std::move(name), std::move(what), [=](StabilityInput& in) { return under_air(in, atmosphere, 20.0); });
  };
  air("no haze", "molecules alone", {{"haze", 0}});
  air("haze of 100", "the sun's light does not reach the ground", {{"haze", 100}});
  air("ozone of 100", "", {{"ozone", 100}});
  air("white ground", "", {{"ground_albedo", 1}});
  air("50 km up", "nearly no air above", {{"altitude_m", 50000}});
  air("haze of 100, 50 km up", "", {{"haze", 100}, {"altitude_m", 50000}});
  air("air under a sun of 1e-30 lux", "", {{"sun_lux", 1e-30}});
  air("air under a sun of 1e30 lux", "", {{"sun_lux", 1e30}});
  add(all, "air under a sun of 0 lux", "black", [](StabilityInput& in) {
    StabilityScene scene = under_air(in, json::object(), 20.0, 0);
    scene.black = true;
    return scene;
  });
  add(all, "air without a sun", "lit by 10 lux from 35 degrees up",
      [](StabilityInput& in) { return under_air(in, json::object()); });
}

void add_colours(Recipes& all) {
  const auto gradient = [&](std::string name, std::string what, const json& colours, bool black = false,
                            double bound = 2e-3) {
    add(all, std::move(name), std::move(what), [=](StabilityInput& in) {
      StabilityScene scene = outdoors(in, {{"gradient", colours}});
      scene.bound = bound;
      scene.black = black;
      return scene;
    });
  };
  const auto all_of = [](double v) { return json{{"zenith", v}, {"horizon", v}, {"ground", v}}; };
  gradient("colours of 0", "no neutral light either", all_of(0), true);
  gradient("colours of 1e-30", "", all_of(1e-30));
  gradient("colours of 1e30", "", all_of(1e30));
  // The root rises without bound at the horizon, where the image of the sky is straight between texels.
  gradient("colours 1e-6 and 1e6", "zenith and ground", {{"zenith", 1e6}, {"horizon", 1}, {"ground", 1e-6}}, false,
           0.1);
}

// The studio is no background, so nothing that the device filters is seen but in surfaces.
void add_studio(Recipes& all) {
  const auto studio = [&](std::string name, std::string what, const json& sky, double lux) {
    add(all, std::move(name), std::move(what), [=](StabilityInput& in) {
      StabilityScene scene = outdoors(in, sky, lux > 0 ? std::optional(20.0) : std::nullopt, lux);
      scene.job.sky = studio_sky;
      return scene;
    });
  };
  studio("studio", "", json::object(), 0);
  studio("studio, turned by -3.6e6 degrees", "whole turns", {{"rotation_deg", -3.6e6}}, 0);
  for (const double intensity : {1e-30, 1e30})
    studio(fmt::format("studio, times {:g}", intensity), "", {{"intensity", intensity}}, 0);
  studio("studio beside a sun of 1e30 lux", "", json::object(), 1e30);
  studio("studio beside a sun of 1e-30 lux", "", json::object(), 1e-30);
}

void add_images_of_skies(Recipes& all) {
  for (const double intensity : {1e-30, 1e30})
    add(all, fmt::format("image, times {:g}", intensity), "", [=](StabilityInput& in) {
      return under_image(in, {{"intensity", intensity}});
    });
  add(all, "image, times 0", "black", [](StabilityInput& in) {
    StabilityScene scene = under_image(in, {{"intensity", 0}});
    scene.black = true;
    return scene;
  });
  for (const double turn : {360.0, -3.6e6})
    add(all, fmt::format("turned by {:g} degrees", turn), "whole turns", [=](StabilityInput& in) {
      return as_plain(under_image(in, {{"rotation_deg", turn}}), dusk(), 1e-4);
    });
  for (const double blur : {1e-30, 1e-6, 1e-3})
    add(all, fmt::format("blurred by {:g} degrees", blur), "less than a texel: as it is", [=](StabilityInput& in) {
      return as_plain(under_image(in, {{"blur_deg", blur}}), dusk(), 1e-5);
    });
  for (const double blur : {3.0, 90.0})
    add(all, fmt::format("blurred by {:g} degrees", blur), "", [=](StabilityInput& in) {
      StabilityScene scene = under_image(in, {{"blur_deg", blur}});
      scene.bound = 0.1, scene.energy_bound = 5e-3;  // the reference's own mean is of some directions
      return scene;
    });
}

void add_blends(Recipes& all) {
  const auto blend = [&](std::string name, const json& second, std::optional<FloatImage> plain,
                         std::optional<double> elevation = {}) {
    add(all, std::move(name), "two images", [=](StabilityInput& in) {
      json with = second;
      with["image"] = "second.exr";
      StabilityScene scene = outdoors(in, {{"second", with}}, elevation);
      scene.sky = dusk(), scene.second_sky = night();
      return plain ? as_plain(std::move(scene), *plain, 1e-5) : scene;
    });
  };
  blend("blended by 0", {{"weight", 0}}, dusk());
  blend("blended by 1", {{"weight", 1}}, night());
  blend("blended by 1e-9", {{"weight", 1e-9}}, dusk());
  blend("the second times 1e30", {{"weight", 0.5}, {"intensity", 1e30}}, std::nullopt);
  const json follows = {{"follows_sun", {{"from_deg", -18}, {"to_deg", 0}}}};
  blend("blended by a sun in the zenith", follows, dusk(), 90);
  blend("blended by a sun in the nadir", follows, night(), -90);
  blend("blended by a sun on the edge", follows, std::nullopt, -18);
}

// A dim sky with bright texels, of which one spot becomes a light.
void add_suns_of_images(Recipes& all) {
  using Bright = std::function<bool(int x, int y)>;
  const auto spot = [&](std::string name, std::string what, const Bright& bright, float radiance = 5000) {
    add(all, std::move(name), std::move(what), [=](StabilityInput& in) {
      StabilityScene scene =
          under_image(in, {{"extract_sun", true}}, sky_image(64, 32, [=](int x, int y) {
                        return bright(x, y) ? glm::vec3(1, 0.9f, 0.7f) * radiance : glm::vec3(0.2f, 0.3f, 0.5f);
                      }));
      // A disc as wide as a texel here, 6 degrees, has penumbrae and highlights that frames only come near to.
      scene.sky_look = json{{"sky", {{"extract_sun", true}}}, {"sun", {{"angular_radius_deg", 0}}}}.dump();
      return scene;
    });
  };
  spot("sun in the image's zenith", "a whole row of texels", [](int, int y) { return y == 0; });
  spot("sun in the image's nadir", "", [](int, int y) { return y == 31; });
  spot("sun on the image's seam", "", [](int x, int y) { return y == 9 && (x == 0 || x == 63); });
  spot("two suns", "as bright as each other", [](int x, int y) { return y == 9 && (x == 10 || x == 40); });
  spot("a sky that is all sun", "too wide for a light", [](int, int) { return true; });
  spot("sun cut by the horizon", "the row above it", [](int x, int y) { return y == 15 && (x == 30 || x == 31); });
  spot(
      "a sun of 1e30", "", [](int x, int y) { return y == 9 && x == 20; }, 1e30f);
}

}  // namespace

void add_skies(Recipes& all) {
  add_air(all);
  add_colours(all);
  add_studio(all);
  add_images_of_skies(all);
  add_blends(all);
  add_suns_of_images(all);
}

}  // namespace candela::stability
