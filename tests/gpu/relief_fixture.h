#pragma once
#include "reference/centre_surface.h"
#include "reference_parity.h"
#include "textured_square.h"

// Squares of hills as tests of reliefs have them, and how far frames are from the reference there.
namespace candela::test::reference_relief {

inline constexpr int width = 64, height = 48;
inline constexpr float deep = 0.3f;

inline std::vector<std::byte> hills(int across) {
  return png_from(32, 32, 3,
                  [=](double u, double v) { return glm::dvec4(glm::dvec3(tiling_noise(u, v, across, 3)), 1); });
}
inline std::vector<std::byte> plain(int code) {
  return png_from(4, 4, 3, [=](double, double) { return glm::dvec4(glm::dvec3(code / 255.0), 1); });
}
// A square of hills, aslant to the camera, with a cube that cuts through it.
inline GltfBuilder square_of(const std::vector<std::byte>& heights, double depth, bool silhouettes, bool with_cube) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  b.use("CANDELA_relief");
  Json material = {{"pbrMetallicRoughness", base_color(0.8, 0.5, 0.3)}};
  const int texture = add_texture(b, heights);
  if (depth >= 0)
    material["extensions"]["CANDELA_relief"] = {
        {"heightTexture", {{"index", texture}}}, {"depth", depth}, {"silhouettes", silhouettes}};
  add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
  if (with_cube) {
    const int small = add_square_mesh(b, 0.4f, add_material(b, {{"pbrMetallicRoughness", base_color(0.2, 0.3, 0.8)}}));
    add_node(b, {{"mesh", small}, {"translation", {0.3, 0.2, -0.15}}});
  }
  add_light(b, {{"type", "point"}, {"intensity", 10.0}}, {{"translation", {-0.8, 0.9, 1.2}}});
  add_light(b, {{"type", "directional"}, {"intensity", 1.0}}, {{"rotation", {-0.35, 0.2, 0.08, 0.91}}});
  return b;
}
inline GltfBuilder hilly(double depth, bool silhouettes = true, bool with_cube = true, int across = 5) {
  return square_of(hills(across), depth, silhouettes, with_cube);
}
inline Job seen_aslant(const std::string& file, int steps = 0, int refinements = 8) {
  Job job;
  job.scene = file;
  job.width_px = width, job.height_px = height, job.samples = 1, job.tonemap = "none";
  job.camera.eye = glm::dvec3(1.6, -1.1, 1.3), job.camera.target = glm::dvec3(0, 0, -0.1), job.camera.yfov_deg = 50;
  job.settings.push_back({"relief", "steps", std::to_string(steps)});
  job.settings.push_back({"relief", "refinements", std::to_string(refinements)});
  return job;
}

class ReferenceRelief : public ReferenceParity {
 protected:
  // Of pixels' centres; infinite where there is nothing.
  static std::vector<double> true_depths(const Job& job, double time_s = 0) {
    std::vector<double> depths;
    auto frame = open_reference(job, time_s, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return depths;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto there = reference::centre_surface(*(*frame)->world, x, y, width, height);
        depths.push_back(there ? there->depth_m : std::numeric_limits<double>::infinity());
      }
    return depths;
  }
  // Of pixels' centres, with shadows.
  static reference::Film truth_of(const Job& job) {
    reference::Film film(width, height);
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return film;
    reference::TraceSettings settings;
    settings.sampler = {reference::SamplerKind::uniform, 1, 0};
    film.add(reference::Integrator(*(*frame)->world, settings, width, height), 1, [](double) { return true; });
    return film;
  }
  struct Fit {
    size_t seen = 0, missed = 0;  // missed: off by more than a hundredth of the layer, or there and not there
    double rms = 0;               // of the others, metres
    double mean = 0, median = 0;  // of what they are off by, and of its size: whether all are off or a few
    double worst = 0;
    glm::ivec2 worst_at{0};
    std::string text() const {
      return fmt::format("rms {:.3g} m, mean {:.3g}, median {:.3g}, worst {:.3g} at {}, {}", rms, mean, median, worst,
                         worst_at.x, worst_at.y);
    }
  };
  static Fit fit_of(Job job, const std::vector<double>& truth, double time_s = 0) {
    job.layers = {"depth"};
    job.effects = "none";
    const Images images = images_of(job, {}, time_s);
    Fit fit;
    std::vector<double> sizes;
    double squares = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double expected = truth[size_t(y * width + x)], found = images["depth"].at(x, y);
        if (!std::isfinite(expected) && found > 1e9) continue;
        ++fit.seen;
        const double off = std::abs(found - expected);
        if (!(off < 0.01 * deep)) {
          ++fit.missed;
          continue;
        }
        squares += off * off, fit.mean += found - expected;
        sizes.push_back(off);
        if (off > fit.worst) fit.worst = off, fit.worst_at = {x, y};
      }
    std::ranges::sort(sizes);
    if (!sizes.empty()) fit.mean /= double(sizes.size()), fit.median = sizes[sizes.size() / 2];
    fit.rms = std::sqrt(squares / double(std::max<size_t>(fit.seen - fit.missed, 1)));
    return fit;
  }
};

}  // namespace candela::test::reference_relief
