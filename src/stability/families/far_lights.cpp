// Where lights without a range end by what they lose (lights.lost): one lamp and many, dim and bright, beside each
// other and under dark exposures. The reference's have no end.
#include "stability/stage.h"

namespace candela::stability {
namespace {

// A floor of 20 m under lamps without range, 0.5 to 1.5 m above it.
struct Field {
  int lamps = 1;
  double candela = 1;
  double most_candela = 0;    // above `candela`: evenly between their logarithms
  double bright_candela = 0;  // of one more in the middle
  double exposure_ev = 0;
};
StabilityScene field(StabilityInput& in, const Field& how, double most_lost) {
  GlbWriter out;
  place(out, ground(20, 1, 1), lit({0.7, 0.6, 0.5}, 0, 0.9), {0, 0, 0});
  place(out, sphere(1, 48, 32), lit({0.3, 0.5, 0.8}, 0, 0.8), {1, 1, 2});
  camera(out, {3, 5, 14}, {0, 0, 0}, 0.8, 0.1);
  for (int i = 0; i < how.lamps; ++i) {
    const double x = in.rng.uniform(-10, 10), y = in.rng.uniform(0.5, 1.5), z = in.rng.uniform(-10, 10);
    const double octaves = how.most_candela > 0 ? std::log2(how.most_candela / how.candela) : 0;
    point(out, {x, y, z}, how.candela * std::exp2(in.rng.uniform(0, 1) * octaves));
  }
  if (how.bright_candela > 0) point(out, {0, 3, 0}, how.bright_candela);
  StabilityScene scene = scene_of(out);
  scene.job.settings = {{"lights", "few", "0"}, {"lights", "lost", fmt::format("{:g}", most_lost)}};
  scene.job.exposure_ev = float(how.exposure_ev);
  // A pixel may lose it of the larger of its light and a hundredth of white, all of them together of their light.
  scene.least_light = 0.01 * std::exp2(-how.exposure_ev);
  scene.bound = scene.energy_bound = most_lost;
  return scene;
}

}  // namespace

void add_far_lights(Recipes& all) {
  for (const double lost : {0.05, 0.005})
    for (const auto& [name, how] : std::initializer_list<std::pair<const char*, Field>>{
             {"one lamp of 1e-6 cd", {.candela = 1e-6, .exposure_ev = 24}},
             {"one lamp of 100 cd", {.candela = 100}},
             {"one lamp of 1e20 cd", {.candela = 1e20, .exposure_ev = -60}},
             {"100 lamps of 1e-3 cd", {.lamps = 100, .candela = 1e-3, .exposure_ev = 12}},
             {"400 lamps of 0.05 cd", {.lamps = 400, .candela = 0.05, .exposure_ev = 5}},
             {"2000 lamps of 0.05 cd", {.lamps = 2000, .candela = 0.05, .exposure_ev = 3}},
             {"600 lamps of 1e-9 to 1e3 cd", {.lamps = 600, .candela = 1e-9, .most_candela = 1e3, .exposure_ev = -3}},
             {"1e6 cd beside 60 of 1e-3 cd", {.lamps = 60, .candela = 1e-3, .bright_candela = 1e6, .exposure_ev = -12}},
             {"1 cd beside 100 of 1e-6 cd", {.lamps = 100, .candela = 1e-6, .bright_candela = 1, .exposure_ev = 4}}})
      all.push_back({"far-lights", fmt::format("{}, {:g} lost", name, lost), "over a floor of 20 m",
                     [=, how = how](StabilityInput& in) {
                       StabilityScene scene = field(in, how, lost);
                       scene.clamps = how.candela > 1e10;
                       // Where the ball's top comes out of a crowd of lamps, which no point that chose has seen.
                       if (how.lamps >= 400) scene.stray_fraction = 1e-3;
                       return scene;
                     }});
}

}  // namespace candela::stability
