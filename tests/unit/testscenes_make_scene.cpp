#include "testscenes/make_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <tuple>

#include "base/files.h"
#include "demoscenes/dusk_sky.h"
#include "gltf/gltf.h"
#include "image/io.h"
#include "scene/frame_data.h"
#include "testscenes/procedural_shapes.h"

namespace candela {
namespace {

std::vector<std::byte> made(std::string_view name, uint64_t seed = 1, int lights = 0) {
  auto bytes = make_scene_bytes(std::string(name), seed, lights);
  EXPECT_TRUE(bytes.has_value()) << name;
  return bytes.value_or(std::vector<std::byte>{});
}

nlohmann::json document(const std::vector<std::byte>& glb) {
  uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  const char* text = reinterpret_cast<const char*>(glb.data() + 20);
  return nlohmann::json::parse(text, text + length);
}

TEST(MakeScene, ReproducesTheCommittedFiles) {
  const std::filesystem::path folder = std::filesystem::path(CANDELA_SOURCE_DIR) / "scenes";
  for (std::string_view name : scene_names()) {
    if (!scene_is_committed(name)) continue;
    const auto committed = read_file(folder / name / (std::string(name) + ".glb"));
    ASSERT_TRUE(committed.has_value()) << committed.error().text();
    EXPECT_TRUE(*committed == made(name)) << name << ": make it again with candela make-scene " << name << " --seed 1";
  }
}

TEST(MakeScene, EveryCommittedSceneHasAName) {
  std::set<std::string> names;
  for (std::string_view name : scene_names()) names.emplace(name);
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(CANDELA_SOURCE_DIR) / "scenes"))
    EXPECT_TRUE(!entry.is_directory() || names.contains(entry.path().filename().string())) << entry.path();
}

TEST(MakeScene, FilesAreSmallWholeAndHaveACamera) {
  for (std::string_view name : scene_names()) {
    const auto bytes = made(name);
    EXPECT_LT(bytes.size(), scene_is_committed(name) ? 120000u : 10000000u) << name;
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 8, 4);
    EXPECT_EQ(length, bytes.size()) << name;
    EXPECT_EQ(document(bytes)["cameras"].size(), 1u) << name;
    EXPECT_FALSE(scene_description(name).empty());
  }
}

TEST(MakeScene, EverySceneLoadsWithoutAWarningAndWithAllItsExtensions) {
  for (std::string_view name : scene_names()) {
    const auto scene = load_gltf_from_memory(made(name), std::string(name), "");
    ASSERT_TRUE(scene.has_value()) << scene.error().text();
    for (const std::string& warning : scene->warnings) ADD_FAILURE() << name << ": " << warning;
    // What is seen through glass is approximate for raster techniques.
    for (const LoadFor use : {LoadFor::raster, LoadFor::path_tracing}) {
      const auto loaded = load_gltf_from_memory(made(name), std::string(name), "", use);
      for (const ExtensionUse& extension : loaded->extensions) {
        const bool through = std::set<std::string>{"KHR_materials_transmission", "KHR_materials_volume",
                                                   "KHR_materials_dispersion", "KHR_materials_volume_scatter"}
                                 .contains(extension.name);
        EXPECT_EQ(extension.support, through && use == LoadFor::raster ? Support::approximated : Support::supported)
            << name << ": " << extension.name;
      }
    }
  }
}

TEST(MakeScene, TheSeedChangesSeededScenesOnly) {
  EXPECT_NE(made("instanced", 1), made("instanced", 2));
  EXPECT_NE(made("animated", 1), made("animated", 2));
  EXPECT_EQ(made("spheres", 1), made("spheres", 2));
  for (const char* name : {"street", "lights-stacked", "light-field"}) EXPECT_NE(made(name, 1), made(name, 2)) << name;
}

TEST(MakeScene, ScattersAsManyLightsAsAsked) {
  const nlohmann::json json = document(made("animated", 1, 1000));
  int lamps = 0;
  for (const auto& node : json["nodes"]) lamps += node.value("name", "") == "lantern" ? 1 : 0;
  EXPECT_EQ(lamps, 1000);
}

FrameData frame_of(const Scene& scene, double time_s) {
  const Pose pose = evaluate_pose(scene, *choose_animations(scene, "all"), time_s);
  const auto view = make_view(scene, pose, {}, 640, 360, world_bounds(scene, pose));
  EXPECT_TRUE(view.has_value());
  return make_frame_data(scene, pose, *view);
}

FrameData frame_of(std::string_view name, int lights, double time_s, uint64_t seed = 1) {
  const auto scene = load_gltf_from_memory(made(name, seed, lights), std::string(name), "");
  EXPECT_TRUE(scene.has_value());
  return frame_of(*scene, time_s);
}

size_t spots(const FrameData& frame) {
  return size_t(std::ranges::count(frame.lights, LightType::spot, &LightItem::type));
}

TEST(MakeScene, ScenesOfLightsHaveExactlyAsManyAsAsked) {
  for (const char* name : {"street", "lights-stacked"})
    for (int lights : {1, 2, 63, 64, 65, 1000}) {
      const FrameData frame = frame_of(name, lights, 0.3);
      EXPECT_EQ(frame.lights.size(), size_t(lights)) << name;
      EXPECT_NEAR(double(spots(frame)), lights / 2.0, 1) << name;
      for (const LightItem& light : frame.lights) EXPECT_TRUE(std::isfinite(light.range_m)) << name;
    }
  // Some of these are dark, which the frame leaves out.
  EXPECT_EQ(document(made("light-field", 3, 77))["extensions"]["KHR_lights_punctual"]["lights"].size(), 77u);
}

// A large city holds the small one as it is, around the camera, and has no more lights in the same place.
TEST(MakeScene, TheStreetGrowsOutwardsAtOneDensity) {
  const auto near_camera = [](int lights) {
    std::set<std::tuple<float, float, float, float>> found;
    for (const LightItem& light : frame_of("street", lights, 1.7).lights)
      if (glm::length(light.position) < 40 && light.position.z < 0)
        found.emplace(light.position.x, light.position.y, light.position.z, light.intensity.x);
    return found;
  };
  const auto small = near_camera(1024);
  EXPECT_GT(small.size(), 30u);
  EXPECT_EQ(small, near_camera(4096));
  const auto covered = [](int lights) {
    DAabb box;
    for (const LightItem& light : frame_of("street", lights, 0).lights)
      box.add({glm::dvec3(light.position), glm::dvec3(light.position)});
    const glm::dvec3 size = box.extent() * 2.0;
    return size.x * size.z;
  };
  EXPECT_NEAR(covered(16384) / covered(4096), 4, 0.8);
}

// The same city whatever the number of lights: density grows with them.
TEST(MakeScene, TheDenseStreetKeepsItsArea) {
  std::set<size_t> items;
  for (int lights : {16, 1000, 1024, 1025, 8192}) {
    const FrameData frame = frame_of("street-dense", lights, 0.3);
    EXPECT_EQ(frame.lights.size(), size_t(lights));
    items.insert(frame.items.size());
    for (const LightItem& light : frame.lights) {
      EXPECT_LT(glm::length(light.position), 400) << lights;
      EXPECT_TRUE(std::isfinite(light.range_m));
    }
  }
  EXPECT_EQ(items.size(), 1u) << "the same houses, streets and cars";
  // With the street's own number it is the street.
  EXPECT_EQ(frame_of("street-dense", 1024, 0.3).items.size(), frame_of("street", 1024, 0.3).items.size());
}

TEST(MakeScene, EveryLightOfTheStreetChangesWithTime) {
  const FrameData a = frame_of("street", 640, 0.25), b = frame_of("street", 640, 0.75);
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (size_t i = 0; i < a.lights.size(); ++i)
    EXPECT_TRUE(a.lights[i].position != b.lights[i].position || a.lights[i].intensity != b.lights[i].intensity) << i;
}

// Cars jump back by one cell, to where the same cars have come: in the middle of the city nothing is seen of it.
TEST(MakeScene, CarsWrapRoundUnseen) {
  const auto scene = load_gltf_from_memory(made("street", 1, 6400), "street", "");
  const auto head_lamps = [&](double time_s, double most_m) {
    std::vector<glm::vec3> found;
    const FrameData frame = frame_of(*scene, time_s);
    for (const LightItem& light : frame.lights)
      if (scene->nodes[light.node].name == "head lamps" && glm::length(light.position) < most_m)
        found.push_back(light.position);
    return found;
  };
  for (double wrap_s : {6.4, 8.0}) {
    const double step_s = 1.0 / 64;
    const std::vector<glm::vec3> before = head_lamps(wrap_s - step_s, 100), after = head_lamps(wrap_s + step_s, 110);
    EXPECT_GT(before.size(), 50u);
    double largest_step_m = 0;
    for (const glm::vec3& lamp : before) {
      double nearest_m = 1e9;
      for (const glm::vec3& other : after) nearest_m = std::min(nearest_m, double(glm::length(lamp - other)));
      largest_step_m = std::max(largest_step_m, nearest_m);
    }
    EXPECT_NEAR(largest_step_m, 2 * step_s * 10, 0.02);
  }
}

// Made for a picture in a few seconds on two cores: what it holds is bounded.
TEST(MakeScene, TheStreetAtDuskIsTheSameEachTimeAndNotTooLarge) {
  const auto bytes = made("street-dusk");
  EXPECT_EQ(bytes, made("street-dusk"));
  EXPECT_NE(bytes, made("street-dusk", 2));
  const auto scene = load_gltf_from_memory(bytes, "street-dusk", "");
  ASSERT_TRUE(scene.has_value()) << scene.error().text();
  const FrameData frame = frame_of(*scene, 1);
  EXPECT_GT(frame.lights.size(), 100u);
  EXPECT_LT(frame.lights.size(), 300u);
  for (const LightItem& light : frame.lights)
    EXPECT_TRUE(light.type == LightType::directional || std::isfinite(light.range_m));
  const nlohmann::json json = document(bytes);
  size_t triangles = 0;
  const auto indices = [&](const nlohmann::json& mesh) {
    size_t sum = 0;
    for (const auto& primitive : mesh["primitives"])
      sum += json["accessors"][primitive["indices"].get<size_t>()]["count"].get<size_t>();
    return sum;
  };
  for (const auto& node : json["nodes"]) {
    if (!node.contains("mesh")) continue;
    size_t count = 1;
    if (node.contains("extensions"))
      count = json["accessors"]
                  [node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"].get<size_t>()]["count"];
    triangles += count * indices(json["meshes"][node["mesh"].get<size_t>()]) / 3;
  }
  EXPECT_GT(triangles, 150000u);
  EXPECT_LT(triangles, 300000u);
}

TEST(MakeScene, ASceneWithASkyIsWrittenWithIt) {
  const auto sky_of = [](const char* name, uint64_t seed) {
    return make_scene_sky(name, seed).value_or(std::vector<std::byte>{});
  };
  EXPECT_TRUE(sky_of("street", 1).empty());
  const std::vector<std::byte> dusk = sky_of("street-dusk", 1);
  EXPECT_FALSE(dusk.empty());
  EXPECT_EQ(dusk, sky_of("street-dusk", 1));
  EXPECT_NE(dusk, sky_of("street-dusk", 2));
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "candela_dusk.glb";
  ASSERT_TRUE(make_scene("street-dusk", 1, 0, file));
  EXPECT_EQ(read_file(file), made("street-dusk"));
  const auto bytes = read_file(sky_beside(file));
  ASSERT_TRUE(bytes.has_value());
  EXPECT_EQ(*bytes, dusk);
  const auto sky = decode_image(*bytes, "the sky");
  ASSERT_TRUE(sky.has_value()) << sky.error().text();
  ASSERT_EQ(sky->width, 512);
  ASSERT_EQ(sky->height, 256);
  ASSERT_EQ(sky->format, DecodedImage::Format::rgba32f);
  // RGBE holds eight bits of the largest channel, cut off below.
  const auto value_at = [&](int x, int y, int c) {
    float value = 0;
    std::memcpy(&value, sky->pixels.data() + (size_t(y) * 512 + size_t(x)) * 16 + size_t(c) * 4, 4);
    return double(value);
  };
  for (int y = 3; y < 256; y += 29)
    for (int x = 5; x < 512; x += 37) {
      const double polar = std::numbers::pi * (y + 0.5) / 256, azimuth = 2 * std::numbers::pi * ((x + 0.5) / 512 - 0.5);
      const glm::dvec3 truth = dusk_sky_radiance(
          {std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)}, 1);
      const double step = std::max({truth.x, truth.y, truth.z}) / 128;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(value_at(x, y, c), truth[c], step) << x << " " << y << " " << c;
    }
  // The sun set at -Z.
  const auto light = [](glm::dvec3 d) { return dusk_sky_radiance(glm::normalize(d), 1).x; };
  EXPECT_GT(light({0, 0.05, -1}), 10 * light({0, 0.05, 1}));
}

TEST(MakeScene, LightFieldsMeetTheHardCases) {
  std::set<std::string> kinds;
  bool orthographic = false, wide = false, narrow = false;
  for (uint64_t seed = 0; seed < 24; ++seed) {
    const nlohmann::json json = document(made("light-field", seed));
    for (const auto& light : json["extensions"]["KHR_lights_punctual"]["lights"]) {
      const std::string name = light["name"];
      kinds.insert(name.substr(0, name.rfind(' ')));
    }
    const auto& camera = json["cameras"][0];
    orthographic |= camera["type"] == "orthographic";
    if (camera["type"] == "orthographic") continue;
    wide |= camera["perspective"]["yfov"] > 2.6;
    narrow |= camera["perspective"]["yfov"] < 0.018;
  }
  EXPECT_TRUE(orthographic && wide && narrow);
  for (const char* kind : {"needle", "half space", "sharp edge", "tiny range", "huge range", "no range", "sun",
                           "bright", "dark", "at the camera", "around the camera", "behind the camera", "on a surface",
                           "power of two", "tile edge", "touching", "touching spot"})
    EXPECT_TRUE(kinds.contains(kind)) << kind;
}

TEST(MakeScene, RefusesWhatItCannotMake) {
  const auto unknown = make_scene_bytes("castle", 1, 0);
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().kind, ErrorKind::usage);
  EXPECT_NE(unknown.error().message.find("unlit-box"), std::string::npos);
  EXPECT_EQ(make_scene_bytes("spheres", 1, 5).error().kind, ErrorKind::usage);
  EXPECT_EQ(make_scene_bytes("street", 1, 1048577).error().kind, ErrorKind::usage);
  EXPECT_EQ(make_scene_bytes("animated", 1, -1).error().kind, ErrorKind::usage);
  EXPECT_EQ(make_scene("unlit-box", 1, 0, "/proc/none/box.glb").error().kind, ErrorKind::output);
}

TEST(MakeScene, FarWorldIsNearWorldMoved) {
  const nlohmann::json near_world = document(made("near-world")), far_world = document(made("far-world"));
  ASSERT_EQ(near_world["nodes"].size(), far_world["nodes"].size());
  int moved = 0;
  for (size_t i = 0; i < near_world["nodes"].size(); ++i) {
    const auto &a = near_world["nodes"][i], &b = far_world["nodes"][i];
    EXPECT_EQ(a["name"], b["name"]);
    if (!a.contains("translation")) continue;
    EXPECT_EQ(b["translation"][0].get<double>() - a["translation"][0].get<double>(), 1e6);
    EXPECT_EQ(b["translation"][2].get<double>() - a["translation"][2].get<double>(), -1e6);
    ++moved;
  }
  EXPECT_GE(moved, 5);
}

// The front of every triangle, by its winding, is the side its normals point to.
void expect_outward(const Shape& shape, const char* name) {
  ASSERT_EQ(shape.position.size(), shape.normal.size());
  ASSERT_GT(shape.index.size(), 0u);
  for (size_t i = 0; i < shape.index.size(); i += 3) {
    const uint32_t a = shape.index[i], b = shape.index[i + 1], c = shape.index[i + 2];
    const glm::dvec3 face = glm::cross(shape.position[b] - shape.position[a], shape.position[c] - shape.position[a]);
    EXPECT_GT(glm::length(face), 1e-9) << name << " triangle " << i / 3;
    EXPECT_GT(glm::dot(face, shape.normal[a] + shape.normal[b] + shape.normal[c]), 0) << name << " triangle " << i / 3;
  }
  for (glm::dvec3 n : shape.normal) EXPECT_NEAR(glm::length(n), 1, 1e-12) << name;
}

TEST(ProceduralShapes, WindingAgreesWithNormals) {
  expect_outward(sphere(2, 12, 8), "sphere");
  expect_outward(torus(1, 0.3, 12, 8), "torus");
  expect_outward(column(0.3, 3, 12), "column");
  expect_outward(box({1, 2, 3}, 2), "box");
  expect_outward(quad(1, 2), "quad");
  expect_outward(ground(4, 2, 1), "ground");
}

TEST(ProceduralShapes, ASphereIsClosed) {
  double volume = 0;  // by the divergence theorem: a hole or a doubled triangle would show
  const Shape shape = sphere(1, 64, 48);
  for (size_t i = 0; i < shape.index.size(); i += 3)
    volume += glm::dot(shape.position[shape.index[i]],
                       glm::cross(shape.position[shape.index[i + 1]], shape.position[shape.index[i + 2]])) /
              6;
  EXPECT_NEAR(volume, 4.18879, 0.02);
}

}  // namespace
}  // namespace candela
