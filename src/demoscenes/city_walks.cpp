#include "demoscenes/city_walks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "demoscenes/city.h"

namespace candela::city {
namespace {

using std::numbers::pi;

constexpr double flat_share = 0.4, roll_share = 0.2;  // of a stride: the foot flat, and on its toes
constexpr double under_hip = 0.22;                    // so far into a stride the foot is below the hips

// A foot so many strides after it touched the ground, 0 to 1: where its ankle is, below the hips at z = 0.
Limb foot_at(const Gait& g, double into) {
  const double stride_m = g.speed_m_s * g.stride_s;
  const auto flat_z = [&](double t) { return (t - under_hip) * stride_m; };
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

constexpr double turn_key_s = 1 / 48.0, lands_from = 0.95;

}  // namespace

double arc_m(const Turn& t) { return pi / 2 * t.radius_m; }
Place place_after(const Turn& t, double walked_m) {
  if (walked_m <= t.after_m) return {{0, 0, -walked_m}, 0};
  const double over = walked_m - t.after_m, a = std::min(over, arc_m(t)) / t.radius_m;
  const glm::dvec3 corner(-t.side * t.radius_m, 0, -t.after_m);
  return {corner + glm::dvec3(t.side * (t.radius_m * std::cos(a) - std::max(over - arc_m(t), 0.0)), 0,
                              -t.radius_m * std::sin(a)),
          t.side * a};
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

Joints legs_at(const Gait& g, const Turn& turn, double time_s) {
  Joints joints;
  const auto place_at = [&](double t) { return place_after(turn, g.speed_m_s * t); };
  const double hip_y = hip_height(g, time_s);
  for (int side = 0; side < 2; ++side) {
    const double x = side ? hip_x_m : -hip_x_m, first = g.phase + 0.5 * side, cycle = time_s / g.stride_s + first;
    const double stride = std::floor(cycle), into = cycle - stride;
    const auto time_of = [&](double strides) { return (strides - first) * g.stride_s; };
    // On the ground: as when the hips are over it.
    const auto stood = [&](double of_stride) { return place_at(time_of(of_stride + under_hip)); };
    const auto on_ground = [&](double part) {
      glm::dvec3 p = foot_at(g, part).at;
      return glm::dvec3(x, p.y, p.z - (part - under_hip) * g.speed_m_s * g.stride_s);
    };
    const Limb straight = foot_at(g, into);
    const Place here = place_at(time_s), from = stood(stride);
    constexpr double lifted = flat_share + roll_share;
    glm::dvec3 ankle = here.in(from.of(on_ground(into)));
    double yaw = from.turn_rad - here.turn_rad;
    if (into > lifted) {
      const double u = (into - lifted) / (1 - lifted), ease = u * u * (3 - 2 * u);
      const Place leaves = place_at(time_of(stride + lifted)), lands = place_at(time_of(stride + 1)),
                  to = stood(stride + 1);
      ankle = glm::mix(leaves.in(from.of(on_ground(lifted))), lands.in(to.of(on_ground(0))), 0.4 * u + 0.6 * ease);
      ankle.y = straight.at.y;
      yaw = glm::mix(from.turn_rad - leaves.turn_rad, to.turn_rad - lands.turn_rad, ease);
    }
    // The leg lies in a plane through the hip and the ankle.
    const glm::dvec3 hip(x, hip_y, 0), way = ankle - hip;
    const glm::dquat lean = rotation_about({0, 0, 1}, std::atan2(way.x, -way.y));
    const auto leg = leg_to({0, 0, 0}, {0, -std::hypot(way.x, way.y), way.z});
    const auto put = [&](Joint left, Joint right, glm::dvec3 at, glm::dquat q) {
      const auto j = size_t(side ? right : left);
      joints.at[j] = at, joints.turn[j] = q;
    };
    put(left_thigh, right_thigh, hip, lean * rotation_about({1, 0, 0}, leg[0].swing_rad));
    put(left_shin, right_shin, hip + lean * leg[1].at, lean * rotation_about({1, 0, 0}, leg[1].swing_rad));
    put(left_foot, right_foot, ankle, Place::turned(yaw) * rotation_about({1, 0, 0}, straight.swing_rad));
  }
  return joints;
}

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

std::vector<double> turn_times(const Gait& g, const Turn& turn, std::vector<double> times, double first) {
  const double from = turn.after_m / g.speed_m_s - g.stride_s,
               to = (turn.after_m + arc_m(turn)) / g.speed_m_s + g.stride_s;
  for (double t = std::max(from, 0.0); t < std::min(to, end_s); t += turn_key_s) {
    // A foot comes down on one line, or it would slide just above the ground.
    if (fraction(t / g.stride_s + first) < lands_from || first < 0) times.push_back(t);
  }
  std::ranges::sort(times);
  const auto same = std::ranges::unique(times, [](double a, double b) { return b < a + 1e-4; });
  times.erase(same.begin(), same.end());
  return times;
}

}  // namespace candela::city
