#include "reference/display.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace candela::reference {
namespace {

glm::dvec3 each(glm::dvec3 c, double (*f)(double)) { return {f(c.x), f(c.y), f(c.z)}; }

double srgb_encoded(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

// ITU-R BT.709-6, item 1.2.
double rec709_encoded(double c) { return c < 0.018 ? 4.5 * c : 1.099 * std::pow(c, 0.45) - 0.099; }

// ACES RRT and ODT as fit by Stephen Hill, input over 0.6.
glm::dvec3 aces(glm::dvec3 c) {
  const glm::dmat3 in =
      glm::transpose(glm::dmat3(0.59719, 0.35458, 0.04823, 0.07600, 0.90834, 0.01566, 0.02840, 0.13383, 0.83777));
  const glm::dmat3 out =
      glm::transpose(glm::dmat3(1.60475, -0.53108, -0.07367, -0.10208, 1.10813, -0.00605, -0.00327, -0.07276, 1.07602));
  return out * each(in * (c / 0.6), [](double v) {
           v = std::min(v, 1e6);
           return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
         });
}

// Khronos PBR Neutral: what 4 % reflection adds is taken off, then everything above 0.76 is compressed and loses
// saturation.
glm::dvec3 neutral(glm::dvec3 c) {
  const double least = std::min({c.x, c.y, c.z});
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  const double peak = std::max({c.x, c.y, c.z}), start = 0.76;
  if (peak < start) return c;
  const double compressed = 1 - (1 - start) * (1 - start) / (peak + 1 - 2 * start);
  const double keep = 1 / (0.15 * (peak - compressed) + 1);
  return glm::mix(glm::dvec3(compressed), c * (compressed / peak), keep);
}

// AgX (Troy Sobotka) of the Rec.709 family: slope 2 through (10/16.5, 1/2), toe power 3, shoulder power 3.25.
double agx_sigmoid(double x) {
  const double pivot = 10 / 16.5, slope = 2, power = x < pivot ? 3 : 3.25;
  const double run = x < pivot ? pivot : 1 - pivot;
  const double scale = slope * run / std::pow(std::pow(slope * run / 0.5, power) - 1, 1 / power);
  const double u = slope * std::abs(x - pivot) / scale, y = scale * u / std::pow(1 + std::pow(u, power), 1 / power);
  return x < pivot ? 0.5 - y : 0.5 + y;
}
glm::dvec3 agx_curve(glm::dvec3 c, double lowest, double highest) {
  glm::dvec3 curved;
  for (int i = 0; i < 3; ++i)
    curved[i] = agx_sigmoid(std::clamp((std::log2(std::max(c[i], 1e-10)) - lowest) / (highest - lowest), 0.0, 1.0));
  return curved;
}
glm::dvec3 agx(glm::dvec3 c, double lowest, double highest) {
  const glm::dmat3 inset(0.842479062253094, 0.0423282422610123, 0.0423756549057051, 0.0784335999999992,
                         0.878468636469772, 0.0784336, 0.0792237451477643, 0.0791661274605434, 0.879142973793104);
  const glm::dmat3 outset(1.19687900512017, -0.0528968517574562, -0.0529716355144438, -0.0980208811401368,
                          1.15190312990417, -0.0980434501171241, -0.0990297440797205, -0.0989611768448433,
                          1.15107367264116);
  const glm::dvec3 curved = agx_curve(inset * c, lowest, highest);
  return each(outset * curved, [](double v) { return std::pow(std::max(v, 0.0), 2.2); });
}

// AgX of the Rec.2020 family: the curve between primaries that are pulled in and pushed out again. Rows.
glm::dvec3 agx_2020(glm::dvec3 c, double lowest, double highest) {
  const auto rows = [](double a, double b, double c, double d, double e, double f, double g, double h, double i) {
    return glm::transpose(glm::dmat3(a, b, c, d, e, f, g, h, i));
  };
  const glm::dmat3 from_709 =
      rows(0.6274039, 0.3292830, 0.0433131, 0.0690973, 0.9195404, 0.0113623, 0.0163914, 0.0880133, 0.8955953);
  const glm::dmat3 inset =
      rows(0.856627153315983, 0.0951212405381588, 0.0482516061458583, 0.137318972929847, 0.761241990602591,
           0.101439036467562, 0.11189821299995, 0.0767994186031903, 0.811302368396859);
  const glm::dmat3 outset =
      rows(1.1271005818144368, -0.1106066430966032, -0.0164939387178346, -0.1413297634984383, 1.157823702216272,
           -0.0164939387178346, -0.1413297634984383, -0.1106066430966032, 1.2519364065950405);
  const glm::dvec3 linear = each(outset * agx_curve(inset * (from_709 * c), lowest, highest),
                                 [](double v) { return std::pow(std::max(v, 0.0), 2.2); });
  return glm::max(glm::inverse(from_709) * linear, glm::dvec3(0));
}

// The hash that the GPU dithers with (Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020).
glm::dvec3 hashed(uint32_t x, uint32_t y, uint32_t z) {
  x = x * 1664525u + 1013904223u, y = y * 1664525u + 1013904223u, z = z * 1664525u + 1013904223u;
  x += y * z, y += z * x, z += x * y;
  x ^= x >> 16, y ^= y >> 16, z ^= z >> 16;
  x += y * z, y += z * x, z += x * y;
  return glm::dvec3(x >> 8, y >> 8, z >> 8) / 16777216.0;
}

// Triangular noise two code values wide, uniform of one within half a code value of black and white, none at either.
glm::dvec3 dithered(glm::dvec3 c, uint32_t x, uint32_t y, uint32_t seed) {
  const glm::dvec3 a = hashed(x, y, seed), b = hashed(x, y, seed ^ 0x9e3779b9u);
  for (int i = 0; i < 3; ++i) {
    const double room = std::min(c[i], 1 - c[i]) * 255;
    if (room > 0) c[i] += (room < 0.5 ? a[i] - 0.5 : a[i] - b[i]) / 255;
  }
  return glm::clamp(c, 0.0, 1.0);
}

}  // namespace

glm::dvec3 tone_mapped(std::string_view curve, glm::dvec3 c, double agx_min_ev, double agx_max_ev) {
  if (curve == "agx") return agx(c, agx_min_ev, agx_max_ev);
  if (curve == "reinhard") return c / (1.0 + c);
  if (curve == "aces") return aces(c);
  if (curve == "neutral") return neutral(c);
  if (curve == "agx-2020") return agx_2020(c, agx_min_ev, agx_max_ev);
  if (curve == "reinhard-luminance") return c / (1 + glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)));
  return c;
}

glm::dvec3 display_encoded(glm::dvec3 mapped, std::string_view curve) {
  return each(glm::clamp(mapped, 0.0, 1.0), curve == "rec709" ? rec709_encoded : srgb_encoded);
}

double automatic_ev(std::span<const glm::dvec4> pixels, const AutoExposure& look) {
  std::vector<double> stops;
  for (const glm::dvec4& p : pixels) {
    const double alpha = std::clamp(p.w, 0.0, 1.0);
    const double light = glm::dot(glm::max(glm::dvec3(p), glm::dvec3(0)), glm::dvec3(0.2126, 0.7152, 0.0722));
    if (alpha > 0 && !std::isnan(light)) stops.push_back(std::log2(std::clamp(light / alpha, 0x1p-24, 0x1p24)));
  }
  std::sort(stops.begin(), stops.end());
  const double count = double(stops.size()), low = look.low_percent / 100 * count,
               high = look.high_percent / 100 * count;
  double weights = 0, sum = 0;
  for (size_t i = 0; i < stops.size(); ++i) {
    const double weight = std::max(std::min(double(i + 1), high) - std::max(double(i), low), 0.0);
    weights += weight, sum += weight * stops[i];
  }
  return weights > 0 ? std::clamp(std::log2(look.target) - sum / weights, look.min_ev, look.max_ev) : 0;
}

DisplayImage display_image(const Film& film, const DisplaySettings& settings) {
  std::vector<glm::dvec4> pixels(film.pixels());
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = film.mean(i);
  return display_image(pixels, film.width(), settings);
}

DisplayImage display_image(std::span<const glm::dvec4> pixels, int width, const DisplaySettings& settings) {
  DisplayImage image;
  image.width = width, image.height = int(pixels.size() / size_t(width));
  image.channels = settings.alpha ? 4 : 3;
  image.bits = settings.bits;
  const size_t each_bytes = size_t(settings.bits) / 8;
  image.pixels.resize(pixels.size() * size_t(image.channels) * each_bytes);
  const double exposure = std::exp2(settings.exposure_ev);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const glm::dvec4 source = pixels[i];
    const double alpha = std::clamp(source.w, 0.0, 1.0);
    glm::dvec3 c = glm::max(glm::dvec3(source), glm::dvec3(0)) * exposure;
    c = glm::min(alpha > 0 ? c / alpha : c, glm::dvec3(1e30));
    c = display_encoded(tone_mapped(settings.curve, c, settings.agx_min_ev, settings.agx_max_ev), settings.curve);
    if (settings.dither && settings.bits == 8)
      c = dithered(c, uint32_t(i % size_t(width)) + uint32_t(settings.corner_px.x),
                   uint32_t(i / size_t(width)) + uint32_t(settings.corner_px.y), settings.seed);
    if (settings.behind_rgb) {
      const uint32_t rgb = *settings.behind_rgb;
      c = glm::mix(glm::dvec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255.0, c, alpha);
    }
    const double values[4] = {c.x, c.y, c.z, alpha};
    for (int k = 0; k < image.channels; ++k) {
      std::byte* at = image.pixels.data() + (i * size_t(image.channels) + size_t(k)) * each_bytes;
      const double code =
          std::isfinite(values[k]) ? std::floor(values[k] * (settings.bits == 8 ? 255 : 65535) + 0.5) : 0;
      if (settings.bits == 8) {
        *at = std::byte(uint8_t(code));
      } else {
        const uint16_t wide = uint16_t(code);
        std::memcpy(at, &wide, 2);
      }
    }
  }
  return image;
}

}  // namespace candela::reference
