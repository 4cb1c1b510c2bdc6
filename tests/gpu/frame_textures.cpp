#include <numbers>

#include "frame_fixture.h"
#include "testscenes/procedural_textures.h"

namespace candela::test::frame_textures {
namespace {

int add_texture(GltfBuilder& b, const std::vector<std::byte>& png, bool nearest) {
  std::vector<uint8_t> bytes(png.size());
  std::memcpy(bytes.data(), png.data(), png.size());
  b.json["images"].push_back({{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}});
  const int filter = nearest ? 9728 : 9729;
  b.json["samplers"].push_back({{"magFilter", filter}, {"minFilter", filter}});
  const size_t index = b.json["images"].size() - 1;
  b.json["textures"].push_back({{"source", index}, {"sampler", index}});
  return int(index);
}

// The square with texture coordinates, (0, 0) at the top left, and tangents along +X.
int add_unit_square(GltfBuilder& b, int material) {
  const int square = add_square_mesh(b, 1, material);
  Json& attributes = b.json["meshes"][size_t(square)]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = b.accessor<float>("VEC2", {0, 1, 1, 1, 1, 0, 0, 0});
  attributes["TANGENT"] = b.accessor<float>("VEC4", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
  return square;
}

double srgb_decode(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

}  // namespace

class FrameTextures : public FrameTest {};

// 4x4 texels of different colours, seen straight on: each has its place, and sRGB is decoded. Drivers decode by table
// or formula; Vulkan allows 0.6 of an 8-bit code value; lavapipe uses 0.15 of it. Coordinates that are moved have no
// number in common with those beside them.
TEST_F(FrameTextures, TexelsLieWhereTheirCoordinatesSay) {
  const auto code = [](double u, double v) {
    return glm::dvec4(std::floor(u * 4) * 60, std::floor(v * 4) * 70, 10 + 20 * std::floor(u * 4), 255) / 255.0;
  };
  for (const auto& [transformed, moved] : {std::pair(false, false), {true, false}, {false, true}}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    b.use("KHR_texture_transform");
    Json material = unlit_material(1, 1, 1);
    material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", add_texture(b, png_from(4, 4, 3, code), true)}};
    if (transformed)
      material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
          {"offset", {0.25, 0.5}}, {"scale", {0.5, 1}}, {"rotation", std::numbers::pi / 2}};
    const int square = add_unit_square(b, add_material(b, material));
    if (moved)
      b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["TEXCOORD_0"] =
          b.accessor<float>("VEC2", {0.25, 1.5, 1.25, 1.5, 1.25, 0.5, 0.25, 0.5});
    add_node(b, {{"mesh", square}});
    b.json["cameras"] = {
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 1.0}, {"ymag", 1.0}, {"znear", 0.5}, {"zfar", 20.0}}}}};
    add_node(b, {{"camera", 0}, {"translation", {0, 0, 2}}});
    const Images images = images_of(job_for(write(b), 32, 32));
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        double u = (x + 0.5) / 32, v = (y + 0.5) / 32;
        if (transformed) {  // scale, then a quarter turn, counter-clockwise with v down, then the offset
          const double su = 0.5 * u, sv = v;
          u = sv + 0.25, v = -su + 0.5;
        }
        if (moved) u += 0.25, v += 0.5;
        const glm::dvec4 wanted = code(u - std::floor(u), v - std::floor(v));
        const glm::vec4 p = images["beauty"].at<glm::vec4>(x, y);
        for (int c = 0; c < 3; ++c) {
          ASSERT_GE(p[c], srgb_decode(wanted[c] - 0.6 / 255)) << x << " " << y;
          ASSERT_LE(p[c], srgb_decode(wanted[c] + 0.6 / 255)) << x << " " << y;
        }
      }
  }
}

// A normal map of one texel under turns and mirrors: the normal is that of mesh space, carried along. 8-bit texels and
// float arithmetic leave 1e-6.
TEST_F(FrameTextures, NormalMapsFollowMirroredTransforms) {
  const glm::dvec3 codes(180, 90, 220);
  const glm::dvec3 mapped = glm::normalize(codes / 255.0 * 2.0 - 1.0);
  struct Case {
    glm::dvec3 scale;
    double turn_rad, side;  // about Z; the camera's side of the plane
  };
  for (const Case& t : {Case{{1, 1, 1}, 0, 1}, Case{{-1, 1, 1}, 0, 1}, Case{{1, -1, 1}, 0, 1}, Case{{-1, -1, 1}, 0, 1},
                        Case{{1, 1, -1}, 0, -1}, Case{{2, 2, 2}, 0.7, 1}, Case{{-2, 2, 2}, 0.7, 1}}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = diffuse_material(0.5, 0.5, 0.5);
    material["normalTexture"] = {
        {"index",
         add_texture(b, png_from(1, 1, 3, [&](double, double) { return glm::dvec4(codes / 255.0, 1); }), true)}};
    add_node(b, {{"mesh", add_unit_square(b, add_material(b, material))},
                 {"scale", {t.scale.x, t.scale.y, t.scale.z}},
                 {"rotation", {0, 0, std::sin(t.turn_rad / 2), std::cos(t.turn_rad / 2)}}});
    Job job = job_for(write(b), 16, 16);
    job.layers = {"normal"};
    look(job, {0, 0, 3 * t.side}, {0, 0, 0}, 20);
    const Images images = images_of(job);
    const glm::dvec3 local = glm::normalize(t.scale) * mapped;
    const double c = std::cos(t.turn_rad), s = std::sin(t.turn_rad);
    const glm::dvec3 wanted = glm::normalize(glm::dvec3(c * local.x - s * local.y, s * local.x + c * local.y, local.z));
    const glm::dvec3 n(images["normal"].at<glm::vec4>(8, 8));
    EXPECT_LT(glm::length(n - wanted), 2e-6)
        << n.x << " " << n.y << " " << n.z << " for " << wanted.x << " " << wanted.y << " " << wanted.z;
  }
}

// A tangent of a slant, and the bitangent of its handedness.
TEST_F(FrameTextures, NormalMapsFollowTheirTangents) {
  const glm::dvec3 codes(180, 90, 220);
  const glm::dvec3 mapped = glm::normalize(codes / 255.0 * 2.0 - 1.0);
  for (const float handedness : {1.0f, -1.0f}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = diffuse_material(0.5, 0.5, 0.5);
    material["normalTexture"] = {
        {"index",
         add_texture(b, png_from(1, 1, 3, [&](double, double) { return glm::dvec4(codes / 255.0, 1); }), true)}};
    const int square = add_unit_square(b, add_material(b, material));
    std::vector<float> tangents;
    for (int i = 0; i < 4; ++i) tangents.insert(tangents.end(), {0.6f, 0.8f, 0, handedness});
    b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["TANGENT"] = b.accessor<float>("VEC4", tangents);
    add_node(b, {{"mesh", square}});
    Job job = job_for(write(b), 16, 16);
    job.layers = {"normal"};
    look(job, {0, 0, 3}, {0, 0, 0}, 20);
    const glm::dvec3 n(images_of(job)["normal"].at<glm::vec4>(8, 8));
    const glm::dvec3 tangent(0.6, 0.8, 0), bitangent = glm::dvec3(-0.8, 0.6, 0) * double(handedness);
    const glm::dvec3 wanted = tangent * mapped.x + bitangent * mapped.y + glm::dvec3(0, 0, mapped.z);
    EXPECT_LT(glm::length(n - wanted), 2e-6)
        << n.x << " " << n.y << " " << n.z << " for " << wanted.x << " " << wanted.y << " " << wanted.z;
  }
}

// Masked sheets across one another before a wall that fills the view: every sample that a mask keeps is shaded, so
// nothing shows through. (Shading asked the mask again, at the centroid of the samples that were left, and dropped some
// of them.)
TEST_F(FrameTextures, NoSampleThatAMaskKeepsIsLost) {
  const auto holes = [](double u, double v) {
    return glm::dvec4(1, 1, 1, std::fmod(std::floor(u * 16) * 7 + std::floor(v * 16) * 5, 3) == 0 ? 0 : 1);
  };
  for (const bool unlit : {false, true}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json sheet = unlit ? unlit_material(1, 1, 1) : diffuse_material(1, 1, 1);
    sheet["alphaMode"] = "MASK";
    sheet["doubleSided"] = true;
    sheet["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", add_texture(b, png_from(16, 16, 4, holes), false)}};
    const int square = add_unit_square(b, add_material(b, sheet));
    for (int i = 0; i < 16; ++i) {
      const double a = 0.37 * i, c = std::cos(a / 2), s = std::sin(a / 2), tilt = 0.3 * std::sin(1.7 * i);
      add_node(b, {{"mesh", square},
                   {"rotation", {tilt * c, tilt * s, s * std::sqrt(1 - tilt * tilt), c * std::sqrt(1 - tilt * tilt)}},
                   {"translation", {0, 0, -0.02 * i}}});
    }
    add_node(b, {{"mesh", add_square_mesh(b, 9, add_material(b, unlit_material(0.5, 0.5, 0.5)))},
                 {"translation", {0, 0, -3}}});
    add_light(b, {{"type", "point"}}, {{"translation", {0, 0, 2}}});
    Job job = job_for(write(b), 96, 96, 4);
    look(job, {0, 0, 3}, {0, 0, 0});
    const Images images = images_of(job);
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x)
        ASSERT_EQ(images["beauty"].at<glm::vec4>(x, y).w, 1.0f) << x << " " << y << " unlit " << unlit;
  }
}

// Triangles whose corners share one place of the texture have no footprint, which an anisotropic filter divides by.
TEST_F(FrameTextures, OnePlaceForAllCornersIsItsTexel) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = unlit_material(1, 1, 1);
  const auto code = [](double u, double) { return glm::dvec4(u < 0.5 ? 0.0 : 1.0, 0.2, 0.4, 1); };
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", add_texture(b, png_from(16, 16, 3, code), false)}};
  b.json["samplers"].back()["minFilter"] = 9987;  // trilinear
  const int square = add_unit_square(b, add_material(b, material));
  b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      b.accessor<float>("VEC2", {0.75, 0.3, 0.75, 0.3, 0.75, 0.3, 0.75, 0.3});
  add_node(b, {{"mesh", square}, {"rotation", {-0.6, 0, 0, 0.8}}});
  Job job = job_for(write(b), 64, 36, 4);
  look(job, {0.3, 0.2, 2}, {0, 0, 0});
  job.settings = {{"textures", "anisotropy", "16"}};
  int seen = 0;
  for (const glm::vec4& p : images_of(job)["beauty"].values<glm::vec4>()) {
    ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
    if (p.w < 1) continue;
    EXPECT_NEAR(p.x, 1, 1e-3);
    ++seen;
  }
  EXPECT_GT(seen, 50);
}

// A floor with stripes that run away from the viewer, seen at a slant: a pixel covers a small part of a stripe's width
// and many texels of its length. Isotropic filtering takes the level of the length, where the stripes are gone. Against
// 64 samples a pixel of the same.
TEST_F(FrameTextures, AnisotropyKeepsStripesOnAFloor) {
  const auto stripes = [](double u, double) {
    return int(std::floor(u * 24)) % 2 == 0 ? glm::dvec4(0.9, 0.8, 0.2, 1) : glm::dvec4(0.1, 0.2, 0.6, 1);
  };
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int texture = add_texture(b, png_from(192, 192, 3, stripes), false);
  b.json["samplers"].back()["minFilter"] = 9987;  // trilinear
  Json material = unlit_material(1, 1, 1);
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", texture}};
  const double half = std::sqrt(0.5);
  add_node(b, {{"mesh", add_unit_square(b, add_material(b, material))}, {"rotation", {-half, 0, 0, half}}});
  constexpr int width = 48, height = 12, side = 8;
  Job job = job_for(write(b), width, height);
  job.background = "0,0,0";
  look(job, {0, 0.25, 1.9}, {0, 0, 0.2}, 12);
  const auto picture = [&](int anisotropy, int by) {
    Job one = job;
    one.settings = {{"textures", "anisotropy", std::to_string(anisotropy)}};
    one.width_px *= by, one.height_px *= by;
    const Images images = images_of(one);
    std::vector<glm::dvec3> mean(size_t(width * height));
    for (int y = 0; y < height * by; ++y)
      for (int x = 0; x < width * by; ++x)
        mean[size_t(y / by * width + x / by)] += glm::dvec3(images["beauty"].at<glm::vec4>(x, y)) / double(by * by);
    return mean;
  };
  const auto exact = picture(16, side);
  double before = std::numeric_limits<double>::infinity();
  for (const int anisotropy : {1, 4, 16}) {
    const auto got = picture(anisotropy, 1);
    double error = 0;
    for (size_t i = 0; i < got.size(); ++i)
      for (int c = 0; c < 3; ++c)
        error += std::pow(got[i][c] - exact[i][c], 2) / (std::pow(exact[i][c], 2) + 0.01) / double(3 * got.size());
    fmt::print("anisotropy {}: relMSE {:.2e}\n", anisotropy, error);
    EXPECT_LT(error, anisotropy == 4 ? 0.7 * before : 0.5 * before) << anisotropy;
    before = error;
  }
}

// Shaders are compiled while textures are decoded: an error of theirs is told all the same, each time.
TEST_F(FrameTextures, AShaderThatDoesNotCompileIsNamed) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "candela_broken_shaders";
  std::filesystem::remove_all(folder);
  std::filesystem::copy(CANDELA_SOURCE_DIR "/shaders", folder, std::filesystem::copy_options::recursive);
  std::ofstream(folder / "shade_forward.frag", std::ios::app) << "\nbroken\n";
  RunSettings settings;
  settings.validate = true;
  settings.shader_folder = folder;
  const auto session = Session::open(job_for(scene("normal-mapped"), 16, 16), {}, settings);
  ASSERT_TRUE(session) << session.error().text();
  for (int frame = 0; frame < 2; ++frame) {
    const auto result = (*session)->render(0);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::input);
    EXPECT_NE(result.error().text().find("shade_forward.frag"), std::string::npos) << result.error().text();
  }
}

}  // namespace candela::test::frame_textures
