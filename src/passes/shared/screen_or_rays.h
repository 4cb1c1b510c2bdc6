#pragma once
#include "base/knob.h"

namespace candela {

// For the knobs of effects that ask what lies in a direction: the depth buffer tells it of what the camera sees
// (screen), rays through the scene's triangles of all there is (by_rays, in files and options "traced").
struct ScreenOrRays {
  static constexpr int screen = 0, by_rays = 1;
};

// The row of K::method, which is one of them.
template <class K>
Knob screen_or_rays_row(std::string_view description) {
  return {.name = "method",
          .member = &K::method,
          .lowest = ScreenOrRays::screen,
          .highest = ScreenOrRays::by_rays,
          .levels = {ScreenOrRays::screen, ScreenOrRays::screen, ScreenOrRays::screen, ScreenOrRays::by_rays},
          .description = description,
          .choices = {"screen", "traced"},
          .sweep = {ScreenOrRays::screen, ScreenOrRays::by_rays}};
}

}  // namespace candela
