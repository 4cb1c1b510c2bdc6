// Cryptomatte layers: coverage by object and material against alpha, ids, geometry and pictures of single samples.
#include <map>

#include "frame_fixture.h"
#include "scene/matte_names.h"

namespace candela::test::frame_mattes {
namespace {

constexpr int width = 48, height = 30;

using Coverage = std::map<uint32_t, float>;  // of a pixel, by id

// Squares of several names that overlap and are cut by a mask, before and behind one another, and one that is blended.
GltfBuilder overlapping() {
  GltfBuilder b = empty_scene();
  const auto add = [&](const char* name, Json material, glm::dvec3 at, float half, double turn) {
    material["doubleSided"] = true;
    Json node = {{"mesh", add_square_mesh(b, half, add_material(b, material))},
                 {"translation", {at.x, at.y, at.z}},
                 {"rotation", {0.0, 0.0, std::sin(turn / 2), std::cos(turn / 2)}}};
    if (*name) node["name"] = name;
    add_node(b, node);
  };
  use_materials(b);
  add("back", diffuse_material(0.5, 0.5, 0.5), {0, 0, -0.5}, 1.2f, 0.1);
  add("front", unlit_material(0.9, 0.1, 0.1), {0.4, 0.3, 0.5}, 0.5f, 0.7);
  add("front", diffuse_material(0.1, 0.9, 0.1), {-0.5, -0.3, 0.4}, 0.4f, 0.3);  // "front #2"
  add("", diffuse_material(0.1, 0.1, 0.9), {-0.3, 0.5, 0.3}, 0.3f, 1.1);        // "node #3"
  Json masked = diffuse_material(0.9, 0.9, 0.1);
  masked["alphaMode"] = "MASK";
  masked["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;  // below the cutoff: nothing is left
  add("cut away", masked, {0.2, -0.4, 0.9}, 0.5f, 0.2);
  add_light(b, {{"type", "directional"}, {"intensity", 2.0}}, {{"translation", {0, 0, 3}}});
  return b;
}

}  // namespace

class FrameMattes : public FrameTest {
 protected:
  static Job job_of(const std::string& file, int samples, int supersampled, int w = width, int h = height) {
    Job job = job_for(file, w, h, samples);
    look(job, {0.1, -0.4, 4}, {0, 0, 0}, 45);
    job.layers = {"crypto_object", "crypto_material"};
    job.settings = {{"supersample", "n", fmt::format("{}", supersampled)}, {"cryptomatte", "ranks", "64"}};
    return job;
  }
  static std::vector<Coverage> coverage(const Images& images, const std::string& layer) {
    std::vector<Coverage> pixels;
    for (const Image& image : images) {
      if (image.layer != layer) continue;
      const auto values = image.values<glm::vec4>();
      pixels.resize(values.size());
      for (size_t i = 0; i < values.size(); ++i)
        for (const glm::vec2 pair : {glm::vec2(values[i]), glm::vec2(values[i].z, values[i].w)}) {
          const uint32_t id = std::bit_cast<uint32_t>(pair.x);
          EXPECT_EQ(id == 0, pair.y == 0) << i;
          if (id == 0) continue;
          EXPECT_TRUE(pixels[i].emplace(id, pair.y).second) << "pixel " << i << " names an id twice";
        }
    }
    return pixels;
  }
  static float sum(const Coverage& pixel) {
    float all = 0;
    for (const auto& [id, fraction] : pixel) all += fraction;
    return all;
  }
};

// With one sample a pixel, a matte is the layer of ids; with more, the coverages of a pixel sum to its alpha.
TEST_F(FrameMattes, CoverWhatBeautyCovers) {
  const std::string file = write(overlapping());
  const auto loaded = load_gltf(file);
  ASSERT_TRUE(loaded);
  const auto objects = matte_ids(node_names(*loaded)), materials = matte_ids(material_names(*loaded));
  for (const auto& [samples, n] : {std::pair(1, 1), {4, 1}, {1, 2}, {1, 4}}) {
    SCOPED_TRACE(fmt::format("{} samples, supersampled {}", samples, n));
    Job job = job_of(file, samples, n);
    job.layers.insert(job.layers.end(), {"object_id", "material_id"});
    const Images images = images_of(job);
    const auto beauty = images["beauty"].values<glm::vec4>();
    const auto object_id = images["object_id"].values<uint32_t>(),
               material_id = images["material_id"].values<uint32_t>();
    const auto by_object = coverage(images, "crypto_object"), by_material = coverage(images, "crypto_material");
    ASSERT_EQ(by_object.size(), beauty.size());
    ASSERT_EQ(by_material.size(), beauty.size());
    size_t mixed = 0;
    for (size_t i = 0; i < beauty.size(); ++i) {
      ASSERT_EQ(sum(by_object[i]), beauty[i].w) << i;
      ASSERT_EQ(sum(by_material[i]), beauty[i].w) << i;
      mixed += by_object[i].size() > 1;
      const bool whole = by_object[i].size() == 1 && sum(by_object[i]) == 1;
      if (samples * n * n == 1) {
        ASSERT_EQ(whole, object_id[i] != 0xffffffffu) << i;
      }
      if (!whole) continue;
      // Where all of a pixel is of one name, its centre is.
      EXPECT_EQ(by_object[i].begin()->first, objects[object_id[i]]) << i;
      EXPECT_EQ(by_material[i].begin()->first, materials[material_id[i]]) << i;
    }
    EXPECT_EQ(mixed > 40, samples * n * n > 1) << mixed;
    for (const char* name : {"back", "front", "front #2", "node #3"}) {
      size_t full = 0;
      for (const Coverage& pixel : by_object) full += pixel.contains(matte_id(name)) && pixel.at(matte_id(name)) == 1;
      EXPECT_GT(full, 8u) << name;
    }
    for (const Coverage& pixel : by_object) ASSERT_FALSE(pixel.contains(matte_id("cut away")));
  }
}

// A straight edge at a known place of a pixel: coverage is within one sample of the area.
TEST_F(FrameMattes, MeasureTheAreaUnderAnEdge) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  // The picture shows 2 m by 1 m of the plane at z = 0 at 16 pixels a metre: the edge at 3.3 pixels from the middle.
  const double edge_px = 3.3;
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, unlit_material(1, 1, 1)))},
               {"name", "wall"},
               {"translation", {edge_px / 16 - 2, 0, 0}}});
  const std::string file = write(b);
  for (const auto& [samples, n] : {std::pair(1, 1), {4, 1}, {1, 2}, {1, 3}, {1, 8}}) {
    Job job = job_of(file, samples, n, 32, 16);
    job.camera.eye = glm::dvec3(0, 0, 2), job.camera.target = glm::dvec3(0);
    job.camera.yfov_deg = glm::degrees(2 * std::atan(0.25));
    const auto pixels = coverage(images_of(job), "crypto_object");
    const double step = n > 1 ? 1.0 / n : 1.0 / samples;  // of a grid's columns, or of samples that share no column
    for (int x = 0; x < 32; ++x) {
      const Coverage& pixel = pixels[size_t(8 * 32 + x)];
      const double area = std::clamp(16 + edge_px - x, 0.0, 1.0);
      EXPECT_NEAR(sum(pixel), area, area > 0 && area < 1 ? step : 0) << samples << " " << n << " " << x;
      if (area > 0.5) {
        EXPECT_EQ(pixel.begin()->first, matte_id("wall"));
      }
    }
  }
}

// The samples of a supersampled frame are the pixels of a larger picture, whose ids are counted here by hand.
TEST_F(FrameMattes, CountTheSamples) {
  const std::string file = write(overlapping());
  const auto loaded = load_gltf(file);
  ASSERT_TRUE(loaded);
  const auto objects = matte_ids(node_names(*loaded));
  for (const int n : {2, 3, 5}) {
    Job large = job_of(file, 1, 1, width * n, height * n);
    large.layers = {"object_id"};
    const Image ids = images_of(large)["object_id"];
    const auto pixels = coverage(images_of(job_of(file, 1, n)), "crypto_object");
    size_t different = 0, mixed = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        std::map<uint32_t, int> counts;
        for (int s = 0; s < n * n; ++s)
          if (const uint32_t id = ids.at<uint32_t>(x * n + s % n, y * n + s / n); id != 0xffffffffu)
            ++counts[objects[id]];
        Coverage expected;
        for (const auto& [id, count] : counts) expected[id] = float(count) / float(n * n);
        mixed += expected.size() > 1;
        different += expected != pixels[size_t(y * width + x)];
      }
    // Corners are rounded to parts of a pixel, of another size in both: samples next to an edge may change sides.
    EXPECT_GT(mixed, 40u);
    EXPECT_LE(different, 8u) << n;
  }
}

// Ranks go from the largest coverage down, ties by id; fewer ranks keep the first of them and say what is lost.
TEST_F(FrameMattes, RanksAreInOrderAndLossesAreSaid) {
  const std::string file = write(overlapping());
  const auto levels = [](const Images& images) {
    std::vector<std::vector<glm::vec4>> out;
    for (const Image& image : images)
      if (image.layer == "crypto_object") out.push_back(image.values<glm::vec4>());
    return out;
  };
  Job job = job_of(file, 1, 4);
  const auto session = open(job);
  const FrameResult result = render(*session);
  const auto exact = levels(images(result));
  ASSERT_EQ(exact.size(), 8u);
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
  size_t ties = 0, most = 0, beyond = 0;
  for (size_t i = 0; i < exact[0].size(); ++i) {
    std::vector<std::pair<float, uint32_t>> ranks;
    for (const auto& level : exact)
      for (const glm::vec2 pair : {glm::vec2(level[i]), glm::vec2(level[i].z, level[i].w)})
        ranks.emplace_back(pair.y, std::bit_cast<uint32_t>(pair.x));
    for (size_t r = 1; r < ranks.size(); ++r) {
      ASSERT_GE(ranks[r - 1].first, ranks[r].first);
      if (ranks[r].first == 0 || ranks[r - 1].first != ranks[r].first) continue;
      ++ties;
      ASSERT_LT(ranks[r - 1].second, ranks[r].second);
    }
    const size_t ids = size_t(std::ranges::count_if(ranks, [](const auto& r) { return r.first > 0; }));
    most = std::max(most, ids), beyond += ids > 1;
  }
  EXPECT_GT(ties, 0u);
  job.settings.back().value = "1";
  const auto less = open(job);
  const FrameResult cut = render(*less);
  const auto first = levels(images(cut));
  ASSERT_EQ(first.size(), 1u);
  for (size_t i = 0; i < exact[0].size(); ++i)
    ASSERT_EQ(first[0][i], glm::vec4(exact[0][i].x, exact[0][i].y, 0, 0)) << i;
  ASSERT_EQ(cut.warnings.size(), 2u);
  EXPECT_TRUE(cut.warnings[0].starts_with(
      fmt::format("crypto_object: {} pixels hold more ids than its 1 ranks, up to {};", beyond, most)))
      << cut.warnings[0];
}

// Other layers and beauty keep their bits, and frames that do not ask hold nothing of it.
TEST_F(FrameMattes, ChangeNothingElse) {
  for (const int n : {1, 2}) {
    Job job = job_of(write(overlapping()), 4, n);
    const Images with = images_of(job);
    job.layers.clear();
    const auto session = open(job);
    const FrameResult result = render(*session);
    EXPECT_EQ(images(result)["beauty"], with["beauty"]);
    for (const PlanPass& pass : result.plan->passes) EXPECT_FALSE(pass.name.starts_with("matte")) << pass.name;
    for (const PlanResource& resource : result.plan->resources)
      EXPECT_EQ(resource.name().find("matte"), std::string::npos) << resource.name();
  }
}

// Blended surfaces do not count, and where there is nothing else there is nothing.
TEST_F(FrameMattes, LeaveBlendedSurfacesOut) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json glass = unlit_material(0.2, 0.9, 0.2, 0.5);
  glass["alphaMode"] = "BLEND";
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, glass))}, {"name", "glass"}});
  const auto pixels = coverage(images_of(job_of(write(b), 4, 1)), "crypto_object");
  ASSERT_EQ(pixels.size(), size_t(width * height));
  for (const Coverage& pixel : pixels) ASSERT_TRUE(pixel.empty());
}

}  // namespace candela::test::frame_mattes
