#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>

#include "reference/punctual.h"
#include "scene/light_layers.h"
#include "scene/scene.h"

namespace candela::reference {

// What beauty is the sum of, beside the light of fog (PixelSample::fog_light). Each holds what arrives at the camera:
// after fog and behind blended surfaces.
//
// direct: light of the punctual lights, by their kind, with visibility. ambient: the sky's light, by the lobe that
// reflects it. emission: what surfaces give off that the camera sees, unlit ones their colour. background: sky or
// background behind everything. reflections: of direct with a look that has them, the light of opaque surfaces that
// others mirror; the sky's specular light is then that of the directions where there is none. indirect: what path adds
// to direct: light that met another surface or fog on its way, and light of emissive surfaces. volumetric: the
// look's light of lamps in the air (volumetric.cpp).
enum class Term : uint8_t {
  direct_sun,
  direct_point,
  direct_spot,
  ambient_diffuse,
  ambient_specular,
  emission,
  background,
  reflections,
  indirect,
  volumetric
};
inline constexpr size_t term_count = 10;
std::string_view name_of(Term term);  // as the layer is called: direct_sun
Term direct_term(LightType type);

// One sample of one pixel, or the light of one surface.
struct TermSample {
  std::array<glm::dvec3, term_count> light{};
  std::array<glm::dvec3, most_light_groups> by_group{};  // of the direct terms, by the groups of their lights
  // Of the directional lights' light on what the pixel shows, weighed by the cosine, the fraction that nothing blocks;
  // 1 where none of them faces the surface, and on what takes no light.
  double shadow = 1;
  // The same of point and spot lights, only where it is wanted: it takes a ray for each of them.
  bool wants_lamp_shadow = false;
  double lamp_shadow = 1;
  // Of the nearest opaque or masked surface: the fraction of the sky's light that near surfaces leave, weighed by the
  // cosine about the triangle's normal (World::occlusion()); 1 where there is none, and on what takes no light.
  double occlusion = 1;

  glm::dvec3& operator[](Term term) { return light[size_t(term)]; }
  const glm::dvec3& operator[](Term term) const { return light[size_t(term)]; }
  void add(const TermSample& surface, glm::dvec3 fraction) {
    for (size_t t = 0; t < term_count; ++t) light[t] += fraction * surface.light[t];
    for (size_t g = 0; g < most_light_groups; ++g) by_group[g] += fraction * surface.by_group[g];
  }
  void add_direct(const PunctualLight& from, glm::dvec3 radiance) {
    (*this)[direct_term(from.type)] += radiance;
    by_group[from.group] += radiance;
  }
  void add_ambient(glm::dvec3 diffuse, glm::dvec3 all) {
    (*this)[Term::ambient_diffuse] += diffuse;
    (*this)[Term::ambient_specular] += all - diffuse;
  }
};

}  // namespace candela::reference
