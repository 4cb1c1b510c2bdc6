#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <set>

#include "base/files.h"
#include "gltf/gltf.h"
#include "look/look.h"
#include "scene/frame_data.h"
#include "testscenes/demo_scene.h"
#include "testscenes/make_scene.h"

// The film scene city: what it promises of its lights, people, cars, cuts and look.
namespace candela {
namespace {

const Scene& city() {
  static const Scene scene = [] {
    const auto bytes = make_scene_bytes("city", 1, 0);
    EXPECT_TRUE(bytes.has_value());
    auto loaded = load_gltf_from_memory(*bytes, "city", "");
    EXPECT_TRUE(loaded.has_value());
    return std::move(*loaded);
  }();
  return scene;
}

Pose pose_at(double time_s) { return evaluate_pose(city(), *choose_animations(city(), "auto"), time_s); }

FrameData frame_at(double time_s) {
  const Pose pose = pose_at(time_s);
  const auto view = make_view(city(), pose, {}, 64, 36, world_bounds(city(), pose));
  EXPECT_TRUE(view.has_value());
  return make_frame_data(city(), pose, *view);
}

size_t lit_at(double time_s) {
  return size_t(std::ranges::count_if(frame_at(time_s).lights,
                                      [](const LightItem& l) { return l.type != LightType::directional; }));
}

std::vector<size_t> nodes_named(std::string_view name) {
  std::vector<size_t> found;
  for (size_t n = 0; n < city().nodes.size(); ++n)
    if (city().nodes[n].name == name) found.push_back(n);
  return found;
}

}  // namespace

TEST(City, HasADistrictOfTrianglesAndOneFilmOfTwentySeconds) {
  const Pose pose = pose_at(0);
  const auto view = make_view(city(), pose, {}, 64, 36, world_bounds(city(), pose));
  ASSERT_TRUE(view.has_value());
  size_t triangles = 0;
  for (const DrawItem& item : make_frame_data(city(), pose, *view).items)
    if (item.deformed < 0) triangles += city().meshes[item.mesh].sections[item.section].index.size() / 3;
  EXPECT_GT(triangles, 150000u);
  EXPECT_LT(triangles, 700000u);
  const auto clips = clip_facts(city(), "auto");
  ASSERT_TRUE(clips.has_value());
  ASSERT_EQ(clips->size(), 1u);
  EXPECT_EQ((*clips)[0].end_s, 20);
  EXPECT_EQ((*clips)[0].conflicts, 0);
  EXPECT_TRUE(pose.warnings.empty());
}

TEST(City, LightsComeOnOneByOneAndHundredsOfThemMove) {
  size_t before = lit_at(3.5);
  EXPECT_LT(before, 20u);  // traffic lights
  for (double t = 5; t <= 11; t += 0.5) {
    const size_t now = lit_at(t);
    EXPECT_GE(now, before) << t;
    before = now;
  }
  EXPECT_GT(lit_at(6), 20u);
  EXPECT_LT(lit_at(6), lit_at(8));
  const FrameData one = frame_at(15.5), other = frame_at(15.6);
  ASSERT_EQ(one.lights.size(), other.lights.size());
  EXPECT_GE(one.lights.size(), 1000u);
  EXPECT_LE(one.lights.size(), 2000u);
  size_t moving = 0;
  for (size_t i = 0; i < one.lights.size(); ++i)
    moving += glm::distance(one.lights[i].world_position, other.lights[i].world_position) > 0.01 ? 1 : 0;
  EXPECT_GT(moving, 200u);
}

TEST(City, TheSunFallsFromFortyDegreesToTwentyFourBelow) {
  const std::vector<size_t> sun = nodes_named("sun");
  ASSERT_EQ(sun.size(), 1u);
  const auto elevation_deg = [&](double t) {
    return std::asin(pose_at(t).world_from_node[sun[0]][2].y) * 180 / std::numbers::pi;
  };
  EXPECT_NEAR(elevation_deg(0), 40, 0.01);
  EXPECT_NEAR(elevation_deg(0.6), 40, 0.3);
  EXPECT_NEAR(elevation_deg(0.6 + 4.6), 8, 0.1);
  EXPECT_NEAR(elevation_deg(9.8), -24, 0.3);
  EXPECT_NEAR(elevation_deg(20), -24, 0.01);
}

// Of a stride each foot stands flat for four tenths; there its ankle stays in one place of the world at any moment, and
// the foot points the same way, also while its walker turns at a corner.
TEST(City, FeetOnTheGroundStandStill) {
  constexpr double leg_m = 0.87, ankle_m = 0.08, step_s = 1 / 190.0;
  std::map<size_t, std::vector<glm::dvec3>> ways, across;
  std::vector<size_t> feet = nodes_named("left foot");
  std::ranges::copy(nodes_named("right foot"), std::back_inserter(feet));
  ASSERT_GT(feet.size(), 40u);
  for (double t = 2; t < 6; t += step_s) {
    const Pose pose = pose_at(t);
    for (size_t foot : feet) {
      ways[foot].emplace_back(pose.world_from_node[foot][3]);
      across[foot].push_back(glm::normalize(glm::dvec3(pose.world_from_node[foot][0])));
    }
  }
  double farthest = 0, most_turned = 0;
  for (const auto& [foot, way] : ways) {
    const Pose pose = pose_at(0);
    const double scale = glm::length(glm::dvec3(pose.world_from_node[foot][0])), floor = 0.14 + ankle_m * scale;
    size_t flat = 0, steps = 0, first = 0;
    for (size_t i = 0; i < way.size(); ++i) {
      const bool down = std::abs(way[i].y - floor) < 2e-5;
      if (!down) continue;
      ++flat;
      if (i == 0 || std::abs(way[i - 1].y - floor) >= 2e-5) first = i, ++steps;
      farthest = std::max(farthest, glm::distance(way[i], way[first]) / (leg_m * scale));
      most_turned = std::max(most_turned, glm::distance(across[foot][i], across[foot][first]));
    }
    EXPECT_GE(steps, 3u);
    EXPECT_NEAR(double(flat) / double(way.size()), 0.4, 0.05);
    EXPECT_GT(glm::distance(way.front(), way.back()), 3);
  }
  EXPECT_LT(farthest, 1e-3);
  EXPECT_LT(most_turned, 5e-3);
}

// They turn by a right angle, evenly, and stay on the pavement of their block.
TEST(City, SomeWalkersTurnAtTheCorner) {
  constexpr double step_s = 0.25, most_a_step_rad = 0.25;
  size_t turned = 0, straight = 0;
  for (size_t walker : nodes_named("walker")) {
    const glm::dvec3 first(pose_at(0).world_from_node[walker][2]), last(pose_at(20).world_from_node[walker][2]);
    const double cosine = glm::dot(glm::normalize(first), glm::normalize(last));
    if (cosine > 0.999) {
      ++straight;
      continue;
    }
    EXPECT_NEAR(cosine, 0, 0.01) << walker;
    ++turned;
    glm::dvec3 before = glm::normalize(first);
    for (double t = 0; t <= 20; t += step_s) {
      const glm::dmat4 world = pose_at(t).world_from_node[walker];
      const glm::dvec3 now = glm::normalize(glm::dvec3(world[2]));
      EXPECT_GT(glm::dot(before, now), std::cos(most_a_step_rad)) << walker << " " << t;
      before = now;
      // Blocks are 64 m apart, their pavements end 26.5 m from their middles, and houses 22 m.
      const glm::dvec2 from_middle =
          glm::abs(glm::dvec2(std::remainder(world[3].x - 32, 64), std::remainder(world[3].z - 32, 64)));
      EXPECT_LT(std::max(from_middle.x, from_middle.y), 26.5) << walker << " " << t;
      EXPECT_GT(std::max(from_middle.x, from_middle.y), 22.3) << walker << " " << t;
    }
  }
  EXPECT_GE(turned, 5u);
  EXPECT_GT(straight, turned);
}

TEST(City, LegsHoldTogether) {
  for (const char* side : {"left", "right"}) {
    const std::vector<size_t> shins = nodes_named(std::string(side) + " shin"),
                              feet = nodes_named(std::string(side) + " foot");
    ASSERT_EQ(shins.size(), feet.size());
    for (double t = 1; t < 4; t += 0.031) {
      const Pose pose = pose_at(t);
      for (size_t i = 0; i < shins.size(); ++i) {
        const glm::dvec3 end(pose.world_from_node[shins[i]] * glm::dvec4(0, -0.43, 0, 1)),
            ankle(pose.world_from_node[feet[i]][3]);
        EXPECT_LT(glm::distance(end, ankle), 0.02) << side << t;
      }
    }
  }
}

TEST(City, CarsKeepClearOfEachOther) {
  const std::vector<size_t> cars = nodes_named("car");
  ASSERT_GT(cars.size(), 40u);
  for (double t = 0; t <= 20; t += 0.1) {
    const Pose pose = pose_at(t);
    for (size_t i = 0; i < cars.size(); ++i)
      for (size_t k = 0; k < i; ++k) {
        const glm::dmat4 &a = pose.world_from_node[cars[i]], &b = pose.world_from_node[cars[k]];
        // In the oncoming lane they pass 3.6 m apart.
        const bool oncoming = glm::dot(glm::dvec3(a[2]), glm::dvec3(b[2])) < -0.9;
        EXPECT_GT(glm::distance(glm::dvec3(a[3]), glm::dvec3(b[3])), oncoming ? 3.4 : 3.5) << i << " " << k << " " << t;
      }
  }
}

TEST(City, TheCommittedLookIsTheGenerators) {
  const std::filesystem::path folder = std::filesystem::path(CANDELA_SOURCE_DIR) / "scenes/city";
  const std::filesystem::path made = std::filesystem::path(::testing::TempDir()) / "candela_city" / "city.glb";
  std::filesystem::create_directories(made.parent_path());
  ASSERT_TRUE(make_scene("city", 1, 0, made));
  for (const char* name : {"city.look.json", "city.hdr", "city-night.hdr"}) {
    const auto committed = read_file(folder / name), again = read_file(made.parent_path() / name);
    ASSERT_TRUE(committed && again) << name;
    EXPECT_TRUE(*committed == *again) << name << ": make it again with candela make-scene city --seed 1";
  }
  std::filesystem::remove_all(made.parent_path());
}

TEST(City, TheLookGoesFromDayToNight) {
  const std::filesystem::path file = std::filesystem::path(CANDELA_SOURCE_DIR) / "scenes/city/city.look.json";
  const auto day = read_look(file, 0), dusk = read_look(file, 5.2), night = read_look(file, 12);
  ASSERT_TRUE(day && dusk && night);
  EXPECT_NEAR(std::log2(day->sky.intensity), 1.5, 0.01);
  EXPECT_NEAR(std::log2(dusk->sky.intensity), 1.5 - 3.75 / 2, 0.02);
  EXPECT_NEAR(std::log2(night->sky.intensity), -2.25, 0.01);
  ASSERT_TRUE(day->sky.second && night->sky.second);
  EXPECT_EQ(day->sky.second->weight, 0);
  EXPECT_EQ(night->sky.second->weight, 1);
  ASSERT_TRUE(day->fog && night->fog);
  EXPECT_NEAR(night->fog->extinction_per_m.y / day->fog->extinction_per_m.y, 0.2 / 0.015, 1);
  EXPECT_GT(night->tone_mapping.agx_max_ev, day->tone_mapping.agx_max_ev);
}

TEST(City, TheSeedChangesIt) {
  const auto one = make_scene_bytes("city", 1, 0), other = make_scene_bytes("city", 2, 0);
  ASSERT_TRUE(one && other);
  EXPECT_NE(*one, *other);
  EXPECT_EQ(*one, *make_scene_bytes("city", 1, 0));
}

// PCM of 16 bits in two channels: how loud a stretch is, root mean square of both.
double loudness(const std::vector<std::byte>& wav, double from_s, double to_s) {
  constexpr size_t header = 44, rate = 32000;
  double sum = 0;
  const size_t from = 2 * size_t(from_s * rate), to = 2 * size_t(to_s * rate);
  for (size_t i = from; i < to; ++i) {
    int16_t sample = 0;
    std::memcpy(&sample, wav.data() + header + 2 * i, 2);
    EXPECT_LT(std::abs(int(sample)), 32000);
    sum += double(sample) * double(sample);
  }
  return std::sqrt(sum / double(to - from)) / 32768;
}

TEST(City, SoundsLowAndTheSaucerIsHeardWhereItComes) {
  const auto wav = make_demo_scene("city", candela_demo_scene_sound, 1, 0);
  ASSERT_TRUE(wav.has_value());
  EXPECT_EQ(*wav, *make_demo_scene("city", candela_demo_scene_sound, 1, 0));
  ASSERT_EQ(wav->size(), 44u + 20 * 32000 * 4);
  EXPECT_EQ(std::memcmp(wav->data(), "RIFF", 4), 0);
  for (double t = 1; t < 19; t += 1) EXPECT_GT(loudness(*wav, t, t + 1), 0.02) << t;
  EXPECT_LT(loudness(*wav, 0, 0.05), 0.01);  // no click at the ends
  EXPECT_LT(loudness(*wav, 19.95, 20), 0.01);
  EXPECT_GT(loudness(*wav, 15.5, 18), 1.3 * loudness(*wav, 2, 6));
  EXPECT_GT(loudness(*wav, 15.5, 18), 2 * loudness(*wav, 19.4, 19.9));  // it is far away
}

}  // namespace candela
