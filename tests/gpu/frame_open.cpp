// Light that was lost or leaked by default: what convex bodies hide of themselves, rooms without a front, the scale of
// a scene.
#include <cstring>
#include <fstream>

#include "../unit/reference_fixture.h"
#include "base/files.h"
#include "frame_sky_fixture.h"
#include "render/reference_frame.h"

namespace candela::test {

class FrameOpen : public SkyTest {
 protected:
  static constexpr int width = 64, height = 48;  // of the pictures
  // A room of inward faces, 4 m wide, a block in it, a lamp and a sun, seen through its front wall; a scale of lengths,
  // with the lamp's intensity by its square.
  static std::string room(double scale, bool double_sided) {
    GltfBuilder b = empty_scene();
    Json walls = diffuse_material(0.7, 0.6, 0.5);
    walls["doubleSided"] = double_sided;
    const int wall = add_square_mesh(b, float(2 * scale), add_material(b, walls));
    const int block = add_square_mesh(b, float(0.7 * scale), add_material(b, diffuse_material(0.2, 0.5, 0.7)));
    const double h = std::sqrt(0.5);
    const auto add = [&](int mesh, glm::dvec3 at, const Json& turn) {
      at *= scale;
      add_node(b, {{"mesh", mesh}, {"translation", {at.x, at.y, at.z}}, {"rotation", turn}});
    };
    add(wall, {0, -2, 0}, {-h, 0, 0, h});  // floor: normal +y
    add(wall, {0, 2, 0}, {h, 0, 0, h});
    add(wall, {0, 0, -2}, {0, 0, 0, 1});
    add(wall, {0, 0, 2}, {0, 1, 0, 0});
    add(wall, {-2, 0, 0}, {0, h, 0, h});
    add(wall, {2, 0, 0}, {0, -h, 0, h});
    add(block, {0.3, -1, -0.4}, {-h, 0, 0, h});  // a table's top
    const glm::dvec3 lamp = glm::dvec3(-1, 1, 0.5) * scale;
    add_light(b, {{"type", "point"}, {"intensity", 6.0 * scale * scale}}, {{"translation", {lamp.x, lamp.y, lamp.z}}});
    add_light(b, {{"type", "directional"}, {"intensity", 2.0}},
              {{"rotation", rotation_between({0, 0, -1}, {-0.4, -1, -0.7})}});
    return write(b);
  }
  static Job seen(const std::string& path, double scale = 1) {
    Job job = job_for(path, width, height, 1);
    look(job, glm::dvec3(1, 2, 9) * scale, {0, 0, 0}, 40);
    return job;
  }
  // Direct light of the reference at 128 samples a pixel.
  static std::vector<glm::vec4> traced(const Job& job) {
    const auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    std::vector<glm::vec4> out;
    if (!frame) return out;
    reference::TraceSettings settings;
    settings.sampler = {reference::SamplerKind::sobol, 128};
    reference::Film film(job.width_px, job.height_px, {});
    film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), 128,
             [](double) { return true; });
    for (size_t i = 0; i < film.pixels(); ++i) out.emplace_back(film.mean(i));
    return out;
  }
  static double relmse(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& truth) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i)
      for (int c = 0; c < 3; ++c)
        sum += std::pow(double(a[i][c] - truth[i][c]), 2) / (std::pow(double(truth[i][c]), 2) + 0.01) / 3;
    return sum / double(a.size());
  }
};

// A white ball in a white furnace hides nothing of itself, at its outline neither.
TEST_F(FrameOpen, AConvexBodyIsAsOpenAsItIs) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", reference::test::add_sphere_mesh(b, 1, add_material(b, diffuse_material(1, 1, 1)), 24)}});
  Job job = job_for(write(b), width, height, 1);
  look(job, {0, 0, 3}, {0, 0, 0}, 45);
  job.sky = write_sky("white", [](glm::dvec3) { return glm::dvec3(1); }).file;
  job.layers = {"occlusion"};
  for (const float v : images_of(job)["occlusion"].values<float>()) EXPECT_GE(v, 0.99f);
}

// A ball that rests on a floor: rays that are filtered keep its contact. In a uniform sky it hides of a point at
// distance r from where it touches (1 + r^2)^-1.5, the form factor of a sphere above a horizon.
TEST_F(FrameOpen, AContactStaysDark) {
  GltfBuilder b = empty_scene();
  const int white = add_material(b, diffuse_material(1, 1, 1));
  add_node(b, {{"mesh", add_square_mesh(b, 8, white)}});
  add_node(b, {{"mesh", reference::test::add_sphere_mesh(b, 1, white, 48)}, {"translation", {0, 0, 1}}});
  Job job = job_for(write(b), width, height, 1);
  const glm::dvec3 eye(0, -7, 4);
  look(job, eye, {0, 0, 0.5}, 40);
  job.sky = write_sky("even", [](glm::dvec3) { return glm::dvec3(1); }).file;
  job.layers = {"occlusion"};
  const glm::dvec3 forward = glm::normalize(glm::dvec3(0, 0, 0.5) - eye), right(1, 0, 0),
                   up = glm::cross(right, forward);
  const double tan_half = std::tan(20 * std::numbers::pi / 180);
  for (const auto& [quality, most] : {std::pair("normal", 0.185), {"high", 0.08}}) {
    job.quality = quality;
    const Images images = images_of(job);
    const auto open = images["occlusion"].values<float>();
    double squares = 0;
    int count = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double across = (2 * (x + 0.5) / width - 1) * tan_half * width / height,
                     over = (1 - 2 * (y + 0.5) / height) * tan_half;
        const glm::dvec3 d = glm::normalize(forward + across * right + over * up), to = eye - glm::dvec3(0, 0, 1);
        if (!(d.z < 0) || glm::dot(to, d) * glm::dot(to, d) - glm::dot(to, to) + 1.05 > 0) continue;  // sky and ball
        const glm::dvec3 at = eye - eye.z / d.z * d;
        const double r2 = at.x * at.x + at.y * at.y;
        if (r2 > 4) continue;
        squares += std::pow(double(open[size_t(y * width + x)]) - (1 - std::pow(1 + r2, -1.5)), 2);
        ++count;
      }
    ASSERT_GT(count, 30);
    EXPECT_LT(std::sqrt(squares / count), most) << quality;
  }
}

// What a wall hides of the sky that rough metal reflects, by rays in the lobe's own directions, is the reference's.
TEST_F(FrameOpen, TracedOcclusionHidesWhatTheLobeSees) {
  GltfBuilder b = empty_scene();
  const auto metal = [&](double roughness) {
    Json m = diffuse_material(0.9, 0.9, 0.9);
    m["pbrMetallicRoughness"]["metallicFactor"] = 1.0, m["pbrMetallicRoughness"]["roughnessFactor"] = roughness;
    m["doubleSided"] = true;
    return add_material(b, m);
  };
  const double h = std::sqrt(0.5);
  add_node(b, {{"mesh", add_square_mesh(b, 2, metal(0.35))}});
  add_node(b, {{"mesh", add_square_mesh(b, 2, metal(0.6))}, {"translation", {0, 1, 2}}, {"rotation", {h, 0, 0, h}}});
  Job job = job_for(write(b), 32, 24, 1);
  look(job, {1, -5, 2}, {0, 0, 0.5}, 40);
  job.sky = write_sky("slope", [](glm::dvec3 d) { return glm::dvec3(1 + d.y, 1 + 0.5 * d.z, 1 - 0.5 * d.x); }).file;
  job.settings = {{"occlusion", "method", "traced"}, {"occlusion", "rays", "256"}, {"ibl", "method", "sampled"}};
  const std::vector<glm::vec4> truth = traced(job);
  ASSERT_FALSE(truth.empty());
  for (const char* technique : {"clustered", "visibility"}) {
    job.technique = technique;
    EXPECT_LT(relmse(images_of(job)["beauty"].values<glm::vec4>(), truth), 0.03) << technique;
  }
}

// A wall hides a bright spot of the sky from a floor, most of which stays open: neither its diffuse light nor its
// highlight is left on matt and on glossy ground. With a look that turns the sky too.
TEST_F(FrameOpen, AWallHidesABrightSpotOfTheSky) {
  GltfBuilder b = empty_scene();
  Json glossy = diffuse_material(0.9, 0.9, 0.9);
  glossy["pbrMetallicRoughness"]["metallicFactor"] = 1.0, glossy["pbrMetallicRoughness"]["roughnessFactor"] = 0.4;
  Json matt = diffuse_material(0.8, 0.8, 0.8);
  matt["doubleSided"] = true;
  const int wall = add_material(b, matt);
  const double h = std::sqrt(0.5);
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, glossy))}, {"translation", {1, 0, 0}}});
  add_node(b, {{"mesh", add_square_mesh(b, 1, wall)}, {"translation", {-1, 0, 0}}});
  add_node(b, {{"mesh", add_square_mesh(b, 3, wall)}, {"translation", {0, 1, 3}}, {"rotation", {h, 0, 0, h}}});
  Job job = job_for(write(b), 32, 24, 1);
  look(job, {0, -5, 2}, {0, 0, 0.2}, 30);
  const glm::dvec3 behind = glm::normalize(glm::dvec3(0.05, 0.8, 0.6));
  const auto radiance = [&](glm::dvec3 d) { return glm::dvec3(glm::dot(d, behind) > 0.995 ? 300 : 0.02); };
  const std::string turning = ::testing::TempDir() + "candela_open_turned_sky.json";
  std::ofstream(turning) << R"({"sky": {"rotation_deg": 90}})";
  for (const bool turned : {false, true}) {
    job.look = turned ? turning : "";
    job.sky = write_sky(turned ? "box_turned" : "box", [&](glm::dvec3 d) {
                return radiance(turned ? glm::dvec3(d.z, d.y, -d.x) : d);
              }).file;
    const std::vector<glm::vec4> truth = traced(job);
    ASSERT_FALSE(truth.empty());
    for (const char* technique : {"clustered", "visibility", "ray"}) {
      job.technique = technique;
      EXPECT_LT(relmse(images_of(job)["beauty"].values<glm::vec4>(), truth), 0.02) << technique << " " << turned;
    }
  }
}

// The sky behind everything is read as finely as a supersampled frame's samples lie: stripes of 3.5 pixels keep their
// contrast, of which a pixel's box leaves 0.87 and texels 0.95.
TEST_F(FrameOpen, ASupersampledSkyIsSharp) {
  GltfBuilder b = empty_scene();
  add_node(
      b, {{"mesh", add_square_mesh(b, 0.1f, add_material(b, diffuse_material(1, 1, 1)))}, {"translation", {0, 0, 5}}});
  Job job = job_for(write(b), 24, 8, 1);
  look(job, {0, 0, 0}, {0, 0, -1},
       2 * std::atan(std::tan(33.75 * std::numbers::pi / 180) / 3) * 180 / std::numbers::pi);
  job.sky = write_sky("stripes", [](glm::dvec3 d) {
              return glm::dvec3(1 + std::cos(std::atan2(d.z, d.x) * sky_width / 8));
            }).file;
  job.effects = "none";
  job.settings = {{"supersample", "n", "4"}};
  for (const char* technique : {"clustered", "visibility"}) {
    job.technique = technique;
    const Images images = images_of(job);
    float least = 9, most = 0;
    for (int x = 6; x < 18; ++x) {
      const float v = images["beauty"].at<glm::vec4>(x, 4).x;
      least = std::min(least, v), most = std::max(most, v);
    }
    EXPECT_GT(most - least, 2 * 0.7f) << technique;
  }
}

// Through a front wall of one side light comes in as the camera sees in, in all techniques and both renderers; a wall
// of two sides is a wall.
TEST_F(FrameOpen, LightPassesSingleSidedFacesFromBehind) {
  Job job = seen(room(1, false));
  const auto frame = open_reference(job, 0, {});
  ASSERT_TRUE(frame);
  reference::TraceSettings settings;
  settings.sampler = {reference::SamplerKind::uniform, 1};
  reference::Film film(width, height, {});
  film.add(reference::Integrator(*(*frame)->world, settings, width, height), 1, [](double) { return true; });
  std::vector<glm::vec4> truth;
  for (size_t i = 0; i < film.pixels(); ++i) truth.emplace_back(film.mean(i));
  for (const char* technique : {"clustered", "visibility", "ray"}) {
    job.technique = technique;
    job.sides = "open";
    const auto open = images_of(job)["beauty"].values<glm::vec4>();
    EXPECT_LT(relmse(open, truth), 0.03) << technique;
    job.sides = "block";
    EXPECT_GT(relmse(images_of(job)["beauty"].values<glm::vec4>(), truth), 0.1) << technique;
  }
  Job closed = seen(room(1, true));
  closed.sides = "open";
  const auto open = images_of(closed)["beauty"].values<glm::vec4>();
  closed.sides = "block";
  EXPECT_EQ(open, images_of(closed)["beauty"].values<glm::vec4>());
}

// A ten-thousandth and ten thousand times as large the picture is the same.
TEST_F(FrameOpen, AScenesScaleChangesNothing) {
  const auto one = images_of(seen(room(1, false)))["beauty"].values<glm::vec4>();
  for (const double scale : {1e-4, 1e4}) {
    const auto other = images_of(seen(room(scale, false), scale))["beauty"].values<glm::vec4>();
    size_t differing = 0;
    for (size_t i = 0; i < one.size(); ++i)
      for (int c = 0; c < 3; ++c) differing += std::abs(other[i][c] - one[i][c]) > 0.008f * (0.1f + one[i][c]);
    EXPECT_LE(differing, 3 * one.size() / 1000) << scale;
  }
}

// A generated scene under a node of this scale, its lamps as bright in it.
static std::string scaled(const std::filesystem::path& scene, double scale) {
  const auto bytes = read_file(scene);
  EXPECT_TRUE(bytes);
  uint32_t length = 0;
  std::memcpy(&length, bytes->data() + 12, 4);
  const auto* text = reinterpret_cast<const char*>(bytes->data()) + 20;
  Json json = Json::parse(text, text + length);
  Json& roots = json["scenes"][0]["nodes"];
  json["nodes"].push_back({{"scale", {scale, scale, scale}}, {"children", roots}});
  roots = {json["nodes"].size() - 1};
  for (Json& camera : json["cameras"])
    for (const char* length_m : {"znear", "zfar"})
      if (Json& p = camera["perspective"]; p.contains(length_m)) p[length_m] = p[length_m].get<double>() * scale;
  for (Json& light : json["extensions"]["KHR_lights_punctual"]["lights"]) {
    if (light["type"] == "directional") continue;
    light["intensity"] = light.value("intensity", 1.0) * scale * scale;
    if (light.contains("range")) light["range"] = light["range"].get<double>() * scale;
  }
  if (json["extensions"]["KHR_lights_punctual"]["lights"].is_null()) json.erase("extensions");
  if (json["cameras"].is_null()) json.erase("cameras");
  std::string out = json.dump();
  out.resize((out.size() + 3) / 4 * 4, ' ');
  const std::span rest = std::span(*bytes).subspan(20 + length);
  const uint32_t head[] = {0x46546c67, 2, uint32_t(20 + out.size() + rest.size()), uint32_t(out.size()), 0x4e4f534a};
  const std::string path = ::testing::TempDir() + scene.stem().string() + fmt::format("-{:g}.glb", scale);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(head), sizeof head) << out;
  file.write(reinterpret_cast<const char*>(rest.data()), long(rest.size()));
  return path;
}

// Powers of two scale a scene without rounding, and then not one pixel differs, beyond a ten-thousandth and ten
// thousand times. (By 1e4 itself corners are rounded anew: on the edge of a texel or a cut-off 0.2 to 1.8 % of these
// scenes' pixels fall to its other side.)
TEST_F(FrameOpen, APowerOfTwoOfScaleChangesNoPixel) {
  for (const char* name : {"alpha", "light-field", "texture-transform"}) {
    const auto picture = [&](double scale) {
      Job job = job_for(scaled(scene(name), scale), 96, 54);
      job.quality = "normal";
      return images_of(job)["beauty"].values<glm::vec4>();
    };
    const auto one = picture(1);
    for (const double scale : {0x1p-14, 0x1p14}) EXPECT_EQ(picture(scale), one) << name << " " << scale;
  }
}

// A sheet of alpha 0.7 leaves 0.3 of a light, whatever the method of transparency.
TEST_F(FrameOpen, ABlendedSheetCastsItsShadow) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(0.8, 0.8, 0.8)))}});
  Json sheet = diffuse_material(0.5, 0.5, 0.5);
  sheet["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.5, 0.5, 0.7};
  sheet["alphaMode"] = "BLEND";
  add_node(b, {{"mesh", add_square_mesh(b, 0.8f, add_material(b, sheet))}, {"translation", {1.5, 0, 1}}});
  add_light(b, {{"type", "directional"}, {"intensity", 3.0}},
            {{"rotation", rotation_between({0, 0, -1}, {-1.5, 0, -1})}});
  Job job = job_for(write(b), width, height, 1);
  look(job, {-2, 0, 5}, {0, 0, 0}, 20);
  const double half = 3 * std::sqrt(1 / 3.25) * 0.8 / std::numbers::pi;
  for (const char* technique : {"clustered", "visibility", "ray"})
    for (const char* transparency : {"sorted", "layers"}) {
      job.technique = technique, job.transparency = transparency;
      const glm::vec4 middle = images_of(job)["beauty"].at<glm::vec4>(width / 2, height / 2);
      EXPECT_NEAR(middle.x, 0.3 * half, 0.01 * half) << technique << " " << transparency;
    }
}

// Three hundred of alpha 0.01 leave 0.99^300 of it: colour maps of full scale are in floats, for each layer rounds.
TEST_F(FrameOpen, HundredsOfNearlyClearSheetsAddUp) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(0.8, 0.8, 0.8)))}});
  Json sheet = diffuse_material(0.5, 0.5, 0.5);
  sheet["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.5, 0.5, 0.01};
  sheet["alphaMode"] = "BLEND";
  const int mesh = add_square_mesh(b, 0.8f, add_material(b, sheet));
  for (int i = 0; i < 300; ++i) add_node(b, {{"mesh", mesh}, {"translation", {1.5, 0, 1 + i / 30000.0}}});
  add_light(b, {{"type", "directional"}, {"intensity", 3.0}},
            {{"rotation", rotation_between({0, 0, -1}, {-1.5, 0, -1})}});
  Job job = job_for(write(b), width, height, 1);
  look(job, {-2, 0, 5}, {0, 0, 0}, 20);
  job.technique = "clustered", job.transparency = "sorted";
  job.settings.push_back({"colored_shadows", "scale", "full"});
  const double left = 3 * std::sqrt(1 / 3.25) * 0.8 / std::numbers::pi * std::pow(0.99, 300);
  EXPECT_NEAR(images_of(job)["beauty"].at<glm::vec4>(width / 2, height / 2).x, left, 0.01 * left);
}

// One of alpha 1 is a wall, shadow and all: to the bit what the material drawn as opaque is.
TEST_F(FrameOpen, ABlendedSheetOfAlphaOneIsAWall) {
  const auto under = [&](const char* mode, double alpha) {
    GltfBuilder b = empty_scene();
    add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(0.8, 0.8, 0.8)))}});
    Json sheet = diffuse_material(0.5, 0.5, 0.5);
    sheet["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.5, 0.5, alpha};
    sheet["alphaMode"] = mode;
    add_node(b, {{"mesh", add_square_mesh(b, 0.8f, add_material(b, sheet))}, {"translation", {0, 0, 1}}});
    add_light(b, {{"type", "directional"}, {"intensity", 3.0}},
              {{"rotation", rotation_between({0, 0, -1}, {-1.5, 0, -1})}});
    add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {0.5, 1, 2}}});
    Job job = job_for(write(b), width, height, 1);
    look(job, {-2, 0, 5}, {0, 0, 0}, 60);
    std::vector<std::vector<glm::vec4>> pictures;
    for (const char* technique : {"clustered", "visibility", "ray"}) {
      job.technique = technique;
      pictures.push_back(images_of(job)["beauty"].values<glm::vec4>());
    }
    return pictures;
  };
  const auto wall = under("OPAQUE", 1);
  EXPECT_EQ(under("BLEND", 1), wall);
  EXPECT_NE(under("BLEND", 0.9), wall);
}

}  // namespace candela::test
