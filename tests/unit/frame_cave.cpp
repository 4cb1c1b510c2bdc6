// The film scene cave-film: what it promises of its bodies, lamps, camera, wall and files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "base/files.h"
#include "plan/plan_frame.h"
#include "plan/posed_scene.h"
#include "scene/frame_data.h"
#include "testscenes/make_scene.h"

namespace candela::test::frame_cave {
namespace {

namespace fs = std::filesystem;
constexpr double end_s = 15, fps = 24, lamp_radius_m = 0.16;
constexpr const char* lamp_names[] = {"Amber", "Azure", "Rose"};

struct Film {
  Job job;
  Scene scene;
  AnimationChoice clips;
};

// Loaded with its look, as `render` does.
const Film& film() {
  static const Film film = [] {
    const fs::path folder = fs::path(::testing::TempDir()) / "candela_cave_film";
    fs::create_directories(folder);
    EXPECT_TRUE(make_scene("cave-film", 1, 0, folder / "cave-film.glb"));
    Film f;
    f.job.scene = (folder / "cave-film.glb").string();
    f.job.look = (folder / "cave-film.look.json").string();
    f.job.width_px = 64, f.job.height_px = 36;
    auto scene = load_scene(f.job);
    EXPECT_TRUE(scene) << scene.error().text();
    f.scene = std::move(*scene);
    f.clips = *choose_animations(f.scene, "auto");
    fs::remove_all(folder);
    return f;
  }();
  return film;
}

Pose pose_at(double t) { return evaluate_pose(film().scene, film().clips, t); }
View view_of(const Pose& pose) {
  const auto view = make_view(film().scene, pose, {}, 64, 36, world_bounds(film().scene, pose));
  EXPECT_TRUE(view.has_value());
  return *view;
}
FrameData frame_at(const Pose& pose) { return make_frame_data(film().scene, pose, view_of(pose)); }
size_t node_named(std::string_view name) {
  for (size_t n = 0; n < film().scene.nodes.size(); ++n)
    if (film().scene.nodes[n].name == name) return n;
  ADD_FAILURE() << name;
  return 0;
}
glm::dvec3 place_of(const Pose& pose, size_t node) { return pose.world_from_node[node][3]; }
const Mesh& mesh_named(std::string_view name) {
  for (const Mesh& mesh : film().scene.meshes)
    if (mesh.name == name) return mesh;
  ADD_FAILURE() << name;
  return film().scene.meshes[0];
}

glm::dvec3 nearest_of_segment(glm::dvec3 p, glm::dvec3 a, glm::dvec3 b) {
  const glm::dvec3 way = b - a;
  return a + way * std::clamp(glm::dot(p - a, way) / std::max(glm::dot(way, way), 1e-30), 0.0, 1.0);
}
double to_triangle(glm::dvec3 p, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double size = glm::length(normal);
  bool above = size > 0;
  double nearest = 1e30;
  for (size_t k = 0; k < 3; ++k) {
    const glm::dvec3 a = t[k], b = t[(k + 1) % 3];
    above &= glm::dot(glm::cross(b - a, p - a), normal) >= 0;
    nearest = std::min(nearest, glm::distance(p, nearest_of_segment(p, a, b)));
  }
  return above ? std::abs(glm::dot(p - t[0], normal)) / size : nearest;
}

// What is drawn and stands still: everything but the lamps' balls and what shows the sky.
std::vector<std::array<glm::dvec3, 3>> still_triangles() {
  const Pose pose = pose_at(0);
  const FrameData frame = frame_at(pose);
  std::vector<std::array<glm::dvec3, 3>> out;
  for (const DrawItem& item : frame.items) {
    const std::string& name = film().scene.nodes[item.node].name;
    if (name == "sky" || std::ranges::find(lamp_names, name) != std::end(lamp_names)) continue;
    const MeshSection& section = film().scene.meshes[item.mesh].sections[item.section];
    const glm::dmat4 from_local(frame.relative_from_local[item.transform]);
    const glm::dvec3 origin = view_of(pose).position;
    for (size_t i = 0; i < section.index.size(); i += 3) {
      std::array<glm::dvec3, 3>& t = out.emplace_back();
      for (size_t k = 0; k < 3; ++k)
        t[k] = glm::dvec3(from_local * glm::dvec4(section.position[section.index[i + k]], 1)) + origin;
    }
  }
  return out;
}

// Each point's distance to the nearest triangle, up to `most`.
std::vector<double> clearance(const std::vector<glm::dvec3>& points, double most) {
  std::vector<double> nearest(points.size(), most);
  for (const auto& t : still_triangles()) {
    const glm::dvec3 low = glm::min(glm::min(t[0], t[1]), t[2]) - most,
                     high = glm::max(glm::max(t[0], t[1]), t[2]) + most;
    for (size_t i = 0; i < points.size(); ++i)
      if (glm::all(glm::greaterThan(points[i], low)) && glm::all(glm::lessThan(points[i], high)))
        nearest[i] = std::min(nearest[i], to_triangle(points[i], t));
  }
  return nearest;
}

}  // namespace

TEST(Cave, BunnyAndDragonAreClosedBodiesOfAtLeastFiveThousandTriangles) {
  for (const char* name : {"bunny", "dragon"}) {
    std::map<std::tuple<float, float, float>, uint32_t> corners;  // of one place, whatever their texture coordinates
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    size_t triangles = 0;
    for (const MeshSection& section : mesh_named(name).sections) {
      const auto corner = [&](size_t i) {
        const glm::vec3 p = section.position[section.index[i]];
        return corners.try_emplace({p.x, p.y, p.z}, uint32_t(corners.size())).first->second;
      };
      for (size_t i = 0; i < section.index.size(); i += 3) {
        ++triangles;
        for (size_t k = 0; k < 3; ++k) ++edges[{corner(i + k), corner(i + (k + 1) % 3)}];
      }
    }
    EXPECT_GE(triangles, 5000u) << name;
    // Every edge once each way: nothing is open, and all triangles face outwards.
    size_t open = 0;
    for (const auto& [edge, count] : edges) {
      const auto back = edges.find({edge.second, edge.first});
      open += count != 1 || back == edges.end() || back->second != 1 ? 1 : 0;
    }
    EXPECT_EQ(open, 0u) << name;
    double volume = 0;
    for (const MeshSection& section : mesh_named(name).sections)
      for (size_t i = 0; i < section.index.size(); i += 3) {
        const glm::dvec3 a(section.position[section.index[i]]), b(section.position[section.index[i + 1]]),
            c(section.position[section.index[i + 2]]);
        volume += glm::dot(a, glm::cross(b, c)) / 6;
      }
    EXPECT_GT(volume, 0.1) << name;
  }
}

TEST(Cave, TheFilmLastsFifteenSecondsAndHasThreeLampsThatMove) {
  const auto clips = clip_facts(film().scene, "auto");
  ASSERT_TRUE(clips.has_value());
  ASSERT_EQ(clips->size(), 1u);
  EXPECT_EQ((*clips)[0].end_s, end_s);
  EXPECT_EQ((*clips)[0].conflicts, 0);
  EXPECT_TRUE(pose_at(0).warnings.empty());
  const FrameData frame = frame_at(pose_at(3));
  EXPECT_EQ(std::ranges::count(frame.lights, LightType::point, &LightItem::type), 3);
  EXPECT_EQ(std::ranges::count(frame.lights, LightType::spot, &LightItem::type), 2);
  for (const char* name : lamp_names) {
    const size_t node = node_named(name);
    double way = 0;
    for (int k = 0; k < int(end_s * fps); ++k)
      way += glm::distance(place_of(pose_at(k / fps), node), place_of(pose_at((k + 1) / fps), node));
    EXPECT_GT(way, 15) << name;
  }
}

TEST(Cave, LampsAndCameraKeepClearOfAllThatStands) {
  std::vector<glm::dvec3> lamps, eyes;
  for (int k = 0; k <= int(end_s * fps); ++k) {
    const Pose pose = pose_at(k / fps);
    for (const char* name : lamp_names) lamps.push_back(place_of(pose, node_named(name)));
    eyes.push_back(place_of(pose, node_named("camera")));
    const auto now = std::span(lamps).last(3);
    for (size_t i = 0; i < 3; ++i) {
      EXPECT_GT(glm::distance(now[i], now[(i + 1) % 3]), 2 * lamp_radius_m) << lamp_names[i] << " at " << k / fps;
      EXPECT_GT(glm::distance(now[i], eyes.back()), 1) << lamp_names[i] << " at " << k / fps;
    }
  }
  const std::vector<double> of_lamps = clearance(lamps, 0.6), of_eyes = clearance(eyes, 0.6);
  for (size_t i = 0; i < lamps.size(); ++i)
    EXPECT_GT(of_lamps[i], lamp_radius_m + 0.02) << lamp_names[i % 3] << " at " << double(i / 3) / fps;
  for (size_t i = 0; i < eyes.size(); ++i) EXPECT_GT(of_eyes[i], 0.3) << "camera at " << double(i) / fps;
}

// Between the cuts nothing jumps: neither the camera nor a lamp.
TEST(Cave, TheCameraJumpsAtItsTwoCutsAlone) {
  const size_t camera = node_named("camera");
  std::set<int> jumps;
  for (int k = 0; k < int(end_s * fps); ++k) {
    const Pose before = pose_at(k / fps), after = pose_at((k + 1) / fps);
    if (glm::distance(place_of(before, camera), place_of(after, camera)) > 0.15) jumps.insert(k + 1);
    for (const char* name : lamp_names)
      EXPECT_LT(glm::distance(place_of(before, node_named(name)), place_of(after, node_named(name))), 0.25)
          << name << k;
  }
  EXPECT_EQ(jumps, (std::set<int>{120, 228}));
}

TEST(Cave, TheWallsReliefDeepensAndFlattens) {
  const auto depth_at = [](double t) {
    for (const Material& material : pose_at(t).materials)
      if (material.relief.texture) return double(material.relief.depth);
    return -1.0;
  };
  EXPECT_EQ(depth_at(0), 0);
  EXPECT_NEAR(depth_at(5.2), 0, 1e-6);
  EXPECT_NEAR(depth_at(7), 0.2, 1e-6);
  EXPECT_NEAR(depth_at(8.4), 0.02, 1e-6);
  EXPECT_GT(depth_at(11), 0.1);
  EXPECT_LT(depth_at(13), 0.05);
}

TEST(Cave, FilesSayWhereStonesAre) {
  const FrameData frame = frame_at(pose_at(0));
  std::map<std::string, int> drawn;
  for (const DrawItem& item : frame.items) ++drawn[film().scene.nodes[item.node].name];
  int stones = 0;
  for (const auto& [name, count] : drawn)
    if (name.starts_with("Boulder") || name.starts_with("Dripstone") || name == "Pebble") {
      EXPECT_GE(count, 10) << name;
      stones += count;
    }
  EXPECT_GE(stones, 250);
  EXPECT_GE(drawn["Standing dripstone"], 3);
}

TEST(Cave, TheCommittedFilesAreTheGenerators) {
  const fs::path folder = fs::path(CANDELA_SOURCE_DIR) / "scenes/cave-film";
  const auto files = make_files_beside("cave-film", 1, folder / "cave-film.glb");
  ASSERT_TRUE(files);
  EXPECT_EQ(files->size(), 16u);
  for (const SceneFile& file : *files) {
    if (file.path.extension() == ".wav") continue;  // two megabytes that no picture needs
    const auto committed = read_file(file.path);
    ASSERT_TRUE(committed) << file.path;
    EXPECT_TRUE(*committed == file.bytes) << file.path << ": make it again with candela make-scene cave-film --seed 1";
  }
}

TEST(Cave, TheSeedChangesRockAndStones) {
  const auto one = make_scene_bytes("cave-film", 1, 0), other = make_scene_bytes("cave-film", 2, 0);
  ASSERT_TRUE(one && other);
  EXPECT_NE(*one, *other);
  EXPECT_EQ(*one, *make_scene_bytes("cave-film", 1, 0));
  const auto files = make_files_beside("cave-film", 1, "a.glb"), others = make_files_beside("cave-film", 2, "a.glb");
  ASSERT_TRUE(files && others);
  int differ = 0;
  for (size_t i = 0; i < files->size(); ++i) differ += (*files)[i].bytes != (*others)[i].bytes ? 1 : 0;
  EXPECT_EQ(differ, 9) << "instances and the sound";
}

}  // namespace candela::test::frame_cave
