// Polygons of metaballs against the surface itself, which the reference meets: error over the size of cells.
#include "passes/geometry/metaballs.h"
#include "reference_parity.h"
#include "render/outputs.h"
#include "render/reference_layers.h"

namespace candela::test {

class ReferenceMetaballs : public ReferenceParity {
 protected:
  static constexpr double time_s = 17.0 / 24;
  static Job job_of(const std::string& cell) {
    Job job = job_for(one_lamp(scene("metaballs"), Light::kept), 2 * width, 2 * height);
    job.settings.push_back({"metaballs", "cell", cell});
    job.exr_float = true;
    return job;
  }
  struct Layers {
    FloatImage gpu, reference;
  };
  static Layers layers_of(Job job) {
    job.layers = {"depth", "normal", "object_id", "material_id", "motion"};
    Layers out;
    const auto session = open(job);
    const auto reference = open_reference(job, time_s, {});
    EXPECT_TRUE(session && reference);
    if (!session || !reference) return out;
    EXPECT_TRUE(add_time_before(**reference, job, job.layers));
    NonFinite nonfinite;
    out.gpu = linear_image(render(*session, time_s), job, *session, std::nullopt, {}, nonfinite);
    out.reference = reference_image(reference::Film(job.width_px, job.height_px), **reference, job, "{}", job.layers,
                                    std::nullopt, {});
    return out;
  }
  // Root mean square over what both show of the body, not at its outline; 1: over how much depth it stretches.
  static double rms(const Layers& p, const std::vector<std::string>& channels, size_t& pixels) {
    const std::vector<uint32_t>&id = p.gpu.find("object_id.X")->u, &idr = p.reference.find("object_id.X")->u;
    const std::vector<float>& z = p.reference.find("depth.Z")->f;
    const int w = p.reference.width, h = p.reference.height;
    double sum = 0;
    pixels = 0;
    const uint32_t body = idr[size_t(h / 2) * size_t(w) + size_t(w / 2)];
    for (int y = 1; y + 1 < h; ++y)
      for (int x = 1; x + 1 < w; ++x) {
        const size_t i = size_t(y) * size_t(w) + size_t(x);
        bool inside = true;
        for (const size_t k : {i, i - 1, i + 1, i - size_t(w), i + size_t(w)})
          inside &= id[k] == body && idr[k] == body && std::abs(z[k] - z[i]) < 0.1f;
        if (!inside) continue;
        ++pixels;
        for (const std::string& c : channels)
          sum += std::pow(double(p.gpu.find(c)->f[i]) - double(p.reference.find(c)->f[i]), 2);
      }
    return std::sqrt(sum / double(pixels));
  }
};

TEST_F(ReferenceMetaballs, ErrorsFallWithTheSquareOfTheCell) {
  struct Errors {
    double depth_m, normal, relmse;
  };
  std::vector<Errors> all;
  for (const char* cell : {"4", "2", "1", "0.5"}) {
    const Layers layers = layers_of(job_of(cell));
    size_t pixels = 0;
    Errors e{};
    e.depth_m = rms(layers, {"depth.Z"}, pixels);
    e.normal = rms(layers, {"normal.X", "normal.Y", "normal.Z"}, pixels);
    EXPECT_GT(pixels, 500u) << cell;
    e.relmse = rendered(job_of(cell), 2, time_s).relmse();
    fmt::print("cell {}: depth {:.3e} m, normal {:.3e}, relMSE {:.3e}\n", cell, e.depth_m, e.normal, e.relmse);
    if (!all.empty()) {
      EXPECT_NEAR(std::log2(all.back().depth_m / e.depth_m), 2, 0.5) << cell;
      EXPECT_LT(e.normal, 0.45 * all.back().normal) << cell;
      EXPECT_LT(e.relmse, 0.6 * all.back().relmse) << cell;
    }
    all.push_back(e);
  }
  EXPECT_LT(all.back().depth_m, 2.5e-4);
  EXPECT_LT(all.back().relmse, 1e-3);
}

// The motion of the surface: the reference's is of the field in double. What differs is where the points lie.
TEST_F(ReferenceMetaballs, AgreeOnMotion) {
  const Layers layers = layers_of(job_of("0.5"));
  size_t pixels = 0;
  const double off_px = rms(layers, {"motion.X", "motion.Y"}, pixels);
  double largest = 0;
  for (const float v : layers.reference.find("motion.X")->f) largest = std::max(largest, std::abs(double(v)));
  EXPECT_GT(largest, 1);
  EXPECT_LT(off_px, 0.01 * largest);
}

}  // namespace candela::test
