// --exposure auto in closed form, on unlit squares.
#include "render/metering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "gltf_builder.h"

namespace candela::test {
namespace {

// A wide square of one colour 2 m off, and before it a square of another with so many metres a side.
Job squares(double wide, double small, double side_m) {
  GltfBuilder b;
  b.use("KHR_materials_unlit");
  b.json["nodes"] = Json::array(), b.json["scenes"][0]["nodes"] = Json::array();
  const auto square = [&](double colour, double half, double z) {
    const auto x = float(half), depth = float(z);
    Json& primitive = b.primitive(
        {{"POSITION", b.accessor<float>("VEC3", {-x, -x, depth, x, -x, depth, -x, x, depth, x, x, depth})}});
    primitive["indices"] = b.accessor<uint8_t>("SCALAR", {0, 1, 2, 2, 1, 3});
    primitive["material"] = b.json["materials"].size();
    b.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", {colour, colour, colour, 1}}}},
                                   {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
    b.json["scenes"][0]["nodes"].push_back(b.json["nodes"].size());
    b.json["nodes"].push_back({{"mesh", b.json["meshes"].size() - 1}});
  };
  square(wide, 20, 0);
  if (side_m > 0) square(small, side_m / 2, 0.1);
  Job job;
  job.scene = (std::filesystem::path(testing::TempDir()) / "candela_metering.glb").string();
  const auto bytes = b.glb();
  std::ofstream(job.scene, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), long(bytes.size()));
  job.width_px = 320, job.height_px = 180;
  job.camera.eye = glm::dvec3(0, 0, 2), job.camera.target = glm::dvec3(0);
  return job;
}

TEST(Metering, PutsTheMiddleAtEighteenPercent) {
  for (const double grey : {0.002, 0.18, 0.9}) {
    const auto ev = metered_ev(squares(grey, 0, 0));
    ASSERT_TRUE(ev) << ev.error().text();
    EXPECT_NEAR(*ev, std::log2(0.18 / grey), 1e-5) << grey;
  }
}

// A tenth of the picture would be burnt out by what the dark rest asks for: it stays within a stop above white.
TEST(Metering, LeavesBrightPartsWithinAStopOfWhite) {
  EXPECT_NEAR(*metered_ev(squares(0.001, 1, 0.5)), 1, 1e-5);
  EXPECT_NEAR(*metered_ev(squares(0.001, 0.25, 0.5)), 3, 1e-5);
}

TEST(Metering, BlackAndNothingAskForNothing) {
  EXPECT_EQ(*metered_ev(squares(0, 0, 0)), 0);
  Job away = squares(0.5, 0, 0);
  away.camera.target = glm::dvec3(0, 0, 9);
  EXPECT_EQ(*metered_ev(away), 0);
}

// What the job says of exposure, and its size, make no difference.
TEST(Metering, IsOfTheSceneAlone) {
  Job job = squares(0.01, 0, 0);
  const double ev = *metered_ev(job);
  job.exposure_ev = 5, job.layers = {"depth"}, job.width_px = 640, job.height_px = 360;
  EXPECT_EQ(*metered_ev(job), ev);
}

}  // namespace
}  // namespace candela::test
