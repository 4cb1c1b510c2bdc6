#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "testscenes/table.h"

// How the walkers of the city move. A walker's node moves evenly, and its joints move below it: while a foot is on the
// ground it goes back evenly by as much, between two keys, so that it stands still in the world at any time. Knees
// follow from hips and ankles. Some turn at a corner of their block: there each foot on the ground keeps the place and
// direction that it has where the hips are over it.
namespace candela::city {

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

// How somebody walks: at a speed, in strides of both legs. -Z is ahead. Lengths are of a body of scale 1.
struct Gait {
  double speed_m_s, stride_s, phase;
  bool with_lantern;
};

// Of a limb: where its upper end is, and its turn about +X from hanging straight down; above 0 it swings ahead.
struct Limb {
  glm::dvec3 at;
  double swing_rad;
};

// A walk that turns left (side 1) or right (-1) by a quarter of a circle. Lengths are of a body of scale 1, places from
// the start, which faces -Z.
struct Turn {
  double after_m, radius_m, side;
};
struct Place {
  glm::dvec3 at;
  double turn_rad;
  glm::dvec3 of(glm::dvec3 p) const { return at + turned(turn_rad) * p; }
  glm::dvec3 in(glm::dvec3 p) const { return turned(-turn_rad) * (p - at); }
  static glm::dquat turned(double angle) { return rotation_about({0, 1, 0}, angle); }
};
double arc_m(const Turn& turn);
Place place_after(const Turn& turn, double walked_m);

// A walker's node: from where, to which way, how fast and with which turn.
struct Walk {
  glm::dvec3 from, way;
  double speed_m_s, scale;
  Turn turn;
  Place at(double time_s) const {
    const Place p = place_after(turn, speed_m_s * time_s);
    const double ahead_rad = std::atan2(-way.x, -way.z);
    return {from + scale * (Place::turned(ahead_rad) * p.at), ahead_rad + p.turn_rad};
  }
};

std::array<Limb, joint_count> pose_at(const Gait& gait, double time_s);
struct Joints {
  std::array<glm::dvec3, joint_count> at{};
  std::array<glm::dquat, joint_count> turn{};
};
// Feet and legs of a walk with a turn, in the space of the walker's node.
Joints legs_at(const Gait& gait, const Turn& turn, double time_s);

// The keys of a joint in all the film: feet have theirs where they touch the ground and leave it.
std::vector<double> key_times(const Gait& gait, size_t joint);
// Where a walk turns, keys are so close that what is on the ground stays there between them too. first: of a foot,
// where in its stride it is at the beginning; below 0: of anything else.
std::vector<double> turn_times(const Gait& gait, const Turn& turn, std::vector<double> times_s, double first = -1);

}  // namespace candela::city
