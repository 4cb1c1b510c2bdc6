#include "reference/interior.h"

#include <cmath>

namespace candela::reference {

bool Interior::holds(const Glass& glass) const {
  for (int i = 0; i < count_; ++i)
    if (bodies_[size_t(i)] == &glass) return true;
  return false;
}

void Interior::enter(const Glass& glass) {
  if (count_ < most_) bodies_[size_t(count_++)] = &glass;
}

void Interior::leave(const Glass& glass) {
  for (int i = count_; i-- > 0;) {
    if (bodies_[size_t(i)] != &glass) continue;
    for (--count_; i < count_; ++i) bodies_[size_t(i)] = bodies_[size_t(i) + 1];
    return;
  }
}

double Interior::ior() const { return count_ > 0 ? index_of_refraction(*bodies_[size_t(count_) - 1], channel) : 1; }

const BodyMedium* Interior::medium() const {
  return count_ > 0 && bodies_[size_t(count_) - 1]->medium ? &*bodies_[size_t(count_) - 1]->medium : nullptr;
}

glm::dvec3 Interior::transmittance(double distance_m) const {
  if (count_ == 0 || !(distance_m > 0)) return glm::dvec3(1);
  const Glass& glass = *bodies_[size_t(count_) - 1];
  glm::dvec3 left(1);
  if (glass.medium) {
    for (int c = 0; c < 3; ++c) left[c] = std::exp(-glass.medium->extinction[c] * distance_m);
    return left;
  }
  // Where a channel is not absorbed, or never, no distance is too long.
  for (int c = 0; c < 3; ++c)
    if (glass.attenuation_color[c] < 1 && std::isfinite(glass.attenuation_distance_m))
      left[c] = std::pow(glass.attenuation_color[c], distance_m / glass.attenuation_distance_m);
  return left;
}

glm::dvec3 GlassWay::arrive(Surface& s, glm::dvec3 v, bool back, double distance_m) {
  const bool body = s.body != nullptr;
  // A ray that began inside, where the camera stands.
  if (body && back && !here_.holds(*s.body)) here_.enter(*s.body);
  const glm::dvec3 left = here_.transmittance(distance_m - travelled_);
  travelled_ = distance_m;
  behind_ = here_;
  if (body) {
    if (back)
      behind_.leave(*s.body);
    else
      behind_.enter(*s.body);
  }
  s.before = &here_, s.behind = &behind_;
  if (s.glass) {
    s.eta = body ? behind_.ior() / here_.ior() : index_of_refraction(*s.glass, -1);
    // Facets are not defined where the shading normal looks away.
    if (!(glm::dot(s.normal, v) > 1e-4)) s.normal = s.geometric;
  }
  return left;
}

bool GlassWay::splits(const Surface& s) const {
  return s.glass && s.glass->body && s.glass->dispersion > 0 && here_.channel < 0;
}

glm::dvec3 GlassWay::choose_channel(const Surface& s, double u) {
  if (!splits(s)) return glm::dvec3(1);
  here_.channel = std::min(int(u * 3), 2);
  glm::dvec3 weight(0);
  weight[here_.channel] = 3;
  return weight;
}

}  // namespace candela::reference
