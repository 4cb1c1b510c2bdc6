#pragma once
#include <numbers>

#include "frame_fixture.h"
#include "image/exr.h"
#include "reference/albedo.h"
#include "reference/brdf.h"
#include "scene/environment.h"

namespace candela::test {

inline constexpr int sky_width = 256, sky_height = 128;

struct Texels {
  std::string file;
  std::vector<std::pair<glm::dvec3, glm::dvec3>> light;  // direction, radiance times solid angle
};

// Squares under skies whose light is summed over their texels by the reference's BRDF.
class SkyTest : public FrameTest {
 protected:
  static Texels write_sky(const std::string& name, const std::function<glm::dvec3(glm::dvec3)>& f) {
    Texels out;
    FloatImage image;
    image.width = sky_width, image.height = sky_height;
    for (const char* channel : {"R", "G", "B"}) image.channels.push_back({channel, ChannelType::float32, {}, {}});
    for (int y = 0; y < sky_height; ++y) {
      const double solid_angle =
          2 * std::numbers::pi / sky_width *
          (std::cos(std::numbers::pi * y / sky_height) - std::cos(std::numbers::pi * (y + 1) / sky_height));
      for (int x = 0; x < sky_width; ++x) {
        const glm::dvec3 d = equirect_direction((x + 0.5) / sky_width, (y + 0.5) / sky_height), c = f(d);
        for (int k = 0; k < 3; ++k) image.channels[size_t(k)].f.push_back(float(c[k]));
        out.light.emplace_back(d, c * solid_angle);
      }
    }
    const auto bytes = encode_exr(image, ExrCompression::zip, name);
    EXPECT_TRUE(bytes);
    out.file = ::testing::TempDir() + "candela_image_light_" + name + ".exr";
    std::ofstream(out.file, std::ios::binary).write(bytes->data(), long(bytes->size()));
    return out;
  }
  // A bright sun of two degrees in a blue half of a sky over dark ground.
  static Texels sunny() {
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.5, 0.7, 0.6));
    return write_sky("sunny", [=](glm::dvec3 d) {
      const glm::dvec3 sky = d.y > 0 ? glm::dvec3(0.3, 0.5, 1) * (1 - 0.5 * d.y) : glm::dvec3(0.12, 0.1, 0.08);
      return glm::dot(d, sun) > std::cos(0.035) ? glm::dvec3(900, 800, 600) : sky;
    });
  }

  // Squares of materials, each turned another way, seen from +Z without perspective.
  static constexpr int columns = 6, rows = 4, cell = 5;
  static constexpr std::array<double, columns> roughness = {0.25, 0.4, 0.55, 0.7, 0.85, 1.0};
  static glm::dquat turned(int row) {
    const double tilts[rows][2] = {{0, 0}, {-0.7, 0.3}, {0.4, 0.8}, {-0.2, -1.1}};
    return glm::dquat(glm::dvec3(tilts[row][0], tilts[row][1], 0));
  }
  static Job squares(const std::string& sky, const std::function<Json(int column)>& material) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    for (int x = 0; x < columns; ++x) {
      const int mesh = add_square_mesh(b, 0.45f, add_material(b, material(x)));
      b.json["meshes"].back()["primitives"][0]["attributes"]["TANGENT"] =
          b.accessor<float>("VEC4", {0.8f, 0.6f, 0, 1, 0.8f, 0.6f, 0, 1, 0.8f, 0.6f, 0, 1, 0.8f, 0.6f, 0, 1});
      for (int y = 0; y < rows; ++y) {
        const glm::dquat q = turned(y);
        add_node(b, {{"mesh", mesh},
                     {"translation", {x - (columns - 1) / 2.0, (rows - 1) / 2.0 - y, 0}},
                     {"rotation", {q.x, q.y, q.z, q.w}}});
      }
    }
    b.json["cameras"] = {
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", columns / 2.0}, {"ymag", rows / 2.0}, {"znear", 1}, {"zfar", 9}}}}};
    add_node(b, {{"camera", 0}, {"translation", {0, 0, 5}}});
    Job job = job_for(write(b), columns * cell, rows * cell);
    job.sky = sky;
    job.effects = "ibl";  // no occlusion: the squares would hide some of the sky from each other
    return job;
  }
  // Seen along -Z: of light from everywhere.
  static glm::dvec3 sum_over(const Texels& sky, const reference::Surface& s) {
    glm::dvec3 sum(0);
    for (const auto& [d, light] : sky.light) sum += light * reference::evaluate_brdf(s, d, {0, 0, 1});
    return sum;
  }

  // Of the middles of the squares: the mean of the squared error over that of the truth's square and 0.01.
  static double relmse_of(const Images& images, const std::function<glm::dvec3(int column, int row)>& truth) {
    double sum = 0;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const glm::dvec3 exact = truth(x, y);
        const glm::vec4 p = images["beauty"].at<glm::vec4>(x * cell + cell / 2, y * cell + cell / 2);
        for (int k = 0; k < 3; ++k) {
          EXPECT_GE(p[k], 0.0f);
          EXPECT_TRUE(std::isfinite(p[k]));
          sum += std::pow(double(p[k]) - exact[k], 2) / (exact[k] * exact[k] + 0.01);
        }
      }
    return sum / (3.0 * rows * columns);
  }
};

}  // namespace candela::test
