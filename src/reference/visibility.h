#pragma once
#include "reference/world.h"

namespace candela::reference {

// The way in which light goes along a ray: to where the ray begins, as along a shadow ray, or from there. Where the
// world opens its sides, light passes single-sided faces from behind. none: what is seen, which every face ends.
enum class LightAlong : uint8_t { none, to_origin, from_origin };
// Whether it passes what is hit, blended or not.
bool passes_light(const World& world, const Hit& hit, LightAlong light);

// Which candidates a ray meets. Holes of alpha masks never. Backs of single-sided surfaces count for every ray but the
// camera's: a wall is matter for light from both sides, and a rasterizer draws it from one
// (docs/understanding/reference.md).
class SurfaceFilter final : public HitFilter {
 public:
  // passed: the surfaces up to and with this hit are behind the ray already; null: none. to_lamp: what glows all over
  // blocks nothing (scene/glow.h).
  SurfaceFilter(const World& world, bool culls_backs, const Hit* passed = nullptr, bool to_lamp = false,
                LightAlong light = LightAlong::none)
      : world_(world), culls_backs_(culls_backs), passed_(passed), to_lamp_(to_lamp), light_(light) {}
  bool accepts(const Hit& candidate) const override;
  // Through the world with this filter. Reliefs are met by the filter, which knows the ray then: no tree does.
  std::optional<Hit> closest(const Ray& ray, TraceCounts* counts = nullptr);
  bool occluded(const Ray& ray);

 private:
  bool counts(const Hit& hit) const;
  void begin(const Ray& ray, bool any);

  const World& world_;
  bool culls_backs_;
  const Hit* passed_;
  bool to_lamp_;
  LightAlong light_;
  const Ray* ray_ = nullptr;  // only where there are reliefs
  bool any_ = false;
  mutable std::optional<Hit> relief_;  // nearest that the ray has met so far
};

// The next surface along a ray; `passed` continues behind a surface that let the ray through, without an offset that
// could miss what lies close behind it.
std::optional<Hit> next_surface(const World& world, const Ray& ray, bool culls_backs, const Hit* passed,
                                TraceCounts* counts, bool to_lamp = false, LightAlong light = LightAlong::none);

// The part of the light that comes through between `from` and a point `distance_m` off in unit direction `l` (infinity:
// from the sky): 0 behind opaque surfaces, otherwise the product of what blended ones leave. `target`, where the light
// is a surface itself. to_lamp: the light is a point or spot light, which what glows all over does not block. light:
// none, where a surface at the other end sends it, for it is seen from there.
double transmittance(const World& world, const SurfacePoint& from, glm::dvec3 l, double distance_m,
                     const SurfacePoint* target = nullptr, bool to_lamp = false,
                     LightAlong light = LightAlong::to_origin);

// The ray of it; nothing where the two are closer than what keeps it off their surfaces.
std::optional<Ray> shadow_ray(const SurfacePoint& from, glm::dvec3 l, double distance_m,
                              const SurfacePoint* target = nullptr);

// How much of what lies in unit direction `l` the surfaces near `from` leave: 1 less what Occlusion says of the nearest
// opaque one, times the same of every blended one before it by its coverage. Its strength does not count.
double near_visibility(const World& world, const SurfacePoint& from, glm::dvec3 l, const Occlusion& occlusion);

Ray rounded(const CameraRay& ray);
Ray leaving_ray(const SurfacePoint& from, glm::dvec3 direction);

}  // namespace candela::reference
