// Fog: extinction from 0 to 1e6, the phase function towards its spikes, density that falls by 1e9 over a metre, eyes
// in, over and under it. Every scene's single scattering is known in closed form.
#include "stability/stage.h"

namespace candela::stability {
namespace {

using Known = std::function<glm::dvec3(glm::dvec3)>;

double phase(double cosine, double g) { return (1 - g * g) / (4 * pi * std::pow(1 + g * g - 2 * g * cosine, 1.5)); }
// (1 - e^-x)/x for x of either sign.
double mean_exp(double x) { return std::abs(x) < 1e-9 ? 1 - x / 2 : -std::expm1(-x) / x; }

// An eye that looks along -Z, and a background.
StabilityScene fogged(const json& fog, const Known& known, const std::function<void(GlbWriter&)>& lights,
                      glm::dvec3 eye = {0, 0, 4}, glm::dvec3 to = {0, 0, -1}, const std::string& background = "0,0,0") {
  GlbWriter out;
  camera(out, eye, eye + to, 0.8, 0.1);
  place(out, box({0.01, 0.01, 0.01}), lit(glm::dvec3(0.5), 0, 0.5),
        eye + glm::dvec3(1000, 0, 0));  // a file needs some geometry: aside, and out of every light's way
  lights(out);
  StabilityScene scene = scene_of(out);
  scene.job.width_px = 32, scene.job.height_px = 24;
  scene.job.background = background;
  scene.look = json{{"fog", fog}}.dump();
  scene.known = known;
  scene.reference = false;
  return scene;
}
void no_light(GlbWriter& out) { sun(out, {0, 1, 0}, 0); }  // no neutral light either

constexpr double sun_lux = 3;
// A slab between z = -1 and 1 lit straight along the axis of view: L = E albedo p (1 - e^(-2 sigma (1 + 1/mu)))/(1 +
// mu).
StabilityScene slab(glm::dvec3 extinction, double g, double albedo = 0.8) {
  const json fog = {
      {"extinction", exact(extinction)}, {"albedo", albedo}, {"anisotropy", g}, {"bounds", {{"z", {-1, 1}}}}};
  return fogged(
      fog,
      [=](glm::dvec3 d) {
        const double mu = -d.z;
        glm::dvec3 out;
        for (int c = 0; c < 3; ++c)
          out[c] = sun_lux * albedo * phase(d.z, g) * -std::expm1(-2 * extinction[c] * (1 + 1 / mu)) / (1 + mu);
        return out;
      },
      [](GlbWriter& out) {
        sun(out, {0, 0, 1}, sun_lux);
      });
}

// A lamp beside the axis in fog too thin to weaken it: the integral of the inverse square is a difference of two arc
// tangents.
StabilityScene lamp_in_thin_air(double extinction, glm::dvec3 at, double candela) {
  const json fog = {{"extinction", extinction}, {"bounds", {{"z", {-1, 1}}}}};
  const glm::dvec3 eye(0, 0, 4);
  return fogged(
      fog,
      [=](glm::dvec3 d) {
        const double from = 3 / -d.z, to = 5 / -d.z, nearest = glm::dot(at - eye, d),
                     aside = glm::length(at - eye - nearest * d);
        return glm::dvec3(extinction * candela / (4 * pi) *
                          (std::atan((to - nearest) / aside) - std::atan((from - nearest) / aside)) / aside);
      },
      [=](GlbWriter& out) { point(out, at, candela); }, eye);
}

// Fog that glows and absorbs before a bright background: J (1 - T) + T B, with T of the medium's length along the ray.
StabilityScene glowing(const json& more, double extinction, glm::dvec3 eye, glm::dvec3 to,
                       const std::function<double(glm::dvec3)>& length) {
  json fog = {{"absorption", extinction}, {"emission", exact(glm::dvec3(0.5, 1, 2) * extinction)}};
  fog.update(more);
  return fogged(
      fog,
      [=](glm::dvec3 d) {
        const double depth = extinction * length(d);
        return glm::dvec3(0.5, 1, 2) * -std::expm1(-depth) + glm::dvec3(4) * std::exp(-depth);
      },
      no_light, eye, to, "4,4,4");
}

const double billionth_a_metre = std::log(1e9);

// Without end, from a height over that of density 1: rays that fall meet all of it.
double falling_length(double falloff, double height, glm::dvec3 d) {
  return d.y > 0 ? std::exp(-falloff * height) / (falloff * d.y) : std::numeric_limits<double>::infinity();
}

// The sun straight over it: looking down L = E p s/(|y| + 1) e^(-sigma rho/k), and up the integral over what is above
// the eye.
StabilityScene under_the_zenith(double extinction, double falloff, double height, glm::dvec3 to) {
  const json fog = {{"extinction", extinction}, {"albedo", 0.9}, {"anisotropy", 0.4}, {"falloff", falloff}};
  return fogged(
      fog,
      [=](glm::dvec3 d) {
        const double density = std::exp(-falloff * height), over = extinction * density / falloff,
                     p = sun_lux * 0.9 * phase(d.y, 0.4);
        if (d.y < 0) return glm::dvec3(p * std::exp(-over) / (1 - d.y));
        return glm::dvec3(p * over / d.y * std::exp(-over / d.y) * mean_exp(over * (1 - 1 / d.y)));
      },
      [](GlbWriter& out) {
        sun(out, {0, 1, 0}, sun_lux);
      },
      {0, height, 0}, to);
}

void add(Recipes& all, std::string name, std::string what, const std::function<StabilityScene()>& make) {
  all.push_back({"fog", std::move(name), std::move(what), [make](StabilityInput&) { return make(); }});
}

void add_glows(Recipes& all) {
  for (const double extinction : {1e-8, 1.0, 1e6})
    add(all, fmt::format("camera inside, extinction {:g}", extinction),
        "endless fog that glows: tends to emission over extinction", [=] {
          return glowing({{"bounds", {{"z", {-10, 10}}}}}, extinction, {0, 0, 0}, {0, 0, -1},
                         [](glm::dvec3 d) { return 10 / -d.z; });
        });
  add(all, "endless", "no bounds: the background is gone", [] {
    return glowing(json::object(), 0.01, {0, 0, 0}, {0, 0, -1},
                   [](glm::dvec3) { return std::numeric_limits<double>::infinity(); });
  });
  for (const auto& [name, height] : {std::pair("over it", 1.0), std::pair("in it", 0.0), std::pair("deep in it", -3.0),
                                     std::pair("1,000 km over it", 1e6), std::pair("1,000 km under it", -1e6)})
    add(all, fmt::format("1e9 over a metre, {}", name), "density falls by 1e9 over a metre of height", [height] {
      return glowing({{"falloff", billionth_a_metre}}, 1, {0, height, 0}, {0, 0.2, -1},
                     [height](glm::dvec3 d) { return falling_length(billionth_a_metre, height, d); });
    });
  add(all, "1e9 over a metre, extinction 1e6", "from a metre over it", [] {
    return glowing({{"falloff", billionth_a_metre}}, 1e6, {0, 1, 0}, {0, 0.6, -1},
                   [](glm::dvec3 d) { return falling_length(billionth_a_metre, 1, d); });
  });
  for (const double falloff : {1e-12, 1e-30})
    add(all, fmt::format("falloff {:g}", falloff), "as good as none", [falloff] {
      return glowing({{"falloff", falloff}, {"bounds", {{"z", {-10, 10}}}}}, 0.05, {0, 0, 0}, {0, 0, -1},
                     [](glm::dvec3 d) { return 10 / -d.z; });
    });
  add(all, "1e6 m along and up", "fog moves with the world", [] {
    return glowing({{"falloff", 0.25}, {"height", 1e6}}, 0.3, {1e6, 1e6 + 2, 1e6}, {0, 0.6, -1},
                   [](glm::dvec3 d) { return falling_length(0.25, 2, d); });
  });
}

}  // namespace

void add_fog(Recipes& all) {
  add(all, "extinction 0", "clear air, exactly black", [] {
    StabilityScene scene = slab(glm::dvec3(0), 0.3);
    scene.black = true;
    return scene;
  });
  for (const double extinction : {1e-8, 1e-3, 1.0, 1e3, 1e6})
    add(all, fmt::format("slab, extinction {:g}", extinction), "lit by a sun in the axis of view",
        [=] { return slab(glm::dvec3(extinction), 0.3); });
  for (const double g : {0.98, 0.9, -0.9, -0.98})
    add(all, fmt::format("slab, g {:g}", g), "towards a spike", [=] { return slab(glm::dvec3(0.7), g); });
  add(all, "slab, colours 1e-3 to 1e3", "extinction of red, green and blue is a million apart", [] {
    return slab({1e-3, 1, 1e3}, 0);
  });
  add(all, "lamp in air of 1e-8", "no light is lost", [] { return lamp_in_thin_air(1e-8, {0.4, -0.3, 0.2}, 1e8); });
  add(all, "lamp at the bound of thin air", "", [] { return lamp_in_thin_air(1e-6, {1.1, 0.2, 1}, 10); });
  add(all, "sun over falling density, from above", "its light comes through what it lights", [] {
    return under_the_zenith(0.5, 0.3, 4, {0, -0.7, -1});
  });
  add(all, "sun over falling density, from inside", "looking up", [] {
    return under_the_zenith(0.5, 0.3, 0.5, {0, 0.7, -1});
  });
  add(all, "sun over 1e9 a metre", "a surface of fog", [] {
    return under_the_zenith(100, billionth_a_metre, 2, {0, -0.7, -1});
  });
  add_glows(all);
}

}  // namespace candela::stability
