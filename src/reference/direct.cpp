// Light that comes straight from its source: every punctual light summed without choosing, and the sky.
#include <cmath>

#include "math/spherical_harmonics.h"
#include "reference/albedo.h"
#include "reference/glass_light.h"
#include "reference/integrator.h"
#include "reference/microfacet.h"
#include "reference/visibility.h"

namespace candela::reference {
namespace {

// Dimensions of a surface that is not opaque: a group of the sampler's four and some more for each layer of blended
// surfaces. Layers beyond so many share those of the last.
constexpr uint32_t dimensions_a_layer = 8, numbered_layers = 256;
// Those of a surface's reflections lie behind all of them.
constexpr uint32_t reflection_dimensions = 4 + numbered_layers * dimensions_a_layer;
constexpr int most_layers = 1 << 16;  // no end of a loop must hang on arithmetic

}  // namespace

glm::dvec3 harmonic_sum(const AmbientSh& sh, glm::dvec3 n, glm::dvec3 band) {
  const std::array<double, 9> basis = sh_basis(n);
  glm::dvec3 sum(0);
  for (size_t i = 0; i < 9; ++i) sum += band[i == 0 ? 0 : i < 4 ? 1 : 2] * basis[i] * glm::dvec3(sh[i]);
  return glm::max(sum, glm::dvec3(0));
}

namespace {

// The direction that a lobe of stretched facets reflects: about a normal that leans towards what those facets show, the
// less the rounder the lobe (the bent normal of Khronos's sample renderer).
glm::dvec3 bent_normal(const Surface& s, glm::dvec3 v) {
  if (!is_stretched(s)) return s.normal;
  const glm::dvec3 across = glm::cross(s.normal, s.lobes->along);
  const glm::dvec3 leaning = glm::cross(glm::cross(across, v), across);
  const double round = 1 - s.lobes->anisotropy * (1 - s.roughness), weight = round * round * round * round;
  const glm::dvec3 bent = glm::mix(leaning, s.normal, weight);
  const double length = glm::length(bent);
  return length > 1e-6 ? bent / length : s.normal;
}

// a: of the base's facets; left: of the light, to the diffuse lobe, by a base without a film.
HarmonicAmbient harmonic_lobes(const AmbientSh& sh, const Surface& s, glm::dvec3 v, const DirectionalAlbedo& a,
                               double left) {
  const double n_v = std::clamp(glm::dot(s.normal, v), 0.0, 1.0), under = share_under(s, v);
  const double scale = a.scale + a.bias;
  // The film's reflectance stands for that of all facets.
  const auto filmed = [&](glm::dvec3 facets, glm::dvec3 f0) {
    return scale > 0 ? under_film(s, facets / scale, f0, n_v) * scale : facets;
  };
  const glm::dvec3 dielectric = filmed(s.dielectric_f0 * a.scale + s.dielectric_f90 * a.bias, s.dielectric_f0),
                   metal = filmed(s.base_color * a.scale + a.bias, s.base_color);
  const double into =
      (1 - largest(under_film(s, glm::dvec3(1 - left), s.dielectric_f0, n_v))) * (1 - s.metallic) * under;
  HarmonicAmbient out;
  out.diffuse = diffuse_color(s, true) * into * harmonic_sum(sh, s.normal);
  if (transmits_diffusely(s)) out.behind = diffuse_color(s, false) * into * harmonic_sum(sh, -s.normal);
  out.specular = s.specular_gain * glm::mix(dielectric, metal, s.metallic) * under *
                 harmonic_sum(sh, glm::reflect(-v, bent_normal(s, v)));
  out.specular += sheen_reflectance(s, v) * harmonic_sum(sh, s.normal);
  if (s.lobes->clearcoat > 0)
    out.specular += coat_reflectance(s, v) * harmonic_sum(sh, glm::reflect(-v, s.lobes->clearcoat_normal));
  return out;
}

}  // namespace

HarmonicAmbient harmonic_ambient(const AmbientSh& sh, const Surface& s, glm::dvec3 v) {
  const DirectionalAlbedo a = facet_albedo(s, v);
  const glm::dvec3 dielectric = s.dielectric_f0 * a.scale + s.dielectric_f90 * a.bias,
                   metal = s.base_color * a.scale + a.bias;
  const double f0 = largest(s.dielectric_f0), left = 1 - (f0 + (s.dielectric_f90 - f0) * a.grazing);
  if (s.lobes) return harmonic_lobes(sh, s, v, a, left);
  const glm::dvec3 diffuse = s.base_color * left * (1 - s.metallic) * harmonic_sum(sh, s.normal);
  return {diffuse,
          s.specular_gain * glm::mix(dielectric, metal, s.metallic) * harmonic_sum(sh, glm::reflect(-v, s.normal)),
          {}};
}

CameraRay Integrator::camera_ray(glm::dvec2 place_px, const SampleStream& stream) const {
  CameraRay ray = world_.camera_ray(place_px, width_px_, height_px_);
  if (world_.has_lens()) ray = world_.through_lens(ray, stream.apart(first_lens_dimension).next2());
  return ray;
}

void Integrator::sample(std::span<const glm::ivec2> pixels, uint64_t index, bool counted, std::span<PixelSample> out,
                        std::span<TermSample> terms) const {
  const size_t count = pixels.size();
  std::vector<SampleStream> streams;
  std::vector<CameraRay> cameras;
  std::vector<Ray> rays;
  streams.reserve(count), cameras.reserve(count), rays.reserve(count);
  for (const glm::ivec2 pixel : pixels) {
    streams.emplace_back(settings_.sampler, pixel.x, pixel.y, index);
    cameras.push_back(camera_ray(glm::dvec2(pixel) + streams.back().pixel(), streams.back()));
    rays.push_back(rounded(cameras.back()));
  }
  std::vector<std::optional<Hit>> first(count);
  SurfaceFilter filter(world_, true);
  const bool one_by_one = counted || world_.has_relief();
  if (!one_by_one) world_.accel().closest(rays, first, &filter);
  for (size_t i = 0; i < count; ++i) {
    TraceCounts counts;
    if (one_by_one) first[i] = filter.closest(rays[i], counted ? &counts : nullptr);
    out[i] = sample_along(cameras[i], first[i], streams[i], terms.empty() ? nullptr : &terms[i],
                          counted ? &counts : nullptr);
    if (counted) out[i].traversal = 0.25 * double(counts.nodes) + double(counts.triangles);
  }
}

PixelSample Integrator::sample_at(glm::dvec2 place_px, uint64_t index, TermSample* terms) const {
  SampleStream stream(settings_.sampler, int(std::floor(place_px.x)), int(std::floor(place_px.y)), index);
  const CameraRay ray = camera_ray(place_px, stream);
  return sample_along(ray, next_surface(world_, rounded(ray), true, nullptr, nullptr), stream, terms, nullptr);
}

PixelSample Integrator::sample_along(const CameraRay& ray, const std::optional<Hit>& first, SampleStream& stream,
                                     TermSample* terms, TraceCounts* counts) const {
  PixelSample out = settings_.mode == Mode::direct ? sample_direct(ray, first, stream, terms, counts)
                                                   : sample_path(ray, first, stream, terms, counts);
  if (world_.volumetric()) add_volumetric(ray, first, stream, out, terms);
  return out;
}

std::optional<RayDifferential> Integrator::footprint() const {
  if (!settings_.footprints) return {};
  RayDifferential steps = world_.camera_steps(width_px_, height_px_);
  const glm::ivec2 grid = grid_of(settings_.sampler.spp);
  for (int i = 0; i < 2; ++i) steps.place[i] /= grid[i], steps.direction[i] /= grid[i];
  return steps;
}

PixelSample Integrator::sample_direct(const CameraRay& camera, const std::optional<Hit>& first, SampleStream& stream,
                                      TermSample* terms, TraceCounts* counts) const {
  PixelSample out;
  const Ray ray = rounded(camera);
  const glm::dvec3 onward = glm::normalize(camera.direction);
  glm::dvec3 to_viewer = -onward;
  double through = 1, before_m = 0;
  std::optional<Hit> hit = first;
  // Front to back: each surface covers what the ones before left open.
  bool opaque_met = false;
  const std::optional<RayDifferential> part = footprint();
  for (int layer = 0; hit && layer < most_layers && through > 0; ++layer) {
    Surface s = world_.surface(*hit, camera.origin, camera.direction, part ? &*part : nullptr);
    const uint32_t numbered = std::min(uint32_t(layer), numbered_layers - 1);
    if (settings_.lifted != 0) {
      s.position += settings_.lifted * glm::distance(s.position, camera.origin) * s.geometric;
      to_viewer = glm::normalize(camera.origin - s.position);
    }
    if (s.coverage > 0) {
      TermSample own;
      own[Term::emission] = s.unlit ? s.base_color : s.emission;
      const SurfacePoint point = world_.point(*hit);
      std::optional<Lobe> lobe;
      if (world_.has_reflections() && !s.unlit && !world_.is_blended(hit->item)) {
        stream.start(reflection_dimensions);
        lobe = specular_lobe(s, point, to_viewer, stream.next2());
        own[Term::reflections] = reflected(*lobe, s, point, stream);
      }
      stream.start(4 + numbered * dimensions_a_layer);
      glm::dvec3 radiance = s.base_color;
      if (!s.unlit)
        radiance = s.emission +
                   surface_light(s, point, to_viewer, stream, terms ? &own : nullptr, lobe ? &*lobe : nullptr) +
                   own[Term::reflections];
      const double here_m = glm::dot(s.position - camera.origin, onward);
      const glm::dvec3 clear = fog_before(camera.origin, onward, {before_m, here_m}, through, numbered, stream, out);
      before_m = here_m;
      out.radiance += through * s.coverage * clear * radiance;
      out.fog_through += through * s.coverage * (clear - 1.0);
      if (terms) {
        terms->add(own, through * s.coverage * clear);
        if (!s.unlit) terms->shadow -= through * s.coverage * (1 - sun_visibility(s, point, stream.next2()));
        if (!s.unlit && terms->wants_lamp_shadow)
          terms->lamp_shadow -=
              through * s.coverage * (1 - lamp_visibility(s, point, stream.apart(first_size_dimension).next2()));
        if (!opaque_met && !world_.is_blended(hit->item)) {
          opaque_met = true;
          if (!s.unlit) terms->occlusion = near_occlusion(s, point, stream.next2());
        }
      }
      out.alpha += through * s.coverage;
      through *= 1 - s.coverage;
    }
    if (!(through > 0)) break;
    const Hit passed = *hit;
    hit = next_surface(world_, ray, true, &passed, counts);
  }
  if (through > 0) {
    const glm::dvec4 background = world_.background(camera.direction);
    const glm::dvec3 clear =
        fog_before(camera.origin, onward, {before_m, endless}, through, numbered_layers, stream, out);
    out.radiance += through * clear * glm::dvec3(background);
    if (terms) (*terms)[Term::background] += through * clear * glm::dvec3(background);
    out.fog_through += through * (clear - 1.0);
    out.alpha += through * (!world_.media().empty() ? 1 - luminance(clear) * (1 - background.w) : background.w);
  }
  return out;
}

std::optional<Hit> Integrator::reflecting_hit(const SurfacePoint& from, glm::dvec3 l) const {
  const Ray ray = leaving_ray(from, l);
  std::optional<Hit> hit = next_surface(world_, ray, false, nullptr, nullptr);
  while (hit && world_.is_blended(hit->item)) {
    const Hit passed = *hit;
    hit = next_surface(world_, ray, false, &passed, nullptr);
  }
  return hit;
}

Integrator::Lobe Integrator::specular_lobe(const Surface& s, const SurfacePoint& point, glm::dvec3 v,
                                           glm::dvec2 u) const {
  Lobe lobe;
  double pdf;
  if (s.lobes) {
    lobe.l = sample_specular(s, v, u);
    pdf = specular_pdf(s, lobe.l, v);
  } else if (!has_facets(s)) {
    lobe.l = sample_base_lobe(s, v, u);
    pdf = base_lobe_pdf(s, lobe.l, v);
  } else {
    const double alpha = alpha_of(s);
    const glm::dvec3 h = visible_normal(s.normal, v, alpha, u);
    lobe.l = glm::reflect(-v, h);
    const double n_v = std::max(glm::dot(s.normal, v), 1e-6);
    pdf = smith_g1(n_v, alpha) * ggx_d(glm::dot(s.normal, h), alpha) / (4 * n_v);
  }
  if (!(pdf > 0) || !(glm::dot(s.normal, lobe.l) > 0)) return lobe;
  lobe.weight = evaluate_brdf(s, lobe.l, v) * (1.0 - diffuse_share(s, lobe.l, v)) / pdf;
  if (settings_.visibility && is_open(s, lobe.l)) lobe.hit = reflecting_hit(point, lobe.l);
  return lobe;
}

glm::dvec3 Integrator::reflected(const Lobe& lobe, const Surface& s, const SurfacePoint& point,
                                 SampleStream& stream) const {
  if (!lobe.hit || lobe.weight == glm::dvec3(0)) return glm::dvec3(0);
  const Ray ray = leaving_ray(point, lobe.l);
  const Surface met = world_.surface(*lobe.hit, glm::dvec3(ray.origin), lobe.l);
  const SurfacePoint there = world_.point(*lobe.hit);
  const glm::dvec3 radiance =
      met.unlit ? met.base_color : met.emission + direct_light(met, there, -lobe.l, stream, nullptr);
  return s.occlusion * lobe.weight * radiance *
         world_.through_fog(s.position, lobe.l, glm::distance(s.position, met.position));
}

glm::dvec3 Integrator::direct_light(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                                    TermSample* terms) const {
  return surface_light(s, point, v, stream, terms, nullptr);
}

glm::dvec3 Integrator::surface_light(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                                     TermSample* terms, const Lobe* lobe) const {
  // What the material says of its own small hollows belongs to this term, as glTF says; tracing adds what the geometry
  // does.
  TermSample parts;
  TermSample* const wanted = terms ? &parts : nullptr;
  glm::dvec3 ambient(0);
  if (world_.sky() && settings_.ambient != Ambient::off) {
    const glm::dvec3 sky = settings_.ambient == Ambient::traced ? traced_ambient(s, point, v, stream, wanted, lobe)
                                                                : occluded_ambient(s, point, v, stream, wanted, lobe);
    ambient = s.occlusion * sky;
    if (terms) terms->add(parts, glm::dvec3(s.occlusion));
  }
  return punctual(s, point, v, stream, terms) + ambient;
}

Integrator::Offer Integrator::punctual_offer(const PunctualLight& light, const Surface& s, glm::dvec3 v,
                                             glm::dvec2 on_disc, double probability, const LampRays* rays) const {
  const Arrival a = arriving(light, s.position, on_disc);
  if (a.illuminance == glm::dvec3(0)) return {};
  const bool sized = a.pdf > 0;  // then mirrors find it by themselves
  const glm::dvec3 f = evaluate_bsdf(s, a.l, v, !sized);
  if (f == glm::dvec3(0)) return {};
  const double by_rays = rays ? lamp_rays(*rays->from, s.position, s.geometric, rays->lamp, a.l) : 0;
  double w = 1;
  if (by_rays > 0) {
    const double own = probability * (sized ? a.pdf : 1), other = sized ? bsdf_pdf(s, a.l, v) : 0;
    w = 1 / (1 + (by_rays / own) * (by_rays / own) + (other / own) * (other / own));
  } else if (sized) {
    w = weight(probability * a.pdf, bsdf_pdf(s, a.l, v), Strategy::light);
  }
  return {a.illuminance * f * w, a.l, a.distance_m, {}};
}

namespace {
// Of a body that is taken for a slab: the same way to a light behind the surface, from where that comes into the slab.
struct LightWay {
  SurfacePoint from;
  glm::dvec3 l{0};
  double distance_m = 0;
};
std::optional<LightWay> beyond_slab(const Surface& s, const SurfacePoint& point, glm::dvec3 l, double distance_m) {
  if (!s.lobes || !s.lobes->slab || !(glm::dot(s.geometric, l) < 0)) return {};
  LightWay way{point, l, distance_m};
  const glm::dvec3 across = -s.lobes->slab->thickness_m * s.geometric;
  way.from.position += glm::vec3(across);
  if (!std::isfinite(distance_m)) return way;
  const glm::dvec3 rest = l * distance_m - across;
  way.distance_m = glm::length(rest);
  if (way.distance_m > 0) way.l = rest / way.distance_m;
  return way;
}
}  // namespace

glm::dvec3 Integrator::taken(const Offer& offer, const Surface& s, const SurfacePoint& point) const {
  if (offer.radiance == glm::dvec3(0)) return offer.radiance;
  const glm::dvec3 radiance = offer.radiance * world_.through_fog(s.position, offer.l, offer.distance_m);
  if (!settings_.visibility) return radiance;
  // Light from behind the triangle, which a shading normal may let in, is blocked by the surface itself.
  if (!is_open(s, offer.l)) return glm::dvec3(0);
  if (const auto beyond = beyond_slab(s, point, offer.l, offer.distance_m))
    return radiance * light_through(world_, beyond->from, beyond->l, beyond->distance_m, nullptr,
                                    offer.end ? &*offer.end : nullptr, offer.is_lamp());
  return radiance * light_through(world_, point, offer.l, offer.distance_m, bodies_towards(s, offer.l),
                                  offer.end ? &*offer.end : nullptr, offer.is_lamp());
}

glm::dvec3 Integrator::punctual(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                                TermSample* terms) const {
  const glm::dvec2 on_disc = stream.next2();
  glm::dvec3 sum(0);
  if (world_.has_sized_lights()) sum = sized_by_brdf(s, point, v, stream.apart(first_size_dimension), terms);
  for (size_t i = 0; i < world_.punctual_lights().size(); ++i) {
    const PunctualLight& light = world_.punctual_lights()[i];
    const glm::dvec3 radiance = taken(punctual_offer(light, s, v, own_place(on_disc, i)), s, point);
    sum += radiance;
    if (terms) terms->add_direct(light, radiance);
  }
  return sum;
}

// Near mirrors show the light's shape, which its own directions seldom hit.
glm::dvec3 Integrator::sized_by_brdf(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream stream,
                                     TermSample* terms) const {
  glm::dvec3 sum(0);
  const glm::dvec2 for_lobe = stream.next2();
  const glm::dvec3 l = sample_brdf(s, v, stream.next(), for_lobe);
  const double pdf = brdf_pdf(s, l, v);
  const glm::dvec3 f = pdf > 0 ? evaluate_brdf(s, l, v) / pdf : glm::dvec3(0);
  if (f == glm::dvec3(0)) return sum;
  for (const PunctualLight& light : world_.punctual_lights()) {
    const std::optional<Arrival> a = light_in(light, s.position, l);
    if (!a) continue;
    const double w = weight(pdf, a->pdf, Strategy::brdf);
    const glm::dvec3 radiance = taken({a->illuminance * a->pdf * f * w, l, a->distance_m, {}}, s, point);
    sum += radiance;
    if (terms) terms->add_direct(light, radiance);
  }
  return sum;
}

// Traced apart from the light itself, which needs no shadow ray where the material shows none of it.
double Integrator::sun_visibility(const Surface& s, const SurfacePoint& point, glm::dvec2 on_disc) const {
  return open_share(world_.directional(), s, point, on_disc);
}

double Integrator::lamp_visibility(const Surface& s, const SurfacePoint& point, glm::dvec2 on_disc) const {
  return open_share(world_.tree_punctual(), s, point, on_disc);
}

double Integrator::open_share(const std::vector<uint32_t>& lights, const Surface& s, const SurfacePoint& point,
                              glm::dvec2 on_disc) const {
  double all = 0, open = 0;
  for (const uint32_t index : lights) {
    const Arrival a = arriving(world_.punctual_lights()[index], s.position, own_place(on_disc, index));
    const double weight = luminance(a.illuminance) * std::max(glm::dot(s.normal, a.l), 0.0);
    if (!(weight > 0)) continue;
    all += weight;
    if (!settings_.visibility)
      open += weight;
    else if (is_open(s, a.l))
      open += weight * luminance(light_through(world_, point, a.l, a.distance_m, bodies_towards(s, a.l), nullptr,
                                               std::isfinite(a.distance_m)));
  }
  return all > 0 ? open / all : 1;
}

double Integrator::near_occlusion(const Surface& s, const SurfacePoint& point, glm::dvec2 u) const {
  if (!settings_.visibility) return 1;
  const Occlusion occlusion = world_.occlusion();
  const double open = near_visibility(world_, point, cosine_direction(s.geometric, u), occlusion);
  return 1 - occlusion.strength * (1 - open);
}

glm::dvec3 Integrator::sky_visibility(const Surface& s, const SurfacePoint& point, glm::dvec3 l) const {
  const glm::dvec3 clear = world_.through_fog(s.position, l, endless);
  if (!settings_.visibility) return clear;
  if (!is_open(s, l)) return glm::dvec3(0);
  if (settings_.mode == Mode::direct && world_.has_near_occlusion()) {
    const Occlusion occlusion = world_.occlusion();
    return clear * (1 - occlusion.strength * (1 - near_visibility(world_, point, l, occlusion)));
  }
  const double distance_m = settings_.mode == Mode::path ? endless : settings_.ambient_distance_m;
  if (const auto beyond = beyond_slab(s, point, l, distance_m))
    return clear * light_through(world_, beyond->from, beyond->l, beyond->distance_m, nullptr);
  return clear * light_through(world_, point, l, distance_m, bodies_towards(s, l));
}

glm::dvec3 Integrator::traced_ambient(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                                      TermSample* terms, const Lobe* lobe) const {
  glm::dvec3 sum(0);
  const glm::dvec2 for_lobe = stream.next2();
  const glm::dvec3 l = sample_brdf(s, v, stream.next(), for_lobe);
  stream.next();  // to a group of its own
  const Sky::Choice choice = world_.sky().sample(stream.next2());
  const auto add = [&](glm::dvec3 direction, double pdf, double other) {
    const glm::dvec3 f = pdf > 0 ? evaluate_brdf(s, direction, v) : glm::dvec3(0);
    if (f == glm::dvec3(0)) return;
    const glm::dvec3 radiance = world_.sky().radiance(direction) * f * (pdf / (pdf * pdf + other * other));
    if (radiance == glm::dvec3(0)) return;
    glm::dvec3 arriving = radiance * sky_visibility(s, point, direction);
    if (lobe) {
      // What the lobe meets stands before the sky, however far it is.
      const glm::dvec3 fraction = diffuse_share(s, direction, v), diffuse = arriving * fraction;
      arriving = diffuse;
      if (!settings_.visibility || (is_open(s, direction) && !reflecting_hit(point, direction)))
        arriving += radiance * (1.0 - fraction) * world_.through_fog(s.position, direction, endless);
      if (terms) terms->add_ambient(diffuse, arriving);
    } else if (terms) {
      terms->add_ambient(arriving * diffuse_share(s, direction, v), arriving);
    }
    sum += arriving;
  };
  add(choice.direction, choice.pdf, brdf_pdf(s, choice.direction, v));
  add(l, brdf_pdf(s, l, v), world_.sky().pdf(l));
  return sum;
}

glm::dvec3 Integrator::occluded_ambient(const Surface& s, const SurfacePoint& point, glm::dvec3 v, SampleStream& stream,
                                        TermSample* terms, const Lobe* lobe) const {
  auto [diffuse, specular, behind] = harmonic_ambient(world_.ambient_sh(), s, v);
  const glm::dvec2 u = stream.next2();
  const glm::dvec3 open = sky_visibility(s, point, cosine_direction(s.normal, u));
  if (lobe && lobe->hit) specular = glm::dvec3(0);
  glm::dvec3 ambient = (diffuse + specular) * open;
  diffuse *= open;
  if (behind != glm::dvec3(0)) {
    behind *= sky_visibility(s, point, cosine_direction(-s.normal, u));
    diffuse += behind, ambient += behind;
  }
  if (terms) terms->add_ambient(diffuse, ambient);
  return ambient;
}

}  // namespace candela::reference
