#pragma once
#include <string_view>

#include "reference/sampling.h"
#include "reference/world.h"

namespace candela::reference {

enum class Mode : uint8_t { direct, path };
// Where direct's ambient term comes from: the sky's radiance over the hemisphere, each direction traced; the raster techniques'
// own ambient term times the cosine-weighted part of the hemisphere that is open; or nowhere.
enum class Ambient : uint8_t { traced, occlusion, off };
// Which of path's two ways to meet a light counts. Both, weighted by the power heuristic (Veach 1997), or one alone for tests.
enum class Strategy : uint8_t { both, light, brdf };

struct TraceSettings {
  Mode mode = Mode::direct;
  SamplerSettings sampler;
  bool visibility = true;  // direct: light is blocked by what stands in its way
  Ambient ambient = Ambient::traced;
  double ambient_distance_m = std::numeric_limits<double>::infinity();  // direct: what is farther off does not occlude the sky
  double lifted = 0;       // direct: points are lit as if they stood this part of their distance above their surface
  int most_bounces = 0;    // path: 0 as many as Russian roulette leaves
  Strategy strategy = Strategy::both;
};

// One sample of one pixel.
struct PixelSample {
  glm::dvec3 radiance{0};  // premultiplied by alpha
  double alpha = 0;
  double traversal = 0;    // of the camera ray: a quarter for each node, one for each triangle tested
};

// What one sample of direct or path is. Thread safe; the result depends on its arguments alone.
class Integrator {
 public:
  Integrator(const World& world, const TraceSettings& settings, int width_px, int height_px)
      : world_(world), settings_(settings), width_px_(width_px), height_px_(height_px) {}
  PixelSample sample(int x, int y, uint64_t index) const;
  // Through a place of the image in pixels, y down.
  PixelSample sample_at(glm::dvec2 place_px, uint64_t index) const;

  // Radiance towards `to_viewer` of light that comes straight from its source. For tests of single points.
  glm::dvec3 direct_light(const Surface& surface, const SurfacePoint& point, glm::dvec3 to_viewer, SampleStream& stream) const;

 private:
  PixelSample sample_through(glm::dvec2 place_px, SampleStream& stream) const;
  PixelSample sample_direct(const CameraRay& ray, SampleStream& stream) const;
  PixelSample sample_path(const CameraRay& ray, SampleStream& stream) const;
  glm::dvec3 punctual(const Surface& s, const SurfacePoint& point, glm::dvec3 v) const;
  glm::dvec3 traced_ambient(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream) const;
  glm::dvec3 occluded_ambient(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream) const;
  glm::dvec3 sky_visibility(const Surface& s, const SurfacePoint& point, glm::dvec3 l) const;
  // What a light would give if nothing stood between.
  struct Offer {
    glm::dvec3 radiance{0}, l{0};
    double distance_m = 0;
    std::optional<SurfacePoint> end;  // where the light is a surface
  };
  Offer punctual_offer(const PunctualLight& light, const Surface& s, glm::dvec3 v) const;
  Offer emissive_offer(int index, double probability, const Surface& s, glm::dvec3 v, glm::dvec2 u) const;
  glm::dvec3 taken(const Offer& offer, const Surface& s, const SurfacePoint& point) const;  // what comes through of it
  glm::dvec3 next_event(const Surface& s, const SurfacePoint& point, glm::dvec3 v, bool every, SampleStream& stream) const;
  double weight(double this_pdf, double other_pdf, Strategy own) const;

  const World& world_;
  TraceSettings settings_;
  int width_px_, height_px_;
};

// The ambient term of the raster techniques (shaders: lib/ambient), in double: spherical harmonics up to l = 2 for diffuse light, and
// for reflections as well.
glm::dvec3 harmonic_ambient(const AmbientSh& sh, const Surface& s, glm::dvec3 v);

}  // namespace candela::reference
