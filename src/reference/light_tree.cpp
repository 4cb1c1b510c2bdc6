#include "reference/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr int buckets = 12;
// Clusters are taken apart where the point is nearer to their centre than this many radii.
constexpr double split_reach = 1;

double angle_between(glm::dvec3 a, glm::dvec3 b) { return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)); }

glm::dvec3 turned(glm::dvec3 v, glm::dvec3 unit_axis, double angle) {  // Rodrigues
  return v * std::cos(angle) + glm::cross(unit_axis, v) * std::sin(angle) +
         unit_axis * glm::dot(unit_axis, v) * (1 - std::cos(angle));
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
  m.is_sphere = a.is_sphere || b.is_sphere;
  return m;
}

// Power times the measures of space and of directions: what a node costs in the paper's surface area orientation
// heuristic.
double cost(const LightExtent& e) {
  if (e.box.empty()) return 0;
  const double o = e.theta_o, w = std::min(o + e.theta_e, pi);
  const double directions = 2 * pi * (1 - std::cos(o)) +
                            pi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
  const glm::dvec3 d = e.box.max - e.box.min;
  const double length = d.x + d.y + d.z;  // lights on a line span no area
  return e.power * std::max(directions, 1e-6) * (d.x * d.y + d.y * d.z + d.z * d.x + 1e-3 * length * length);
}

// The cosine of an angle less another, held at 0 degrees.
double cos_less(double cos_a, double sin_a, double cos_b, double sin_b) {
  return cos_a > cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}
double sin_of(double cosine) { return std::sqrt(std::max(1 - cosine * cosine, 0.0)); }

}  // namespace

void merge_cones(glm::dvec3 axis_a, double theta_a, glm::dvec3 axis_b, double theta_b, glm::dvec3& axis,
                 double& theta) {
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

// An estimate of what arrives from a cluster, never 0 where some of its light can arrive.
double LightTree::importance(const Node& node, glm::dvec3 point, glm::dvec3 normal) {
  const LightExtent& e = node.extent;
  if (std::isfinite(e.range_m)) {
    const glm::dvec3 outside = glm::max(glm::max(e.box.min - point, point - e.box.max), glm::dvec3(0));
    if (glm::dot(outside, outside) > e.range_m * e.range_m * (1 + 1e-9)) return 0;
  }
  const glm::dvec3 to_centre = node.centre - point;
  const double distance2 = glm::dot(to_centre, to_centre), distance = std::sqrt(distance2);
  const double held2 = std::max({distance2, node.radius * node.radius, 1e-4});
  if (distance <= node.radius * (1 + 1e-9) || distance == 0) return e.power / held2;
  const glm::dvec3 l = to_centre / distance;
  // Half the angle that the cluster's sphere takes, and a little more against rounding.
  const double sin_spread = std::min(node.radius / distance + 1e-9, 1.0), cos_spread = sin_of(sin_spread);
  const double cos_in = std::clamp(glm::dot(normal, l), -1.0, 1.0);
  const double received = normal == glm::dvec3(0) ? 1 : cos_less(cos_in, sin_of(cos_in), cos_spread, sin_spread);
  if (received <= 0) return 0;
  double sent = std::clamp(-glm::dot(e.axis, l), -1.0, 1.0);
  sent = cos_less(sent, sin_of(sent), node.cos_o, node.sin_o);
  sent = cos_less(sent, sin_of(sent), cos_spread, sin_spread);
  if (sent < node.cos_e - 1e-9) return 0;
  // A spot's light does not fall with the cosine, so that its edge must keep some fraction.
  return e.power * std::max(received, 1e-3) * std::max(sent, 1e-3) / held2;
}

LightTree::LightTree(std::vector<LightExtent> lights) : leaf_of_light_(lights.size(), -1) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < lights.size(); ++i)
    if (lights[i].power > 0) order.push_back(i);
  if (order.empty()) return;
  nodes_.reserve(2 * order.size());
  build(order, 0, order.size(), lights, -1);
}

int LightTree::build(std::vector<uint32_t>& order, size_t first, size_t last, const std::vector<LightExtent>& lights,
                     int parent) {
  const int index = int(nodes_.size());
  nodes_.push_back({});
  nodes_[size_t(index)].parent = parent;
  LightExtent whole;
  DAabb centres;
  for (size_t i = first; i < last; ++i) {
    whole = merged(whole, lights[order[i]]);
    centres.add(lights[order[i]].box.centre());
  }
  Node& node = nodes_[size_t(index)];
  node.extent = whole;
  node.centre = whole.box.centre(), node.radius = glm::length(whole.box.extent());
  node.cos_o = std::cos(whole.theta_o), node.sin_o = std::sin(whole.theta_o),
  node.cos_e = std::cos(std::min(whole.theta_e, pi));
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

bool LightTree::is_about(const Node& node, glm::dvec3 point) {
  return node.left >= 0 && node.radius > 0 && glm::length(node.centre - point) < split_reach * node.radius;
}

void LightTree::choose(glm::dvec3 point, glm::dvec3 normal, double u, bool split, std::vector<Choice>& chosen) const {
  chosen.clear();
  if (nodes_.empty()) return;
  int stack[128], top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const int at = stack[--top];
    const Node* node = &nodes_[size_t(at)];
    if (importance(*node, point, normal) <= 0) continue;
    if (split && top + 2 <= 128 && is_about(*node, point)) {
      stack[top++] = node->right, stack[top++] = node->left;
      continue;
    }
    // Clusters get numbers of their own, each as even as u is.
    double own = u + double(at) * 0.6180339887498949;
    own -= std::floor(own);
    double probability = 1;
    while (node && node->left >= 0) {
      const Node &left = nodes_[size_t(node->left)], &right = nodes_[size_t(node->right)];
      const double a = importance(left, point, normal), b = importance(right, point, normal);
      if (!(a + b > 0)) {
        node = nullptr;
        break;
      }
      const double fraction = a / (a + b);
      if (own < fraction || b <= 0) {
        own = std::min(own / fraction, 1 - 0x1p-53);
        probability *= fraction;
        node = &left;
      } else {
        own = std::min((own - fraction) / (1 - fraction), 1 - 0x1p-53);
        probability *= 1 - fraction;
        node = &right;
      }
    }
    if (node) chosen.push_back({node->light, probability});
  }
}

void LightTree::met(glm::dvec3 origin, glm::dvec3 direction, std::vector<uint32_t>& lights) const {
  lights.clear();
  if (!has_spheres()) return;
  static thread_local std::vector<int> open;
  open.assign(1, 0);
  while (!open.empty()) {
    const Node& node = nodes_[size_t(open.back())];
    open.pop_back();
    if (!node.extent.is_sphere) continue;
    const glm::dvec3 to_centre = node.centre - origin;
    const double along = glm::dot(to_centre, direction), radius = node.radius * (1 + 1e-9);
    const glm::dvec3 aside = to_centre - along * direction;
    if (along < -radius || glm::dot(aside, aside) > radius * radius) continue;
    if (node.left < 0)
      lights.push_back(node.light);
    else
      open.insert(open.end(), {node.right, node.left});
  }
}

double LightTree::probability(uint32_t light, glm::dvec3 point, glm::dvec3 normal, bool split) const {
  if (nodes_.empty() || leaf_of_light_[light] < 0) return 0;
  int path[256], length = 0;  // from the leaf to the root
  for (int n = leaf_of_light_[light]; n >= 0 && length < 256; n = nodes_[size_t(n)].parent) path[length++] = n;
  double probability = 1;
  bool apart = split;
  for (int i = length - 1; i >= 0; --i) {
    const Node& node = nodes_[size_t(path[i])];
    if (apart || i == length - 1)
      if (importance(node, point, normal) <= 0) return 0;
    if (node.left < 0) break;
    apart = apart && is_about(node, point);
    if (apart) continue;
    const double a = importance(nodes_[size_t(node.left)], point, normal);
    const double b = importance(nodes_[size_t(node.right)], point, normal);
    if (!(a + b > 0)) return 0;
    const double fraction = a / (a + b);
    probability *= path[i - 1] == node.left ? fraction : 1 - fraction;
  }
  return probability;
}

}  // namespace candela::reference
