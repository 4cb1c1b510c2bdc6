#include "reference/lamps_along_ray.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/transforms.h"
#include "reference/equi_angular.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
// Of an estimate, the part that does not know the phase function, the range's window and the cone, and the one that
// knows no fog either: what three points may miss.
constexpr double without_shape = 0.05, without_fog = 1e-6;
// Clusters are taken apart down to this part of a point's worth.
constexpr double least_worth = 0.25;

// The part of a line, in metres from its point nearest to a spot, that lies in the spot's cone. `nearest`: that point
// as seen from the spot.
Span in_cone(const PunctualLight& light, glm::dvec3 nearest, glm::dvec3 direction, Span all) {
  const double c = light.cos_outer;
  if (!(c >= 0)) return all;
  // (w.axis)^2 >= c^2 w.w for w = nearest + s direction, of the half with w.axis >= 0.
  const double a = glm::dot(nearest, light.direction), b = glm::dot(direction, light.direction),
               h2 = glm::dot(nearest, nearest);
  const double square_term = b * b - c * c, half_linear = a * b, constant = a * a - c * c * h2;
  if (std::abs(square_term) < 1e-9) return all;
  const double under_root = c * c * (a * a + h2 * square_term);
  if (!(under_root > 0)) return square_term < 0 ? Span{} : all;
  const double q = -(half_linear + std::copysign(std::sqrt(under_root), half_linear));
  double first = q / square_term, second = q != 0 ? constant / q : first;
  if (first > second) std::swap(first, second);
  // The light's edge is dark; nothing of it is lost to rounding.
  const double slack = 1e-9 * (std::sqrt(h2) + std::abs(first) + std::abs(second));
  first -= slack, second += slack;
  Span lit = all;
  if (square_term < 0) {
    if (a + b * 0.5 * (first + second) < 0) return {};
    lit.begin_m = std::max(lit.begin_m, first), lit.end_m = std::min(lit.end_m, second);
  } else if (b > 0) {
    lit.begin_m = std::max(lit.begin_m, second - 2 * slack);
  } else {
    lit.end_m = std::min(lit.end_m, first + 2 * slack);
  }
  return lit;
}

}  // namespace

Span lit_part(const PunctualLight& light, glm::dvec3 origin, glm::dvec3 direction, Span span) {
  const EquiAngular angles(origin, direction, light.position, light.least_m);
  const Span near = angles.within(light.range_m);
  Span lit{std::max(near.begin_m, span.begin_m), std::min(near.end_m, span.end_m)};
  if (lit.empty() || light.type != LightType::spot) return lit;
  const double nearest_m = glm::dot(light.position - origin, direction);
  const Span cone = in_cone(light, origin + nearest_m * direction - light.position, direction,
                            {lit.begin_m - nearest_m, lit.end_m - nearest_m});
  return {cone.begin_m + nearest_m, cone.end_m + nearest_m};
}

LampsAlongRay::LampsAlongRay(const World& world, glm::dvec3 origin, glm::dvec3 direction, Span span, double anisotropy,
                             Left left)
    : world_(world),
      origin_(origin),
      direction_(direction),
      span_(span),
      anisotropy_(anisotropy),
      left_(std::move(left)) {}

const PunctualLight& LampsAlongRay::lamp_of(const LightTree::Node& leaf) const {
  return world_.punctual_lights()[world_.tree_punctual()[leaf.light]];
}

// False only where no light of the node lights any of the ray.
bool LampsAlongRay::reaches(const LightTree::Node& node) const {
  if (node.left < 0) return !lit_part(lamp_of(node), origin_, direction_, span_).empty();
  const glm::dvec3 to_centre = node.centre - origin_;
  const double along = std::clamp(glm::dot(to_centre, direction_), span_.begin_m, span_.end_m);
  const double distance_m = glm::length(to_centre - along * direction_);
  if (distance_m > (node.radius + node.extent.range_m) * (1 + 1e-9)) return false;
  // Light of a cone narrower than a half space stays on that half space's side of the cluster.
  if (!(node.extent.theta_o + node.extent.theta_e < pi / 2) || std::isinf(span_.end_m)) return true;
  const glm::dvec3 axis = node.extent.axis, begin = origin_ + span_.begin_m * direction_ - node.centre,
                   end = origin_ + span_.end_m * direction_ - node.centre;
  return std::max(glm::dot(begin, axis), glm::dot(end, axis)) >= -node.radius * (1 + 1e-9);
}

bool LampsAlongRay::reaching(size_t most, std::vector<uint32_t>& lights) const {
  lights.clear();
  const std::vector<LightTree::Node>& nodes = world_.lamp_tree().nodes();
  if (nodes.empty()) return true;
  static thread_local std::vector<int> open;
  open.assign(1, 0);
  while (!open.empty()) {
    const LightTree::Node& node = nodes[size_t(open.back())];
    open.pop_back();
    if (!reaches(node)) continue;
    if (node.left >= 0) {
      open.insert(open.end(), {node.right, node.left});
    } else {
      if (lights.size() == most) return false;
      lights.push_back(world_.tree_punctual()[node.light]);
    }
  }
  std::ranges::sort(lights);
  return true;
}

// The light of one lamp along the ray, what stands in its way aside, over what is the same for all.
double LampsAlongRay::of_lamp(const PunctualLight& light) const {
  const Span lit = lit_part(light, origin_, direction_, span_);
  if (lit.empty()) return 0;
  EquiAngular angles(origin_, direction_, light.position, light.least_m);
  angles.limit(lit);
  const double plain = luminance(light.intensity) * angles.angle() / angles.aside_m() / (4 * pi);
  if (!(plain > 0)) return 0;
  double sum = 0, shapeless = 0;
  constexpr int places = 3;
  for (int i = 0; i < places; ++i) {
    const double at = angles.distance_at((i + 0.5) / places);
    if (!std::isfinite(at)) continue;
    const glm::dvec3 p = origin_ + at * direction_;
    const Arrival a = arriving(light, p);
    const glm::dvec3 left = left_(at, p, a.l, a.distance_m);
    shapeless += plain * largest(left) / places;
    sum += luminance(a.illuminance * left) * henyey_greenstein(glm::dot(a.l, direction_), anisotropy_) /
           (angles.density(at) * places);
  }
  return sum + without_shape * shapeless + without_fog * plain;
}

double LampsAlongRay::importance(const LightTree::Node& node) const {
  if (!reaches(node)) return 0;
  if (node.left < 0) return of_lamp(lamp_of(node));
  // As if all of it hung in the middle, at least as far from the ray as the cluster is wide.
  const glm::dvec3 to_centre = node.centre - origin_;
  const double nearest_m = glm::dot(to_centre, direction_), aside2 = glm::dot(to_centre, to_centre) - square(nearest_m);
  const double held = std::max({std::sqrt(std::max(aside2, 0.0)), node.radius, 1e-5 * std::abs(nearest_m), 1e-30});
  double from = span_.begin_m - nearest_m, to = span_.end_m - nearest_m;
  if (std::isfinite(node.extent.range_m)) {
    const double reach = node.radius + node.extent.range_m;
    const double half = std::sqrt(std::max(square(reach) - aside2, square(1e-3 * reach)));
    from = std::clamp(from, -half, half), to = std::clamp(to, -half, half);
  }
  const double angle =
      std::isinf(to) ? std::atan2(held, from) : std::atan2(held * (to - from), held * held + from * to);
  if (!(angle > 0)) return node.extent.power / pi * without_fog * 1e-6;
  const double t = std::tan(0.5 * angle), below = held - from * t;
  const double middle = below > 0 ? std::clamp(held * (from + held * t) / below, from, to) : to;
  double plain = node.extent.power / pi * angle / held / (4 * pi);
  if (const double sent = node.extent.theta_o + node.extent.theta_e; sent < pi) plain *= sent / pi;
  if (!std::isfinite(middle)) return plain * without_fog;
  const glm::dvec3 p = origin_ + (nearest_m + middle) * direction_, to_light = node.centre - p;
  const double distance_m = glm::length(to_light);
  const glm::dvec3 l = distance_m > 0 ? to_light / distance_m : -direction_;
  const double left =
      largest(left_(std::max(nearest_m + middle - node.radius, 0.0), p, l, std::max(distance_m - node.radius, 0.0)));
  const double phase =
      0.5 +
      0.5 * 4 * pi * henyey_greenstein(glm::dot(l, direction_) * distance_m / (distance_m + node.radius), anisotropy_);
  return plain * (left * phase + without_fog);
}

LampsAlongRay::Cluster LampsAlongRay::cluster(int index) const {
  const LightTree::Node& node = world_.lamp_tree().nodes()[size_t(index)];
  Cluster c{index, importance(node), 0};
  if (node.left < 0 || !(c.importance > 0)) return c;
  const glm::dvec3 to_centre = node.centre - origin_;
  const double along = std::clamp(glm::dot(to_centre, direction_), span_.begin_m, span_.end_m);
  const double distance_m = glm::length(to_centre - along * direction_);
  c.worth = c.importance * (distance_m > node.radius ? node.radius / distance_m : 1);
  return c;
}

void LampsAlongRay::take_apart(size_t most, std::vector<Cluster>& clusters) const {
  const std::vector<LightTree::Node>& nodes = world_.lamp_tree().nodes();
  const auto dearer = [](const Cluster& a, const Cluster& b) {
    return a.worth != b.worth ? a.worth < b.worth : a.node > b.node;
  };
  clusters.assign(1, cluster(0));
  double total = clusters[0].importance;
  while (clusters.size() < most && clusters.front().worth * double(most) > least_worth * total) {
    std::ranges::pop_heap(clusters, dearer);
    const Cluster apart = clusters.back();
    clusters.pop_back();
    total -= apart.importance;
    for (const int child : {nodes[size_t(apart.node)].left, nodes[size_t(apart.node)].right}) {
      const Cluster c = cluster(child);
      if (!(c.importance > 0)) continue;
      total += c.importance;
      clusters.push_back(c);
      std::ranges::push_heap(clusters, dearer);
    }
    if (clusters.empty()) return;
  }
  std::ranges::sort(clusters, {}, &Cluster::node);
}

void LampsAlongRay::share_out(int index, Part part, double begin, double width, std::vector<Point>& chosen) const {
  const LightTree::Node& node = world_.lamp_tree().nodes()[size_t(index)];
  if (part.count == 0 || !(width > 0)) return;
  if (node.left < 0) {
    for (size_t i = 0; i < part.count; ++i)
      chosen.push_back(
          {world_.tree_punctual()[node.light], width, std::clamp((part.place[i] - begin) / width, 0.0, 1 - 0x1p-53)});
    return;
  }
  const std::vector<LightTree::Node>& nodes = world_.lamp_tree().nodes();
  const double a = importance(nodes[size_t(node.left)]), b = importance(nodes[size_t(node.right)]);
  if (!(a + b > 0)) return;
  const double left_width = width * (a / (a + b)), middle = begin + left_width;
  const size_t to_left =
      b > 0 ? size_t(std::lower_bound(part.place, part.place + part.count, middle) - part.place) : part.count;
  share_out(node.left, {part.place, to_left}, begin, left_width, chosen);
  share_out(node.right, {part.place + to_left, part.count - to_left}, middle, width - left_width, chosen);
}

void LampsAlongRay::choose(int points, double offset, std::vector<Point>& chosen) const {
  chosen.clear();
  if (world_.lamp_tree().empty() || points < 1) return;
  static thread_local std::vector<Cluster> clusters;
  static thread_local std::vector<double> places;
  take_apart(size_t(points), clusters);
  double total = 0;
  for (const Cluster& c : clusters) total += c.importance;
  if (!(total > 0)) return;
  places.resize(size_t(points));
  for (int k = 0; k < points; ++k) places[size_t(k)] = k + (k % 2 == 0 ? offset : 1 - offset);
  double before = 0;
  size_t next = 0;
  for (size_t i = 0; i < clusters.size(); ++i) {
    const double begin = before / total * points;
    before += clusters[i].importance;
    const double end = before / total * points;
    const size_t first = next;
    while (next < places.size() && (places[next] < end || i + 1 == clusters.size())) ++next;
    share_out(clusters[i].node, {places.data() + first, next - first}, begin, clusters[i].importance / total * points,
              chosen);
  }
}

}  // namespace candela::reference
