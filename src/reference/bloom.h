#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "look/look.h"

namespace candela::reference {

// What of a texel blooms: all of it without a threshold; else what of its largest channel is above it, with a quadratic
// knee, in the texel's own colour. Negative and non-finite channels count as 0.
glm::dvec3 bloom_bright(glm::dvec3 c, double threshold, double knee);

// The glow of a picture, before its strength: Gaussians of the look's variances, each by its weight over the sum of
// all, out to six standard deviations, clamped to the edge; in double. picture: linear, rows from the top. exposure:
// from the picture's units to those of the threshold.
std::vector<glm::dvec3> bloom_glow(const std::vector<glm::dvec3>& picture, int width, int height, const Bloom& look,
                                   double exposure);

// The picture with its glow: what glows is taken from where it came, or added, as the look says.
std::vector<glm::dvec3> bloomed(const std::vector<glm::dvec3>& picture, const std::vector<glm::dvec3>& glow,
                                const Bloom& look, double exposure);

}  // namespace candela::reference
