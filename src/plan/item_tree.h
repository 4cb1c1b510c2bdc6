#pragma once
#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <memory_resource>
#include <span>
#include <vector>

#include "shared/cull.h"
#include "shared/scene.h"

namespace candela {

// A view's planes as the tests take them.
struct ViewPlanes {
  struct Plane {
    glm::dvec3 normal, size;  // size: of its components
    double away;
  };
  std::array<Plane, sizeof(shared::View::planes) / sizeof(glm::vec4)> planes;
  ViewPlanes(const shared::View& view);
};

// Whether any device keeps an item in the view: a test in double that is four times as wide as the device's roundings.
bool may_keep(const ViewPlanes& view, const shared::Item& item);
bool may_keep(const ViewPlanes& view, glm::dvec3 centre, glm::dvec3 extent);

// A bounding volume hierarchy over items, to count for many views how many items of each class may be kept: the same
// counts as may_keep() for each item gives, without views times items tests. Eight neighbours on a Morton curve make a
// node, eight nodes the next one.
class ItemTree {
 public:
  // class_of: of each item; items of a negative class are left out. Items whose bounds are not finite are tested one by
  // one.
  // memory: for the tree; lives as long.
  ItemTree(std::span<const shared::Item> items, std::span<const int> class_of,
           std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  // Calls for each such item, in an order of the tree's.
  template <class Found>
  void each(const ViewPlanes& view, Found&& found) const {
    for (const uint32_t i : unbounded_)
      if (may_keep(view, items_[i])) found(i);
    if (!levels_.empty()) each(view, levels_.size() - 1, 0, found);
  }
  // Adds to counts[class].
  void count(const ViewPlanes& view, uint32_t* counts) const {
    each(view, [&](uint32_t i) { ++counts[class_of_[i]]; });
  }

 private:
  struct Node {
    glm::dvec3 centre{0}, extent{0};
    uint32_t first = 0, end = 0;  // of order_
  };
  // How a box lies in a view whose planes point inwards. outside: may_keep() is false for whatever lies in the box, and
  // inside: true, whatever the last bits are.
  enum class Lies { outside, across, inside };
  static Lies place_of(const ViewPlanes& view, glm::dvec3 centre, glm::dvec3 extent);
  template <class Found>
  void each(const ViewPlanes& view, size_t level, size_t node_index, Found& found) const {
    const Node& node = levels_[level][node_index];
    const Lies place = place_of(view, node.centre, node.extent);
    if (place == Lies::outside) return;
    if (place == Lies::inside || level == 0) {
      for (uint32_t i = node.first; i < node.end; ++i)
        if (place == Lies::inside || may_keep(view, items_[order_[i]])) found(order_[i]);
      return;
    }
    const size_t end = std::min((node_index + 1) * fan_out, levels_[level - 1].size());
    for (size_t child = node_index * fan_out; child < end; ++child) each(view, level - 1, child, found);
  }
  static constexpr size_t fan_out = 8;

  std::span<const shared::Item> items_;
  std::span<const int> class_of_;
  std::pmr::vector<uint32_t> order_;                 // items along the curve
  std::pmr::vector<uint32_t> unbounded_;             // items
  std::pmr::vector<std::pmr::vector<Node>> levels_;  // from the leaves to the root
};

}  // namespace candela
