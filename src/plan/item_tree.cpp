#include "plan/item_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace candela {
namespace {

// The device adds and multiplies in float: about six roundings, and it keeps what lies outside by up to four.
constexpr double rounding = 16 * 0x1p-23;

// Every third bit, from 21 bits on.
uint64_t spread(uint64_t v) {
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

bool is_finite(const shared::Item& item) {
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(item.bounds_centre[c]) || !std::isfinite(item.bounds_extent[c])) return false;
  return true;
}

}  // namespace

ViewPlanes::ViewPlanes(const shared::View& view) {
  for (size_t p = 0; p < planes.size(); ++p) {
    const glm::dvec3 normal(view.planes[p]);
    planes[p] = {normal, glm::abs(normal), double(view.planes[p].w)};
  }
}

ItemTree::Lies ItemTree::place_of(const ViewPlanes& view, glm::dvec3 centre, glm::dvec3 extent) {
  Lies place = Lies::inside;
  for (const auto& [n, n_abs, w] : view.planes) {
    const double middle = glm::dot(n, centre) + w, half = glm::dot(n_abs, extent);
    // No scale of an item in the box is larger than this.
    const double scale = glm::dot(n_abs, glm::abs(centre) + 2.0 * extent) + std::abs(w);
    if (middle + half < -2 * rounding * scale) return Lies::outside;
    if (!(middle - half >= 0)) place = Lies::across;
  }
  return place;
}

bool may_keep(const ViewPlanes& view, glm::dvec3 centre, glm::dvec3 extent) {
  for (const auto& [n, n_abs, w] : view.planes) {
    const double outwards = glm::dot(n_abs, extent);
    const double reach = glm::dot(n, centre) + w + outwards;
    const double scale = glm::dot(n_abs, glm::abs(centre)) + outwards + std::abs(w);
    if (reach < -rounding * scale) return false;  // not for NaN
  }
  return true;
}

bool may_keep(const ViewPlanes& view, const shared::Item& item) {
  return may_keep(view, glm::dvec3(item.bounds_centre), glm::dvec3(item.bounds_extent));
}

ItemTree::ItemTree(std::span<const shared::Item> items, std::span<const int> class_of,
                   std::pmr::memory_resource* memory)
    : items_(items), class_of_(class_of), order_(memory), unbounded_(memory), levels_(memory) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  std::pmr::vector<std::pair<uint64_t, uint32_t>> curve(memory);
  curve.reserve(items.size());
  for (uint32_t i = 0; i < items.size(); ++i) {
    if (class_of[i] < 0) continue;
    if (!is_finite(items[i])) {
      unbounded_.push_back(i);
      continue;
    }
    curve.emplace_back(0, i);
    low = glm::min(low, glm::dvec3(items[i].bounds_centre)), high = glm::max(high, glm::dvec3(items[i].bounds_centre));
  }
  if (curve.empty()) return;
  const glm::dvec3 scale = double((1 << 21) - 1) / glm::max(high - low, glm::dvec3(1e-300));
  for (auto& [code, i] : curve) {
    const glm::dvec3 cell = (glm::dvec3(items[i].bounds_centre) - low) * scale;
    for (int c = 0; c < 3; ++c) code |= spread(uint64_t(std::clamp(cell[c], 0.0, double((1 << 21) - 1)))) << c;
  }
  std::ranges::sort(curve);
  order_.reserve(curve.size());
  for (const auto& [code, i] : curve) order_.push_back(i);

  // Boxes of the nodes of a level from those of the one below it; of leaves from the items.
  const auto enclose = [](Node& node, size_t first, size_t end, auto&& box_of) {
    glm::dvec3 from(std::numeric_limits<double>::infinity()), to = -from;
    for (size_t i = first; i < end; ++i) {
      const auto [centre, extent] = box_of(i);
      from = glm::min(from, centre - extent), to = glm::max(to, centre + extent);
    }
    node.centre = 0.5 * (from + to);
    // Rounded outwards.
    node.extent = (0.5 * (to - from)) * (1 + 1e-12) + 1e-12 * glm::abs(node.centre);
  };
  std::pmr::vector<Node> leaves((order_.size() + fan_out - 1) / fan_out, memory);
  for (size_t n = 0; n < leaves.size(); ++n) {
    leaves[n].first = uint32_t(n * fan_out), leaves[n].end = uint32_t(std::min((n + 1) * fan_out, order_.size()));
    enclose(leaves[n], leaves[n].first, leaves[n].end, [&](size_t i) {
      const shared::Item& item = items[order_[i]];
      return std::pair(glm::dvec3(item.bounds_centre), glm::dvec3(item.bounds_extent));
    });
  }
  levels_.push_back(std::move(leaves));
  while (levels_.back().size() > 1) {
    const std::pmr::vector<Node>& below = levels_.back();
    std::pmr::vector<Node> nodes((below.size() + fan_out - 1) / fan_out, memory);
    for (size_t n = 0; n < nodes.size(); ++n) {
      const size_t first = n * fan_out, end = std::min(first + fan_out, below.size());
      nodes[n].first = below[first].first, nodes[n].end = below[end - 1].end;
      enclose(nodes[n], first, end, [&](size_t i) { return std::pair(below[i].centre, below[i].extent); });
    }
    levels_.push_back(std::move(nodes));
  }
}

}  // namespace candela
