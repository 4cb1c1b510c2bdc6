#pragma once
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "reference/interior.h"
#include "reference/sampling.h"
#include "reference/terms.h"
#include "reference/world.h"

namespace candela::reference {

enum class Mode : uint8_t { direct, path };
// Where direct's ambient term comes from: the sky's radiance over the hemisphere, each direction traced; the raster
// techniques' own ambient term times the cosine-weighted part of the hemisphere that is open; or nowhere.
enum class Ambient : uint8_t { traced, occlusion, off };
// Which of path's two ways to meet a light counts. Both, weighted by the power heuristic (Veach 1997), or one alone for
// tests.
enum class Strategy : uint8_t { both, light, brdf };

// The dimensions that lights with a size take from a stream, apart from the rest.
inline constexpr uint32_t first_size_dimension = 1u << 23;
// Those of the lens.
inline constexpr uint32_t first_lens_dimension = first_size_dimension + (1u << 22);
// Behind this optical depth e^-40 (4e-18) of the light is left.
inline constexpr double deepest = 40;
inline constexpr int most_fog_steps = 65536, most_fog_lights = 4096;  // their product fits an int

struct TraceSettings {
  Mode mode = Mode::direct;
  SamplerSettings sampler;
  bool visibility = true;  // direct: light is blocked by what stands in its way
  Ambient ambient = Ambient::traced;
  double ambient_distance_m =
      std::numeric_limits<double>::infinity();  // direct: what is farther off does not occlude the sky
  double lifted = 0;      // direct: points are lit as if they stood this part of their distance above their surface
  int most_bounces = 0;   // path: 0 as many as Russian roulette leaves
  bool lamp_rays = true;  // path: bounces are made from lamps as well (lamp_paths.cpp); else for tests
  Strategy strategy = Strategy::both;
  // What the camera sees has the means of its colour textures over the part of the pixel that is a sample's own.
  bool footprints = false;
  int fog_steps = 16;  // direct: points on a ray at which each light's way through fog is followed (fog_march.cpp)
  // direct: where more point lights and spots than these reach a ray through fog, they share the points of so many;
  // 0: each has its own.
  int fog_lights = 16;
};

// One sample of one pixel.
struct PixelSample {
  glm::dvec3 radiance{0};  // premultiplied by alpha
  double alpha = 0;
  // Of the camera ray: a quarter for each node, one for each triangle tested. NaN: not counted.
  double traversal = std::numeric_limits<double>::quiet_NaN();
  glm::dvec3 fog_light{0};    // of radiance, what fog scatters or emits towards the camera
  glm::dvec3 fog_through{1};  // what fog leaves of the light of whatever lies at the end of the camera ray
};

// What one sample of direct or path is. Thread safe; the result depends on its arguments alone.
class Integrator {
 public:
  Integrator(const World& world, const TraceSettings& settings, int width_px, int height_px)
      : world_(world), settings_(settings), width_px_(width_px), height_px_(height_px) {}
  // Of the camera through a place of the image, and through a point of the lens where there is one.
  CameraRay camera_ray(glm::dvec2 place_px, const SampleStream& stream) const;
  // One sample of each of the pixels. Their camera rays go side by side (Accel::closest), so pixels that lie together
  // are quicker; what a pixel gets does not depend on the others. counted: with PixelSample::traversal, by rays alone.
  // terms: empty, or one for each pixel, to which the sample's are added. They have sums of their own, so that asking
  // for them changes no bit of the rest.
  void sample(std::span<const glm::ivec2> pixels, uint64_t index, bool counted, std::span<PixelSample> out,
              std::span<TermSample> terms) const;
  // Through a place of the image in pixels, y down.
  PixelSample sample_at(glm::dvec2 place_px, uint64_t index, TermSample* terms = nullptr) const;

  // Radiance towards `to_viewer` of light that comes straight from its source. For tests of single points.
  glm::dvec3 direct_light(const Surface& surface, const SurfacePoint& point, glm::dvec3 to_viewer, SampleStream& stream,
                          TermSample* terms = nullptr) const;

 private:
  // first: the surface that the ray meets first. counts: of the ray behind that; null: not wanted.
  PixelSample sample_along(const CameraRay& ray, const std::optional<Hit>& first, SampleStream& stream,
                           TermSample* terms, TraceCounts* counts) const;
  PixelSample sample_direct(const CameraRay& ray, const std::optional<Hit>& first, SampleStream& stream,
                            TermSample* terms, TraceCounts* counts) const;
  PixelSample sample_path(const CameraRay& ray, const std::optional<Hit>& first_hit, SampleStream& stream,
                          TermSample* terms, TraceCounts* counts) const;
  // `terms` may be null in all of these.
  glm::dvec3 punctual(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                      TermSample* terms) const;
  // A direction of a surface's specular lobe, by the normals that the viewer sees, and what it meets.
  struct Lobe {
    glm::dvec3 l{0}, weight{0};  // BRDF times cosine over density
    std::optional<Hit> hit;
  };
  Lobe specular_lobe(const Surface& s, const SurfacePoint& point, glm::dvec3 v, glm::dvec2 u) const;
  // The light of what it meets, as that looks under lights and sky.
  glm::dvec3 reflected(const Lobe& lobe, const Surface& s, const SurfacePoint& point, SampleStream& stream) const;
  // The nearest opaque or masked surface; blended ones are not there for reflections.
  std::optional<Hit> reflecting_hit(const SurfacePoint& from, glm::dvec3 l) const;
  // lobe: of surfaces that reflect others: where something is met there, no light of the sky comes from.
  glm::dvec3 surface_light(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                           TermSample* terms, const Lobe* lobe) const;
  // Lights of a size by way of a direction that the BRDF chose.
  glm::dvec3 sized_by_brdf(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream stream,
                           TermSample* terms) const;
  glm::dvec3 traced_ambient(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                            TermSample* terms, const Lobe* lobe) const;
  glm::dvec3 occluded_ambient(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                              TermSample* terms, const Lobe* lobe) const;
  // TermSample::shadow of one surface.
  double sun_visibility(const Surface& s, const SurfacePoint& point, glm::dvec2 on_disc) const;
  // TermSample::occlusion of one surface.
  double near_occlusion(const Surface& s, const SurfacePoint& point, glm::dvec2 u) const;
  // TermSample::lamp_shadow
  double lamp_visibility(const Surface& s, const SurfacePoint& point, glm::dvec2 on_disc) const;
  double open_share(const std::vector<uint32_t>& lights, const Surface& s, const SurfacePoint& point,
                    glm::dvec2 on_disc) const;
  glm::dvec3 sky_visibility(const Surface& s, const SurfacePoint& point, glm::dvec3 l) const;
  // What a light would give if nothing stood between.
  struct Offer {
    glm::dvec3 radiance{0}, l{0};
    double distance_m = 0;
    std::optional<SurfacePoint> end;  // where the light is a surface
    bool is_lamp() const { return !end && std::isfinite(distance_m); }
  };
  // One of several offers, as likely as it weighs; taken() of it times scale() is their sum on average.
  class OneOf {
   public:
    // Whether it is now this one. u: a number in [0, 1), and what is left of it.
    bool consider(const Offer& other, double weight, double& u);
    double scale() const { return weight_ > 0 ? total_ / weight_ : 0; }
    Offer offer;

   private:
    double weight_ = 0, total_ = 0;
  };
  // Where a path left for its next surface, and the density of the direction that it went on in, 1/sr; 0: nothing else
  // could have chosen it. joined: bounces from there are made from lamps as well.
  struct Departure {
    glm::dvec3 position{0}, normal{0};
    double density = 0;
    bool joined = false;
  };
  struct LampRays {
    const Departure* from;
    uint32_t lamp;  // into World::tree_punctual()
  };
  // probability: with which the light was chosen, for the weight against the other ways to meet it: the BRDF's where it
  // has a size, and rays that leave it (null: there are none). The offer is not divided by the probability.
  Offer punctual_offer(const PunctualLight& light, const Surface& s, glm::dvec3 v, glm::dvec2 on_disc,
                       double probability = 1, const LampRays* rays = nullptr) const;
  // The light of the lights that the tree chooses for a place (a normal of 0: none). make(choice, number, is_lamp) is
  // what one of them would give unhindered over its probability, take(offer, choice) what comes through of an offer.
  // With `every` each is taken; else one of them, as likely as it would give light unhindered (Talbot et al.,
  // "Importance Resampling for Global Illumination", 2005): lamps close to the place, which a common estimate of their
  // cluster misses, are the ones that matter.
  template <class Make, class Take>
  glm::dvec3 by_tree(glm::dvec3 position, glm::dvec3 normal, double which, double pick, bool every, Make&& make,
                     Take&& take) const {
    static thread_local std::vector<LightTree::Choice> chosen;
    world_.light_tree().choose(position, normal, which, true, chosen);
    glm::dvec3 sum(0);
    OneOf best;
    LightTree::Choice of_best{};
    for (size_t i = 0; i < chosen.size(); ++i) {
      const Offer offer = make(chosen[i], i, chosen[i].light < world_.tree_punctual().size());
      if (every)
        sum += take(offer, chosen[i]);
      else if (best.consider(offer, largest(offer.radiance), pick))
        of_best = chosen[i];
    }
    return every ? sum : take(best.offer, of_best) * best.scale();
  }
  Offer emissive_offer(uint32_t light, double probability, const Surface& s, glm::dvec3 v, glm::dvec2 u) const;
  glm::dvec3 taken(const Offer& offer, const Surface& s, const SurfacePoint& point) const;  // what comes through of it
  // terms: only with `every`.
  // from: where the path came from; null: bounces from there are not made from lamps as well. sky: the share of the
  // sky's light that counts, 1 but where light passes faces from behind (path.cpp).
  glm::dvec3 next_event(const Surface& s, const SurfacePoint& point, glm::dvec3 v, bool every, SampleStream& stream,
                        TermSample* terms, const Departure* from, glm::dvec3 sky) const;
  // fog_march.cpp: direct's single scattering. fog_before adds the light of a span of the camera ray, of which surfaces
  // in front leave `share`, and returns the transmittance from the camera to the span's end.
  glm::dvec3 fog_before(glm::dvec3 origin, glm::dvec3 direction, Span span, double fraction, uint32_t layer,
                        SampleStream& stream, PixelSample& out) const;
  glm::dvec3 fog_light(glm::dvec3 origin, glm::dvec3 direction, Span span, uint32_t layer, SampleStream& stream) const;
  // Of one of the media, behind what the others take away.
  glm::dvec3 fog_light_of(size_t which, glm::dvec3 origin, glm::dvec3 direction, Span span, uint32_t layer,
                          SampleStream& stream) const;
  glm::dvec3 fog_glow(size_t which, glm::dvec3 origin, glm::dvec3 direction, Span span, double offset) const;
  glm::dvec3 fog_ambient(glm::dvec3 position, glm::dvec3 direction, double g, SampleStream& stream) const;
  // volumetric.cpp: the look's light of lamps in the air along a camera ray.
  glm::dvec3 volumetric_light(glm::dvec3 origin, glm::dvec3 direction, double end_m, SampleStream& stream) const;
  void add_volumetric(const CameraRay& camera, const std::optional<Hit>& first, SampleStream& stream, PixelSample& out,
                      TermSample* terms) const;
  // A point of an emissive triangle or body as `from` sees it; empty where it gives no light there.
  struct EmissivePoint {
    glm::dvec3 l{0};                 // unit, towards it
    double distance_m = 0, pdf = 0;  // per steradian
    uint32_t light = 0;              // into World::emissive(), behind its end into World::glowing()
    glm::dvec2 at{0};                // weights of the second and third corner
    bool back = false;
    std::optional<Hit> of_body = {};  // instead of weights
  };
  std::optional<EmissivePoint> emissive_point(uint32_t light, double probability, glm::dvec3 from, glm::dvec2 u) const;
  double chosen_density(size_t body, glm::dvec3 from, glm::dvec3 way) const;  // per steradian; 0: never
  glm::dvec3 radiance_of(const EmissivePoint& p) const;
  SurfacePoint surface_of(const EmissivePoint& p) const;
  double weight(double this_pdf, double other_pdf, Strategy own) const;
  // path: what the lamps with a radius that the ray meets between two distances give. `left`: of their light, at a
  // distance.
  // `came`: how the path came to the surface that it left; geometric: of that surface.
  template <class Left, class Gain>
  void meet_lamps(const Departure& from, const Departure& came, glm::dvec3 geometric, glm::dvec3 direction,
                  Span between, Left&& left, Gain&& gain) const;
  // What a path's ray meets on behind a face that light passes from behind (--sides), as shadow rays find it:
  // stretch(span, left) of each part of the way, emission(hit, surface, distance_m, left) of each surface that sends
  // light; left: of light from there. Returns the part of the sky's light that comes through.
  template <class Stretch, class Emission>
  glm::dvec3 light_behind(const Ray& ray, const Hit& face, double face_m, glm::dvec3 origin, glm::dvec3 direction,
                          GlassWay way, Stretch&& stretch, Emission&& emission) const;
  bool joins_lamps(int bounce) const;  // whether bounces from a surface are made from lamps as well
  // lamp_paths.cpp: light of a lamp by way of another surface, which a ray from the lamp finds.
  glm::dvec3 by_lamp_rays(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream stream) const;
  // How often that makes the path from `from` by way of this surface to the lamp, its light coming from l, over how
  // often the path's own bounce came to the surface.
  double lamp_rays(const Departure& from, glm::dvec3 position, glm::dvec3 geometric, uint32_t lamp, glm::dvec3 l) const;
  // refracted_lamps.cpp: light of lamps without a size that bodies of smooth glass bend towards a surface; that of one.
  glm::dvec3 by_bodies(const Surface& s, const SurfacePoint& point, glm::dvec3 v, int bounce,
                       SampleStream stream) const;
  // What takes the light: a place, the bodies about it on either side of a normal, and what it turns of light from a
  // direction towards where the path came from, 1/sr.
  struct Receiver {
    glm::dvec3 position{0};
    SurfacePoint point;
    const Interior *before = nullptr, *behind = nullptr;
    glm::dvec3 normal{0};
    std::function<glm::dvec3(glm::dvec3 l)> turns;
  };
  glm::dvec3 by_bodies(const Receiver& receiver, int bounce, SampleStream stream) const;
  glm::dvec3 through_bodies(const PunctualLight& light, const Receiver& receiver, int most_walls_left,
                            SampleStream stream) const;
  static bool survives(double u, int bounce, glm::dvec3& through, double compressed = 1);  // Russian roulette

  // fog_walk.cpp: what fog does to a path on its way to the next surface. Adds the light that fog emits on the way, and
  // all light that reaches the place where it scatters.
  struct FogStep {
    glm::dvec3 through{1};  // of the path, from here on
    glm::dvec3 clear{1};    // transmittance of the way to the next surface
    bool scattered = false;
    glm::dvec3 position{0}, direction{0};  // where it goes on
    double density = 0;                    // of that direction
  };
  FogStep fog_step(glm::dvec3 origin, glm::dvec3 direction, double end_m, glm::dvec3 through, int bounce,
                   uint32_t number, bool every, SampleStream& stream, PixelSample& out, glm::dvec3 sky) const;
  // body: of bodies, which hold no fog, those about the place; null: it lies in the open.
  glm::dvec3 fog_event(glm::dvec3 position, glm::dvec3 direction, double g, bool every, double which,
                       SampleStream& stream, glm::dvec3 sky, const Interior* body = nullptr) const;

  // body_walk.cpp: what the medium of the body that the path is in does to it before the next surface, `end_m` from
  // where the ray began. compressed: of survives().
  struct BodyStep {
    glm::dvec3 weight{1};  // of the path from here on; on the way to the surface, over the transmittance
    bool scattered = false;
    glm::dvec3 light{0};                   // that reaches the place where it scatters
    glm::dvec3 position{0}, direction{0};  // where it goes on
    double density = 0;                    // of that direction
  };
  BodyStep body_step(const GlassWay& way, glm::dvec3 origin, glm::dvec3 direction, double end_m, glm::dvec3 through,
                     double compressed, int bounce, uint32_t number, SampleStream& stream, glm::dvec3 sky) const;
  // Each light at a point a place of its own, as even as the first (the R2 sequence's steps).
  static glm::dvec2 own_place(glm::dvec2 first, size_t light);

  // Of a camera ray over a sample's part of the pixel; nothing where textures are read at points.
  std::optional<RayDifferential> footprint() const;

  const World& world_;
  TraceSettings settings_;
  int width_px_, height_px_;
};

// The normal by which lights are chosen: what lets light through is lit from either side.
inline glm::dvec3 lit_side(const Surface& s) { return s.glass || transmits_diffusely(s) ? glm::dvec3(0) : s.normal; }

// A sky of spherical harmonics, as they are for diffuse light, in direction n; every band times its factor.
glm::dvec3 harmonic_sum(const AmbientSh& sh, glm::dvec3 n, glm::dvec3 band = glm::dvec3(1));

// The ambient term of the raster techniques (shaders: lib/ambient), in double: spherical harmonics up to l = 2 for
// diffuse light, and for reflections as well.
struct HarmonicAmbient {
  glm::dvec3 diffuse{0}, specular{0};
  glm::dvec3 behind{0};  // diffuse light that comes through from the other side
};
HarmonicAmbient harmonic_ambient(const AmbientSh& sh, const Surface& s, glm::dvec3 v);

}  // namespace candela::reference
