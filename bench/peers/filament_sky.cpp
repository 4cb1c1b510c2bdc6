#include "filament_sky.h"

#include <filament/IndirectLight.h>
#include <filament/Skybox.h>
#include <filament/Texture.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "image/io.h"
#include "scene/environment.h"
#include "sky/sky_pyramid.h"

namespace candela::peers {
namespace {

using filament::Texture;
using filament::math::float3;

constexpr int side = 256;

// Bilinear, around the image's seam.
glm::vec3 radiance(const SkyLevel& sky, glm::dvec3 d) {
  const double pi = std::numbers::pi;
  const double u = std::atan2(d.z, d.x) / (2 * pi) + 0.5, v = std::acos(std::clamp(d.y, -1.0, 1.0)) / pi;
  const double x = u * sky.width - 0.5, y = std::clamp(v * sky.height - 0.5, 0.0, sky.height - 1.0);
  const int x0 = int(std::floor(x)), y0 = std::min(int(y), sky.height - 2);
  const float fx = float(x - x0), fy = float(y - y0);
  const auto texel = [&](int column, int row) {
    const SkyTexel& t = sky.at((column + sky.width) % sky.width, row);
    return glm::vec3(t[0], t[1], t[2]);
  };
  return glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), fx),
                  glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), fx), fy);
}

// The six faces as cubes are looked up by direction: +X, -X, +Y, -Y, +Z, -Z.
std::vector<float3> cube_of(const SkyLevel& sky) {
  std::vector<float3> texels;
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double s = 2 * (x + 0.5) / side - 1, t = 2 * (y + 0.5) / side - 1;
        const std::array<glm::dvec3, 6> of{glm::dvec3(1, -t, -s), {-1, -t, s}, {s, 1, t},
                                           {s, -1, -t},           {s, -t, 1},  {-s, -t, -1}};
        const glm::vec3 c = radiance(sky, glm::normalize(of[size_t(face)]));
        texels.push_back({c.x, c.y, c.z});
      }
  return texels;
}

Texture* make_cube(filament::Engine& engine, const std::vector<float3>& texels, bool prefiltered) {
  auto* const copy = new std::vector<float3>(texels);
  Texture::PixelBufferDescriptor pixels(
      copy->data(), copy->size() * sizeof(float3), Texture::Format::RGB, Texture::Type::FLOAT,
      [](void*, size_t, void* user) { delete static_cast<std::vector<float3>*>(user); }, copy);
  Texture* const cube = Texture::Builder()
                            .width(side)
                            .height(side)
                            .levels(prefiltered ? 0xff : 1)
                            .format(Texture::InternalFormat::RGB32F)
                            .sampler(Texture::Sampler::SAMPLER_CUBEMAP)
                            .build(engine);
  const Texture::FaceOffsets faces(size_t(side) * side * sizeof(float3));
  Texture::PrefilterOptions options;
  options.sampleCount = 64;
  options.mirror = false;
  if (prefiltered)
    cube->generatePrefilterMipmap(engine, std::move(pixels), faces, &options);
  else
    cube->setImage(engine, 0, std::move(pixels), faces);
  return cube;
}

}  // namespace

Expected<void> add_sky(filament::Engine& engine, filament::Scene& scene, const std::string& file) {
  const auto image = read_environment(file);
  if (!image) return std::unexpected(image.error());
  const std::vector<float3> texels = cube_of(sky_level(*image));
  const AmbientSh sh = project_environment(*image);
  // Filament's polynomials have no factors of their own.
  constexpr float basis[] = {0.282095f, 0.488603f, 0.488603f, 0.488603f, 1.092548f,
                             1.092548f, 0.315392f, 1.092548f, 0.546274f};
  std::array<float3, 9> bands;
  for (size_t i = 0; i < 9; ++i) bands[i] = float3{sh[i].x, sh[i].y, sh[i].z} * basis[i];
  scene.setSkybox(filament::Skybox::Builder()
                      .environment(make_cube(engine, texels, false))
                      .showSun(false)
                      .intensity(1)
                      .build(engine));
  scene.setIndirectLight(filament::IndirectLight::Builder()
                             .reflections(make_cube(engine, texels, true))
                             .irradiance(3, bands.data())
                             .intensity(1)
                             .build(engine));
  return {};
}

}  // namespace candela::peers
