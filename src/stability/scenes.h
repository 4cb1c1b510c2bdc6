#pragma once
#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/rng.h"
#include "image/image.h"
#include "job/job.h"

namespace candela {

// What a scene's generator may draw on.
struct StabilityInput {
  Rng rng;
  bool large = false;  // ten million triangles in a pixel, the largest image: minutes and gigabytes
};

// An extreme scene and what is true of its picture. Two truths may hold at once: the reference ray tracer, in double
// and without shadows as the techniques are, and a plain scene that must look the same.
struct StabilityScene {
  std::vector<std::byte> file;                             // .glb
  std::vector<std::byte> plain;                            // .glb; empty: none
  std::optional<FloatImage> sky, plain_sky, second_sky;    // second_sky: second.exr, for sky_look to name
  std::string sky_look;                                    // of the scene, not of the plain one; empty: none
  std::vector<std::pair<std::string, std::string>> texts;  // files that paths of the job name, and what is in them
  Job job;                                                 // without scene and sky
  std::optional<Job> plain_job;                            // where it is not `job`
  double time_s = 0, plain_time_s = 0;
  std::string effects = "none";  // of the scene and of the plain one; the reference knows none
  bool reference = true;
  // Samples of each of the reference's places, with what stands in the light's way; 0: one, without, as techniques are
  // without effects. The sky's light needs many.
  int blocked_samples = 0;
  bool paths = false;          // light goes through surfaces: paths must be finite too, and refraction may brighten
  double bound = 1e-3;         // relative error that a pixel may have against the reference
  double plain_bound = 1e-5;   // and against the plain scene
  double least_light = 0;      // radiance below which a pixel's error counts against it, if it is above that hundredth
  double energy_bound = 1e-3;  // relative error of the sum over all pixels
  double stray_fraction = 0;   // pixels that may lie beyond the bound: edges, where a point is in or out by rounding
  bool refused = false;        // no picture but an error that says why
  bool warns = false;          // a line of warning is owed to the user
  bool clamps = false;         // values beyond half: the count must not be 0
  bool black = false;          // every pixel is exactly 0
  double most = std::numeric_limits<double>::infinity();  // no colour is above this, with effects neither
  bool display = false;                                   // the 16-bit picture is compared with the curve in double
  // Fog, as a look file has it. No pass draws it yet: the reference does, in both modes, and is measured against the
  // radiance that is known in closed form for a direction (unit, world axes) from the eye. path is held to one bounce,
  // which is what direct solves, and judged by its energy: it has noise.
  std::string look;
  std::function<glm::dvec3(glm::dvec3 direction)> known;
};

struct StabilityRecipe {
  std::string family, name, what;  // what: one line for a reader
  std::function<StabilityScene(StabilityInput&)> make;
};
// In the order of the table; names are unique in their family. sizes: of the family "images", in pixels; empty: its
// own.
std::vector<StabilityRecipe> stability_recipes(const std::vector<std::pair<int, int>>& sizes = {});

}  // namespace candela
