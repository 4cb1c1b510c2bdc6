#pragma once
#include <glm/glm.hpp>
#include <optional>

#include "reference/texture.h"

namespace candela::reference {

// What lies below a triangle whose material has a relief (CANDELA_relief): the points
//   corner + weights.x * edge[0] + weights.y * edge[1] + depth * below,  depth = the height at that place,
// on and on in the triangle's plane, up to the bounds of its texture coordinates where it has silhouettes. Heights are
// the bilinear function of the texture's texels, and a ray meets it exactly: cell by cell, by the roots of a quadratic.
struct ReliefLayer {
  glm::dvec3 corner{0}, edge[2], below{0};
  glm::dvec2 uv{0}, uv_edge[2];  // of the vertices, not transformed
  glm::dvec2 least_uv{0}, most_uv{0};
  bool ends = false;  // at those
  const Texture* heights = nullptr;
  const TextureSlot* slot = nullptr;
  const Sampler* sampler = nullptr;

  double height(glm::dvec2 weights) const;
  // How it grows with each of the weights. smooth: by the texels on either side, else of the cell alone.
  glm::dvec2 slope(glm::dvec2 weights, bool smooth) const;
  glm::dvec3 position(glm::dvec2 weights, double depth) const {
    return corner + weights.x * edge[0] + weights.y * edge[1] + depth * below;
  }
  // The surface's normal there, on the side that glTF calls the front: `normal` of the mesh, leaned over by the slope.
  glm::dvec3 leaned(glm::dvec3 normal, glm::dvec2 slope) const;
};

struct ReliefHit {
  double t = 0;
  glm::dvec2 weights{0};  // of the second and third corner
  double depth = 0;
};
// Where the line origin + t * direction goes through the surface into what is below it, t_min <= t <= t_max. A line
// that comes into the layer there counts as above; one that begins inside has to come out first. From behind it meets
// the floor.
std::optional<ReliefHit> meet_relief(const ReliefLayer& layer, glm::dvec3 origin, glm::dvec3 direction, double t_min,
                                     double t_max);
// The same near t, where it is known to be: to the last digits.
ReliefHit refined(const ReliefLayer& layer, glm::dvec3 origin, glm::dvec3 direction, const ReliefHit& near);

}  // namespace candela::reference
