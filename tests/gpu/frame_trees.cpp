// The trees that rays go through, looked at: boxes where they are, and costs as the CPU counts them.
#include "frame_fixture.h"
#include "render/reference_frame.h"

namespace candela::test::frame_trees {
namespace {
constexpr int width = 96, height = 64;
constexpr glm::vec3 leaf_colour(1, 0.35f, 0.02f), inner_colour(0.05f, 0.25f, 1);
}  // namespace

class FrameTrees : public FrameTest {
 protected:
  // Two triangles in the plane z = 0, left and right, of one mesh.
  static std::string two_triangles() {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json& p = b.primitive({{"POSITION", b.accessor<float>("VEC3", {-2, -1, 0, -0.5, -1, 0, -2, 1, 0,  //
                                                                   0.5, -0.5, 0, 2, -0.5, 0, 2, 1, 0})}});
    p["material"] = add_material(b, unlit_material(0.5, 0.5, 0.5));
    add_node(b, {{"mesh", int(b.json["meshes"].size()) - 1}});
    return write(b);
  }
  static glm::dvec2 pixel_of(glm::dvec2 p) {  // of z = 0 from (0, 0, 4), 60 degrees
    const double scale = height / 2.0 / (4 * std::tan(glm::radians(30.0)));
    return glm::dvec2(width, height) / 2.0 + scale * glm::dvec2(p.x, -p.y);
  }
  // How far in pixels a place is from the outline of a box.
  static double off_outline(glm::dvec2 at, glm::dvec2 low, glm::dvec2 high) {
    const glm::dvec2 a = pixel_of({low.x, high.y}), b = pixel_of({high.x, low.y});
    const glm::dvec2 out = glm::max(glm::max(a - at, at - b), 0.0);
    if (out != glm::dvec2(0)) return glm::length(out);
    const glm::dvec2 in = glm::min(at - a, b - at);
    return std::min(in.x, in.y);
  }
};

// Each triangle has its leaf, and the root is around both. Every pixel on a box's outline has the box's colour, and no
// other pixel has any.
TEST_F(FrameTrees, BoxesOfTwoTriangles) {
  Job job = job_for(two_triangles(), width, height, 1);
  look(job, {0, 0, 4}, {0, 0, 0}, 60);
  job.layers = {"debug_bvh"};
  job.settings = {{"bvh", "max_leaf", "1"}, {"bvh", "block", "0"}};
  for (const char* technique : {"clustered", "ray"}) {
    job.technique = technique;
    const Images images = images_of(job);
    int leaves = 0, inner = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const glm::dvec2 at = glm::dvec2(x, y) + 0.5;
        const glm::vec3 color(images["debug_bvh"].at<glm::vec4>(x, y));
        const double off_leaf = std::min(off_outline(at, {-2, -1}, {-0.5, 1}), off_outline(at, {0.5, -0.5}, {2, 1}));
        const double off_root = off_outline(at, {-2, -1}, {2, 1});
        // Boxes are rounded outwards to a grid of 255 steps of their parent, here 4 m wide.
        const double rounded_px = (pixel_of({4.0 / 255, 0}) - pixel_of({0, 0})).x;
        if (color == leaf_colour) {
          EXPECT_LT(off_leaf, 1.01 + rounded_px) << x << "," << y;
          ++leaves;
        } else if (color == inner_colour) {
          EXPECT_LT(off_root, 1.01 + rounded_px) << x << "," << y;
          ++inner;
        } else {
          EXPECT_EQ(color, glm::vec3(0)) << x << "," << y;
          EXPECT_GT(std::min(off_leaf, off_root), 0.3 - rounded_px) << x << "," << y;
        }
      }
    // Outlines of 21 by 28 and 21 by 21 pixels; of the root's, what is between the two and below the smaller.
    EXPECT_NEAR(leaves, 2 * (21 + 28) + 2 * (21 + 21), 8);
    EXPECT_GT(inner, 30);
  }
}

// Instances have their trees where they stand: lines all over the picture of many, and none where nothing is.
TEST_F(FrameTrees, BoxesOfInstances) {
  Job job = job_for(scene("instanced"), width, height, 1);
  job.layers = {"debug_bvh"};
  const Images images = images_of(job);
  int leaves = 0, inner = 0;
  for (const glm::vec4& v : images["debug_bvh"].values<glm::vec4>()) {
    leaves += glm::vec3(v) == leaf_colour;
    inner += glm::vec3(v) == inner_colour;
    EXPECT_TRUE(glm::vec3(v) == leaf_colour || glm::vec3(v) == inner_colour || glm::vec3(v) == glm::vec3(0));
  }
  EXPECT_GT(leaves, 100);
  EXPECT_GT(inner, 20);
}

// The device visits children in the order of the ray's octant, and triangles one by one, the CPU by distance and by
// blocks: so a ray's cost differs, and the picture's little. Where nothing is met nothing is tested, on both.
TEST_F(FrameTrees, CostsAreThoseOfTheReference) {
  for (const char* name : {"spheres", "alpha"}) {
    Job job = job_for(scene(name), width, height, 1);
    job.layers = {"heatmap_traversal"};
    job.effects = "none";
    const auto frame = open_reference(job, 0, {});
    ASSERT_TRUE(frame);
    reference::TraceSettings settings;
    settings.sampler = {reference::SamplerKind::uniform, 1};  // the pixel's middle
    reference::Film film(width, height, {.traversal = true});
    film.add(reference::Integrator(*(*frame)->world, settings, width, height), 1, [](double) { return true; });
    const std::vector<float> truth = reference_counts(film, **frame, "heatmap_traversal");
    const auto cost = images_of(job)["heatmap_traversal"].values<float>();
    ASSERT_EQ(cost.size(), truth.size());
    double here = 0, there = 0;
    for (size_t i = 0; i < cost.size(); ++i) {
      EXPECT_EQ(cost[i] == 0, truth[i] == 0) << name << " " << i;
      here += double(cost[i]), there += double(truth[i]);
    }
    EXPECT_NEAR(here / there, 1, 0.5) << name;
    EXPECT_GT(*std::max_element(truth.begin(), truth.end()), 5);
  }
}

// Builders make other trees, which cost something else, and the picture stays.
TEST_F(FrameTrees, BuildersChangeCostsAlone) {
  Job job = job_for(scene("spheres"), width, height, 1);
  job.technique = "ray";
  job.layers = {"heatmap_traversal"};
  std::vector<std::pair<Image, Image>> seen;
  for (const char* builder : {"equal-counts", "sah", "sbvh"}) {
    job.settings = {{"bvh", "builder", builder}, {"bvh", "max_leaf", "1"}};
    const Images images = images_of(job);
    seen.emplace_back(images["beauty"], images["heatmap_traversal"]);
  }
  EXPECT_EQ(seen[1].first, seen[0].first);
  EXPECT_EQ(seen[2].first, seen[0].first);
  EXPECT_NE(seen[1].second, seen[0].second);
  const auto cost = [](const Image& image) {
    double sum = 0;
    for (const float v : image.values<float>()) sum += double(v);
    return sum;
  };
  EXPECT_LT(cost(seen[1].second), cost(seen[0].second));
}

}  // namespace candela::test::frame_trees
