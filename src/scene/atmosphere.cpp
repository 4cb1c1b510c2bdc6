#include "scene/atmosphere.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace candela {
namespace {

using std::numbers::pi;
constexpr double ground_m = 6'360'000, top_m = 6'460'000, thickness_m = top_m - ground_m;
// Per metre at sea level (Hillaire 2020, table 1).
constexpr glm::dvec3 molecules(5.802e-6, 13.558e-6, 33.1e-6), ozone_absorption(0.650e-6, 1.881e-6, 0.085e-6);
constexpr double aerosol_scattering = 3.996e-6, aerosol_absorption = 0.444e-6;
constexpr double molecule_scale_m = 8000, aerosol_scale_m = 1200, ozone_middle_m = 25'000, ozone_half_m = 15'000;
constexpr double aerosol_g = 0.8;
constexpr double sun_radius_rad = 0.00465;

constexpr int t_columns = 256, t_rows = 64;  // transmittance: direction, height
constexpr int h_columns = 64, h_rows = 32;   // higher orders: the sun's elevation, height
constexpr int g_columns = 64;                // light of the sky on the ground

double rayleigh_phase(double c) { return 3 / (16 * pi) * (1 + c * c); }
// Cornette and Shanks, "Physically Reasonable Analytic Expression for the Single-Scattering Phase Function", 1992.
double aerosol_phase(double c) {
  constexpr double g = aerosol_g, g2 = g * g;
  return 3 / (8 * pi) * (1 - g2) * (1 + c * c) / ((2 + g2) * std::pow(1 + g2 - 2 * g * c, 1.5));
}

// Along a ray from a radius, sine of its elevation there: to the top of the air, and to the ground, below 0 where it
// does not meet it.
double to_top(double radius, double sine) {
  return std::max(-radius * sine + std::sqrt(std::max(radius * radius * (sine * sine - 1) + top_m * top_m, 0.0)), 0.0);
}
double to_ground(double radius, double sine) {
  const double inside = radius * radius * (sine * sine - 1) + ground_m * ground_m;
  if (!(sine < 0) || inside < 0) return -1;
  return std::max(-radius * sine - std::sqrt(inside), 0.0);
}

// Linear between the nodes of a table; x and y from 0 to 1.
glm::dvec3 between_nodes(const std::vector<glm::vec3>& table, int columns, int rows, double x, double y) {
  const double u = std::clamp(x, 0.0, 1.0) * (columns - 1), v = std::clamp(y, 0.0, 1.0) * (rows - 1);
  const int i = std::min(int(u), columns - 2), j = rows > 1 ? std::min(int(v), rows - 2) : 0;
  const double fu = u - i, fv = v - j;
  const auto node = [&](int a, int b) { return glm::dvec3(table[size_t(b) * size_t(columns) + size_t(a)]); };
  const glm::dvec3 low = glm::mix(node(i, j), node(i + 1, j), fu);
  return rows > 1 ? glm::mix(low, glm::mix(node(i, j + 1), node(i + 1, j + 1), fu), fv) : low;
}

// Nodes lie close where the sun is at the horizon.
double place_of_sine(double sine) { return 0.5 + 0.5 * std::copysign(std::sqrt(std::abs(sine)), sine); }
double sine_of_place(double x) { return std::copysign((2 * x - 1) * (2 * x - 1), 2 * x - 1); }

glm::dvec3 sun_direction(double sine) { return {std::sqrt(std::max(1 - sine * sine, 0.0)), sine, 0}; }

glm::dvec3 spread_direction(int i, int count) {  // Fibonacci's lattice
  const double y = 1 - 2 * (i + 0.5) / count, across = std::sqrt(1 - y * y), phi = pi * (3 - std::sqrt(5.0)) * i;
  return {across * std::cos(phi), y, across * std::sin(phi)};
}

}  // namespace

struct Air::Medium {
  glm::dvec3 molecules{0};
  double aerosols = 0;  // scattering
  glm::dvec3 extinction{0};
};

Air::Air(const Atmosphere& atmosphere) : atmosphere_(atmosphere) {
  make_transmittance();
  make_higher_orders();
  make_ground_light();
}

Air::Medium Air::medium(double height_m) const {
  Medium m;
  const double aerosols = atmosphere_.haze * std::exp(-height_m / aerosol_scale_m);
  m.molecules = std::exp(-height_m / molecule_scale_m) * molecules;
  m.aerosols = aerosols * aerosol_scattering;
  const double ozone = atmosphere_.ozone * std::max(1 - std::abs(height_m - ozone_middle_m) / ozone_half_m, 0.0);
  m.extinction = m.molecules + m.aerosols + aerosols * aerosol_absorption + ozone * ozone_absorption;
  return m;
}

// Bruneton's parameters: the distance to the top between its least and its most, and the distance to the horizon.
void Air::make_transmittance() {
  transmittance_.resize(size_t(t_columns) * t_rows);
  const double horizon = std::sqrt(top_m * top_m - ground_m * ground_m);
  tbb::parallel_for(0, t_rows, [&](int row) {
    const double rho = horizon * row / (t_rows - 1), radius = std::sqrt(rho * rho + ground_m * ground_m);
    for (int column = 0; column < t_columns; ++column) {
      const double least = top_m - radius, most = rho + horizon;
      const double d = least + (most - least) * column / (t_columns - 1);
      const double sine =
          d > 0 ? std::clamp((horizon * horizon - rho * rho - d * d) / (2 * radius * d), -1.0, 1.0) : 1.0;
      constexpr int steps = 80;
      glm::dvec3 depth(0);
      for (int i = 0; i < steps; ++i) {
        const double t = d * (i + 0.5) / steps;
        const double r = std::sqrt(radius * radius + t * t + 2 * radius * t * sine);
        depth += medium(std::max(r - ground_m, 0.0)).extinction * (d / steps);
      }
      transmittance_[size_t(row) * t_columns + size_t(column)] = glm::vec3(glm::exp(-depth));
    }
  });
}

glm::dvec3 Air::transmittance(double height_m, double sine) const {
  const double radius = ground_m + std::clamp(height_m, 0.0, thickness_m);
  const double horizon = std::sqrt(top_m * top_m - ground_m * ground_m);
  const double rho = std::sqrt(std::max(radius * radius - ground_m * ground_m, 0.0));
  const double least = top_m - radius, most = rho + horizon;
  return between_nodes(transmittance_, t_columns, t_rows, (to_top(radius, sine) - least) / (most - least),
                       rho / horizon);
}

// Light of the sun; its disc sets over its own width.
glm::dvec3 Air::sun_at(double radius_m, double sine) const {
  const double horizon_sine = -std::sqrt(std::max(1 - ground_m * ground_m / (radius_m * radius_m), 0.0));
  const double up = std::clamp((sine - horizon_sine) / (2 * sun_radius_rad) + 0.5, 0.0, 1.0);
  if (!(up > 0)) return glm::dvec3(0);
  return up * up * (3 - 2 * up) * transmittance(radius_m - ground_m, std::max(sine, horizon_sine));
}

glm::dvec3 Air::higher_orders(double radius_m, double sine) const {
  return between_nodes(higher_, h_columns, h_rows, place_of_sine(sine),
                       std::sqrt(std::clamp((radius_m - ground_m) / thickness_m, 0.0, 1.0)));
}

// from: relative to the middle of the Earth. Each step's light is integrated under its own extinction in closed form.
Air::Scattered Air::follow(glm::dvec3 from, glm::dvec3 direction, glm::dvec3 to_sun, int steps, Orders orders) const {
  const double radius = glm::length(from), sine = glm::dot(from, direction) / radius;
  const double ground = to_ground(radius, sine), end = ground >= 0 ? ground : to_top(radius, sine);
  const bool all = orders == Orders::all;
  const double c = glm::dot(direction, to_sun);
  const double of_molecules = all ? rayleigh_phase(c) : 1 / (4 * pi),
               of_aerosols = all ? aerosol_phase(c) : 1 / (4 * pi);
  Scattered out;
  double before = 0;
  for (int i = 0; i < steps; ++i) {
    // Close by, where the air is dense, steps are short.
    const double fraction = double(i + 1) / steps, until = end * fraction * fraction, length = until - before;
    const glm::dvec3 at = from + (0.5 * (before + until)) * direction;
    before = until;
    const double r = std::max(glm::length(at), ground_m), sun_sine = glm::dot(at, to_sun) / r;
    const Medium m = medium(r - ground_m);
    const glm::dvec3 scattering = m.molecules + m.aerosols;
    glm::dvec3 source = (of_molecules * m.molecules + of_aerosols * m.aerosols) * sun_at(r, sun_sine);
    if (all) source += scattering * higher_orders(r, sun_sine);
    const glm::dvec3 kept = glm::exp(-length * m.extinction);
    glm::dvec3 weight;  // of the source: the integral of the transmittance
    for (int k = 0; k < 3; ++k) weight[k] = m.extinction[k] > 1e-20 ? (1 - kept[k]) / m.extinction[k] : length;
    out.light += out.through * source * weight;
    out.isotropic += out.through * scattering * weight;
    out.through *= kept;
  }
  if (ground >= 0 && atmosphere_.ground_albedo > 0) {
    const glm::dvec3 at = from + ground * direction;
    const double sun_sine = glm::dot(at, to_sun) / glm::length(at);
    glm::dvec3 light = std::max(sun_sine, 0.0) * sun_at(ground_m, sun_sine);
    if (all) light += between_nodes(ground_, g_columns, 1, place_of_sine(sun_sine), 0);
    out.light += out.through * light * (atmosphere_.ground_albedo / pi);
  }
  return out;
}

// Light that was scattered once comes from all sides alike, and each further order is the same fraction of the one
// before.
void Air::make_higher_orders() {
  higher_.resize(size_t(h_columns) * h_rows);
  tbb::parallel_for(0, h_rows, [&](int row) {
    const double height = thickness_m * std::pow(double(row) / (h_rows - 1), 2);
    const glm::dvec3 at(0, ground_m + std::clamp(height, 1.0, thickness_m - 1), 0);
    for (int column = 0; column < h_columns; ++column) {
      const glm::dvec3 to_sun = sun_direction(sine_of_place(double(column) / (h_columns - 1)));
      constexpr int directions = 64;
      glm::dvec3 light(0), again(0);
      for (int i = 0; i < directions; ++i) {
        const Scattered s = follow(at, spread_direction(i, directions), to_sun, 24, Orders::single_isotropic);
        light += s.light / double(directions), again += s.isotropic / double(directions);
      }
      higher_[size_t(row) * h_columns + size_t(column)] = glm::vec3(light / (1.0 - glm::min(again, glm::dvec3(0.99))));
    }
  });
}

void Air::make_ground_light() {
  ground_.assign(g_columns, glm::vec3(0));
  std::vector<glm::vec3> table(g_columns);
  tbb::parallel_for(0, g_columns, [&](int column) {
    const glm::dvec3 to_sun = sun_direction(sine_of_place(double(column) / (g_columns - 1)));
    constexpr int directions = 128;
    glm::dvec3 sum(0);
    for (int i = 0; i < directions / 2; ++i) {  // the upper half of the lattice
      const glm::dvec3 d = spread_direction(i, directions);
      sum += d.y * follow({0, ground_m + 1, 0}, d, to_sun, 32, Orders::all).light * (4 * pi / directions);
    }
    table[size_t(column)] = glm::vec3(sum);
  });
  ground_ = table;
}

glm::dvec3 Air::radiance(glm::dvec3 direction, glm::dvec3 to_sun) const {
  const double height = std::clamp(atmosphere_.altitude_m, 1.0, thickness_m - 1);
  return follow({0, ground_m + height, 0}, glm::normalize(direction), glm::normalize(to_sun), 48, Orders::all).light;
}

DecodedImage Air::image(glm::dvec3 to_sun, int width, int height) const {
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 3, {}};
  image.pixels.resize(size_t(width) * size_t(height) * 16);
  // A sun above the image's middle column leaves both halves alike.
  const bool mirrored = to_sun.z == 0 && to_sun.x >= 0 && width % 2 == 0;
  tbb::parallel_for(0, height, [&](int y) {
    const double polar = pi * (y + 0.5) / height;
    for (int x = mirrored ? width / 2 : 0; x < width; ++x) {
      const double longitude = ((x + 0.5) / width - 0.5) * 2 * pi;
      const glm::dvec3 d(std::sin(polar) * std::cos(longitude), std::cos(polar), std::sin(polar) * std::sin(longitude));
      const glm::vec4 texel(glm::vec3(radiance(d, to_sun)), 1);
      const auto put = [&](int at) {
        std::memcpy(image.pixels.data() + (size_t(y) * size_t(width) + size_t(at)) * 16, &texel, 16);
      };
      put(x);
      if (mirrored) put(width - 1 - x);
    }
  });
  return image;
}

}  // namespace candela
