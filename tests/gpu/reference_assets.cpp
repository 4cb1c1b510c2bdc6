// Agreement on real scenes: one shadowless lamp, no ambient term, 16 samples a pixel at the same places in both,
// textures from level 0. The goal of relMSE below 1e-5; every figure is printed and kept in the test's XML.
#include "reference_parity.h"

namespace candela::test {
namespace {

struct RealScene {
  const char *name, *file;
  double bound = 1e-5;
  LampScene::Textures textures = LampScene::Textures::level_0;
};
// What has no lit surface or only lines would agree without saying anything.
constexpr RealScene real_scenes[] = {
    {"FlightHelmet", "khronos/FlightHelmet/FlightHelmet.gltf"},
    {"CesiumMilkTruck", "khronos/CesiumMilkTruck/CesiumMilkTruck.gltf"},
    {"CesiumMan", "khronos/CesiumMan/glTF-Binary"},
    {"Fox", "khronos/Fox"},
    // Near mirrors under 8-bit normal maps: llvmpipe rounds filtered values to 8 bits again, which moves highlights.
    // With one texel's value (below), or GALLIVM_PERF=no_aos_sampling, they agree, so that is the term.
    {"NormalTangentTest", "khronos/NormalTangentTest", 1e-3},
    {"NormalTangentMirrorTest", "khronos/NormalTangentMirrorTest", 1e-3},
    {"AlphaBlendModeTest", "khronos/AlphaBlendModeTest"},
    {"OrientationTest", "khronos/OrientationTest"},
    {"PBR_Spheres", "materials/PBR_Spheres"},
    {"Sponza", "scenes/Sponza"},
    {"CornellBox", "scenes/CornellBox"},
    {"low-poly-jungle", "scenes/low-poly-jungle"},
    {"NormalTangentTest_nearest", "khronos/NormalTangentTest", 1e-5, LampScene::Textures::nearest_texel},
    {"NormalTangentMirrorTest_nearest", "khronos/NormalTangentMirrorTest", 1e-5, LampScene::Textures::nearest_texel},
    // With mip maps: what they leave wrong at 16 samples a pixel, kept as figures.
    {"Sponza_mipmapped", "scenes/Sponza", 1e-2, LampScene::Textures::as_they_are},
    {"FlightHelmet_mipmapped", "khronos/FlightHelmet/FlightHelmet.gltf", 1e-2, LampScene::Textures::as_they_are},
    {"Fox_mipmapped", "khronos/Fox", 1e-2, LampScene::Textures::as_they_are},
    {"low-poly-jungle_mipmapped", "scenes/low-poly-jungle", 1e-2, LampScene::Textures::as_they_are},
};

std::filesystem::path file_of(const RealScene& scene) {
  const std::filesystem::path path = std::filesystem::path(CANDELA_SOURCE_DIR "/../shared/assets") / scene.file;
  std::error_code failed;
  if (!std::filesystem::is_directory(path, failed)) return path;
  for (const auto& entry : std::filesystem::directory_iterator(path))
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") return entry.path();
  return path;
}

}  // namespace

class ReferenceAssets : public ReferenceParity, public ::testing::WithParamInterface<RealScene> {};

TEST_P(ReferenceAssets, AgreeUnderOneLamp) {
  const std::filesystem::path file = file_of(GetParam());
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the folder shared/assets is absent";
  const Pair pair = rendered(job_for(one_lamp(file, Light::one_lamp, GetParam().textures), 160, 120), 4);
  size_t lit = 0;
  for (const glm::dvec4& p : pair.reference) lit += p.x > 0.01;
  EXPECT_GT(lit, 1000u);
  const size_t worst = pair.worst();
  const std::string line = fmt::format(
      "{}: relMSE {:.2e}, worst pixel {},{} has {:.2e} of it: {:.4f} {:.4f} {:.4f} for {:.4f} {:.4f} {:.4f}",
      GetParam().name, pair.relmse(), worst % 160, worst / 160, pair.squared(worst) / double(pair.gpu.size()),
      pair.gpu[worst].x, pair.gpu[worst].y, pair.gpu[worst].z, pair.reference[worst].x, pair.reference[worst].y,
      pair.reference[worst].z);
  RecordProperty("relmse", line);
  fmt::print("{}\n", line);
  EXPECT_LT(pair.relmse(), GetParam().bound);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ReferenceAssets, ::testing::ValuesIn(real_scenes), [](const auto& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace candela::test
