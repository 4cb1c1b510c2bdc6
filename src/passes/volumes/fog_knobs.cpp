#include "passes/volumes/fog_knobs.h"

namespace candela {
namespace {

struct GridSize {
  std::string_view name;
  glm::uvec3 nodes;
};
// The seed's, and finer ones.
constexpr GridSize fog_grids[] = {{"32x18x24", {32, 18, 24}},     {"64x36x32", {64, 36, 32}},
                                  {"96x54x48", {96, 54, 48}},     {"128x72x64", {128, 72, 64}},
                                  {"160x90x128", {160, 90, 128}}, {"256x144x256", {256, 144, 256}}};

const std::vector<std::string_view> seen_by = {"fog",           "fog_march",   "shade_forward", "shade_gbuffer",
                                               "shade_volumes", "shade_unlit", "sky",           "background",
                                               "transparent",   "fog_layers"};

}  // namespace

std::span<const Knob<FogKnobs>> FogKnobs::table() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const GridSize& size : fog_grids) all.push_back(size.name);
    return all;
  }();
  static const Knob<FogKnobs> table[] = {
      {"method",
       &FogKnobs::method,
       "",
       0,
       2,
       {froxels, froxels, froxels, pixels},
       "froxels: light is kept in a grid of rays and depths; march: coarse texels follow rays in steps that take even "
       "shares of the light; pixels: each pixel follows a ray of its own",
       {"froxels", "march", "pixels"},
       Trades::error,
       {froxels, march, pixels},
       seen_by},
      {"grid",
       &FogKnobs::grid,
       "",
       0,
       double(std::size(fog_grids) - 1),
       {0, 2, 3, 5},
       "rays across and down and depths at which the light of fog is kept",
       names,
       Trades::error,
       {0, 1, 2, 3, 4, 5},
       seen_by,
       {},
       "fog.method=froxels"},
      {"last",
       &FogKnobs::last,
       "",
       0,
       1,
       {0, 0, 0, 1},
       "the slice in which a surface stands: 0 interpolated, so that lamps behind it shine through; 1 followed by each "
       "pixel through its own lists",
       {},
       Trades::error,
       {0, 1},
       seen_by},
      {"steps",
       &FogKnobs::steps,
       "",
       4,
       65536,
       {64, 128, 128, 512},
       "fog.method=pixels: slices of a ray in which light is summed",
       {},
       Trades::error,
       {32, 64, 128, 512},
       seen_by,
       {},
       "fog.method=pixels"},
      {"march_steps",
       &FogKnobs::march_steps,
       "",
       4,
       4096,
       {32, 64, 64, 512},
       "fog.method=march: steps of a ray, at most; the last one takes what is left of it",
       {},
       Trades::error,
       {16, 64, 512},
       {"fog_march"},
       {},
       "fog.method=march"},
      {"march_loss",
       &FogKnobs::march_loss,
       "",
       1e-4,
       0.5,
       {0.05, 0.025, 0.025, 0.002},
       "fog.method=march: share of the light from the camera on that a step takes, 0.05 to 25 m",
       {},
       Trades::error,
       {0.1, 0.025, 0.002},
       {"fog_march"},
       {},
       "fog.method=march"},
      {"march_px",
       &FogKnobs::march_px,
       "px",
       1,
       8,
       {4, 2, 2, 1},
       "fog.method=march: side of a texel that follows a ray: 1 full resolution, 2 half",
       {},
       Trades::error,
       {4, 2, 1},
       {"fog_march"},
       {},
       "fog.method=march"},
      {"lamp_shadows",
       &FogKnobs::lamp_shadows,
       "",
       0,
       64,
       {0, 1, 1, 4},
       "points of a slice, at least, at which the shadow maps of a lamp are asked; 0: lamps shine through everything "
       "in "
       "the air",
       {},
       Trades::error,
       {0, 1, 2, 4},
       seen_by},
      {"sky_directions",
       &FogKnobs::sky_directions,
       "",
       1,
       4096,
       {4, 16, 16, 256},
       "directions in which the fog before the sky is looked through, for ambient light in fog that has an end; on "
       "surfaces in fog without bounds two elevations for each 16, and no azimuths",
       {},
       Trades::error,
       {1, 4, 16, 64, 256},
       seen_by},
  };
  return table;
}

glm::uvec3 FogKnobs::nodes(uint32_t width_px, uint32_t height_px) const {
  if (method == froxels) return fog_grids[grid].nodes;
  // A march says the side of its texels; what is blended before it goes as many steps.
  if (method == march) return glm::uvec3(march_px, march_px, std::min(march_steps, 128));
  return glm::uvec3(width_px, height_px, steps);
}

Need fog_light_needed(const SceneFacts& facts, const FrameRequest& request) {
  if (!request.look.fog) return {false, "the look has no fog (--look)"};
  if (!request.draws_fog()) return {false, "fog is not wanted (--effects)"};
  const bool glows = summed_fog(request.look) > 0 && fog_glows(request.look);
  if (!fog_scatters(request.look) && !glows) return {false, "the fog scatters nothing"};
  if (facts.lights() == 0 && !facts.environment && !request.neutral_light && !glows)
    return {false, "no light is there to be scattered"};
  return {};
}

}  // namespace candela
