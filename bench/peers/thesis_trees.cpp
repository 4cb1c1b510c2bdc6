// Builds the trees of one thesis's tables (T. Le's hybrid renderer: equal counts, areas in 12 buckets, spatial splits;
// leaves of one triangle, a step down at an eighth of a test) and candela's own, traces a frame's primary rays through
// each in turn, on one thread, and prints JSON:
//   thesis_trees [--rounds N] [--size WxH] SCENE... > bench/results/cpu/thesis.json
// Rays cross nodes of eight children that are made of the binary trees, not these: `nodes` counts the binary ones.
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/measured.h"
#include "gltf/gltf.h"
#include "reference/accel.h"
#include "render/reference_frame.h"
#include "scene/view.h"

using namespace candela;
using nlohmann::ordered_json;

namespace {

struct Row {
  std::string name;
  BvhOptions tree;
  std::unique_ptr<Accel> accel;
  std::vector<double> least_ms{};  // by piece of the frame: a busy machine only ever takes longer
  double frame_ms() const { return std::accumulate(least_ms.begin(), least_ms.end(), 0.0); }
};

// As the thesis has them.
BvhOptions of_thesis(BvhBuilder builder) {
  BvhOptions o;
  o.builder = builder, o.buckets = 12, o.max_leaf = 1, o.block_shift = 0, o.node_cost = 0.125f;
  return o;
}

std::vector<Row> rows() {
  std::vector<Row> out;
  for (const BvhBuilder b : {BvhBuilder::equal_counts, BvhBuilder::sah, BvhBuilder::sbvh, BvhBuilder::spatial_only})
    out.push_back({"thesis", of_thesis(b), nullptr});
  for (const float budget : {0.0f, 0.01f, 0.05f, 0.1f, 0.2f, 0.5f, 1.0f, 2.0f}) {
    BvhOptions o = of_thesis(BvhBuilder::sbvh);
    o.split_budget = budget, o.overlap_alpha = 0;
    out.push_back({"budget", o, nullptr});
  }
  for (const uint32_t depth : {0u, 4u, 8u, 10u, 12u, 14u, 16u, 20u}) {
    BvhOptions o = of_thesis(BvhBuilder::sbvh);
    o.depth = depth;
    out.push_back({"depth", o, nullptr});
  }
  for (const BvhBuilder b : {BvhBuilder::sah, BvhBuilder::sbvh}) {
    BvhOptions o;
    o.builder = b;
    out.push_back({"candela", o, nullptr});
  }
  return out;
}

Expected<ordered_json> measure(const std::string& file, int rounds, int width, int height) {
  const auto scene = load_gltf(file);
  if (!scene) return std::unexpected(scene.error());
  const Pose pose = evaluate_pose(*scene, {}, 0);
  const auto view = make_view(*scene, pose, {}, width, height, world_bounds(*scene, pose));
  if (!view) return std::unexpected(view.error());
  const FrameData frame = make_frame_data(*scene, pose, *view);
  std::vector<Ray> rays;
  const glm::dmat3 relative_from_view = glm::transpose(glm::dmat3(view->view_from_relative));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width * 2 - 1, v = 1 - (y + 0.5) / height * 2;
      rays.emplace_back().direction =
          glm::vec3(relative_from_view * glm::normalize(glm::dvec3(u * view->tan_x, v * view->tan_y, -1)));
    }
  std::vector<Row> list = rows();
  for (Row& row : list) {
    AccelOptions options;
    options.tree = row.tree, options.measure_cost = true;
    row.accel = std::make_unique<Accel>(*scene, pose, frame, options);
  }
  size_t hits = 0;
  constexpr size_t piece = 4096;
  const size_t pieces = (rays.size() + piece - 1) / piece;
  for (Row& row : list) row.least_ms.assign(pieces, std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round)
    for (size_t p = 0; p < pieces; ++p)
      for (Row& row : list) {
        const auto begin = std::chrono::steady_clock::now();
        for (size_t i = p * piece; i < std::min((p + 1) * piece, rays.size()); ++i)
          hits += row.accel->closest(rays[i]).has_value();
        const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
        row.least_ms[p] = std::min(row.least_ms[p], taken.count());
      }
  const size_t traced = rays.size() * list.size() * size_t(rounds);
  ordered_json out = {{"scene", std::filesystem::path(file).stem().string()},
                      {"triangles", list[0].accel->statistics().triangles},
                      {"rays_that_hit", double(hits) / double(traced)},
                      {"rows", ordered_json::array()}};
  for (const Row& row : list) {
    TraceCounts counts;
    for (const Ray& ray : rays) (void)row.accel->closest(ray, nullptr, &counts);
    const AccelStatistics& s = row.accel->statistics();
    const auto a_ray = [&](uint64_t n) { return double(n) / double(rays.size()); };
    out["rows"].push_back({{"what", row.name},
                           {"builder", name_of(row.tree.builder)},
                           {"buckets", row.tree.buckets},
                           {"max_leaf", row.tree.max_leaf},
                           {"budget", row.tree.split_budget},
                           {"depth", row.tree.depth},
                           {"nodes", s.binary_nodes},
                           {"wide_nodes", s.nodes},
                           {"references", s.references},
                           {"sah_cost", s.sah_cost},
                           {"build_ms", s.build_ms},
                           {"nodes_a_ray", a_ray(counts.nodes)},
                           {"boxes_a_ray", a_ray(counts.boxes)},
                           {"triangles_a_ray", a_ray(counts.triangles)},
                           {"frame_ms", row.frame_ms()},
                           {"over_equal_counts", row.frame_ms() / list[0].frame_ms()}});
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 15, width = 800, height = 600;
  ordered_json scenes = ordered_json::array();
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--rounds" && i + 1 < argc) {
      rounds = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--size" && i + 1 < argc) {
      if (std::sscanf(argv[++i], "%dx%d", &width, &height) != 2) return 2;
    } else {
      const auto result = measure(argument, rounds, width, height);
      if (!result) {
        std::fprintf(stderr, "%s\n", result.error().text().c_str());
        return int(result.error().kind);
      }
      scenes.push_back(*result);
    }
  }
  const ordered_json all = {{"version", "candela " CANDELA_VERSION},
                            {"cpu", processor_name()},
                            {"size", {width, height}},
                            {"rounds", rounds},
                            {"scenes", scenes}};
  std::printf("%s\n", all.dump(1).c_str());
}
