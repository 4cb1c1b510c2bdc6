// The layers beside beauty, from the GPU and from the reference: one sample at the centre of each pixel, of the same surface.
#include "reference_parity.h"
#include "render/outputs.h"
#include "render/reference_layers.h"

namespace candela::test {
namespace {

struct LayerPair {
  FloatImage gpu, reference;
  const std::vector<float>& of(const FloatImage& image, const std::string& channel) const { return image.find(channel)->f; }
};

// Where a sample of the other renderer may have met a neighbour: rasterizers move corners to a grid of 1/256 pixel. The reference, in
// the 3x3 pixels about this one, shows the GPU's surface.
bool is_at_edge(const LayerPair& p, int x, int y) {
  const int w = p.gpu.width, h = p.gpu.height;
  const size_t here = size_t(y) * size_t(w) + size_t(x);
  const auto &object = p.reference.find("object_id")->u, &material = p.reference.find("material_id")->u;
  const uint32_t seen_object = p.gpu.find("object_id")->u[here], seen_material = p.gpu.find("material_id")->u[here];
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, w - 1); ++i) {
      const size_t at = size_t(j) * size_t(w) + size_t(i);
      if (at != here && object[at] == seen_object && material[at] == seen_material) return true;
    }
  return false;
}

// A plane, curves, masks and creases bend the depth within a pixel: by how much relative to it, from the neighbours.
double depth_change(const std::vector<float>& depth, int x, int y, int w, int h) {
  const double z = depth[size_t(y) * size_t(w) + size_t(x)];
  double most = 0;
  for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}})
    if (x + dx >= 0 && x + dx < w && y + dy >= 0 && y + dy < h)
      most = std::max(most, std::abs(depth[size_t(y + dy) * size_t(w) + size_t(x + dx)] - z) / z);
  return most;
}

}  // namespace

class ReferenceLayers : public ReferenceParity {
 protected:
  static LayerPair layers_of(Job job, double time_s) {
    job.exr_float = true;
    job.layers = surface_layer_names();
    LayerPair out;
    const auto session = open(job);
    EXPECT_TRUE(session);
    if (!session) return out;
    const FrameResult frame = render(*session, time_s);
    NonFinite nonfinite;
    out.gpu = linear_image(frame, job, *session, std::nullopt, {}, nonfinite);
    const auto reference = open_reference(job, time_s, {});
    EXPECT_TRUE(reference);
    if (reference) out.reference = reference_image(reference::Film(job.width_px, job.height_px), **reference, job, "{}", job.layers, std::nullopt, {});
    return out;
  }
};

TEST_F(ReferenceLayers, AgreeOnGeneratedScenes) {
  for (const std::string& name : scene_names()) {
    if (name == "primitive-modes") continue;  // lines and points, which rays do not meet
    SCOPED_TRACE(name);
    const LayerPair p = layers_of(job_for(one_lamp(scene(name), Light::kept), width * 2, height * 2), 17.0 / 24);
    const size_t count = size_t(p.gpu.width) * size_t(p.gpu.height);
    const auto &z = p.of(p.reference, "depth.Z"), &gpu_z = p.of(p.gpu, "depth.Z");
    const auto &object = p.reference.find("object_id")->u, &gpu_object = p.gpu.find("object_id")->u;
    const auto &material = p.reference.find("material_id")->u, &gpu_material = p.gpu.find("material_id")->u;
    size_t edges = 0, surfaces = 0;
    double worst_depth = 0, worst_normal = 0, worst_albedo = 0, worst_emission = 0, worst_share = 0;
    for (size_t i = 0; i < count; ++i) {
      const int x = int(i % size_t(p.gpu.width)), y = int(i / size_t(p.gpu.width));
      if (object[i] != gpu_object[i] || material[i] != gpu_material[i]) {
        ++edges;
        EXPECT_TRUE(is_at_edge(p, x, y)) << x << "," << y << ": object " << gpu_object[i] << " and " << object[i];
        continue;
      }
      if (z[i] == 1e10f || gpu_z[i] == 1e10f) {
        EXPECT_EQ(z[i], gpu_z[i]) << x << "," << y;
        continue;
      }
      ++surfaces;
      const double change = depth_change(z, x, y, p.gpu.width, p.gpu.height), error = std::abs(gpu_z[i] / z[i] - 1);
      worst_depth = std::max(worst_depth, error);
      worst_share = std::max(worst_share, (error - 1e-6) / std::max(change, 1e-9));
      for (const char* part : {"X", "Y", "Z"})
        worst_normal = std::max(worst_normal, double(std::abs(p.of(p.gpu, std::string("normal.") + part)[i] - p.of(p.reference, std::string("normal.") + part)[i])));
      for (const char* part : {"R", "G", "B"}) {
        worst_albedo = std::max(worst_albedo, double(std::abs(p.of(p.gpu, std::string("albedo.") + part)[i] - p.of(p.reference, std::string("albedo.") + part)[i])));
        worst_emission = std::max(worst_emission, double(std::abs(p.of(p.gpu, std::string("emission.") + part)[i] - p.of(p.reference, std::string("emission.") + part)[i])));
      }
    }
    fmt::print("{}: {} surfaces, {} edges, depth {:.2e} ({:.2e} of its change), normal {:.2e}, albedo {:.2e}, emission {:.2e}\n", name, surfaces, edges,
               worst_depth, worst_share, worst_normal, worst_albedo, worst_emission);
  }
}

}  // namespace candela::test
