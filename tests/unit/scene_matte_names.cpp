#include "scene/matte_names.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

#include "base/hash.h"

namespace candela {

TEST(MatteNames, AreUnique) {
  EXPECT_EQ(unique_names({"Box", "", "Box", "Box #2", "", "node #1"}, "node"),
            (std::vector<std::string>{"Box", "node #1", "Box #2", "Box #2 #3", "node #4", "node #1 #5"}));
}

// Two names with one hash, found by search.
TEST(MatteNames, HaveIdsOfTheirOwn) {
  ASSERT_EQ(matte_id("n40665"), matte_id("n93112"));
  const std::vector<std::string> names = unique_names({"n40665", "a", "n93112", "b"}, "node");
  EXPECT_EQ(names, (std::vector<std::string>{"n40665", "a", "n93112 #2", "b"}));
  const std::vector<uint32_t> ids = matte_ids(names);
  EXPECT_EQ(std::set<uint32_t>(ids.begin(), ids.end()).size(), 4u);
}

// uint32_to_float32: bit 23 turns where the exponent's bits are all 0 or all 1, and nowhere else.
TEST(MatteNames, IdsAreOrdinaryFloats) {
  EXPECT_EQ(hash32("n17"), 0x000738c5u);
  EXPECT_EQ(matte_id("n17"), 0x008738c5u);
  EXPECT_EQ(hash32("n132"), 0x802d7680u);
  EXPECT_EQ(matte_id("n132"), 0x80ad7680u);
  EXPECT_EQ(hash32("n535"), 0xff8d97efu);
  EXPECT_EQ(matte_id("n535"), 0xff0d97efu);
  size_t turned = 0;
  for (int i = 0; i < 100000; ++i) {
    const std::string name = "n" + std::to_string(i);
    ASSERT_TRUE(std::isnormal(std::bit_cast<float>(matte_id(name)))) << name;
    turned += matte_id(name) != hash32(name);
  }
  EXPECT_NEAR(double(turned), 100000.0 * 2 / 256, 120);
}

// Surfaces without a material are a matte of their own, beside a material of that name.
TEST(MatteNames, EndWithTheDefaultMaterials) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[0].name = "default material";
  EXPECT_EQ(material_names(scene),
            (std::vector<std::string>{"default material", "material #1", "default material #2"}));
}

}  // namespace candela
