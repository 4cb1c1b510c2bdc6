#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "demoscenes/city.h"
#include "demoscenes/city_walks.h"
#include "testscenes/table.h"

// People who walk along the pavements, some with lanterns.
namespace candela::city {
namespace {

using std::numbers::pi;

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

  // Along the sides of a block, in the middle of the pavement; every sixth turns at the corner.
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
            for (int tries = 0; tries < 20 && !is_clear_of_camera(straight(from, way)); ++tries) from = anywhere();
            Walk walk = straight(from, way);
            if (!is_clear_of_camera(walk)) continue;
            walk.scale = town_.rng.uniform(0.94, 1.06);
            const auto turn_s = turn_times_s[next_ / 3 % turn_times_s.size()];
            if (next_ % 6 == 1) {
              Walk turning = walk;
              turning.turn = {turn_s * walk.speed_m_s, turn_radius_m / walk.scale, right ? 1.0 : -1.0};
              // The middle of the pavement of the next side is as far from the block's middle as here.
              const double x = (right ? 1 : -1) * (z - turn_radius_m - turn_s * walk.speed_m_s * walk.scale);
              turning.from = glm::dvec3(frame * glm::dvec4(x, kerb_m, z, 1));
              if (is_clear_of_camera(turning)) walk = turning;
            }
            add(walk);
          }
        }
  }

 private:
  static constexpr int lantern_groups = 5;
  static constexpr double turn_radius_m = 2.4;
  static constexpr std::array turn_times_s{3.1, 9.2, 7.6, 15.4, 4.6, 10.7, 14.2};

  size_t next_gait() const { return next_ % gaits_.size(); }

  Walk straight(glm::dvec3 from, glm::dvec3 way) const {
    return {from, way, gaits_[next_gait()].speed_m_s, 1, {1e6, 1, 1}};
  }

  // Nobody walks into the camera.
  static bool is_clear_of_camera(const Walk& walk) {
    for (double t = 0; t <= end_s; t += 0.1) {
      const glm::dvec3 d = walk.at(t).at - camera_at(t);
      if (glm::length(glm::dvec2(d.x, d.z)) < 1.3 && d.y > -3) return false;
    }
    return true;
  }

  void add(const Walk& walk) {
    GlbWriter& out = town_.out;
    const size_t gait = next_gait(), who = next_++;
    const Gait& g = gaits_[gait];
    const bool turns = walk.turn.after_m < g.speed_m_s * end_s;
    const int walker = out.node("walker", {{"translation", vector_json(walk.from)},
                                           {"rotation", quaternion_json(Place::turned(walk.at(0).turn_rad))},
                                           {"scale", vector_json(glm::dvec3(walk.scale))}});
    std::vector<double> times{0.0, end_s};
    if (turns) times = turn_times(g, walk.turn, times);
    std::vector<glm::dvec3> places;
    std::vector<glm::dquat> heads;
    for (double t : times) places.push_back(walk.at(t).at), heads.push_back(Place::turned(walk.at(t).turn_rad));
    animate_places(out, walker, times, places);
    if (turns) animate_turns(out, walker, times, heads);
    const Samplers samplers = turns ? turning_samplers(gait, walk.turn) : samplers_[gait];
    static constexpr std::array<const char*, joint_count> names{
        "torso",      "head",       "left thigh", "left shin",    "left foot", "right thigh",
        "right shin", "right foot", "left arm",   "left forearm", "right arm", "right forearm"};
    json joints = json::array();
    for (size_t j = 0; j < joint_count; ++j) {
      const int joint = out.child(walker, names[j], {{"translation", vector_json(rest[j])}});
      joints.push_back(joint);
      play(out, samplers.places[j], joint, "translation");
      play(out, samplers.turns[j], joint, "rotation");
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

  // Legs and feet of its own, the rest as of its gait.
  Samplers turning_samplers(size_t gait, const Turn& turn) {
    const Gait& g = gaits_[gait];
    Samplers made = samplers_[gait];
    for (size_t j = left_thigh; j <= right_foot; ++j) {
      const std::vector<double> times = turn_times(g, turn, key_times(g, j),
                                                   j == left_foot    ? g.phase
                                                   : j == right_foot ? g.phase + 0.5
                                                                     : -1);
      std::vector<double> places, turns;
      for (double t : times) {
        const Joints joints = legs_at(g, turn, t);
        push(places, joints.at[j]);
        push(turns, joints.turn[j]);
      }
      made.places[j] = add_sampler(town_.out, times, places, 3);
      made.turns[j] = add_sampler(town_.out, times, turns, 4);
    }
    return made;
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
