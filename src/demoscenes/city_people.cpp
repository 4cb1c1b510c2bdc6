#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "demoscenes/city.h"
#include "testscenes/table.h"

// People who walk along the pavements, some with lanterns. A walker's node moves evenly, and its joints move below it:
// while a foot is on the ground it goes back evenly by as much, between two keys, so that it stands still in the world
// at any time. Knees follow from hips and ankles.
namespace candela::city {
namespace {

using std::numbers::pi;

enum Joint {
  torso,
  head,
  left_thigh,
  left_shin,
  left_foot,
  right_thigh,
  right_shin,
  right_foot,
  left_arm,
  left_forearm,
  right_arm,
  right_forearm,
  joint_count
};
constexpr double thigh_m = 0.44, shin_m = 0.43, ankle_m = 0.08, hip_m = ankle_m + shin_m + thigh_m, hip_x_m = 0.09;
constexpr double arm_m = 0.28, shoulder_y_m = 1.41, shoulder_x_m = 0.21;
constexpr std::array<glm::dvec3, joint_count> rest{{{0, hip_m, 0},
                                                    {0, 1.46, 0},
                                                    {-hip_x_m, hip_m, 0},
                                                    {-hip_x_m, hip_m - thigh_m, 0},
                                                    {-hip_x_m, ankle_m, 0},
                                                    {hip_x_m, hip_m, 0},
                                                    {hip_x_m, hip_m - thigh_m, 0},
                                                    {hip_x_m, ankle_m, 0},
                                                    {-shoulder_x_m, shoulder_y_m, 0},
                                                    {-shoulder_x_m, shoulder_y_m - arm_m, 0},
                                                    {shoulder_x_m, shoulder_y_m, 0},
                                                    {shoulder_x_m, shoulder_y_m - arm_m, 0}}};

// --- bodies, which face -Z

struct Clothes {
  glm::dvec3 coat, trousers, hair;
  double coat_end_m;
};

void outline(MeshKit& kit, const Paint& paint, std::initializer_list<glm::dvec2> circles, double z = 0) {
  constexpr size_t columns = 10;
  std::vector<glm::dvec3> points;
  for (glm::dvec2 c : circles)
    for (size_t i = 0; i < columns; ++i) {
      const double angle = -2 * pi * double(i) / columns;
      points.emplace_back(c.y * std::cos(angle), c.x, z + 0.72 * c.y * std::sin(angle));
    }
  kit.surface(paint, points, columns, true);
}

std::array<MeshKit, joint_count> body_parts(const Materials& m, const Clothes& c) {
  std::array<MeshKit, joint_count> parts;
  const Paint cloth = m.matte.tinted(c.coat), trousers = m.matte.tinted(c.trousers),
              skin = m.matte.tinted({0.35, 0.22, 0.16}), hair = m.matte.tinted(c.hair),
              shoe = m.glass.tinted(glm::dvec3(0.03));
  outline(parts[torso], cloth,
          {{c.coat_end_m, 0.0},
           {c.coat_end_m, 0.2 + 0.25 * (0.9 - c.coat_end_m)},
           {1.02, 0.185},
           {1.2, 0.21},
           {1.36, 0.23},
           {1.45, 0.18},
           {1.5, 0.08},
           {1.52, 0}});
  outline(parts[head], skin, {{1.44, 0.055}, {1.53, 0.055}, {1.56, 0.08}, {1.64, 0.098}, {1.7, 0.08}, {1.74, 0}});
  outline(parts[head], hair, {{1.55, 0.06}, {1.6, 0.108}, {1.67, 0.112}, {1.73, 0.08}, {1.765, 0}}, 0.02);
  for (int side = 0; side < 2; ++side) {
    const glm::dvec3 hip = rest[size_t(side ? right_thigh : left_thigh)],
                     knee = rest[size_t(side ? right_shin : left_shin)],
                     ankle = rest[size_t(side ? right_foot : left_foot)],
                     shoulder = rest[size_t(side ? right_arm : left_arm)],
                     elbow = rest[size_t(side ? right_forearm : left_forearm)];
    MeshKit& thigh = parts[size_t(side ? right_thigh : left_thigh)];
    MeshKit& shin = parts[size_t(side ? right_shin : left_shin)];
    MeshKit& foot = parts[size_t(side ? right_foot : left_foot)];
    MeshKit& arm = parts[size_t(side ? right_arm : left_arm)];
    MeshKit& forearm = parts[size_t(side ? right_forearm : left_forearm)];
    const glm::dvec3 down(0, -0.035, 0);
    thigh.tube(trousers, hip, 0.09, knee + down, 0.066, 7);
    shin.tube(trousers, knee - down, 0.066, ankle + glm::dvec3(0, 0.01, 0), 0.052, 7);
    foot.box(shoe, ankle + glm::dvec3(-0.045, -ankle_m, -0.19), ankle + glm::dvec3(0.045, -0.015, 0.07), MeshKit::all);
    foot.box(shoe, ankle + glm::dvec3(-0.04, -0.02, -0.06), ankle + glm::dvec3(0.04, 0.035, 0.065));
    arm.tube(cloth, shoulder + glm::dvec3(0, 0.03, 0), 0.064, elbow + down, 0.052, 7, true);
    forearm.tube(cloth, elbow - 0.6 * down, 0.052, elbow - glm::dvec3(0, 0.25, 0), 0.043, 7, true);
    forearm.tube(skin, elbow - glm::dvec3(0, 0.24, 0), 0.036, elbow - glm::dvec3(0, 0.33, 0), 0.03, 6, true);
  }
  return parts;
}

int make_body(GlbWriter& out, const Materials& m, const Clothes& clothes) {
  std::map<int, Shape> merged;
  std::map<int, std::vector<glm::u16vec4>> joints;
  const auto parts = body_parts(m, clothes);
  for (size_t j = 0; j < parts.size(); ++j)
    for (const auto& [material, part] : parts[j].shapes()) {
      Shape& shape = merged[material];
      const auto first = uint32_t(shape.position.size());
      shape.position.insert(shape.position.end(), part.position.begin(), part.position.end());
      shape.normal.insert(shape.normal.end(), part.normal.begin(), part.normal.end());
      shape.color.insert(shape.color.end(), part.color.begin(), part.color.end());
      for (uint32_t k : part.index) shape.index.push_back(first + k);
      joints[material].resize(shape.position.size(), glm::u16vec4(j, 0, 0, 0));
    }
  json primitives = json::array();
  for (const auto& [material, shape] : merged) {
    Shape bare = shape;
    bare.color.clear();
    json primitive = out.primitive(bare);
    std::vector<double> weights;
    for (size_t v = 0; v < shape.position.size(); ++v) weights.insert(weights.end(), {1, 0, 0, 0});
    primitive["attributes"]["COLOR_0"] = out.unorm8_accessor(shape.color);
    primitive["attributes"]["JOINTS_0"] = out.joint_accessor(joints[material]);
    primitive["attributes"]["WEIGHTS_0"] = out.float_accessor(weights, 4);
    primitive["material"] = material;
    primitives.push_back(std::move(primitive));
  }
  out.root["meshes"].push_back({{"name", "walker"}, {"primitives", std::move(primitives)}});
  return int(out.root["meshes"].size()) - 1;
}

// --- motion

// How somebody walks: at a speed, in strides of both legs. -Z is ahead. Lengths are of a body of scale 1.
struct Gait {
  double speed_m_s, stride_s, phase;
  bool with_lantern;
};
constexpr double flat_share = 0.4, roll_share = 0.2;  // of a stride: the foot flat, and on its toes

// Of a limb: where its upper end is, and its turn about +X from hanging straight down; above 0 it swings ahead.
struct Limb {
  glm::dvec3 at;
  double swing_rad;
};

// A foot so many strides after it touched the ground, 0 to 1: where its ankle is, below the hips at z = 0.
Limb foot_at(const Gait& g, double into) {
  const double stride_m = g.speed_m_s * g.stride_s;
  const auto flat_z = [&](double t) { return (t - 0.22) * stride_m; };
  constexpr double ball_z = -0.13, ball_y = 0.015, most_lift = 0.75;
  // The ball of the foot stays where it is on the ground, and the heel goes up.
  const auto rolled = [&](double t, double lift) {
    const double y = ankle_m - ball_y, z = -ball_z, c = std::cos(lift), s = -std::sin(lift);
    return glm::dvec3(0, ball_y + y * c - z * s, flat_z(t) + ball_z + y * s + z * c);
  };
  if (into <= flat_share) return {{0, ankle_m, flat_z(into)}, 0};
  const double lifted = flat_share + roll_share;
  if (into <= lifted) {
    const double lift = most_lift * (into - flat_share) / roll_share;
    return {rolled(into, lift), -lift};
  }
  const double u = (into - lifted) / (1 - lifted), ease = u * u * (3 - 2 * u);
  const glm::dvec3 from = rolled(lifted, most_lift);
  const double up = std::sin(pi * u);
  return {
      {0, from.y + (ankle_m - from.y) * ease + 0.06 * up * up, from.z + (flat_z(0) - from.z) * (0.4 * u + 0.6 * ease)},
      -most_lift * (1 - ease) + 0.25 * up * up * u};
}

double fraction(double x) { return x - std::floor(x); }

// Lowest where both feet are on the ground and legs are farthest apart.
double hip_height(const Gait& g, double time_s) {
  const double wave = std::sin(2 * pi * (time_s / g.stride_s + g.phase - 0.05));
  return 0.893 + 0.033 * wave * wave;
}

// Thigh and shin of the leg whose foot is there; the knee bends ahead.
std::array<Limb, 2> leg_to(glm::dvec3 hip, glm::dvec3 ankle) {
  glm::dvec2 way(ankle.y - hip.y, ankle.z - hip.z);
  const double distance = std::min(glm::length(way), 0.9995 * (thigh_m + shin_m));
  way = glm::normalize(way);
  const double along = (thigh_m * thigh_m - shin_m * shin_m + distance * distance) / (2 * distance);
  const double ahead = std::sqrt(std::max(thigh_m * thigh_m - along * along, 0.0));
  const glm::dvec2 knee = along * way + ahead * glm::dvec2(way.y, -way.x), below = distance * way - knee;
  const auto swing = [](glm::dvec2 d) { return std::atan2(-d.y, -d.x); };
  return {{{hip, swing(knee)}, {hip + glm::dvec3(0, knee.x, knee.y), swing(below)}}};
}

std::array<Limb, joint_count> pose_at(const Gait& g, double time_s) {
  const double cycle = time_s / g.stride_s + g.phase, hip = hip_height(g, time_s), drop = hip - hip_m;
  std::array<Limb, joint_count> limbs;
  limbs[torso] = {{0, hip, 0}, -0.05};
  limbs[head] = {{0, rest[head].y + drop, -0.02}, 0};
  for (int side = 0; side < 2; ++side) {
    const double x = side ? hip_x_m : -hip_x_m;
    Limb foot = foot_at(g, fraction(cycle + 0.5 * side));
    foot.at.x = x;
    const auto leg = leg_to({x, hip, 0}, foot.at);
    limbs[size_t(side ? right_thigh : left_thigh)] = leg[0];
    limbs[size_t(side ? right_shin : left_shin)] = leg[1];
    limbs[size_t(side ? right_foot : left_foot)] = foot;
    // Arms go with the other leg.
    const bool holds = side && g.with_lantern;
    const double swing = holds ? 0.25 : -0.42 * std::cos(2 * pi * (cycle + 0.5 * side));
    const Limb arm{{side ? shoulder_x_m : -shoulder_x_m, shoulder_y_m + drop, -0.03}, swing};
    limbs[size_t(side ? right_arm : left_arm)] = arm;
    limbs[size_t(side ? right_forearm : left_forearm)] = {
        arm.at + arm_m * glm::dvec3(0, -std::cos(swing), -std::sin(swing)), holds ? pi / 2 : swing + 0.3};
  }
  return limbs;
}

// The keys of a joint in all the film: feet have theirs where they touch the ground and leave it.
std::vector<double> key_times(const Gait& g, size_t joint) {
  std::vector<double> times{0};
  const bool is_foot = joint == left_foot || joint == right_foot;
  if (!is_foot) {
    for (int k = 1; k <= int(end_s * frames_per_s); ++k) times.push_back(k / frames_per_s);
    return times;
  }
  std::vector<double> parts{0, flat_share};
  for (int i = 1; i <= 4; ++i) parts.push_back(flat_share + roll_share * i / 4);
  for (int i = 1; i < 10; ++i) parts.push_back(flat_share + roll_share + (1 - flat_share - roll_share) * i / 10);
  const double first = g.phase + (joint == right_foot ? 0.5 : 0);
  for (int stride = 0; stride * g.stride_s < end_s + 2 * g.stride_s; ++stride)
    for (double part : parts) {
      const double time = (stride + part - first) * g.stride_s;
      if (time > times.back() + 1e-4 && time < end_s) times.push_back(time);
    }
  times.push_back(end_s);
  return times;
}

struct Samplers {
  std::array<int, joint_count> places, turns;
};

Samplers make_samplers(GlbWriter& out, const Gait& g) {
  Samplers made{};
  for (size_t j = 0; j < joint_count; ++j) {
    const std::vector<double> times = key_times(g, j);
    std::vector<double> places, turns;
    for (double t : times) {
      // A hair before a foot touches the ground and just after are the same place.
      const Limb limb = pose_at(g, t)[j];
      push(places, limb.at);
      push(turns, rotation_about({1, 0, 0}, limb.swing_rad));
    }
    made.places[j] = add_sampler(out, times, places, 3);
    made.turns[j] = add_sampler(out, times, turns, 4);
  }
  return made;
}

class People {
 public:
  explicit People(Town& town) : town_(town) {
    static constexpr std::array<Clothes, 6> clothes{
        {{{0.3, 0.22, 0.12}, {0.03, 0.03, 0.04}, {0.03, 0.02, 0.015}, 0.72},
         {{0.05, 0.06, 0.12}, {0.08, 0.08, 0.09}, {0.12, 0.07, 0.03}, 0.84},
         {{0.26, 0.03, 0.03}, {0.02, 0.02, 0.03}, {0.05, 0.03, 0.02}, 0.74},
         {{0.1, 0.14, 0.12}, {0.14, 0.11, 0.08}, {0.25, 0.24, 0.22}, 0.84},
         {{0.5, 0.42, 0.25}, {0.04, 0.05, 0.09}, {0.02, 0.015, 0.01}, 0.78},
         {{0.04, 0.04, 0.045}, {0.03, 0.03, 0.03}, {0.2, 0.12, 0.05}, 0.7}}};
    for (const Clothes& c : clothes) bodies_.push_back(make_body(town.out, town.m, c));
    for (int g = 0; g < 8; ++g) {
      Gait gait{town.rng.uniform(1.15, 1.38), town.rng.uniform(1.0, 1.1), town.rng.uniform(), g % 2 == 0};
      gaits_.push_back(gait);
      samplers_.push_back(make_samplers(town.out, gait));
    }
    std::vector<glm::dmat4> inverse(joint_count, glm::dmat4(1));
    for (size_t j = 0; j < joint_count; ++j) inverse[j][3] = glm::dvec4(-rest[j], 1);
    inverse_bind_ = town.out.mat4_accessor(inverse);
    MeshKit kit;
    glow_band(kit, town.m, {0, 0, 0}, {0, -0.13}, {0.1, -0.07}, 8, dusk::lamp_glow);
    glow_band(kit, town.m, {0, 0, 0}, {0.1, -0.07}, {0.1, 0.07}, 8, dusk::lamp_glow);
    glow_band(kit, town.m, {0, 0, 0}, {0.1, 0.07}, {0, 0.13}, 8, dusk::lamp_glow);
    kit.tube(town.m.matte.tinted(glm::dvec3(0.02)), {0, 0.12, 0}, 0.006, {0, 0.34, 0}, 0.006, 4);
    const int lantern = kit.write(town.out, "lantern");
    for (int g = 0; g < lantern_groups; ++g) {
      const double on_s = 5.6 + 0.6 * g;
      const int paper = town.switches.material(town.m.glows, on_s);
      town.out.root["materials"][size_t(paper)]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] =
          5;
      lanterns_.push_back(town.switches.mesh_with(lantern, town.m.glows, paper));
      lamps_.push_back(spot(town.switches, "lantern", 6, 0.7, 1.12, on_s));
    }
  }

  // Straight on along the sides of a block, in the middle of the pavement.
  void make() {
    for (int c = 0; c < block_columns; ++c)
      for (int r = 0; r < block_rows; ++r)
        for (int side = 0; side < 4; ++side) {
          const bool avenue = (c == 0 && side == 1) || (c == 1 && side == 3) || is_square(c, r);
          for (int i = 0; i < (avenue ? 2 : 1); ++i) {
            const glm::dvec2 centre = block_centre(c, r);
            const glm::dmat4 frame = placed({centre.x, 0, centre.y}, side * pi / 2);
            const bool right = (i + side + c) % 2;
            const double z = right ? town_.rng.uniform(23.9, 24.6) : town_.rng.uniform(23.1, 23.7);
            const glm::dvec3 way = glm::dmat3(frame) * glm::dvec3(right ? 1 : -1, 0, 0);
            const auto anywhere = [&] {
              const double x = town_.rng.uniform(-23, -5) * (right ? 1 : -1);
              return glm::dvec3(frame * glm::dvec4(x, kerb_m, z, 1));
            };
            glm::dvec3 from = anywhere();
            for (int tries = 0; tries < 20 && !is_clear_of_camera(from, way); ++tries) from = anywhere();
            if (is_clear_of_camera(from, way)) add(from, way);
          }
        }
  }

 private:
  static constexpr int lantern_groups = 5;

  size_t next_gait() const { return next_ % gaits_.size(); }

  // Nobody walks into the camera.
  bool is_clear_of_camera(glm::dvec3 from, glm::dvec3 way) const {
    for (double t = 0; t <= end_s; t += 0.1) {
      const glm::dvec3 d = from + way * gaits_[next_gait()].speed_m_s * t - camera_at(t);
      if (glm::length(glm::dvec2(d.x, d.z)) < 1.3 && d.y > -3) return false;
    }
    return true;
  }

  void add(glm::dvec3 from, glm::dvec3 way) {
    GlbWriter& out = town_.out;
    const size_t gait = next_gait(), who = next_++;
    const Gait& g = gaits_[gait];
    const double scale = town_.rng.uniform(0.94, 1.06);
    const int walker =
        out.node("walker", {{"translation", vector_json(from)},
                            {"rotation", quaternion_json(rotation_about({0, 1, 0}, std::atan2(-way.x, -way.z)))},
                            {"scale", vector_json(glm::dvec3(scale))}});
    animate_places(out, walker, std::array{0.0, end_s}, std::array{from, from + way * g.speed_m_s * scale * end_s});
    static constexpr std::array<const char*, joint_count> names{
        "torso",      "head",       "left thigh", "left shin",    "left foot", "right thigh",
        "right shin", "right foot", "left arm",   "left forearm", "right arm", "right forearm"};
    json joints = json::array();
    for (size_t j = 0; j < joint_count; ++j) {
      const int joint = out.child(walker, names[j], {{"translation", vector_json(rest[j])}});
      joints.push_back(joint);
      play(out, samplers_[gait].places[j], joint, "translation");
      play(out, samplers_[gait].turns[j], joint, "rotation");
    }
    const int skin = int(out.root.value("skins", json::array()).size());
    out.root["skins"].push_back({{"joints", joints}, {"inverseBindMatrices", inverse_bind_}});
    out.child(walker, "body", {{"mesh", bodies_[who * 5 % bodies_.size()]}, {"skin", skin}});
    if (!g.with_lantern) return;
    // The forearm points ahead: +Z of its own space is down.
    const size_t group = who / 2 % lantern_groups;
    const int hand = out.child(joints[right_forearm], "lantern",
                               {{"mesh", lanterns_[group]},
                                {"translation", vector_json({0, -0.29, 0.33})},
                                {"rotation", quaternion_json(rotation_about({1, 0, 0}, -pi / 2))}});
    LightArrays light;
    light.add({0, -0.2, 0}, {1, 0.6, 0.28}, 4, 6, {0, 1, 0});
    light.aim({0, -1, 0.4});
    out.child(hand, "lantern light", {{"extensions", light.extension(out, lamps_[group])}});
  }

  Town& town_;
  std::vector<int> bodies_, lanterns_, lamps_;
  std::vector<Gait> gaits_;
  std::vector<Samplers> samplers_;
  int inverse_bind_ = -1;
  size_t next_ = 0;
};

}  // namespace

void add_city_people(Town& town) { People(town).make(); }

}  // namespace candela::city
