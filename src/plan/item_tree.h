#pragma once
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "shared/cull.h"
#include "shared/scene.h"

namespace candela {

// Whether any device keeps an item in the view: a test in double that is four times as wide as the device's roundings.
bool may_keep(const shared::View& view, const shared::Item& item);
bool may_keep(const shared::View& view, glm::dvec3 centre, glm::dvec3 extent);

// A bounding volume hierarchy over items, to count for many views how many items of each class may be kept: the same
// counts as may_keep() for each item gives, without views times items tests. Eight neighbours on a Morton curve make a
// node, eight nodes the next one.
class ItemTree {
 public:
  // class_of: of each item; items of a negative class are left out. Items whose bounds are not finite are tested one by
  // one.
  ItemTree(std::span<const shared::Item> items, std::span<const int> class_of);
  // Adds to counts[class].
  void count(const shared::View& view, uint32_t* counts) const;

 private:
  struct Node {
    glm::dvec3 centre{0}, extent{0};
    uint32_t first = 0, end = 0;  // of order_
  };
  void count(const shared::View& view, size_t level, size_t node, uint32_t* counts) const;

  std::span<const shared::Item> items_;
  std::span<const int> class_of_;
  std::vector<uint32_t> order_;            // items along the curve
  std::vector<uint32_t> unbounded_;        // items
  std::vector<std::vector<Node>> levels_;  // from the leaves to the root
};

}  // namespace candela
