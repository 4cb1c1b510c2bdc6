#include <numbers>

#include "frame_fixture.h"

namespace candela::test {
namespace {
constexpr uint32_t no_id = 0xffffffffu;
Json with_alpha(Json material, const char* mode, double alpha) {
  material["alphaMode"] = mode;
  material["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
  return material;
}
Json two_sided(Json material) {
  material["doubleSided"] = true;
  return material;
}
}  // namespace

class FrameSurfaces : public FrameTest {
 protected:
  static glm::vec4 centre(const Images& images, const char* layer = "beauty") {
    return images[layer].at<glm::vec4>(images[layer].width / 2, images[layer].height / 2);
  }
};

// A plane tilted about Y, as the layers see it: depth along the view axis, world normal, ids, albedo, emission.
TEST_F(FrameSurfaces, LayersOfATiltedPlane) {
  const int width = 64, height = 36;
  GltfBuilder b = empty_scene();
  use_materials(b);
  add_material(b, diffuse_material(0.1, 0.1, 0.1));
  Json material = diffuse_material(0.25, 0.5, 0.75);
  material["emissiveFactor"] = {0.5, 0.25, 0.125};
  const int square = add_square_mesh(b, 1.5, add_material(b, material));
  add_node(b, {{"translation", {1, 2, 3}}});
  const double angle = 0.6;
  add_node(b, {{"mesh", square}, {"rotation", {0, std::sin(angle / 2), 0, std::cos(angle / 2)}}});
  for (const int samples : {1, 4}) {
    Job job = job_for(write(b), width, height, samples);
    job.layers = {"depth", "normal", "object_id", "material_id", "albedo", "emission"};
    look(job, {0, 0, 4}, {0, 0, 0}, 60);
    const Images images = images_of(job);
    const double tan_y = std::tan(std::numbers::pi / 6), tan_x = tan_y * width / height;
    const glm::dvec3 normal(std::sin(angle), 0, std::cos(angle));
    size_t inside = 0, outside = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const glm::dvec3 ray(tan_x * (2 * (x + 0.5) / width - 1), -tan_y * (2 * (y + 0.5) / height - 1), -1);
        const double depth = -4 * normal.z / glm::dot(ray, normal);  // (eye + depth * ray) lies in the plane
        const glm::dvec3 point = glm::dvec3(0, 0, 4) + depth * ray;
        const double reach = std::max(std::abs(point.x / std::cos(angle)), std::abs(point.y));
        const float seen_depth = images["depth"].at(x, y);
        const uint32_t object = images["object_id"].at<uint32_t>(x, y),
                       material_id = images["material_id"].at<uint32_t>(x, y);
        const glm::vec4 seen_normal = images["normal"].at<glm::vec4>(x, y);
        if (depth > 0 && reach < 1.5 - 1e-4) {
          ++inside;
          EXPECT_NEAR(seen_depth, depth, 2e-6 * depth) << x << " " << y;
          EXPECT_NEAR(glm::length(glm::dvec3(seen_normal)), 1, 2e-7);
          EXPECT_LT(glm::length(glm::dvec3(seen_normal) - normal), 5e-7);
          EXPECT_EQ(object, 1u);
          EXPECT_EQ(material_id, 1u);
          EXPECT_EQ(images["albedo"].at<glm::vec4>(x, y), glm::vec4(0.25, 0.5, 0.75, 1));
          // A mean over the samples: at an edge, of those that are covered.
          const float covered = images["beauty"].at<glm::vec4>(x, y).w;
          EXPECT_EQ(images["emission"].at<glm::vec4>(x, y), covered * glm::vec4(0.5, 0.25, 0.125, 1));
          if (samples == 1) {
            EXPECT_EQ(covered, 1);
          }
        } else if (depth < 0 || reach > 1.5 + 1e-4) {
          ++outside;
          EXPECT_EQ(seen_depth, 1e10f) << x << " " << y;
          EXPECT_EQ(object, no_id);
          EXPECT_EQ(material_id, no_id);
          EXPECT_EQ(seen_normal, glm::vec4(0));
          EXPECT_EQ(images["albedo"].at<glm::vec4>(x, y), glm::vec4(0));
          if (samples == 1) {
            EXPECT_EQ(images["beauty"].at<glm::vec4>(x, y), glm::vec4(0));
          }
        }
        if (HasFailure()) return;
      }
    EXPECT_GT(inside, 300u);
    EXPECT_GT(outside, 300u);
  }
}

// Four samples give edges the fraction of the pixel that is covered, and everything else stays as with one.
TEST_F(FrameSurfaces, EdgesOfFourSamplesLieBetween) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int square = add_square_mesh(b, 1, add_material(b, unlit_material(1, 0.5, 0.25)));
  add_node(b, {{"mesh", square}, {"rotation", {0, 0, std::sin(0.15), std::cos(0.15)}}});
  Job job = job_for(write(b), 64, 36, 1);
  job.background = "0,0.25,0.5";
  look(job, {0, 0, 4}, {0, 0, 0});
  const Images one = images_of(job);
  job.samples = 4;
  const Images four = images_of(job);
  const glm::vec4 front(1, 0.5, 0.25, 1), back(0, 0.25, 0.5, 1);
  size_t mixed = 0, full = 0, none = 0;
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::vec4 hard = one["beauty"].at<glm::vec4>(x, y), soft = four["beauty"].at<glm::vec4>(x, y);
      EXPECT_TRUE(hard == front || hard == back);
      const float covered = soft.x;  // the front's red is 1, the background's 0
      EXPECT_EQ(covered * 4, std::floor(covered * 4));
      EXPECT_EQ(soft, back + (front - back) * covered);
      (covered == 1 ? full : covered == 0 ? none : mixed)++;
    }
  EXPECT_GT(mixed, 30u);
  EXPECT_GT(full, 200u);
  EXPECT_GT(none, 500u);
}

TEST_F(FrameSurfaces, BlendedSquaresCoverBackToFrontFromBothSides) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int red = add_square_mesh(b, 1, add_material(b, two_sided(with_alpha(unlit_material(1, 0, 0), "BLEND", 0.5))));
  const int green =
      add_square_mesh(b, 1, add_material(b, two_sided(with_alpha(unlit_material(0, 1, 0), "BLEND", 0.25))));
  const int solid = add_square_mesh(b, 0.2f, add_material(b, two_sided(unlit_material(0, 0, 1))));
  add_node(b, {{"mesh", green}, {"translation", {0, 0, 1}}});
  add_node(b, {{"mesh", red}});
  for (const int samples : {1, 4}) {
    Job job = job_for(write(b), 32, 32, samples);
    look(job, {0, 0, 5}, {0, 0, 0}, 30);
    EXPECT_EQ(centre(images_of(job)), glm::vec4(0.375, 0.25, 0, 0.625));  // green 1/4 over red 1/2
    look(job, {0, 0, -5}, {0, 0, 0}, 30);
    EXPECT_EQ(centre(images_of(job)), glm::vec4(0.5, 0.125, 0, 0.625));  // red 1/2 over green 1/4
  }
  // A solid square between them hides the one behind it.
  add_node(b, {{"mesh", solid}, {"translation", {0, 0, 0.5}}});
  Job job = job_for(write(b), 32, 32);
  look(job, {0, 0, 5}, {0, 0, 0}, 30);
  EXPECT_EQ(centre(images_of(job)), glm::vec4(0, 0.25, 0.75, 1));
  look(job, {0, 0, -5}, {0, 0, 0}, 30);
  EXPECT_EQ(centre(images_of(job)), glm::vec4(0.5, 0, 0.5, 1));
}

// A blended surface covers with its emission as with everything else: a quarter of a lamp is a quarter as bright.
TEST_F(FrameSurfaces, BlendedEmissionIsCoveredToo) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = with_alpha(diffuse_material(0, 0, 0), "BLEND", 0.25);
  material["emissiveFactor"] = {0.5, 0.25, 1};
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, material))}});
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, unlit_material(1, 1, 1)))}, {"translation", {0, 0, -1}}});
  for (const int samples : {1, 4}) {
    Job job = job_for(write(b), 32, 32, samples);
    look(job, {0, 0, 5}, {0, 0, 0}, 10);
    EXPECT_EQ(centre(images_of(job)), glm::vec4(0.875, 0.8125, 1, 1));
  }
}

// glTF 2.0, 3.9.4: what is at least the cutoff is solid, so alpha that equals it is.
TEST_F(FrameSurfaces, AMaskKeepsWhatEqualsItsCutoff) {
  for (const bool unlit : {false, true}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = with_alpha(unlit ? unlit_material(1, 1, 1, 1) : diffuse_material(1, 1, 1), "MASK", 0.375);
    material["alphaCutoff"] = 0.375;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, material))}});
    Job job = job_for(write(b), 16, 16);
    job.layers = {"object_id"};
    look(job, {0, 0, 5}, {0, 0, 0}, 10);
    const Images images = images_of(job);
    EXPECT_EQ(centre(images).w, 1.0f);
    EXPECT_EQ(images["object_id"].at<uint32_t>(8, 8), 0u);
  }
}

// masks.by_sample: a pixel that a mask's edge crosses keeps as many of its samples as lie inside; the rest stays.
TEST_F(FrameSurfaces, AMaskBySampleCoversAsMuchAsLiesInside) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = with_alpha(unlit_material(1, 1, 1), "MASK", 1);
  material["alphaCutoff"] = 0.5;
  const int square = add_square_mesh(b, 1, add_material(b, material));
  b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["COLOR_0"] =
      b.accessor<float>("VEC4", {1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1});
  add_node(b, {{"mesh", square}, {"rotation", {0, 0, std::sin(0.15), std::cos(0.15)}}});
  Job job = job_for(write(b), 64, 36, 4);
  look(job, {0, 0, 3}, {0, 0, 0}, 30);
  const Images whole = images_of(job);
  job.settings = {{"masks", "by_sample", "1"}};
  const Images parts = images_of(job);
  // The line of alpha 0.5 runs through the middle of the square, 0.3 radians off the vertical.
  const glm::dvec2 places[] = {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}};
  size_t mixed = 0, hard = 0;
  for (int y = 10; y < 26; ++y)
    for (int x = 22; x < 42; ++x) {
      int inside = 0;
      bool clear = true;
      for (const glm::dvec2& place : places) {
        const glm::dvec2 at(x + place.x - 32, 18 - (y + place.y));
        const double px = -(at.x * std::cos(0.3) + at.y * std::sin(0.3));
        clear = clear && std::abs(px) > 0.02;
        inside += px > 0;
      }
      const float of_whole = whole["beauty"].at<glm::vec4>(x, y).w;
      EXPECT_TRUE(of_whole == 0 || of_whole == 1) << x << " " << y;
      if (!clear) continue;
      EXPECT_EQ(parts["beauty"].at<glm::vec4>(x, y).w, inside / 4.0f) << x << " " << y;
      mixed += inside % 4 != 0, hard += inside % 4 == 0;
    }
  EXPECT_GE(mixed, 10u);
  EXPECT_GT(hard, 100u);
}

// A mask by vertex colours whose alpha falls from 1 to 0: solid up to the cutoff, then gone, in beauty and layers
// alike. Each channel of the colours is its own.
TEST_F(FrameSurfaces, AMaskCutsAtItsCutoff) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = with_alpha(unlit_material(1, 0.5, 0.25), "MASK", 1);
  material["alphaCutoff"] = 0.25;
  const int square = add_square_mesh(b, 1, add_material(b, material));
  b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["COLOR_0"] =
      b.accessor<float>("VEC4", {0.5, 0.25, 0.125, 1, 0.5, 0.25, 0.125, 0, 0.5, 0.25, 0.125, 0, 0.5, 0.25, 0.125, 1});
  add_node(b, {{"mesh", square}});
  for (const int samples : {1, 4}) {
    Job job = job_for(write(b), 64, 36, samples);
    job.layers = {"object_id"};
    look(job, {0, 0, 3}, {0, 0, 0});
    const Images images = images_of(job);
    const double tan_x = std::tan(std::numbers::pi / 8) * 64 / 36;
    size_t cut = 0, solid = 0;
    for (int x = 0; x < 64; ++x) {
      const double at = 3 * tan_x * (2 * (x + 0.5) / 64 - 1), alpha = (1 - at) / 2;
      if (std::abs(at) > 0.95 || std::abs(alpha - 0.25) < 0.05) continue;
      const glm::vec4 p = images["beauty"].at<glm::vec4>(x, 18);
      EXPECT_EQ(p, alpha > 0.25 ? glm::vec4(0.5, 0.125, 0.03125, 1) : glm::vec4(0)) << x;
      EXPECT_EQ(images["object_id"].at<uint32_t>(x, 18), alpha > 0.25 ? 0u : no_id) << x;
      (alpha > 0.25 ? solid : cut)++;
    }
    EXPECT_GT(cut, 3u);
    EXPECT_GT(solid, 10u);
  }
}

// glTF 2.0, 3.9.6: a double-sided surface turns its normal over on its back; a single-sided one is not drawn.
TEST_F(FrameSurfaces, BacksAreShadedWhenDoubleSidedAndAbsentOtherwise) {
  for (const bool both : {true, false}) {
    GltfBuilder b = empty_scene();
    Json material = diffuse_material(0.5, 0.5, 0.5);
    material["doubleSided"] = both;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, material))}});
    add_light(b, {{"type", "point"}, {"intensity", 10.0}}, {{"translation", {0.5, 0.25, 2}}});
    add_light(b, {{"type", "point"}, {"intensity", 10.0}}, {{"translation", {-0.5, 0.25, -2}}});  // turned about Y
    Job job = job_for(write(b), 32, 32);
    job.layers = {"normal"};
    look(job, {0, 0, 4}, {0, 0, 0});
    const Images front = images_of(job);
    look(job, {0, 0, -4}, {0, 0, 0});
    const Images back = images_of(job);
    EXPECT_GT(centre(front).x, 0.1f);
    EXPECT_EQ(centre(front, "normal"), glm::vec4(0, 0, 1, 1));
    if (!both) {
      EXPECT_EQ(centre(back), glm::vec4(0));
      continue;
    }
    EXPECT_EQ(centre(back, "normal"), glm::vec4(0, 0, -1, 1));
    const auto a = front["beauty"].values<float>(), c = back["beauty"].values<float>();
    for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], c[i], 2e-6 * a[i]);
  }
}

// A mesh under a transform that mirrors, against the same surface built without one: the same pixels up to rounding.
TEST_F(FrameSurfaces, MirroredTransformsShadeLikeMirroredGeometry) {
  const std::vector<float> corners = {0, 0, 1, 1.2f, -0.3f, 0, -0.4f, 0.9f, 0.1f, -0.6f, -0.7f, -0.2f};
  const std::vector<uint16_t> faces = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
  const auto build = [&](bool mirrored_geometry) {
    GltfBuilder b = empty_scene();
    std::vector<float> position = corners, normal;
    std::vector<uint16_t> index = faces;
    if (mirrored_geometry)
      for (size_t i = 0; i < position.size(); i += 3) position[i] = -position[i];
    if (mirrored_geometry)
      for (size_t i = 0; i < index.size(); i += 3) std::swap(index[i + 1], index[i + 2]);
    for (size_t i = 0; i < position.size(); i += 3) {
      const glm::vec3 n =
          glm::normalize(glm::vec3(position[i], position[i + 1], position[i + 2]) - glm::vec3(0, 0, -0.5f));
      normal.insert(normal.end(), {n.x, n.y, n.z});
    }
    Json& p =
        b.primitive({{"POSITION", b.accessor<float>("VEC3", position)}, {"NORMAL", b.accessor<float>("VEC3", normal)}});
    p["indices"] = b.accessor<uint16_t>("SCALAR", index);
    p["material"] = add_material(b, {{"pbrMetallicRoughness", base_color(0.7, 0.5, 0.3)}});
    add_node(b, {{"mesh", 0}, {"scale", {mirrored_geometry ? 1 : -1, 1, 1}}});
    add_light(b, {{"type", "point"}, {"intensity", 30.0}}, {{"translation", {1.5, 1, 2}}});
    return b;
  };
  Job job = job_for("", 64, 48);
  job.layers = {"object_id", "normal", "depth"};
  look(job, {0.5, 0.3, 4}, {0, 0, 0}, 40);
  job.scene = write(build(true));
  const Images geometry = images_of(job);
  job.scene = write(build(false));
  const Images transform = images_of(job);
  const auto a = geometry["object_id"].values<uint32_t>(), c = transform["object_id"].values<uint32_t>();
  EXPECT_EQ(a, c);
  EXPECT_GT(std::count(a.begin(), a.end(), 0u), 200);
  for (const char* layer : {"beauty", "normal", "depth"}) {
    const auto u = geometry[layer].values<float>(), v = transform[layer].values<float>();
    for (size_t i = 0; i < u.size(); ++i)
      ASSERT_NEAR(u[i], v[i], 2e-6 * std::max(1.0f, std::abs(u[i]))) << layer << " " << i;
  }
}

TEST_F(FrameSurfaces, AnOrthographicCameraMeasuresInMetres) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int square = add_square_mesh(b, 1, add_material(b, unlit_material(1, 1, 1)));
  add_node(b, {{"mesh", square}, {"translation", {0.5, 0.25, -1}}});
  add_node(b, {{"mesh", square}, {"translation", {0.5, 0.25, -7}}});  // hidden: no perspective makes it larger
  b.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 4.0}, {"ymag", 2.0}, {"znear", 0.5}, {"zfar", 20.0}}}}};
  add_node(b, {{"camera", 0}, {"translation", {0, 0, 2}}});
  Job job = job_for(write(b), 64, 32);
  job.layers = {"object_id", "depth"};
  const Images images = images_of(job);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) {
      const double px = -4 + (x + 0.5) / 8, py = 2 - (y + 0.5) / 8;  // eight pixels a metre
      const bool inside = std::abs(px - 0.5) < 1 && std::abs(py - 0.25) < 1;
      EXPECT_EQ(images["beauty"].at<glm::vec4>(x, y), inside ? glm::vec4(1) : glm::vec4(0)) << x << " " << y;
      EXPECT_EQ(images["object_id"].at<uint32_t>(x, y), inside ? 0u : no_id);
      if (inside) {
        EXPECT_NEAR(images["depth"].at(x, y), 3, 1e-6);
      }
    }
}

TEST_F(FrameSurfaces, ExposureScalesLinearRadianceByPowersOfTwo) {
  Job job = job_for(scene("spheres"), 48, 27);
  const auto plain = images_of(job)["beauty"].values<glm::vec4>();
  job.exposure_ev = 3;
  const auto brighter = images_of(job)["beauty"].values<glm::vec4>();
  for (size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(glm::vec3(plain[i]) * 8.0f, glm::vec3(brighter[i]));
    EXPECT_EQ(plain[i].w, brighter[i].w);
  }
}

TEST_F(FrameSurfaces, AnEmptySceneShowsTheBackground) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"name", "nothing"}});
  for (const int samples : {1, 4}) {
    Job job = with_layers(job_for(write(b), 16, 9, samples));
    job.background = "0.125,0.25,0.5";
    const Images images = images_of(job, {.linear = true, .display = true});
    for (const glm::vec4& p : images["beauty"].values<glm::vec4>()) EXPECT_EQ(p, glm::vec4(0.125, 0.25, 0.5, 1));
  }
}

}  // namespace candela::test
