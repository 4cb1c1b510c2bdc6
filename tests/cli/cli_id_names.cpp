#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "image/io.h"
#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

std::string attribute(const FloatImage& image, const std::string& name) {
  for (const MetadataEntry& entry : image.metadata)
    if (entry.name == name) return entry.text;
  return {};
}

}  // namespace

// Every id of the picture has a name, no other has, and no two ids share one.
TEST(IdNames, StandBesideTheIds) {
  const TestFolder folder;
  Json of_render;
  for (const std::string command : {"render", "reference"}) {
    const std::string file = folder / (command + ".exr");
    const Ended made = candela(
        {command, scene("spheres"), "--size", "48x27", "--layers", "object_id,material_id", "-o", file, "--quiet"});
    ASSERT_EQ(made.code, 0) << made.err;
    const auto image = read_image(file);
    ASSERT_TRUE(image);
    EXPECT_TRUE(attribute(*image, "software").starts_with("candela ")) << attribute(*image, "software");
    Json both;
    for (const std::string layer : {"object_id", "material_id"}) {
      const Json names = Json::parse(attribute(*image, "candela:" + layer));
      std::set<std::string> ids, different;
      for (const uint32_t id : image->find(layer + ".X")->u)
        if (id != 0xffffffffu) ids.insert(std::to_string(id));
      ASSERT_GT(ids.size(), 1u);
      EXPECT_EQ(names.size(), ids.size());
      for (const std::string& id : ids) {
        ASSERT_TRUE(names.contains(id)) << layer << " " << id;
        EXPECT_TRUE(different.insert(names[id]).second) << names[id];
      }
      both[layer] = names;
    }
    if (command == "render") of_render = both;
    EXPECT_EQ(both, of_render);
  }
  ASSERT_EQ(candela({"render", scene("spheres"), "--size", "16x9", "-o", folder / "plain.exr", "--quiet"}).code, 0);
  const auto plain = read_image(folder / "plain.exr");
  ASSERT_TRUE(plain);
  EXPECT_EQ(attribute(*plain, "candela:object_id"), "");
}

}  // namespace candela::test
