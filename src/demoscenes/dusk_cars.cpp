#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/dusk.h"

// Cars as two lofted shells, the body and the glass on it, with wheels, lamps, plates and mirrors.
namespace candela::dusk {
namespace {

using std::numbers::pi;

// A section across the car at z: half width, sill, shoulder and top of the body.
struct Section {
  double z, half, sill, shoulder, top;
};
// The outline of the glass: from the front pillar's foot over the roof to the rear one's.
struct Cabin {
  double foot_front, roof_front, roof_back, foot_back, base, height, half_base, half_roof;
};
struct Profile {
  std::array<Section, 10> body;
  Cabin cabin;
  double front_axle, back_axle, wheel;
};

constexpr Profile saloon_profile{{{{-2.2, 0.6, 0.32, 0.5, 0.54},
                                   {-2.13, 0.76, 0.22, 0.58, 0.64},
                                   {-1.9, 0.84, 0.19, 0.66, 0.74},
                                   {-1.35, 0.88, 0.18, 0.76, 0.84},
                                   {-0.8, 0.89, 0.18, 0.83, 0.92},
                                   {0.1, 0.9, 0.18, 0.86, 0.93},
                                   {1.1, 0.9, 0.18, 0.88, 0.95},
                                   {1.75, 0.87, 0.19, 0.89, 0.98},
                                   {2.15, 0.8, 0.22, 0.85, 0.95},
                                   {2.24, 0.68, 0.32, 0.74, 0.82}}},
                                 {-0.95, -0.2, 0.95, 1.72, 0.9, 1.43, 0.79, 0.59},
                                 -1.36,
                                 1.36,
                                 0.32};
constexpr Profile hatchback_profile{{{{-1.95, 0.6, 0.32, 0.52, 0.56},
                                      {-1.88, 0.75, 0.22, 0.62, 0.68},
                                      {-1.65, 0.82, 0.19, 0.72, 0.8},
                                      {-1.2, 0.86, 0.18, 0.82, 0.9},
                                      {-0.75, 0.87, 0.18, 0.88, 0.97},
                                      {0.1, 0.88, 0.18, 0.9, 0.98},
                                      {0.9, 0.88, 0.18, 0.93, 1.0},
                                      {1.5, 0.86, 0.19, 0.95, 1.02},
                                      {1.85, 0.82, 0.22, 0.94, 1.0},
                                      {1.94, 0.72, 0.32, 0.84, 0.9}}},
                                    {-0.98, -0.25, 1.3, 1.82, 0.95, 1.53, 0.78, 0.6},
                                    -1.22,
                                    1.24,
                                    0.31};
constexpr Profile van_profile{{{{-2.4, 0.7, 0.34, 0.6, 0.66},
                                {-2.33, 0.85, 0.24, 0.74, 0.82},
                                {-2.1, 0.92, 0.2, 0.9, 1.0},
                                {-1.75, 0.95, 0.2, 1.02, 1.12},
                                {-1.4, 0.96, 0.2, 1.08, 1.18},
                                {0.0, 0.97, 0.2, 1.1, 1.2},
                                {1.2, 0.97, 0.2, 1.1, 1.2},
                                {2.0, 0.97, 0.2, 1.1, 1.2},
                                {2.42, 0.95, 0.22, 1.08, 1.18},
                                {2.5, 0.88, 0.34, 1.0, 1.1}}},
                              {-1.8, -1.15, 2.2, 2.44, 1.14, 2.15, 0.9, 0.8},
                              -1.55,
                              1.5,
                              0.35};

const Profile& profile_of(CarKind kind) {
  return kind == hatchback ? hatchback_profile : kind == van ? van_profile : saloon_profile;
}

void add_body(MeshKit& kit, const Paint& paint, const Profile& p) {
  std::vector<glm::dvec3> points;
  constexpr size_t columns = 13;
  const auto row = [&](const Section& s, double shrink) {
    const double w = s.half, mid = (s.sill + s.shoulder) / 2;
    // From the right sill over the top to the left one, seen from the front: with rows towards +Z this turns outwards.
    const std::array<glm::dvec2, columns> outline{{{0.86 * w, s.sill},
                                                   {0.97 * w, s.sill + 0.06},
                                                   {w, mid},
                                                   {0.985 * w, s.shoulder - 0.03},
                                                   {0.93 * w, s.shoulder + 0.03},
                                                   {0.6 * w, s.top},
                                                   {0, s.top + 0.025},
                                                   {-0.6 * w, s.top},
                                                   {-0.93 * w, s.shoulder + 0.03},
                                                   {-0.985 * w, s.shoulder - 0.03},
                                                   {-w, mid},
                                                   {-0.97 * w, s.sill + 0.06},
                                                   {-0.86 * w, s.sill}}};
    for (glm::dvec2 o : outline)
      points.emplace_back(o.x * shrink, mid + (o.y - mid) * shrink, s.z + (shrink < 1 ? (s.z < 0 ? -0.02 : 0.02) : 0));
  };
  row(p.body.front(), 0);
  for (const Section& s : p.body) row(s, 1);
  row(p.body.back(), 0);
  kit.surface(paint, points, columns, false);
}

// Rings at the glass's foot, half way, and at the roof's edge; the roof lies on the last one.
void add_cabin(MeshKit& kit, const Materials& m, const Paint& paint, const Cabin& c, bool closed_sides) {
  constexpr size_t columns = 16;
  const auto ring = [&](double t, double grow) {
    const double front = c.foot_front + (c.roof_front - c.foot_front) * t - grow;
    const double back = c.foot_back + (c.roof_back - c.foot_back) * t + grow;
    const double half = c.half_base + (c.half_roof - c.half_base) * std::pow(std::max(t, 0.0), 1.3) + grow;
    const double middle = (front + back) / 2, reach = (back - front) / 2;
    std::vector<glm::dvec3> points;
    for (size_t i = 0; i < columns; ++i) {
      const double angle = 2 * pi * (double(i) + 0.5) / columns;
      const double x = std::cos(angle), z = -std::sin(angle), power = 0.38;
      points.emplace_back(half * std::copysign(std::pow(std::abs(x), power), x), c.base + (c.height - c.base) * t,
                          middle + reach * std::copysign(std::pow(std::abs(z), power), z));
    }
    return points;
  };
  std::vector<glm::dvec3> glass, roof;
  const auto append = [](std::vector<glm::dvec3>& to, const std::vector<glm::dvec3>& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  for (double t : {-0.12, 0.45, 0.9}) append(glass, ring(t, 0));
  kit.surface(closed_sides ? paint : m.glass.tinted(glm::dvec3(0.02, 0.023, 0.026)), glass, columns, true);
  append(roof, ring(0.88, 0.006));
  append(roof, ring(0.97, -0.01));
  append(roof, ring(1.02, -0.12));
  append(roof,
         std::vector<glm::dvec3>(columns, {0, c.base + (c.height - c.base) * 1.06, (c.roof_front + c.roof_back) / 2}));
  kit.surface(paint, roof, columns, true);
  // Pillars over the glass.
  const auto pillar = [&](double z_foot, double z_roof, double x_scale, double wide) {
    for (double side : {-1.0, 1.0})
      kit.tube(paint, {side * c.half_base * x_scale, c.base - 0.02, z_foot}, wide,
               {side * c.half_roof * x_scale, c.base + (c.height - c.base) * 0.95, z_roof}, wide * 0.8, 5);
  };
  if (closed_sides) return;
  pillar(c.foot_front + 0.1, c.roof_front + 0.03, 0.955, 0.045);
  const double middle = (c.roof_front + c.roof_back) / 2;
  pillar(middle + 0.05, middle, 1.0, 0.045);
  pillar(c.foot_back - 0.18, c.roof_back - 0.05, 0.95, 0.07);
}

const glm::dvec3 tyre_color(0.015);

// The arch is a dark disc that stands out from the body by a hair.
void add_arch(MeshKit& kit, const Materials& m, double x, double z, double radius) {
  const double out = x < 0 ? -1 : 1;
  kit.tube(m.matte.tinted(tyre_color * 0.4), {x - out * 0.02, radius + 0.03, z}, radius + 0.07,
           {x + out * 0.012, radius + 0.03, z}, radius + 0.05, 18, true);
}

void add_wheel(MeshKit& kit, const Materials& m, double x, double y, double z, double radius) {
  const Paint tyre = m.matte.tinted(tyre_color), rim = m.chrome.tinted(glm::dvec3(0.5));
  const double out = x < 0 ? -1 : 1;
  kit.tube(tyre, {x - out * 0.1, y, z}, radius, {x + out * 0.03, y, z}, radius * 0.97, 18, true);
  kit.tube(rim, {x, y, z}, radius * 0.66, {x + out * 0.036, y, z}, radius * 0.62, 14, true);
  kit.tube(tyre, {x, y, z}, radius * 0.5, {x + out * 0.038, y, z}, radius * 0.5, 12, true);
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * pi * i / 5;
    const glm::dvec3 way(0, std::cos(angle), std::sin(angle)), centre(x + out * 0.036, y, z);
    kit.tube(rim, centre, 0.045, centre + way * radius * 0.58, 0.03, 5);
  }
}

}  // namespace

int make_wheel(GlbWriter& out, const Materials& m, double radius) {
  MeshKit kit;
  add_wheel(kit, m, 0, 0, 0, radius);
  return kit.write(out, "wheel");
}

Car make_car(GlbWriter& out, const Materials& m, CarKind kind, glm::dvec3 color, bool lit, bool with_wheels) {
  const Profile& p = profile_of(kind);
  const Paint paint = m.car_paint.tinted(color), dark = m.matte.tinted(glm::dvec3(0.02));
  MeshKit kit;
  add_body(kit, paint, p);
  add_cabin(kit, m, paint, p.cabin, false);
  if (kind == van) {  // closed behind the doors
    Cabin cargo = p.cabin;
    cargo.foot_front = cargo.roof_front = -0.35;
    cargo.half_base += 0.03, cargo.half_roof += 0.03, cargo.foot_back += 0.02, cargo.roof_back += 0.03;
    add_cabin(kit, m, paint, cargo, true);
  }
  const double side = p.body[4].half + 0.005;
  for (double x : {-side, side})
    for (double z : {p.front_axle, p.back_axle}) {
      add_arch(kit, m, x, z, p.wheel);
      if (with_wheels) add_wheel(kit, m, x, p.wheel, z, p.wheel);
    }
  const Section &front = p.body[1], &back = p.body[8];
  Car car{0,           0.56, front.shoulder - 0.02, p.body[0].z, 0.6,    back.shoulder - 0.1,
          p.body[9].z, side, p.front_axle,          p.back_axle, p.wheel};
  if (kind == van) car.head_x = car.tail_x = 0.7;
  // Lamps stand on the corners of the shell. Unlit ones are glass.
  for (double x : {-1.0, 1.0}) {
    const double fx = x * car.head_x, bx = x * car.tail_x;
    kit.box(m.chrome.tinted(glm::dvec3(0.3)), {fx - 0.19, car.head_y - 0.09, front.z - 0.045},
            {fx + 0.19, car.head_y + 0.09, front.z + 0.1}, MeshKit::all);
    glow_quad(kit, m, {fx + 0.16, car.head_y - 0.06, front.z - 0.05}, {-0.32, 0, 0}, {0, 0.12, 0},
              lit ? head_glow : no_glow);
    const double tail_h = kind == van ? 0.34 : 0.15, tail_w = kind == van ? 0.14 : 0.32;
    kit.box(dark, {bx - tail_w / 2 - 0.02, car.tail_y - tail_h / 2 - 0.02, back.z - 0.1},
            {bx + tail_w / 2 + 0.02, car.tail_y + tail_h / 2 + 0.02, p.body[9].z + 0.015}, MeshKit::all);
    glow_quad(kit, m, {bx - tail_w / 2, car.tail_y - tail_h / 2, p.body[9].z + 0.02}, {tail_w, 0, 0}, {0, tail_h, 0},
              lit ? tail_glow : no_glow);
    // Mirrors and door handles.
    kit.box(paint, {x * (side + 0.08) - 0.08, p.cabin.base + 0.02, p.cabin.foot_front + 0.32},
            {x * (side + 0.08) + 0.08, p.cabin.base + 0.15, p.cabin.foot_front + 0.42}, MeshKit::all);
    kit.box(m.chrome, {x * side - 0.015, front.shoulder + 0.17, 0.25}, {x * side + 0.015, front.shoulder + 0.2, 0.42},
            MeshKit::all);
  }
  // Grille, bumpers, plates, sills.
  kit.box(dark, {-0.34, 0.42, p.body[0].z - 0.015}, {0.34, 0.56, p.body[0].z + 0.1}, MeshKit::all);
  kit.box(m.chrome.tinted(glm::dvec3(0.7)), {-0.36, 0.555, p.body[0].z - 0.02}, {0.36, 0.58, p.body[0].z + 0.1},
          MeshKit::all);
  kit.box(dark, {-0.72, 0.24, front.z - 0.09}, {0.72, 0.38, front.z + 0.1}, MeshKit::all);
  kit.box(dark, {-0.74, 0.26, back.z - 0.1}, {0.74, 0.42, p.body[9].z + 0.05}, MeshKit::all);
  kit.box(m.matte.tinted({0.55, 0.55, 0.5}), {-0.26, 0.5, p.body[9].z}, {0.26, 0.61, p.body[9].z + 0.025},
          MeshKit::all);
  kit.box(m.matte.tinted({0.55, 0.55, 0.5}), {-0.26, 0.29, front.z - 0.1}, {0.26, 0.39, front.z}, MeshKit::all);
  kit.box(dark, {-0.8, 0.1, p.front_axle}, {0.8, 0.3, p.back_axle}, MeshKit::all);
  if (kind == taxi) {
    const double y = p.cabin.height + 0.03, z = (p.cabin.roof_front + p.cabin.roof_back) / 2;
    kit.box(dark, {-0.34, y - 0.03, z - 0.1}, {0.34, y, z + 0.1}, MeshKit::all);
    for (double way : {-1.0, 1.0})
      glow_quad(kit, m, {-way * 0.3, y, z + way * 0.08}, {way * 0.6, 0, 0}, {0, 0.15, -way * 0.04}, fairy_glow);
  }
  car.mesh = kit.write(out, "car");
  return car;
}

}  // namespace candela::dusk
