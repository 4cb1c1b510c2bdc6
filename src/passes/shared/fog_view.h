#pragma once
#include <string>

#include "graph/builder.h"

namespace candela {

struct SceneInputs;
struct Lighting;

// What the frame's shaders know of its fog. Not a pass. Its values are FOG in shaders/lib/fog.glsl.
enum class FogLight : uint8_t {
  no_fog,
  nothing,  // the fog scatters nothing, or no light reaches it: transmittance and emission alone
  grid,     // from the image
  march,    // each point follows its own ray
  texels    // from an image of coarse texels that followed rays
};
struct FogView {
  FogLight light = FogLight::no_fog;
  bool ambient = false;  // the sky's light is scattered too
  int last = 0;          // grid: whether the slice in which a surface stands is summed for itself, as fog.last
  int media = 0;         // whose sum the air is; 0: one, in closed form
  int lamp_points = 0;   // of a slice, at least, at which a lamp's shadow maps are asked; 0: none
  int sun_points = 1;    // of a slice, at which a sun's shadow maps are asked
  ImageHandle grid;
  explicit operator bool() const { return light != FogLight::no_fog; }
};

// A shader's name with the definitions that have it seen through the fog; the name alone in clear air. Definitions and
// not specialization constants: a frame without fog compiles the source that it would have without this effect.
std::string with_fog(std::string shader, const Lighting& lists);
// The same for the maps of suns and lamps that the light in fog is shadowed by.
std::string fog_shadows(const Lighting& lists, int lamp_points, int sun_points);
// Which shaders read what a shading pass declares.
struct ReadBy {
  Access buffer = Access::fragment_read, image = Access::sampled_fragment;
  static ReadBy compute() { return {Access::compute_read, Access::sampled_compute}; }
};
// What such a shader reads besides the frame's constants: the grid, and, to walk, lights and shadow maps.
void declare_fog(GraphBuilder& builder, const SceneInputs& scene, const Lighting& lists, bool lights_declared = false,
                 const ReadBy& by = {});
// Whether such a shader reads the light of fog from an image.
bool fog_is_read(const Lighting& lists);
// Texels hold the light up to the nearest opaque surface: what is blended before it follows its own rays.
Lighting of_blended(Lighting lists);
// For shaders that know what fog takes on other ways than the camera's, and no light of it.
Lighting fog_on_the_way(Lighting lists);
// Whether such a shader walks the lists of lights itself.
bool fog_walks(const Lighting& lists);

}  // namespace candela
