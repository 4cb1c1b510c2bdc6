#include <cmath>
#include <glm/glm.hpp>
#include <numeric>

#include "frame_fixture.h"

namespace candela::test {
namespace {

// The technique `visibility` (passes/geometry/rasterize.h, passes/surfaces/shade_visible.h) against `clustered`.
class Visibility : public FrameTest {
 protected:
  // lavapipe 25.0.7 filters by one side of a footprint alone where a shader gives its slopes.
  static Job drawn(const std::string& file, int samples = 1) {
    Job job = job_for(file, 64, 36, samples);
    job.settings = {{"textures", "anisotropy", "1"}};
    job.effects = "none";
    return job;
  }
  static Job of_scene(const std::string& name, int samples = 1) { return drawn(scene(name), samples); }
  static Image picture(Job job, const std::string& technique, const std::string& layer = "beauty") {
    job.technique = technique;
    if (layer != "beauty") job.layers = {layer};
    return images_of(job)[layer];
  }
  static Image with(Job job, const std::string& pass, const std::string& knob, const std::string& value) {
    job.settings.push_back({pass, knob, value});
    return picture(job, "visibility");
  }
  // Mean relative squared error but for the worst pixels, a hundredth: a lamp of less than a pixel is one sample more
  // or less.
  static double error(const Image& a, const Image& truth) {
    std::vector<double> pixels;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        pixels.push_back(0);
        for (int c = 0; c < 3; ++c) {
          const double p = a.at<glm::vec4>(x, y)[c], q = truth.at<glm::vec4>(x, y)[c];
          pixels.back() += (p - q) * (p - q) / (q * q + 0.01) / 3;
        }
      }
    std::sort(pixels.begin(), pixels.end());
    pixels.resize(pixels.size() * 99 / 100);
    return std::accumulate(pixels.begin(), pixels.end(), 0.0) / double(pixels.size());
  }
  // Pixels that differ by more than a fraction of their value.
  static int differing(const Image& a, const Image& b, double fraction) {
    int count = 0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        const glm::dvec4 p(a.at<glm::vec4>(x, y)), q(b.at<glm::vec4>(x, y));
        for (int c = 0; c < 4; ++c)
          if (!(std::abs(p[c] - q[c]) <= fraction * (std::abs(q[c]) + 0.01))) {
            ++count;
            break;
          }
      }
    return count;
  }
};

// Without textures the two differ in the last bits, and in a few pixels where snapped corners or depths do.
TEST_F(Visibility, IsTheHardwaresPicture) {
  for (const char* name : {"spheres", "lights-stacked", "emissive-strength", "primitive-modes"})
    EXPECT_LE(differing(picture(of_scene(name), "clustered"), picture(of_scene(name), "visibility"), 1e-3), 4) << name;
}

// Slopes of texture coordinates are the triangle's own, not differences to the neighbours of a quad, and several
// samples shade their common middle: no farther from many samples than what the hardware does.
TEST_F(Visibility, IsAsNearToManySamples) {
  for (const char* name : {"street", "texture-transform", "normal-mapped", "alpha"}) {
    Job many = of_scene(name);
    many.settings.push_back({"supersample", "n", "8"});
    const Image truth = picture(many, "clustered");
    for (const int samples : {1, 4}) {
      const Job job = of_scene(name, samples);
      const double a = error(picture(job, "clustered"), truth), b = error(picture(job, "visibility"), truth);
      EXPECT_LE(b, 1.05 * a) << name << ", samples " << samples;
    }
  }
}

TEST_F(Visibility, DrawsLinesPointsAndGlassOverIt) {
  EXPECT_LE(differing(picture(of_scene("primitive-modes", 4), "clustered"),
                      picture(of_scene("primitive-modes", 4), "visibility"), 0.1),
            50);
  Job glass = of_scene("glass");
  glass.effects = "refraction";
  EXPECT_EQ(differing(picture(glass, "clustered"), picture(glass, "visibility"), 0.1), 0);
}

TEST_F(Visibility, TakesAnyWayToTheSameBytes) {
  for (const auto& [name, samples] : {std::pair("street", 4), std::pair("alpha", 1), std::pair("animated", 1)}) {
    Job job = of_scene(name, samples);
    if (samples == 4) job.width_px = 101, job.height_px = 67;
    const Image plain = picture(job, "visibility");
    EXPECT_EQ(plain, picture(job, "visibility")) << name;
    EXPECT_EQ(plain, with(job, "rasterize", "small_px", "1")) << name;
    EXPECT_EQ(plain, with(job, "rasterize", "small_px", "64")) << name;
    EXPECT_EQ(plain, with(job, "rasterize", "list", "1")) << name;
    EXPECT_EQ(plain, with(job, "cull", "enabled", "0")) << name;
    EXPECT_EQ(plain, with(job, "lights", "few", "1048576")) << name;
    EXPECT_EQ(plain, with(job, "lights", "list", "compact")) << name;
  }
}

// Depths are put into the tiles of blended surfaces alone: glass without refraction, behind and before bodies.
TEST_F(Visibility, DrawsBlendedSurfacesOverPartsOfADepth) {
  Job job = of_scene("glass", 4);
  job.width_px = 101, job.height_px = 67;
  for (const std::string method : {"sorted", "weighted", "moments", "layers", "near"}) {
    if (method == "near") look(job, {0.1, 1.0, 0.9}, {0.0, 0.9, -1.0});
    job.transparency = method == "near" ? "sorted" : method;
    EXPECT_EQ(picture(job, "visibility"), with(job, "key_depth", "tiles", "0")) << method;
  }
}

TEST_F(Visibility, StoresSamplesOfAnyTechniqueEitherWay) {
  for (const auto& [name, technique] :
       {std::pair("animated", "visibility"), std::pair("street", "deferred-clustered")}) {
    Job job = of_scene(name, 4);
    const Image stored = picture(job, technique);
    job.settings.push_back({"sample_store", "in", "buffer"});
    EXPECT_EQ(stored, picture(job, technique)) << name;
  }
}

// A plane under the eye: corners behind it, and far outside of what fixed point holds.
TEST_F(Visibility, ClipsWhatPassesTheEye) {
  Job job = of_scene("spheres");
  for (const double height : {1.0, 0.01, 1e-4}) {
    look(job, {0.3, height, 0.2}, {1, height * 0.5, -0.4});
    const Image a = picture(job, "clustered"), b = picture(job, "visibility");
    int covered = 0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) covered += a.at<glm::vec4>(x, y).w != b.at<glm::vec4>(x, y).w;
    EXPECT_LE(covered, 2) << height;
  }
}

// Rays of the camera name the triangles that are rasterized, but on edges.
TEST_F(Visibility, RaysMeetWhatIsRasterized) {
  for (const auto& [name, samples] : {std::pair("street", 4), std::pair("skinned", 1), std::pair("instanced", 1),
                                      std::pair("primitive-modes", 1), std::pair("far-world", 1)}) {
    const Job job = of_scene(name, samples);
    const Image a = picture(job, "visibility"), b = picture(job, "ray");
    EXPECT_EQ(b, picture(job, "ray")) << name;
    EXPECT_LE(differing(a, b, 1e-3), 6) << name;
  }
}

// Techniques that trace begin with traced shadows and occlusion, and settings still count.
TEST_F(Visibility, HybridTracesShadows) {
  Job job = of_scene("spheres"), traced = job;
  job.effects = traced.effects = "shadows";
  traced.settings.push_back({"sun", "mode", "traced"});
  traced.settings.push_back({"local", "method", "traced"});
  const Image a = picture(job, "hybrid"), b = picture(traced, "visibility");
  EXPECT_EQ(a, b);
  EXPECT_NE(b, picture(job, "visibility"));
  job.settings.push_back({"sun", "mode", "off"});
  EXPECT_NE(picture(job, "hybrid"), a);
}

TEST_F(Visibility, RasterizesShadowMaps) {
  for (const auto& [name, layer] : {std::pair("spheres", "shadow_sun"), std::pair("spheres", "shadow_local"),
                                    std::pair("alpha", "shadow_sun"), std::pair("alpha", "shadow_local"),
                                    std::pair("street", "shadow_local")}) {  // of as many views as share workgroups
    Job job = of_scene(name);
    job.effects = "shadows";
    const Image a = picture(job, "clustered", layer), b = picture(job, "visibility", layer);
    ASSERT_FALSE(a.bytes.empty()) << name << " " << layer;
    int off = 0;
    for (size_t i = 0; i < a.bytes.size() / 4; ++i) {
      float p, q;
      std::memcpy(&p, a.bytes.data() + 4 * i, 4), std::memcpy(&q, b.bytes.data() + 4 * i, 4);
      off += std::abs(p - q) > 1e-3;
    }
    EXPECT_LE(off, 4) << name << " " << layer;
  }
}

}  // namespace
}  // namespace candela::test
