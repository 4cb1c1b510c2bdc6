#pragma once
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

// CANDELA_light_instances (docs/understanding/light-instances.md): one point or spot light of KHR_lights_punctual many
// times over, at one node. A node for each light is 160 bytes of JSON and 14 us of loading; here it is 12 to 56 bytes,
// and no text.
namespace candela {

struct LightModulation {
  float depth = 0;     // 0 to 1: how much of the intensity goes at the darkest moment
  float period_s = 1;  // greater than 0
  float phase = 0;     // in periods
};

struct LightInstances {                // `translation` is count() long, the others that or empty
  int light = -1;                      // the template, into Scene::lights; its animated values hold for all instances
  std::vector<glm::vec3> translation;  // metres, in the node's space
  std::vector<glm::vec3> direction;    // the way a spot shines, in the node's space, not zero; empty: along -Z
  std::vector<glm::vec3> color;        // multiplies the template's
  std::vector<float> intensity;        // multiplies the template's
  std::vector<float> range_m;          // stands instead of the template's
  std::vector<LightModulation> modulation;
  size_t count() const { return translation.size(); }
};

// What the intensity is multiplied by: 1 at the phase 0, 1 - depth half a period later, smooth between. Made of
// additions and multiplications alone, so that it is the same number on every machine.
double modulation_factor(const LightModulation& modulation, double time_s);

}  // namespace candela
