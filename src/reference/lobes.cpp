#include "reference/lobes.h"

#include <cmath>
#include <numbers>

#include "reference/albedo.h"
#include "reference/blinn_phong.h"
#include "reference/brdf.h"
#include "reference/sampling.h"
#include "reference/sheen.h"
#include "reference/thin_film.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr double least_facing = 1e-4, coat_f0 = 0.04;
constexpr double least_choice = 0.05;  // of a lobe that is there, before all are made to sum to 1

double schlick_weight(double cosine) { return std::pow(std::clamp(1 - cosine, 0.0, 1.0), 5); }
double facing(glm::dvec3 normal, glm::dvec3 v) { return std::max(std::abs(glm::dot(normal, v)), least_facing); }
glm::dvec3 half_vector(glm::dvec3 l, glm::dvec3 v, glm::dvec3 normal) {
  const glm::dvec3 sum = l + v;
  const double length = glm::length(sum);
  return length > 1e-6 ? sum / length : normal;
}

double coat_alpha(const Lobes& lobes) {
  const double r = std::max(lobes.clearcoat_roughness, least_roughness);
  return r * r;
}
// By the coat's normal and not by its facets', so that what it takes and what it leaves are one number.
double coat_share(const Lobes& lobes, glm::dvec3 v) {
  return lobes.clearcoat * (coat_f0 + (1 - coat_f0) * schlick_weight(facing(lobes.clearcoat_normal, v)));
}
bool has_sheen(const Lobes& lobes) { return lobes.sheen_color != glm::dvec3(0); }
// Both sides of the surface have it.
double sheen_share(const Lobes& lobes, double cosine) {
  return largest(lobes.sheen_color) * std::min(sheen_albedo(lobes.sheen_roughness, std::abs(cosine)), 1.0);
}

glm::dvec3 dielectric_reflectance(const Surface& s, double v_h) {
  const glm::dvec3 f = s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) * schlick_weight(v_h);
  return under_film(s, f, s.dielectric_f0, v_h);
}
glm::dvec3 metal_reflectance(const Surface& s, double v_h) {
  return under_film(s, s.base_color + (1.0 - s.base_color) * schlick_weight(v_h), s.base_color, v_h);
}

// Whether the base meets light from l at all, and its half vector, with that light on the viewer's side.
bool meets_base(const Surface& s, double n_l) { return n_l > 0 || (n_l < 0 && transmits_diffusely(s)); }
glm::dvec3 base_half_vector(const Surface& s, glm::dvec3 l, double n_l, glm::dvec3 v) {
  return half_vector(n_l > 0 ? l : l - 2 * n_l * s.normal, v, s.normal);
}

double facet_lobe(const Surface& s, glm::dvec3 l, double n_l, glm::dvec3 v, glm::dvec3 h) {
  const double n_v = facing(s.normal, v);
  if (!is_stretched(s)) {
    const double alpha = alpha_of(s);
    return ggx_d(glm::dot(s.normal, h), alpha) * smith_v(n_l, n_v, alpha);
  }
  const StretchedFacets facets = facets_of(s);
  return ggx_d(facets, h) * smith_v(facets, l, n_l, v, n_v);
}
// Of facets that are seen: some reflect to below the surface, where other lobes may have light.
double facet_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const glm::dvec3 sum = l + v;
  const double length = glm::length(sum), n_v = glm::dot(s.normal, v);
  if (!(n_v > least_facing) || !(length > 1e-6) || !(glm::dot(s.normal, sum) > 0)) return 0;
  const StretchedFacets facets = facets_of(s);
  // D_v / (4 v.h), where D_v = G1 (v.h) D / (n.v).
  return smith_g1(facets, v) * ggx_d(facets, sum / length) / (4 * n_v);
}
double coat_pdf(const Lobes& lobes, glm::dvec3 l, glm::dvec3 v) {
  const glm::dvec3 n = lobes.clearcoat_normal, sum = l + v;
  const double n_v = glm::dot(n, v), length = glm::length(sum), alpha = coat_alpha(lobes);
  if (!(n_v > least_facing) || !(length > 1e-6) || !(glm::dot(n, sum) > 0)) return 0;
  return smith_g1(n_v, alpha) * ggx_d(glm::dot(n, sum) / length, alpha) / (4 * n_v);
}

// f(l, v) |n.l| of the base: that of brdf.h with film, stretched facets and light from the other side.
glm::dvec3 evaluate_base(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const double n_l = glm::dot(s.normal, l);
  if (!meets_base(s, n_l)) return glm::dvec3(0);
  const glm::dvec3 h = base_half_vector(s, l, n_l, v);
  const double v_h = glm::dot(v, h);
  const glm::dvec3 f_dielectric = dielectric_reflectance(s, v_h);
  const glm::dvec3 diffuse = diffuse_color(s, n_l > 0) / pi * (1 - largest(f_dielectric));
  if (n_l < 0) return diffuse * ((1 - s.metallic) * -n_l);
  const glm::dvec3 specular = s.specular_gain * facet_lobe(s, l, n_l, v, h);
  return glm::mix(diffuse + specular * f_dielectric, specular * metal_reflectance(s, v_h), s.metallic) * n_l;
}

// How often the lobes of the base are chosen: its facets, and diffuse light of either side.
struct BaseChoices {
  double facets = 0, front = 1, behind = 0;
};
BaseChoices base_choices(const Surface& s, glm::dvec3 v) {
  const double n_v = glm::dot(s.normal, v);
  const DirectionalAlbedo a = facet_albedo(s, v);
  const glm::dvec3 dielectric =
      under_film(s, s.dielectric_f0 * a.scale + s.dielectric_f90 * a.bias, s.dielectric_f0, n_v);
  const glm::dvec3 metal = under_film(s, s.base_color * a.scale + a.bias, s.base_color, n_v);
  const double left = (1 - s.metallic) * std::max(1 - largest(dielectric), 0.0);
  const auto chosen = [](glm::dvec3 albedo) { return std::max(luminance(albedo), least_choice); };
  BaseChoices c;
  // Visible normals are not defined from below.
  c.facets = n_v > least_facing ? chosen(glm::mix(dielectric, metal, s.metallic)) : 0;
  c.front = s.metallic < 1 || c.facets == 0 ? chosen(left * diffuse_color(s, true)) : 0;
  c.behind = transmits_diffusely(s) ? chosen(left * diffuse_color(s, false)) : 0;
  const double sum = c.facets + c.front + c.behind;
  c.facets /= sum, c.front /= sum, c.behind /= sum;
  return c;
}

// One of several by a number in [0, 1), of which the rest is left for the next choice.
bool chooses(double& u, double probability) {
  if (u < probability) {
    u /= probability;
    return true;
  }
  u = std::min((u - probability) / (1 - probability), 1 - 0x1p-53);
  return false;
}

}  // namespace

bool is_stretched(const Surface& s) { return s.lobes && s.lobes->anisotropy > 0; }

StretchedFacets facets_of(const Surface& s) {
  const double alpha = alpha_of(s);
  StretchedFacets f{{}, {}, s.normal, glm::dvec2(alpha)};
  if (is_stretched(s)) {
    f.x = s.lobes->along, f.y = glm::cross(s.normal, f.x);
    f.alpha.x = alpha + (1 - alpha) * s.lobes->anisotropy * s.lobes->anisotropy;
  } else {
    make_frame(s.normal, f.x, f.y);
  }
  return f;
}

DirectionalAlbedo facet_albedo(const Surface& s, glm::dvec3 v) {
  const double n_v = std::clamp(glm::dot(s.normal, v), 0.0, 1.0);
  if (!has_facets(s)) return {blinn_phong_albedo(s.exponent, n_v), 0, 0};
  if (!is_stretched(s)) return directional_albedo(s.roughness, n_v);
  const StretchedFacets facets = facets_of(s);
  DirectionalAlbedo a = directional_albedo(std::sqrt(mean_alpha(facets)), n_v);
  // The gain of a white metal makes up for what its facets lose.
  const double part = 1 / (specular_gain(glm::dvec3(1), facets, v).x * (a.scale + a.bias));
  a.scale *= part, a.bias *= part;
  return a;
}

glm::dvec3 under_film(const Surface& s, glm::dvec3 reflectance, glm::dvec3 f0, double cosine) {
  if (!s.lobes || !(s.lobes->iridescence > 0) || !(s.lobes->film_nm > 0)) return reflectance;
  return glm::mix(reflectance, film_reflectance(cosine, s.lobes->film_ior, s.lobes->film_nm, f0), s.lobes->iridescence);
}

bool transmits_diffusely(const Surface& s) { return s.lobes && s.lobes->diffuse_transmission > 0 && s.metallic < 1; }

glm::dvec3 diffuse_color(const Surface& s, bool in_front) {
  if (!s.lobes) return in_front ? s.base_color : glm::dvec3(0);
  if (s.lobes->slab) return in_front ? s.lobes->slab->front : s.lobes->slab->behind;
  return in_front ? s.base_color * (1 - s.lobes->diffuse_transmission)
                  : s.lobes->transmitted_color * s.lobes->diffuse_transmission;
}

double share_under_coat(const Lobes& lobes, glm::dvec3 v) { return 1 - coat_share(lobes, v); }

double share_under(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const double fraction = share_under_coat(*s.lobes, v);
  if (!has_sheen(*s.lobes)) return fraction;
  const double to_viewer = sheen_share(*s.lobes, glm::dot(s.normal, v)),
               to_light = sheen_share(*s.lobes, glm::dot(s.normal, l));
  return fraction * (1 - std::max(to_viewer, to_light));
}

double share_under(const Surface& s, glm::dvec3 v) {
  const double fraction = share_under_coat(*s.lobes, v);
  return has_sheen(*s.lobes) ? fraction * (1 - sheen_share(*s.lobes, glm::dot(s.normal, v))) : fraction;
}

glm::dvec3 evaluate_layers(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const Lobes& lobes = *s.lobes;
  glm::dvec3 sum(0);
  const double n_l = glm::dot(s.normal, l), coat_l = glm::dot(lobes.clearcoat_normal, l);
  if (has_sheen(lobes) && n_l > 0) {
    const double n_v = facing(s.normal, v), n_h = glm::dot(s.normal, half_vector(l, v, s.normal));
    const double white = sheen_lobe(n_l, n_v, n_h, lobes.sheen_roughness);
    // Alone it may reflect more than there is.
    const double energy = std::max(sheen_albedo(lobes.sheen_roughness, n_v), 1.0);
    sum += lobes.sheen_color * (white / energy * share_under_coat(lobes, v));
  }
  if (lobes.clearcoat > 0 && coat_l > 0) {
    const double n_v = facing(lobes.clearcoat_normal, v), alpha = coat_alpha(lobes);
    const double n_h = glm::dot(lobes.clearcoat_normal, half_vector(l, v, lobes.clearcoat_normal));
    sum += coat_share(lobes, v) * ggx_d(n_h, alpha) * smith_v(coat_l, n_v, alpha) * coat_l;
  }
  return sum;
}

glm::dvec3 sheen_reflectance(const Surface& s, glm::dvec3 v) {
  const Lobes& lobes = *s.lobes;
  if (!has_sheen(lobes)) return glm::dvec3(0);
  const double white = std::min(sheen_albedo(lobes.sheen_roughness, facing(s.normal, v)), 1.0);
  return lobes.sheen_color * (white * share_under_coat(lobes, v));
}

double coat_reflectance(const Surface& s, glm::dvec3 v) {
  const Lobes& lobes = *s.lobes;
  if (!(lobes.clearcoat > 0)) return 0;
  const DirectionalAlbedo a =
      directional_albedo(lobes.clearcoat_roughness, std::min(facing(lobes.clearcoat_normal, v), 1.0));
  return coat_share(lobes, v) * (a.scale + a.bias);
}

LayerChoices layer_choices(const Surface& s, glm::dvec3 v) {
  const Lobes& lobes = *s.lobes;
  LayerChoices c;
  if (lobes.clearcoat > 0 && glm::dot(lobes.clearcoat_normal, v) > least_facing)
    c.coat = std::max(coat_share(lobes, v), least_choice);
  if (has_sheen(lobes)) c.sheen = std::max(luminance(sheen_reflectance(s, v)), least_choice);
  c.under = std::max(share_under(s, v), least_choice);
  const double sum = c.coat + c.sheen + c.under;
  c.coat /= sum, c.sheen /= sum, c.under /= sum;
  return c;
}

glm::dvec3 sample_coat(const Surface& s, glm::dvec3 v, glm::dvec2 u) {
  const glm::dvec3 h = visible_normal(s.lobes->clearcoat_normal, v, coat_alpha(*s.lobes), u);
  return glm::normalize(2 * glm::dot(v, h) * h - v);
}

double layers_pdf(const Surface& s, const LayerChoices& choices, glm::dvec3 l, glm::dvec3 v) {
  double pdf = choices.sheen * std::max(glm::dot(s.normal, l), 0.0) / pi;
  if (choices.coat > 0) pdf += choices.coat * coat_pdf(*s.lobes, l, v);
  return pdf;
}

glm::dvec3 evaluate_lobes(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  return evaluate_layers(s, l, v) + share_under(s, l, v) * evaluate_base(s, l, v);
}

glm::dvec3 diffuse_lobes(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const double n_l = glm::dot(s.normal, l);
  if (!meets_base(s, n_l)) return glm::dvec3(0);
  const double v_h = glm::dot(v, base_half_vector(s, l, n_l, v));
  return diffuse_color(s, n_l > 0) *
         ((1 - largest(dielectric_reflectance(s, v_h))) * (1 - s.metallic) * std::abs(n_l) / pi * share_under(s, l, v));
}

glm::dvec3 sample_lobes(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u) {
  const LayerChoices layers = layer_choices(s, v);
  if (chooses(lobe, layers.coat)) return sample_coat(s, v, u);
  if (chooses(lobe, layers.sheen / (layers.sheen + layers.under))) return cosine_direction(s.normal, u);
  const BaseChoices choices = base_choices(s, v);
  if (chooses(lobe, choices.behind)) return cosine_direction(-s.normal, u);
  if (chooses(lobe, choices.front / (choices.front + choices.facets))) return cosine_direction(s.normal, u);
  const glm::dvec3 h = visible_normal(facets_of(s), v, u);
  return glm::normalize(2 * glm::dot(v, h) * h - v);
}

double lobes_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const LayerChoices layers = layer_choices(s, v);
  const BaseChoices choices = base_choices(s, v);
  const double n_l = glm::dot(s.normal, l), diffuse = (n_l > 0 ? choices.front : choices.behind) * std::abs(n_l) / pi;
  const double facets = choices.facets > 0 ? choices.facets * facet_pdf(s, l, v) : 0;
  return layers_pdf(s, layers, l, v) + layers.under * (diffuse + facets);
}

glm::dvec3 sample_specular(const Surface& s, glm::dvec3 v, glm::dvec2 u) {
  if (s.lobes) {
    const LayerChoices layers = layer_choices(s, v);
    if (chooses(u.x, layers.coat)) return sample_coat(s, v, u);
    if (chooses(u.x, layers.sheen / (layers.sheen + layers.under))) return cosine_direction(s.normal, u);
    return glm::reflect(-v, visible_normal(facets_of(s), v, u));
  }
  return glm::reflect(-v, visible_normal(s.normal, v, alpha_of(s), u));
}

double specular_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const LayerChoices layers = layer_choices(s, v);
  return layers_pdf(s, layers, l, v) + layers.under * facet_pdf(s, l, v);
}

}  // namespace candela::reference
