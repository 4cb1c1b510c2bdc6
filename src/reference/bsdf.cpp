#include "reference/bsdf.h"

#include <cmath>
#include <numbers>

#include "reference/microfacet.h"
#include "reference/sampling.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr double same_index = 1e-7;  // indices are floats: closer than their steps is equal

bool is_smooth(const Surface& s) { return s.roughness < least_roughness && !is_stretched(s); }
// What becomes of light that meets a facet at this cosine; behind: of diffuse light from the other side.
struct Shares {
  glm::dvec3 reflected, through, diffuse, behind{0};
};
Shares shares_at(const Surface& s, double cosine) {
  const double grazing = std::pow(std::clamp(1 - cosine, 0.0, 1.0), 5);
  glm::dvec3 f;
  if (s.glass->ior == 0) {
    f = s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) * grazing;
  } else {
    const double exact = fresnel(cosine, s.eta), ratio = (s.eta - 1) / (s.eta + 1), normal = ratio * ratio;
    // Total reflection leaves nowhere to go, whatever the specular extension says.
    if (exact >= 1)
      f = glm::dvec3(1);
    else
      f = glm::mix(glm::min(normal * s.specular_tint, glm::dvec3(1)) * s.dielectric_f90, glm::dvec3(s.dielectric_f90),
                   normal < 1 ? (exact - normal) / (1 - normal) : 1.0);
    f = glm::clamp(f, glm::dvec3(0), glm::dvec3(1));  // at indices above 4 the reflectance dips before it rises
  }
  glm::dvec3 metal = s.base_color + (1.0 - s.base_color) * grazing;
  if (s.lobes) {
    // The film is seen from the air on either side, and no film ends total reflection.
    const double sine2 = (1 - cosine * cosine) / (s.eta * s.eta);
    const double in_air = s.eta < 1 ? std::sqrt(std::max(1 - sine2, 0.0)) : cosine;
    if (s.eta >= 1 || sine2 < 1) f = under_film(s, f, glm::min(s.dielectric_f0, glm::dvec3(1)), in_air);
    metal = under_film(s, metal, s.base_color, in_air);
    const double left = (1 - s.metallic) * (1 - largest(f));
    const double diffuse = left * (1 - s.transmission);
    return {glm::mix(f, metal, s.metallic), s.base_color * (left * s.transmission), diffuse_color(s, true) * diffuse,
            diffuse_color(s, false) * diffuse};
  }
  const glm::dvec3 base = s.base_color * ((1 - s.metallic) * (1 - largest(f)));
  return {glm::mix(f, metal, s.metallic), base * s.transmission, base * (1 - s.transmission)};
}

// D and Smith's term over 4 (n.l) (n.v); D and the masking of v over n.v.
double facets_lit(const Surface& s, glm::dvec3 l, glm::dvec3 v, glm::dvec3 h) {
  const double n_l = std::abs(glm::dot(s.normal, l)), n_v = glm::dot(s.normal, v), alpha = alpha_of(s);
  if (!is_stretched(s)) return ggx_d(glm::dot(s.normal, h), alpha) * smith_v(n_l, n_v, alpha);
  const StretchedFacets facets = facets_of(s);
  return ggx_d(facets, h) * smith_v(facets, l, n_l, v, n_v);
}
double facets_seen(const Surface& s, glm::dvec3 v, glm::dvec3 h) {
  const double n_v = glm::dot(s.normal, v), alpha = alpha_of(s);
  if (!is_stretched(s)) return smith_g1(n_v, alpha) * ggx_d(glm::dot(s.normal, h), alpha) / n_v;
  const StretchedFacets facets = facets_of(s);
  return smith_g1(facets, v) * ggx_d(facets, h) / n_v;
}

// The facet that takes light between l and v; its normal is on the side of v. Zero: none does.
glm::dvec3 facet_between(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  glm::dvec3 sum;
  if (glm::dot(s.normal, l) > 0)
    sum = l + v;
  else if (s.glass->body)
    sum = (v + s.eta * l) * (s.eta > 1 ? -1.0 : 1.0);
  else
    sum = l - 2 * glm::dot(s.normal, l) * s.normal + v;
  const double length = glm::length(sum);
  if (!(length > 0)) return glm::dvec3(0);
  const glm::dvec3 h = sum / length;
  const bool bends = glm::dot(s.normal, l) < 0 && s.glass->body;
  if (!(glm::dot(s.normal, h) > 0) || !(glm::dot(v, h) > 0) || (bends && !(glm::dot(l, h) < 0))) return glm::dvec3(0);
  return h;
}

// Solid angle of facets over that of the directions to which they refract.
double facets_per_direction(const Surface& s, glm::dvec3 l, glm::dvec3 v, glm::dvec3 h) {
  const double l_h = std::abs(glm::dot(l, h)), sum = glm::dot(v, h) - s.eta * l_h;
  return s.eta * s.eta * l_h / (sum * sum);
}

// How often each kind of lobe is chosen: a function of the viewer's direction alone.
struct Choices {
  double diffuse = 0, straight = 0, facets = 0;
  double behind = 0;  // of diffuse light, that from the other side
};
Choices choices_of(const Surface& s, double n_v) {
  const Shares shares = shares_at(s, n_v);
  Choices c;
  const double behind = luminance(shares.behind);
  c.diffuse = luminance(shares.diffuse) + behind;
  if (transmits_diffusely(s)) c.behind = c.diffuse > 0 ? std::clamp(behind / c.diffuse, 0.05, 0.95) : 0.5;
  c.straight = is_straight(s) ? luminance(shares.through) : 0;
  c.facets = luminance(shares.reflected) + (is_straight(s) ? 0 : luminance(shares.through));
  const double sum = c.diffuse + c.straight + c.facets;
  if (!(sum > 0)) return {};
  c.diffuse /= sum, c.straight /= sum, c.facets /= sum;
  // Facets of other angles may leave light to the base where the middle one reflects all.
  constexpr double least = 0.05;
  if (!is_smooth(s) && s.transmission < 1 && s.metallic < 1 && c.diffuse < least) {
    const double rest = (1 - least) / (c.straight + c.facets);
    c.diffuse = least, c.straight *= rest, c.facets *= rest;
  }
  return c;
}
// The part of a facet's light that it reflects, as sampling has it.
double reflected_part(const Surface& s, const Shares& shares) {
  const double r = luminance(shares.reflected), t = is_straight(s) ? 0 : luminance(shares.through);
  return r + t > 0 ? r / (r + t) : 0;
}

glm::dvec3 refracted(glm::dvec3 v, glm::dvec3 h, double eta) {
  const glm::dvec3 across = (glm::dot(v, h) * h - v) / eta;
  return glm::normalize(across - std::sqrt(std::max(1 - glm::dot(across, across), 0.0)) * h);
}

// Mirrors and windows under an interpolated normal may point to the wrong side of the triangle; then its own normal
// counts.
glm::dvec3 mirror_facet(const Surface& s, glm::dvec3 v) {
  const glm::dvec3 l = 2 * glm::dot(v, s.normal) * s.normal - v;
  return glm::dot(s.geometric, l) > 0 ? s.normal : s.geometric;
}
glm::dvec3 window_facet(const Surface& s, glm::dvec3 v) {
  return glm::dot(s.geometric, refracted(v, s.normal, s.eta)) < 0 ? s.normal : s.geometric;
}
BsdfSample mirrored(const Surface& s, glm::dvec3 v) {
  BsdfSample out;
  const glm::dvec3 h = mirror_facet(s, v);
  out.l = 2 * glm::dot(v, h) * h - v;
  return out;
}
BsdfSample window(const Surface& s, glm::dvec3 v) {
  BsdfSample out;
  out.through = true;
  if (is_straight(s)) {
    out.straight = true;
    out.l = -v;
    return out;
  }
  out.l = refracted(v, window_facet(s, v), s.eta);
  return out;
}

// On a mirror that is a window: three ways, of which one has a density.
std::optional<BsdfSample> sample_smooth(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u) {
  const double n_v = glm::dot(s.normal, v);
  const Shares shares = shares_at(s, n_v);
  const double r = luminance(shares.reflected), t = luminance(shares.through),
               sum = r + t + luminance(shares.diffuse) + luminance(shares.behind);
  if (!(sum > 0)) return {};
  BsdfSample out;
  if (lobe * sum < r) {
    out = mirrored(s, v);
    out.weight = shares.reflected * (sum / r);
  } else if (lobe * sum < r + t) {
    out = window(s, v);
    out.weight = shares.through * (sum / t);
    if (s.glass->body) out.weight /= s.eta * s.eta;
  } else {
    const double rest = std::clamp((lobe * sum - r - t) / (sum - r - t), 0.0, 1.0);
    out.through = rest < choices_of(s, n_v).behind;
    out.l = cosine_direction(out.through ? -s.normal : s.normal, u);
    out.pdf = bsdf_pdf(s, out.l, v);
    if (!(out.pdf > 0) || !is_open(s, out.l)) return {};
    out.weight = evaluate_bsdf(s, out.l, v) / out.pdf;
  }
  return out;
}

std::optional<BsdfSample> sample_rough(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u) {
  const double n_v = glm::dot(s.normal, v);
  const Choices choices = choices_of(s, n_v);
  if (!(choices.diffuse + choices.straight + choices.facets > 0)) return {};
  BsdfSample out;
  if (lobe < choices.straight) {
    out = window(s, v);
    out.weight = shares_at(s, n_v).through / choices.straight;
    return out;
  }
  if (lobe < choices.straight + choices.diffuse) {
    out.through = lobe - choices.straight < choices.diffuse * choices.behind;
    out.l = cosine_direction(out.through ? -s.normal : s.normal, u);
  } else {
    const double rest = (lobe - choices.straight - choices.diffuse) / choices.facets;
    const glm::dvec3 h =
        is_stretched(s) ? visible_normal(facets_of(s), v, u) : visible_normal(s.normal, v, alpha_of(s), u);
    const double v_h = glm::dot(v, h);
    if (!(v_h > 0)) return {};
    if (rest < reflected_part(s, shares_at(s, v_h))) {
      out.l = 2 * v_h * h - v;
      if (!(glm::dot(s.normal, out.l) > 0)) return {};
    } else {
      out.through = true;
      if (s.glass->body) {
        out.l = refracted(v, h, s.eta);
      } else {
        const glm::dvec3 l = 2 * v_h * h - v;
        out.l = l - 2 * glm::dot(s.normal, l) * s.normal;
      }
      if (!(glm::dot(s.normal, out.l) < 0)) return {};
    }
    out.l = glm::normalize(out.l);
  }
  out.pdf = bsdf_pdf(s, out.l, v);
  if (!(out.pdf > 0) || !is_open(s, out.l)) return {};
  out.weight = evaluate_bsdf(s, out.l, v) / out.pdf;
  return out;
}

// Light from behind that the base scatters. Inside a body it has the radiance of the body's medium.
glm::dvec3 diffuse_from_behind(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const double n_l = glm::dot(s.normal, l);
  if (!(n_l < 0) || !transmits_diffusely(s)) return glm::dvec3(0);
  const glm::dvec3 h = glm::normalize(l - 2 * n_l * s.normal + v);
  return shares_at(s, glm::dot(v, h)).behind * (-n_l / pi / (s.glass->body ? s.eta * s.eta : 1.0));
}

// f(l, v) |n.l| and the density of what lies under layers.
glm::dvec3 evaluate_glass(const Surface& s, glm::dvec3 l, glm::dvec3 v, bool punctual) {
  const double n_l = glm::dot(s.normal, l), n_v = glm::dot(s.normal, v);
  if (n_l == 0 || !(n_v > 0)) return glm::dvec3(0);
  const glm::dvec3 behind = diffuse_from_behind(s, l, v);
  if (n_l < 0 && (is_smooth(s) || is_straight(s))) return behind;
  const glm::dvec3 h = facet_between(s, l, v);
  if (h == glm::dvec3(0)) return behind;
  const double v_h = glm::dot(v, h);
  const Shares shares = shares_at(s, v_h);
  // D and G over 4 (n.l) (n.v), times n.l.
  const double facets = facets_lit(s, l, v, h) * std::abs(n_l);
  if (n_l > 0)
    return shares.diffuse * (n_l / pi) + (punctual || !is_smooth(s) ? shares.reflected * facets : glm::dvec3(0));
  if (!s.glass->body) return shares.through * facets + behind;
  return shares.through * (4 * facets * v_h * facets_per_direction(s, l, v, h) / (s.eta * s.eta)) + behind;
}

double glass_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const double n_l = glm::dot(s.normal, l), n_v = glm::dot(s.normal, v);
  if (n_l == 0 || !(n_v > 0)) return 0;
  const Choices choices = choices_of(s, n_v);
  const double diffuse = choices.diffuse * (n_l > 0 ? 1 - choices.behind : choices.behind) * std::abs(n_l) / pi;
  if (is_smooth(s) || (n_l < 0 && is_straight(s))) return diffuse;
  const glm::dvec3 h = facet_between(s, l, v);
  if (h == glm::dvec3(0)) return diffuse;
  const double v_h = glm::dot(v, h), visible = facets_seen(s, v, h);  // D_v over v.h
  const double part = reflected_part(s, shares_at(s, v_h));
  if (n_l > 0) return diffuse + choices.facets * part * visible / 4;
  return diffuse +
         choices.facets * (1 - part) * visible * (s.glass->body ? v_h * facets_per_direction(s, l, v, h) : 0.25);
}

std::optional<BsdfSample> sample_layered(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u) {
  const LayerChoices layers = layer_choices(s, v);
  if (lobe >= layers.coat + layers.sheen) {
    const double rest = std::min((lobe - layers.coat - layers.sheen) / layers.under, 1 - 0x1p-53);
    std::optional<BsdfSample> out = is_smooth(s) ? sample_smooth(s, v, rest, u) : sample_rough(s, v, rest, u);
    if (out && !(out->pdf > 0)) out->weight *= share_under(s, out->l, v) / layers.under;
    return out;
  }
  BsdfSample out;
  out.l = lobe < layers.coat ? sample_coat(s, v, u) : cosine_direction(s.normal, u);
  out.pdf = bsdf_pdf(s, out.l, v);
  if (!(out.pdf > 0) || !is_open(s, out.l)) return {};
  out.through = glm::dot(s.normal, out.l) < 0;
  out.weight = evaluate_bsdf(s, out.l, v) / out.pdf;
  return out;
}

}  // namespace

double index_of_refraction(const Glass& glass, int channel) {
  if (glass.ior == 0) return 1;
  if (channel < 0) return glass.ior;
  return std::max(glass.ior + (channel - 1) * (glass.ior - 1) * 0.025 * glass.dispersion, 1.0);
}

double fresnel(double cosine, double eta) {
  const double sin2 = (1 - cosine * cosine) / (eta * eta);
  if (sin2 >= 1) return 1;
  const double behind = std::sqrt(1 - sin2);
  const double s = (cosine - eta * behind) / (cosine + eta * behind),
               p = (eta * cosine - behind) / (eta * cosine + behind);
  return (s * s + p * p) / 2;
}

bool is_straight(const Surface& s) {
  return s.glass && (s.glass->body ? std::abs(s.eta - 1) < same_index : is_smooth(s));
}

glm::dvec3 straight_share(const Surface& s, glm::dvec3 v) {
  if (!is_straight(s)) return glm::dvec3(0);
  const glm::dvec3 through = shares_at(s, glm::dot(s.normal, v)).through;
  return s.lobes ? through * share_under(s, -v, v) : through;
}

std::optional<Bend> bent(const Surface& s, glm::dvec3 v) {
  if (!s.glass || !s.glass->body || !(is_smooth(s) || is_straight(s)) || !(glm::dot(s.normal, v) > 0)) return {};
  const Shares shares = shares_at(s, glm::dot(s.normal, v));
  const bool total = s.glass->ior != 0 && fresnel(glm::dot(s.normal, v), s.eta) >= 1;
  const BsdfSample way = total ? mirrored(s, v) : window(s, v);
  Bend out{way.l, total ? shares.reflected : shares.through / (s.eta * s.eta),
           total ? mirror_facet(s, v) : window_facet(s, v), !total};
  if (s.lobes) out.weight *= share_under(s, out.l, v);
  return out;
}

bool is_open(const Surface& s, glm::dvec3 l) {
  const double geometric = glm::dot(s.geometric, l);
  if (!s.glass && !transmits_diffusely(s)) return geometric > 0;
  return geometric * glm::dot(s.normal, l) > 0;
}

glm::dvec3 evaluate_bsdf(const Surface& s, glm::dvec3 l, glm::dvec3 v, bool punctual) {
  if (!s.glass) return evaluate_brdf(s, l, v);
  const glm::dvec3 under = evaluate_glass(s, l, v, punctual);
  return s.lobes ? evaluate_layers(s, l, v) + share_under(s, l, v) * under : under;
}

glm::dvec3 diffuse_share(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const glm::dvec3 all = evaluate_bsdf(s, l, v);
  if (all == glm::dvec3(0)) return all;
  glm::dvec3 diffuse(0);
  if (!s.glass) {
    diffuse = diffuse_brdf(s, l, v);
  } else {
    const double n_l = glm::dot(s.normal, l);
    if (n_l > 0) diffuse = shares_at(s, glm::dot(v, facet_between(s, l, v))).diffuse * (n_l / pi);
    if (n_l < 0) diffuse = diffuse_from_behind(s, l, v);
    if (s.lobes) diffuse *= share_under(s, l, v);
  }
  for (int c = 0; c < 3; ++c) diffuse[c] = all[c] > 0 ? std::min(diffuse[c] / all[c], 1.0) : 0;
  return diffuse;
}

double bsdf_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  if (!s.glass) return brdf_pdf(s, l, v);
  if (!s.lobes) return glass_pdf(s, l, v);
  const LayerChoices layers = layer_choices(s, v);
  return layers_pdf(s, layers, l, v) + layers.under * glass_pdf(s, l, v);
}

std::optional<BsdfSample> sample_bsdf(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u) {
  if (s.glass) {
    if (!(glm::dot(s.normal, v) > 0)) return {};
    if (s.lobes) return sample_layered(s, v, lobe, u);
    return is_smooth(s) ? sample_smooth(s, v, lobe, u) : sample_rough(s, v, lobe, u);
  }
  BsdfSample out;
  out.l = sample_brdf(s, v, lobe, u);
  out.pdf = brdf_pdf(s, out.l, v);
  if (!(out.pdf > 0) || !is_open(s, out.l)) return {};
  out.weight = evaluate_brdf(s, out.l, v) / out.pdf;
  out.through = glm::dot(s.geometric, out.l) < 0;
  return out;
}

}  // namespace candela::reference
