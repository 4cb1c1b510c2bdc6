#include <algorithm>
#include <cmath>
#include <numbers>

#include "demoscenes/cave.h"
#include "demoscenes/tile_maps.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

// A bunny and a dragon: smooth unions of ellipsoids and cones with noise, meshed.
namespace candela::cave {
namespace {

using std::numbers::pi;

Shape ball(glm::dvec3 centre, double radius) {
  Shape shape = sphere(radius, 14, 10);
  for (glm::dvec3& p : shape.position) p += centre;
  return shape;
}

glm::dvec3 mirrored(glm::dvec3 p) { return {std::abs(p.x), p.y, p.z}; }

// An ellipsoid whose own axes are the columns of a rotation.
double to_turned_ellipsoid(glm::dvec3 p, glm::dvec3 centre, const glm::dmat3& axes, glm::dvec3 radii) {
  return to_ellipsoid(glm::transpose(axes) * (p - centre), glm::dvec3(0), radii);
}
// Y along `up`, Z as near to `front` as may be.
glm::dmat3 axes_along(glm::dvec3 up, glm::dvec3 front) {
  const glm::dvec3 y = glm::normalize(up), x = glm::normalize(glm::cross(y, front));
  return {x, y, glm::cross(x, y)};
}

// --- the bunny: it sits, looks to +Z, and is about 1.4 m high to the tips of its ears

struct Bunny {
  static constexpr glm::dvec3 head{0, 0.88, 0.3}, eye{0.15, 0.935, 0.41};
  static glm::dvec3 ear_root() { return {0.085, 1.03, 0.2}; }
  static glm::dvec3 ear_tip() { return {0.2, 1.52, 0.04}; }
  static glm::dmat3 ear_axes() { return axes_along(ear_tip() - ear_root(), {0.35, 0.1, 1}); }

  static double to_ear(glm::dvec3 p) {
    const glm::dvec3 middle = glm::mix(ear_root(), ear_tip(), 0.52);
    double d = to_turned_ellipsoid(p, middle, ear_axes(), {0.1, 0.315, 0.055});
    const double hollow =
        to_turned_ellipsoid(p, middle + ear_axes() * glm::dvec3(0, 0.01, 0.062), ear_axes(), {0.062, 0.25, 0.045});
    return smooth_max(d, -hollow, 0.03);
  }
  static double smooth_body(glm::dvec3 q) {
    const glm::dvec3 p = mirrored(q);
    double d = to_turned_ellipsoid(p, {0, 0.4, -0.14}, axes_along({0, 1, 0.35}, {0, -0.3, 1}), {0.335, 0.4, 0.4});
    d = smooth_min(d, to_ellipsoid(p, {0, 0.5, 0.16}, {0.23, 0.3, 0.22}), 0.16);
    d = smooth_min(
        d, to_turned_ellipsoid(p, {0.25, 0.28, -0.14}, axes_along({0.1, 1, 0.35}, {0, -0.3, 1}), {0.14, 0.26, 0.29}),
        0.07);
    d = smooth_min(d, to_round_cone(p, {0, 0.66, 0.14}, 0.17, {0, 0.84, 0.24}, 0.16), 0.1);
    double head_d = to_ellipsoid(p, head, {0.195, 0.19, 0.225});
    head_d = smooth_min(head_d, to_ellipsoid(p, {0.055, 0.815, 0.475}, {0.085, 0.07, 0.085}), 0.07);
    head_d = smooth_min(head_d, to_ellipsoid(p, {0.12, 0.82, 0.37}, {0.1, 0.09, 0.1}), 0.06);
    head_d = smooth_min(head_d, to_ellipsoid(p, {0, 0.9, 0.47}, {0.07, 0.07, 0.1}), 0.06);
    head_d = smooth_min(head_d, to_ellipsoid(p, {0, 0.866, 0.556}, {0.032, 0.02, 0.022}), 0.015);
    // The mouth's cleft and the sockets of the eyes.
    head_d = smooth_max(head_d, -to_round_cone(p, {0, 0.848, 0.59}, 0.006, {0, 0.79, 0.575}, 0.008), 0.02);
    head_d = smooth_max(head_d, -(glm::length(p - (eye + glm::dvec3(0.022, 0.0, 0.012))) - 0.055), 0.025);
    head_d = smooth_min(head_d, to_ellipsoid(p, eye + glm::dvec3(-0.03, 0.04, -0.02), {0.05, 0.03, 0.05}), 0.04);
    d = smooth_min(d, head_d, 0.07);
    d = smooth_min(d, to_ear(p), 0.045);
    // Legs and feet.
    d = smooth_min(d, to_round_cone(p, {0.13, 0.4, 0.2}, 0.095, {0.115, 0.1, 0.3}, 0.062), 0.06);
    d = smooth_min(d, to_ellipsoid(p, {0.115, 0.05, 0.35}, {0.07, 0.055, 0.105}), 0.04);
    d = smooth_min(d, to_ellipsoid(p, {0.27, 0.055, 0.08}, {0.085, 0.06, 0.26}), 0.05);
    for (const double toe : {-0.04, 0.0, 0.04}) {
      d = smooth_max(
          d, -to_round_cone(p, {0.27 + toe + 0.02, 0.09, 0.345}, 0.006, {0.27 + toe + 0.02, 0.02, 0.36}, 0.006), 0.015);
    }
    d = smooth_min(d, glm::length(p - glm::dvec3(0, 0.27, -0.56)) - 0.13, 0.04);
    return d;
  }
  static double field(glm::dvec3 p) {
    const double d = smooth_body(p);
    if (std::abs(d) > 0.15) return d;
    // Fur lies backwards and down: noise drawn out along it; the ears have less of it, the tail more.
    const double on_tail = 1 - smooth_step(0.14, 0.24, glm::length(p - glm::dvec3(0, 0.27, -0.56)));
    const double on_ear = smooth_step(1.03, 1.1, p.y),
                 on_face = 1 - smooth_step(0.2, 0.3, glm::length(p - glm::dvec3(0, 0.87, 0.42)));
    const glm::dvec3 combed(p.x * 26, (p.y + 0.5 * p.z) * 9, (p.z - 0.3 * p.y) * 14);
    const double amount = 0.007 * (1 - 0.8 * std::max(on_ear, on_face)) + 0.012 * on_tail;
    return d + amount * fbm3(combed, 2, 60);
  }
  static glm::dvec3 color(glm::dvec3 q, glm::dvec3 normal) {
    const glm::dvec3 p = mirrored(q);
    const glm::dvec3 brown(0.23, 0.125, 0.06), cream(0.72, 0.62, 0.5), pink(0.9, 0.42, 0.38);
    const double combed = fbm3({p.x * 30, (p.y + 0.5 * p.z) * 8, p.z * 16}, 2, 61);
    double pale = 1 - smooth_step(0.1, 0.16, std::abs(glm::length(p - glm::dvec3(0, 0.27, -0.58)) - 0.05));  // the tail
    pale = std::max(pale, smooth_step(0.2, 0.75, normal.z - 0.2 * normal.y) * (1 - smooth_step(0.62, 0.78, p.y)));
    pale = std::max(
        pale, 1 - smooth_step(0.06, 0.14, glm::length((p - glm::dvec3(0.03, 0.79, 0.5)) * glm::dvec3(0.8, 1, 1))));
    pale = std::max(pale, 1 - smooth_step(0.055, 0.075, glm::length(p - eye)));
    pale = std::max(pale, 1 - smooth_step(0.05, 0.16, p.y));
    glm::dvec3 c = glm::mix(brown, cream, std::clamp(pale, 0.0, 1.0)) * (0.95 + 0.35 * combed);
    const glm::dvec3 middle = glm::mix(ear_root(), ear_tip(), 0.52);
    const double inner =
        to_turned_ellipsoid(p, middle + ear_axes() * glm::dvec3(0, 0.01, 0.045), ear_axes(), {0.062, 0.245, 0.035});
    c = glm::mix(c, pink, 1 - smooth_step(-0.012, 0.008, inner));
    c = glm::mix(
        c, pink * 0.8,
        1 - smooth_step(0.7, 1.1, glm::length((p - glm::dvec3(0, 0.868, 0.57)) / glm::dvec3(0.04, 0.026, 0.035))));
    return glm::clamp(c, 0.0, 1.0);
  }
};

// --- the dragon: it lies on its haunches, looks to +Z, its tail comes round; about 3 m high to the wings' wrists

struct Bone {
  glm::dvec3 at;
  double radius;
};

class Dragon {
 public:
  Dragon() {
    // From the tip of the tail to the head.
    const std::vector<Bone> keys{
        {{0.4, 0.1, 1.95}, 0.015},   {{0.95, 0.1, 1.75}, 0.05},    {{1.45, 0.11, 1.25}, 0.085},
        {{1.65, 0.13, 0.55}, 0.12},  {{1.5, 0.17, -0.25}, 0.16},   {{1.0, 0.27, -0.95}, 0.22},
        {{0.42, 0.48, -1.2}, 0.3},   {{0.05, 0.72, -0.85}, 0.42},  {{0, 0.95, -0.3}, 0.47},
        {{0, 1.2, 0.22}, 0.43},      {{-0.03, 1.55, 0.5}, 0.29},   {{-0.1, 1.95, 0.47}, 0.21},
        {{-0.16, 2.35, 0.4}, 0.175}, {{-0.13, 2.66, 0.58}, 0.165}, {{-0.06, 2.74, 0.86}, 0.16}};
    constexpr int steps = 16;
    for (size_t k = 0; k + 1 < keys.size(); ++k)
      for (int i = 0; i < steps; ++i) {
        const double t = double(i) / steps;
        const auto at = [&](int j) { return keys[size_t(std::clamp(int(k) + j, 0, int(keys.size()) - 1))]; };
        const Bone a = at(-1), b = at(0), c = at(1), d = at(2);
        const auto blend = [t](auto p, auto q, auto r, auto s) {  // Catmull and Rom 1974
          return 0.5 * (2.0 * q + (r - p) * t + (2.0 * p - 5.0 * q + 4.0 * r - s) * (t * t) +
                        (3.0 * q - p - 3.0 * r + s) * (t * t * t));
        };
        spine_.push_back(
            {blend(a.at, b.at, c.at, d.at), std::max(blend(a.radius, b.radius, c.radius, d.radius), 0.012)});
      }
    spine_.push_back(keys.back());
    for (size_t i = 0; i < spine_.size(); i += steps / 4) coarse_.push_back(spine_[i]);
    length_.push_back(0);
    for (size_t i = 1; i < spine_.size(); ++i)
      length_.push_back(length_.back() + glm::length(spine_[i].at - spine_[i - 1].at));
    // The head's frame: it looks a little down and aside.
    head_ = spine_.back().at + glm::dvec3(0.0, 0.0, 0.0);
    const glm::dvec3 front = glm::normalize(glm::dvec3(0.3, -0.28, 1));
    axes_ = axes_along(glm::dvec3(0, 1, 0) - front * front.y, front);
    // Spikes along neck, back and tail.
    for (double s = 0.9; s < length_.back() - 0.12;) {
      const size_t i = span_at(s);
      const Bone b = bone_at(s);
      const glm::dvec3 way = glm::normalize(spine_[i + 1].at - spine_[i].at);
      const glm::dvec3 up = upward(way);
      const double tall = 0.07 + 0.42 * b.radius;
      spikes_.push_back(
          {b.at + up * (b.radius * 0.85), b.at + up * (b.radius + tall) - way * (0.45 * tall), 0.25 * tall + 0.03});
      s += 0.13 + 0.36 * b.radius;
    }
  }

  double field(glm::dvec3 p) const {
    const double d = smooth_body(p);
    if (std::abs(d) > 0.12) return d;
    return d + 0.012 * smooth_step(0.03, 0.08, to_membranes(mirrored(p))) * fbm3(p * 9.0, 2, 80);
  }

  struct Place {
    double along_m, turn;
    double off_m;  // from the spine's skin
  };
  Place on_spine(glm::dvec3 p) const {
    size_t span = 0;
    double along = 0, off_m = 1e9;
    for (size_t i = 0; i + 1 < spine_.size(); ++i) {
      double t = 0;
      const double d = to_round_cone(p, spine_[i].at, spine_[i].radius, spine_[i + 1].at, spine_[i + 1].radius, &t);
      if (d < off_m) span = i, along = t, off_m = d;
    }
    const Bone a = spine_[span], b = spine_[span + 1];
    const glm::dvec3 way = glm::normalize(b.at - a.at), up = upward(way), side = glm::cross(up, way);
    const glm::dvec3 off = p - glm::mix(a.at, b.at, along);
    return {glm::mix(length_[span], length_[span + 1], along), std::atan2(glm::dot(off, side), glm::dot(off, up)),
            off_m};
  }

  static constexpr int skin = 8;
  // 8 and more: the wings' skin. 6 and 7: the spine, above it (turn > 0 apart from turn < 0); else by the axis that a
  // triangle faces.
  int group(glm::dvec3 middle, glm::dvec3 normal) const {
    if (to_membranes(mirrored(middle)) < 0.012) return skin + box_group(normal);
    const Place place = on_spine(middle);
    if (place.off_m > 0.09 || to_head(middle) < place.off_m + 0.02) return box_group(normal);
    return place.turn >= 0 ? 6 : 7;
  }
  glm::dvec2 uv(glm::dvec3 p, int group) const {
    if (group >= skin) return box_uv(p, group - skin) / 0.5;
    if (group < 6) return box_uv(p, group) / 0.5;
    const Place place = on_spine(p);
    // Across the back the turn goes from -pi to pi: each half on its own side of it.
    double turn = place.turn;
    if (group == 6 && turn < -pi / 2) turn += 2 * pi;
    if (group == 7 && turn > pi / 2) turn -= 2 * pi;
    return {turn / (2 * pi) * 4, place.along_m / 0.5};
  }
  glm::dvec3 color(glm::dvec3 p) const {
    const glm::dvec3 back(0.035, 0.2, 0.15), belly(0.62, 0.47, 0.2), wing(0.3, 0.07, 0.06), horn(0.62, 0.55, 0.42);
    const Place place = on_spine(p);
    const double under = smooth_step(1.75, 2.35, std::abs(place.turn));
    glm::dvec3 c = glm::mix(back, belly, place.off_m < 0.06 ? under : 0.0);
    c *= 1 + 0.6 * fbm3(p * 3.0, 3, 81);
    if (to_membranes(mirrored(p)) < 0.012) c = wing * (1 + 0.5 * fbm3(p * 4.0, 3, 82));
    if (to_spikes(p) < 0.02 && place.off_m > 0.015)
      c = glm::mix(c, glm::dvec3(0.5, 0.32, 0.12), smooth_step(0.015, 0.1, place.off_m));
    if (to_horns(p) < 0.02 || to_claws(mirrored(p)) < 0.015) c = horn * (1 + 0.3 * fbm3(p * 14.0, 2, 83));
    return glm::clamp(c, 0.0, 1.0);
  }
  // Of an eye, -1 or 1.
  glm::dvec3 eye(double side) const { return in_head({side * 0.125, 0.105, 0.17}); }
  glm::dvec3 pupil(double side) const { return in_head({side * 0.157, 0.11, 0.2}); }

 private:
  static glm::dvec3 upward(glm::dvec3 way) {
    // Along the neck, which stands, the back is towards -Z.
    const glm::dvec3 hint = glm::normalize(glm::dvec3(0, 1, 0) + glm::dvec3(0, 0, -1.2) * std::max(way.y, 0.0));
    return glm::normalize(hint - way * glm::dot(hint, way));
  }
  size_t span_at(double s) const {
    size_t i = 0;
    while (i + 2 < length_.size() && length_[i + 1] < s) ++i;
    return i;
  }
  Bone bone_at(double s) const {
    const size_t i = span_at(s);
    const double t = (s - length_[i]) / (length_[i + 1] - length_[i]);
    return {glm::mix(spine_[i].at, spine_[i + 1].at, t), glm::mix(spine_[i].radius, spine_[i + 1].radius, t)};
  }
  static constexpr double head_size = 1.35;
  glm::dvec3 in_head(glm::dvec3 local) const { return head_ + axes_ * (local * head_size); }
  glm::dvec3 of_head(glm::dvec3 p) const { return glm::transpose(axes_) * (p - head_) / head_size; }

  double to_spikes(glm::dvec3 p) const {
    double d = 1e9;
    for (const Spike& s : spikes_) d = std::min(d, to_round_cone(p, s.root, s.radius, s.tip, 0.008));
    return d;
  }
  double to_horns(glm::dvec3 q) const {
    const glm::dvec3 p = mirrored(of_head(q));
    double d = to_round_cone(p, {0.09, 0.14, 0.02}, 0.05, {0.17, 0.27, -0.18}, 0.038);
    d = std::min(d, to_round_cone(p, {0.17, 0.27, -0.18}, 0.038, {0.22, 0.3, -0.38}, 0.026));
    d = std::min(d, to_round_cone(p, {0.22, 0.3, -0.38}, 0.026, {0.23, 0.41, -0.55}, 0.01));
    d = std::min(d, to_round_cone(p, {0.14, 0.0, 0.0}, 0.035, {0.27, 0.01, -0.17}, 0.01));
    d = std::min(d, to_round_cone(p, {0.14, -0.06, 0.05}, 0.03, {0.24, -0.1, -0.08}, 0.01));
    return d * head_size;
  }
  double to_head(glm::dvec3 q) const {
    const glm::dvec3 p = mirrored(of_head(q));
    double d = to_ellipsoid(p, {0, 0.03, 0.04}, {0.17, 0.16, 0.2});
    double snout = to_round_cone(p, {0, 0.03, 0.15}, 0.115, {0, 0.0, 0.5}, 0.075);
    snout = smooth_min(snout, to_ellipsoid(p, {0.045, 0.045, 0.52}, {0.04, 0.04, 0.06}), 0.03);  // nostrils
    snout = smooth_max(snout, -to_ellipsoid(p, {0.06, 0.06, 0.57}, {0.018, 0.015, 0.03}), 0.015);
    snout = smooth_min(snout, to_round_cone(p, {0.0, 0.1, 0.2}, 0.03, {0.0, 0.08, 0.45}, 0.02), 0.05);  // its ridge
    double jaw = to_round_cone(p, {0, -0.1, 0.06}, 0.085, {0, -0.155, 0.43}, 0.045);
    jaw = smooth_min(jaw, to_round_cone(p, {0.07, -0.07, 0.05}, 0.06, {0.02, -0.15, 0.4}, 0.03), 0.04);
    d = smooth_min(d, snout, 0.07);
    d = smooth_min(d, jaw, 0.035);
    d = smooth_min(d, to_round_cone(p, {0.1, 0.14, 0.2}, 0.032, {0.13, 0.17, 0.06}, 0.045), 0.04);  // brows
    d = smooth_max(d, -(glm::length(p - glm::dvec3(0.15, 0.105, 0.19)) - 0.042), 0.02);
    for (const double z : {0.25, 0.33, 0.41, 0.48})  // teeth
      d = std::min(d, to_round_cone(p, {0.095 - 0.1 * (z - 0.2), -0.03 - 0.05 * (z - 0.2), z}, 0.018,
                                    {0.09 - 0.1 * (z - 0.2), -0.1 - 0.05 * (z - 0.2), z + 0.01}, 0.006));
    return smooth_min(d * head_size, to_horns(q), 0.02);
  }

  // Of the right side, which the left mirrors.
  static constexpr glm::dvec3 shoulder{0.3, 1.5, 0.1}, elbow{0.85, 2.0, -0.35}, wrist{1.15, 2.85, -0.15},
      hip_end{0.3, 1.05, -0.75};
  static constexpr std::array<glm::dvec3, 3> tips{{{2.35, 2.75, -0.45}, {2.3, 1.75, -0.85}, {1.55, 1.05, -1.1}}};
  static double to_membranes(glm::dvec3 p) {
    double d = 1e9;
    const auto web = [&](glm::dvec3 root, glm::dvec3 a, glm::dvec3 b) {
      // Drawn in between two fingers.
      const glm::dvec3 middle = glm::mix(root, 0.5 * (a + b), 0.76);
      d = std::min({d, to_triangle(p, root, a, middle), to_triangle(p, root, middle, b)});
    };
    web(wrist, tips[0], tips[1]), web(wrist, tips[1], tips[2]);
    d = std::min(d, to_triangle(p, wrist, tips[2], elbow));
    web(elbow, tips[2], hip_end);
    d = std::min(d, to_triangle(p, elbow, hip_end, shoulder));
    return d - 0.036;
  }
  static double to_wing(glm::dvec3 p) {
    double d = to_round_cone(p, shoulder - glm::dvec3(0.1, 0.12, 0), 0.13, elbow, 0.08);
    d = smooth_min(d, to_round_cone(p, elbow, 0.08, wrist, 0.055), 0.04);
    for (const glm::dvec3& tip : tips) {
      const glm::dvec3 bend = glm::mix(wrist, tip, 0.5) + glm::dvec3(0.05, 0.06, 0.02);
      d = smooth_min(d, to_round_cone(p, wrist, 0.05, bend, 0.036), 0.03);
      d = smooth_min(d, to_round_cone(p, bend, 0.036, tip, 0.016), 0.02);
    }
    d = smooth_min(d, to_membranes(p), 0.035);
    return d;
  }
  static double to_claws(glm::dvec3 p) {
    double d = to_round_cone(p, wrist, 0.04, wrist + glm::dvec3(-0.06, 0.2, 0.06), 0.01);
    for (const double toe : {-0.11, 0.0, 0.11}) {
      d = std::min(d, to_round_cone(p, {0.58 + 1.3 * toe, 0.07, 0.42 - std::abs(toe)}, 0.035,
                                    {0.58 + 1.6 * toe, 0.03, 0.56 - std::abs(toe)}, 0.01));
      d = std::min(d, to_round_cone(p, {0.48 + 1.3 * toe, 0.065, 0.9 - std::abs(toe)}, 0.032,
                                    {0.48 + 1.6 * toe, 0.03, 1.03 - std::abs(toe)}, 0.01));
    }
    return d;
  }
  static double to_legs(glm::dvec3 p) {
    // Behind: thigh, shin, foot; before: upper arm, lower arm, hand.
    double d = to_turned_ellipsoid(p, {0.44, 0.62, -0.5}, axes_along({0.15, 1, 0.45}, {0, -0.4, 1}), {0.2, 0.42, 0.3});
    d = smooth_min(d, to_round_cone(p, {0.52, 0.36, -0.35}, 0.15, {0.56, 0.16, -0.12}, 0.09), 0.1);
    d = smooth_min(d, to_round_cone(p, {0.56, 0.12, -0.15}, 0.1, {0.58, 0.09, 0.22}, 0.075), 0.06);
    d = smooth_min(
        d, to_turned_ellipsoid(p, {0.36, 1.05, 0.32}, axes_along({0.1, 1, 0.1}, {0, 0, 1}), {0.15, 0.32, 0.2}), 0.1);
    d = smooth_min(d, to_round_cone(p, {0.42, 0.85, 0.25}, 0.13, {0.5, 0.5, 0.3}, 0.095), 0.08);
    d = smooth_min(d, to_round_cone(p, {0.5, 0.5, 0.3}, 0.095, {0.47, 0.12, 0.6}, 0.07), 0.05);
    d = smooth_min(d, to_round_cone(p, {0.47, 0.1, 0.58}, 0.075, {0.48, 0.08, 0.72}, 0.06), 0.04);
    for (const double toe : {-0.11, 0.0, 0.11}) {
      d = smooth_min(
          d,
          to_round_cone(p, {0.58 + 0.5 * toe, 0.09, 0.2}, 0.055, {0.58 + 1.3 * toe, 0.06, 0.42 - std::abs(toe)}, 0.042),
          0.03);
      d = smooth_min(
          d,
          to_round_cone(p, {0.48 + 0.5 * toe, 0.08, 0.68}, 0.05, {0.48 + 1.3 * toe, 0.055, 0.9 - std::abs(toe)}, 0.038),
          0.03);
    }
    return smooth_min(d, to_claws(p), 0.015);
  }
  double smooth_body(glm::dvec3 q) const {
    double d = 1e9;
    for (size_t i = 0; i + 1 < coarse_.size(); ++i)
      d = std::min(d, to_round_cone(q, coarse_[i].at, coarse_[i].radius, coarse_[i + 1].at, coarse_[i + 1].radius));
    const glm::dvec3 p = mirrored(q);
    d = smooth_min(d, to_spikes(q), 0.03);
    if (glm::length(q - head_) < 1.5) d = smooth_min(d, to_head(q), 0.08);
    if (p.y < 1.9) d = smooth_min(d, to_legs(p), 0.1);
    return smooth_min(d, to_wing(p), 0.06);
  }

  struct Spike {
    glm::dvec3 root, tip;
    double radius;
  };
  std::vector<Bone> spine_, coarse_;  // the coarse one is meshed, the other one textured
  std::vector<double> length_;
  std::vector<Spike> spikes_;
  glm::dvec3 head_;
  glm::dmat3 axes_;
};

// Rows of round scales that lie over each other, eight abreast and ten rows over the unit square.
TilePoint scale_point(double u, double v) {
  constexpr int columns = 7, rows = 10;
  double height = 0, shade = 0;
  for (int k = 0; k < 3; ++k) {
    const double row = std::floor(v * rows) + k - 1;
    const int r = (int(row) % rows + rows) % rows;
    const double x = u * columns + (r % 2 == 0 ? 0 : 0.5), fx = x - std::floor(x) - 0.5, fy = v * rows - row;
    // Its root is a row further up, its rounded end towards the tail.
    const double edge = 1 - std::max(std::abs(fx) * 2 * (0.4 + 0.35 * fy), 0.0), end = 1.45 - fy - 1.3 * fx * fx;
    if (end < 0 || edge < 0 || fy < -0.2) continue;
    const double tall = (0.35 + 0.5 * fy) * smooth_step(0, 0.22, end) * smooth_step(0, 0.3, edge);
    if (tall > height) height = tall, shade = tiling_noise((std::floor(x) + 0.5) / columns, (r + 0.5) / rows, 23, 90);
  }
  TilePoint p;
  p.height_m = 0.02 * height;
  p.color = glm::dvec3(0.45 + 0.45 * height) * (0.85 + 0.3 * shade);
  p.roughness = 0.62 - 0.3 * height;
  return p;
}

}  // namespace

void add_bunny(GlbWriter& out) {
  const TileMaps fur = bake_tile(256, 0.35, [](double u, double v) {
    TilePoint p;
    const double hair = tiling_noise(u, v * 0.25, 96, 65), tuft = tiling_octaves(u, v, 10, 3, 66);
    p.height_m = 0.0025 * hair + 0.003 * tuft;
    return p;
  });
  json coat = pbr({1, 1, 1, 1}, 0, 0.85);
  coat["normalTexture"] = {{"index", out.texture("fur normal", fur.normal, trilinear())}, {"scale", 0.55}};
  out.use_extension("KHR_materials_sheen");
  coat["extensions"]["KHR_materials_sheen"] = {{"sheenColorFactor", vector_json({0.22, 0.19, 0.16})},
                                               {"sheenRoughnessFactor", 0.5}};
  const int material = out.material("fur", coat);
  const ImplicitMesh mesh = mesh_implicit(Bunny::field, {-0.56, -0.15, -0.86}, {0.56, 1.72, 0.72}, 0.032, 1.7);
  const Shape shape =
      textured(mesh, {[](glm::dvec3, glm::dvec3 n) { return box_group(n); },
                      [](glm::dvec3 at, glm::dvec3, int group) { return box_uv(at, group) / 0.35; }, Bunny::color});
  const glm::dquat turn = rotation_about({0, 1, 0}, 0.35);
  const double foot = floor_height(island) + 0.0;
  const int body = out.node("bunny", {{"mesh", out.mesh("bunny", out.primitive(shape), material)},
                                      {"translation", vector_json({island.x, foot, island.y})},
                                      {"rotation", quaternion_json(turn)}});
  const int dark = out.material("bunny eye", pbr({0.012, 0.007, 0.005, 1}, 0, 0.06));
  for (const double side : {-1.0, 1.0}) {
    const glm::dvec3 at = Bunny::eye * glm::dvec3(side, 1, 1);
    out.child(body, "bunny eye", {{"mesh", out.mesh("bunny eye", out.primitive(ball(at, 0.047)), dark)}});
  }
}

void add_dragon(GlbWriter& out) {
  const TileMaps scales = bake_tile(256, 0.5, [](double u, double v) { return scale_point(u, v); });
  json hide = pbr_textured(out.texture("scales colour", scales.color, trilinear()), 0, 1);
  hide["normalTexture"] = {{"index", out.texture("scales normal", scales.normal, trilinear())}};
  hide["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {
      {"index", out.texture("scales roughness", scales.roughness, trilinear())}};
  const int material = out.material("dragon", hide);
  const Dragon dragon;
  const ImplicitMesh mesh =
      mesh_implicit([&](glm::dvec3 p) { return dragon.field(p); }, {-2.6, -0.2, -1.75}, {2.6, 3.75, 2.2}, 0.0445, 1.5);
  // Scales, and the skin between the wings' fingers.
  std::array<ImplicitMesh, 2> parts;
  for (ImplicitMesh& part : parts) part.position = mesh.position, part.normal = mesh.normal;
  const Texturing texturing{[&](glm::dvec3 middle, glm::dvec3 n) { return dragon.group(middle, n); },
                            [&](glm::dvec3 at, glm::dvec3, int group) { return dragon.uv(at, group); },
                            [&](glm::dvec3 at, glm::dvec3) { return dragon.color(at); }};
  for (size_t i = 0; i < mesh.index.size(); i += 3) {
    glm::dvec3 middle(0);
    for (size_t k = 0; k < 3; ++k) middle += mesh.position[mesh.index[i + k]] / 3.0;
    ImplicitMesh& part = parts[dragon.group(middle, mesh.normal[mesh.index[i]]) >= Dragon::skin ? 1 : 0];
    for (size_t k = 0; k < 3; ++k) part.index.push_back(mesh.index[i + k]);
  }
  json scaled = out.primitive(textured(parts[0], texturing)), skin = out.primitive(textured(parts[1], texturing));
  skin["material"] = out.material("wings", pbr({1, 1, 1, 1}, 0, 0.5));
  const int whole = out.mesh("dragon", scaled, material);
  out.root["meshes"][size_t(whole)]["primitives"].push_back(std::move(skin));
  const glm::dquat turn = rotation_about({0, 1, 0}, 0.75);
  const int body = out.node("dragon", {{"mesh", whole},
                                       {"translation", vector_json({ledge.x, floor_height(ledge) - 0.05, ledge.y})},
                                       {"rotation", quaternion_json(turn)}});
  out.use_extension("KHR_materials_emissive_strength");
  json glow = pbr({0.3, 0.16, 0.02, 1}, 0, 0.15);
  glow["emissiveFactor"] = vector_json({1, 0.5, 0.06});
  glow["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 0.9;
  const int eye = out.material("dragon eye", glow), pupil = out.material("pupil", pbr({0.01, 0.01, 0.01, 1}, 0, 0.1));
  for (const double side : {-1.0, 1.0}) {
    out.child(body, "dragon eye",
              {{"mesh", out.mesh("dragon eye", out.primitive(ball(dragon.eye(side), 0.055)), eye)}});
    out.child(body, "pupil", {{"mesh", out.mesh("pupil", out.primitive(ball(dragon.pupil(side), 0.022)), pupil)}});
  }
}

}  // namespace candela::cave
