#include "plan/item_tree.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/rng.h"

namespace candela {
namespace {

shared::Item item_at(glm::dvec3 centre, glm::dvec3 extent) {
  shared::Item item{};
  item.bounds_centre = glm::vec3(centre), item.bounds_extent = glm::vec3(extent);
  return item;
}

// Six planes that point inwards, about a place, some of them slanted.
shared::View view_about(glm::dvec3 place, double half, Rng& rng) {
  shared::View view{};
  for (size_t p = 0; p < std::size(view.planes); ++p) {
    glm::dvec3 n(0);
    n[int(p / 2) % 3] = p % 2 ? -1 : 1;
    n = glm::normalize(n + 0.3 * glm::dvec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)));
    view.planes[p] = glm::vec4(glm::vec3(n), float(half - glm::dot(n, place)));
  }
  return view;
}

}  // namespace

// The counts are those of the test of each item: items large and small, in one place and far off, some that are left
// out, some without finite bounds, and some whose outline lies on a plane.
TEST(ItemTree, CountsWhatEachItemsTestCounts) {
  Rng rng(7);
  std::vector<shared::Item> items;
  std::vector<int> class_of;
  constexpr int classes = 5;
  for (int i = 0; i < 3000; ++i) {
    const double spread = i % 3 == 0 ? 1000 : 10;
    const glm::dvec3 centre(rng.uniform(-spread, spread), rng.uniform(-spread, spread), rng.uniform(-spread, spread));
    items.push_back(
        item_at(i % 50 == 0 ? glm::dvec3(1, 2, 3) : centre, glm::dvec3(rng.uniform(0, i % 7 == 0 ? 50 : 1))));
    class_of.push_back(i % 11 == 0 ? -1 : i % classes);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double odd : {infinity, std::numeric_limits<double>::quiet_NaN()}) {
    items.push_back(item_at({0, odd, 0}, glm::dvec3(1)));
    items.push_back(item_at({0, 0, 0}, glm::dvec3(odd)));
    class_of.insert(class_of.end(), 2, 1);
  }
  const ItemTree tree(items, class_of);
  uint64_t kept = 0, left_out = 0;
  for (int v = 0; v < 200; ++v) {
    shared::View view = view_about({rng.uniform(-12, 12), rng.uniform(-12, 12), rng.uniform(-12, 12)},
                                   rng.uniform(0.1, v % 10 == 0 ? 2000 : 8), rng);
    // The nearest plane touches an item to the last bit.
    const shared::Item& touched = items[size_t(v) * 7];
    view.planes[0].w = -(glm::dot(glm::vec3(view.planes[0]), touched.bounds_centre) +
                         glm::dot(glm::abs(glm::vec3(view.planes[0])), touched.bounds_extent));
    std::vector<uint32_t> counts(classes, 0), expected(classes, 0);
    tree.count(view, counts.data());
    for (size_t i = 0; i < items.size(); ++i)
      if (class_of[i] >= 0) {
        const bool keeps = may_keep(view, items[i]);
        expected[size_t(class_of[i])] += keeps;
        ++(keeps ? kept : left_out);
      }
    EXPECT_EQ(counts, expected) << "view " << v;
  }
  EXPECT_GT(kept, 1000u);
  EXPECT_GT(left_out, 100000u);
}

TEST(ItemTree, OfNothingCountsNothing) {
  const std::vector<shared::Item> items(3, item_at({0, 0, 0}, {1, 1, 1}));
  const std::vector<int> none(3, -1);
  Rng rng(1);
  uint32_t count = 0;
  ItemTree({}, {}).count(view_about({0, 0, 0}, 5, rng), &count);
  ItemTree(items, none).count(view_about({0, 0, 0}, 5, rng), &count);
  EXPECT_EQ(count, 0u);
}

}  // namespace candela
