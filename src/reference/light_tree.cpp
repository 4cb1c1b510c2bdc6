#include "reference/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace candela::reference {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int buckets = 12;

double angle_between(glm::dvec3 a, glm::dvec3 b) { return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)); }

glm::dvec3 turned(glm::dvec3 v, glm::dvec3 unit_axis, double angle) {  // Rodrigues
  return v * std::cos(angle) + glm::cross(unit_axis, v) * std::sin(angle) + unit_axis * glm::dot(unit_axis, v) * (1 - std::cos(angle));
}

LightExtent merged(const LightExtent& a, const LightExtent& b) {
  if (a.box.empty()) return b;
  if (b.box.empty()) return a;
  LightExtent m;
  m.box = a.box;
  m.box.add(b.box);
  m.power = a.power + b.power;
  merge_cones(a.axis, a.theta_o, b.axis, b.theta_o, m.axis, m.theta_o);
  m.theta_e = std::max(a.theta_e, b.theta_e);
  m.range_m = std::max(a.range_m, b.range_m);
  return m;
}

// Power times the measures of space and of directions: what a node costs in the paper's surface area orientation heuristic.
double cost(const LightExtent& e) {
  if (e.box.empty()) return 0;
  const double o = e.theta_o, w = std::min(o + e.theta_e, pi);
  const double directions = 2 * pi * (1 - std::cos(o)) +
                            pi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
  const glm::dvec3 d = e.box.max - e.box.min;
  const double length = d.x + d.y + d.z;  // lights on a line span no area
  return e.power * std::max(directions, 1e-6) * (d.x * d.y + d.y * d.z + d.z * d.x + 1e-3 * length * length);
}

// An estimate of what arrives from a cluster, never 0 where some of its light can arrive.
double importance(const LightExtent& e, glm::dvec3 point, glm::dvec3 normal) {
  if (std::isfinite(e.range_m)) {
    const glm::dvec3 outside = glm::max(glm::max(e.box.min - point, point - e.box.max), glm::dvec3(0));
    if (glm::length(outside) > e.range_m * (1 + 1e-9)) return 0;
  }
  const glm::dvec3 to_centre = e.box.centre() - point;
  const double radius = glm::length(e.box.extent()), distance = glm::length(to_centre);
  const double held = std::max({distance, radius, 1e-2});
  double shares = 1;
  if (distance > radius * (1 + 1e-9)) {
    const glm::dvec3 l = to_centre / distance;
    const double spread = std::asin(std::min(radius / distance, 1.0)) + 1e-9;
    const double received = std::max(angle_between(normal, l) - spread, 0.0);
    if (received >= pi / 2) return 0;
    const double sent = std::max(angle_between(e.axis, -l) - e.theta_o - spread, 0.0);
    if (sent > e.theta_e + 1e-9) return 0;
    // A spot's emission does not fall with the cosine, so its edge must keep some share.
    shares = std::max(std::cos(received), 1e-3) * std::max(std::cos(sent), 1e-3);
  }
  return e.power * shares / (held * held);
}

}  // namespace

void merge_cones(glm::dvec3 axis_a, double theta_a, glm::dvec3 axis_b, double theta_b, glm::dvec3& axis, double& theta) {
  if (theta_b > theta_a) std::swap(axis_a, axis_b), std::swap(theta_a, theta_b);
  const double between = angle_between(axis_a, axis_b);
  axis = axis_a, theta = theta_a;
  if (std::min(between + theta_b, pi) <= theta_a) return;
  theta = (theta_a + between + theta_b) / 2;
  const glm::dvec3 about = glm::cross(axis_a, axis_b);
  const double length = glm::length(about);
  if (theta >= pi || !(length > 1e-12)) {
    theta = pi;
    return;
  }
  axis = glm::normalize(turned(axis_a, about / length, theta - theta_a));
}

LightTree::LightTree(std::vector<LightExtent> lights) : leaf_of_light_(lights.size(), -1) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < lights.size(); ++i)
    if (lights[i].power > 0) order.push_back(i);
  if (order.empty()) return;
  nodes_.reserve(2 * order.size());
  build(order, 0, order.size(), lights, -1);
}

int LightTree::build(std::vector<uint32_t>& order, size_t first, size_t last, const std::vector<LightExtent>& lights, int parent) {
  const int index = int(nodes_.size());
  nodes_.push_back({});
  nodes_[size_t(index)].parent = parent;
  LightExtent whole;
  DAabb centres;
  for (size_t i = first; i < last; ++i) {
    whole = merged(whole, lights[order[i]]);
    centres.add(lights[order[i]].box.centre());
  }
  nodes_[size_t(index)].extent = whole;
  if (last - first == 1) {
    nodes_[size_t(index)].light = order[first];
    leaf_of_light_[order[first]] = index;
    return index;
  }
  // Binned over all axes; lights on one point are halved by their order.
  double best = std::numeric_limits<double>::infinity();
  int best_axis = -1, best_bucket = 0;
  const glm::dvec3 size = centres.max - centres.min;
  const auto bucket_of = [&](uint32_t light, int axis) {
    return std::min(int((lights[light].box.centre()[axis] - centres.min[axis]) / size[axis] * buckets), buckets - 1);
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (!(size[axis] > 0)) continue;
    std::array<LightExtent, buckets> bins;
    for (size_t i = first; i < last; ++i) {
      LightExtent& bin = bins[size_t(bucket_of(order[i], axis))];
      bin = merged(bin, lights[order[i]]);
    }
    const double regular = std::max({size.x, size.y, size.z}) / size[axis];  // thin boxes are cut along their length
    for (int split = 1; split < buckets; ++split) {
      LightExtent left, right;
      for (int b = 0; b < buckets; ++b) (b < split ? left : right) = merged(b < split ? left : right, bins[size_t(b)]);
      if (left.box.empty() || right.box.empty()) continue;
      const double value = regular * (cost(left) + cost(right));
      if (value < best) best = value, best_axis = axis, best_bucket = split;
    }
  }
  size_t middle = (first + last) / 2;
  if (best_axis >= 0)
    middle = size_t(std::stable_partition(order.begin() + long(first), order.begin() + long(last),
                                          [&](uint32_t light) { return bucket_of(light, best_axis) < best_bucket; }) -
                    order.begin());
  const int left = build(order, first, middle, lights, index), right = build(order, middle, last, lights, index);
  nodes_[size_t(index)].left = left;
  nodes_[size_t(index)].right = right;
  return index;
}

std::optional<LightTree::Choice> LightTree::choose(glm::dvec3 point, glm::dvec3 normal, double u) const {
  if (nodes_.empty()) return std::nullopt;
  double probability = 1;
  const Node* node = &nodes_[0];
  if (importance(node->extent, point, normal) <= 0) return std::nullopt;
  while (node->left >= 0) {
    const Node &left = nodes_[size_t(node->left)], &right = nodes_[size_t(node->right)];
    const double a = importance(left.extent, point, normal), b = importance(right.extent, point, normal);
    if (!(a + b > 0)) return std::nullopt;
    const double share = a / (a + b);
    if (u < share || b <= 0) {
      u = std::min(u / share, 1 - 0x1p-53);
      probability *= share;
      node = &left;
    } else {
      u = std::min((u - share) / (1 - share), 1 - 0x1p-53);
      probability *= 1 - share;
      node = &right;
    }
  }
  return Choice{node->light, probability};
}

double LightTree::probability(uint32_t light, glm::dvec3 point, glm::dvec3 normal) const {
  if (nodes_.empty() || leaf_of_light_[light] < 0) return 0;
  if (importance(nodes_[0].extent, point, normal) <= 0) return 0;
  double probability = 1;
  for (int n = leaf_of_light_[light]; nodes_[size_t(n)].parent >= 0; n = nodes_[size_t(n)].parent) {
    const Node& parent = nodes_[size_t(nodes_[size_t(n)].parent)];
    const double a = importance(nodes_[size_t(parent.left)].extent, point, normal);
    const double b = importance(nodes_[size_t(parent.right)].extent, point, normal);
    if (!(a + b > 0)) return 0;
    const double share = a / (a + b);
    probability *= n == parent.left ? share : 1 - share;
  }
  return probability;
}

}  // namespace candela::reference
