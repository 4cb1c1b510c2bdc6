// What reflections know of surfaces: of keys in compute the same as of surfaces that the hardware draws again.
#include <glm/gtc/packing.hpp>

#include "relief_fixture.h"
#include "render/dump.h"

namespace candela::test::frame_reflections_keyed {
namespace {

constexpr int width = 72, height = 48;

// A floor, a wall and squares of each kind of material that has a path of its own.
GltfBuilder kinds() {
  GltfBuilder b = reference_relief::hilly(0.2, true, false);
  for (const char* name : {"clearcoat", "sheen", "iridescence", "anisotropy", "specular"})
    b.use(std::string("KHR_materials_") + name);
  const auto put = [&](float half, Json material, glm::dvec3 at, glm::dvec3 faces) {
    const int mesh = add_square_mesh(b, half, add_material(b, std::move(material)));
    add_node(b,
             {{"mesh", mesh}, {"translation", {at.x, at.y, at.z}}, {"rotation", rotation_between({0, 0, 1}, faces)}});
    return mesh;
  };
  const auto of = [](double metallic, double roughness, Json extensions = {}) {
    Json material = {{"pbrMetallicRoughness", base_color(0.8, 0.7, 0.5)}};
    material["pbrMetallicRoughness"]["metallicFactor"] = metallic;
    material["pbrMetallicRoughness"]["roughnessFactor"] = roughness;
    if (!extensions.empty()) material["extensions"] = std::move(extensions);
    return material;
  };
  put(3, of(1, 0.3), {0, -1.2, -1}, {0, 1, 0});
  put(3, unlit_material(0.2, 0.5, 0.9), {0, 1, -2}, {0, 0, 1});
  put(0.4f, of(0.2, 0.4, {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.8}, {"clearcoatRoughnessFactor", 0.3}}}}),
      {-1.6, 0.6, 0.2}, {0.3, 0.2, 1});
  put(0.4f,
      of(0, 0.6, {{"KHR_materials_sheen", {{"sheenColorFactor", {0.6, 0.3, 0.1}}, {"sheenRoughnessFactor", 0.4}}}}),
      {-1.6, -0.4, 0.2}, {0.3, 0.2, 1});
  put(0.4f, of(0.5, 0.3, {{"KHR_materials_iridescence", {{"iridescenceFactor", 1}}}}), {1.6, 0.6, 0.2}, {-0.3, 0.1, 1});
  put(0.4f, of(1, 0.4, {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.7}, {"anisotropyRotation", 0.5}}}}),
      {1.6, -0.4, 0.2}, {-0.3, 0.1, 1});
  Json masked = of(0.4, 0.3);
  masked["alphaMode"] = "MASK", masked["doubleSided"] = true;
  const int fence = put(0.5f, masked, {-0.3, -0.9, 1.1}, {0.2, 0.1, 1});
  b.json["meshes"][size_t(fence)]["primitives"][0]["attributes"]["COLOR_0"] =
      b.accessor<float>("VEC4", {1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 0});
  return b;
}

struct Texels {
  std::vector<float> z;
  std::vector<std::vector<float>> values;  // of each channel, unpacked
};

}  // namespace

class FrameReflectionsKeyed : public FrameTest {
 protected:
  static Texels texels(Job job, bool fog) {
    std::vector<std::string> names = {"reflections.reflections.z", "reflections.reflections.sky",
                                      "reflections.reflections.reflectance", "reflections.reflections.surface"};
    if (fog) names.emplace_back("reflections.reflections.fog");
    WantedOutputs wanted;
    for (const std::string& name : names) wanted.dumps.push_back(*parse_dump(name));
    Texels out;
    const auto session = open(job, wanted);
    if (!session) return out;
    const FrameResult result = render(*session);
    EXPECT_EQ(result.dumps.size(), names.size());
    for (const FrameDump& of : result.dumps) {
      const FloatImage image = dump_image(of, result.readbacks.at(of.resource)->bytes());
      for (size_t i = 0; i < image.channels.size(); ++i) {
        const Channel& c = image.channels[i];
        if (out.z.empty()) {
          out.z = c.f;
        } else if (c.type != ChannelType::uint32) {
          out.values.push_back(c.f);
        } else {
          // f0, f90, fraction and roughness are halves; normals, the last two words of the surface, are 16 bits each.
          const bool normals = image.channels.size() == 4 && (c.name == "B" || c.name == "A");
          std::vector<float> low, high;
          for (const uint32_t u : c.u) {
            const glm::vec2 both = normals ? glm::unpackSnorm2x16(u) : glm::unpackHalf2x16(u);
            low.push_back(both.x), high.push_back(both.y);
          }
          out.values.push_back(std::move(low)), out.values.push_back(std::move(high));
        }
      }
    }
    return out;
  }
};

TEST_F(FrameReflectionsKeyed, SurfacesAreThoseThatTheHardwareDraws) {
  const std::string path = write(kinds());
  GltfBuilder flat = kinds();
  flat.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2.4}, {"ymag", 1.6}, {"znear", 0.1}, {"zfar", 20}}}}};
  add_node(
      flat,
      {{"camera", 0}, {"translation", {0.6, 0.8, 4}}, {"rotation", rotation_between({0, 0, -1}, {-0.15, -0.2, -1})}});
  const std::string orthographic = ::testing::TempDir() + "candela_reflections_keyed_orthographic.glb";
  const auto bytes = flat.glb();
  std::ofstream(orthographic, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), long(bytes.size()));
  const std::string plain = R"("reflections": {}, "occlusion": {"radius_m": 1})";
  const std::string fog = plain + R"(, "fog": {"extinction": 0.05, "anisotropy": 0.3})";
  const std::string media = plain + R"(, "fog": {"extinction": 0.05, "boxes": [
      {"extinction": 0.3, "bounds": {"x": [-2, 0], "y": [-2, 1], "z": [-2, 1]}}]})";
  struct Mode {
    const char* name;
    std::string scene, look;
    std::vector<KnobSetting> settings;
    bool region = false;
  };
  for (const Mode& mode :
       {Mode{"fog", path, fog, {}}, Mode{"media", path, media, {}}, Mode{"orthographic", orthographic, fog, {}},
        Mode{"traced", path, plain, {{"occlusion", "method", "traced"}, {"sun", "mode", "traced"}}},
        Mode{"region", path, fog, {}, true}}) {
    Job job = job_for(mode.scene, width, height);
    if (mode.scene == path) look(job, {0.5, 0.3, 3}, {0, -0.2, -0.5}, 60);
    job.look = look_file("{" + mode.look + "}");
    job.settings = mode.settings;
    job.settings.insert(job.settings.end(), {{"reflections", "method", "screen"}, {"relief", "steps", "256"}});
    if (mode.region) job.region = PixelRect{13, 9, 41, 30};
    const bool has_fog = mode.look != plain;
    job.technique = "clustered";
    const Texels drawn = texels(job, has_fog);
    job.technique = "visibility";
    const Texels keyed = texels(job, has_fog);
    ASSERT_EQ(drawn.values.size(), keyed.values.size()) << mode.name;
    size_t seen = 0, apart = 0;
    double most_z = 0;
    std::vector<double> most(drawn.values.size(), 0);
    for (size_t i = 0; i < drawn.z.size(); ++i) {
      const float z = drawn.z[i], other = keyed.z[i];
      if (z == 0 && other == 0) continue;
      ++seen;
      bool is_apart = std::abs(z - other) > 1e-4f * z;
      most_z = std::max(most_z, double(std::abs(z - other) / z));
      for (size_t c = 0; c < most.size(); ++c) {
        const double off = std::abs(drawn.values[c][i] - keyed.values[c][i]);
        most[c] = std::max(most[c], off);
        is_apart |= off > 4e-3 * (0.25 + std::abs(drawn.values[c][i]));
      }
      apart += is_apart;
    }
    fmt::print("{}: {} of {} apart, depth {:.1e}, channels {:.1e}\n", mode.name, apart, seen, most_z,
               fmt::join(most, " "));
    EXPECT_GT(seen, drawn.z.size() / 2) << mode.name;
    EXPECT_LE(apart, seen / 200) << mode.name;
  }
}

}  // namespace candela::test::frame_reflections_keyed
