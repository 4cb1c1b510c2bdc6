#include "plan/probe_image.h"

#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/check.h"
#include "base/text.h"
#include "passes/surfaces/ibl_knobs.h"

namespace candela {
namespace {

int side_of(const ProbeKnobs& knobs) { return knobs.size_px + 2; }
double tan_of(const ProbeKnobs& knobs) { return double(side_of(knobs)) / knobs.size_px; }

// Bilinear, by the view that drew the face.
glm::dvec3 look_up(const ProbeFace& face, const View& view, int side, glm::dvec3 d) {
  const glm::dvec3 seen = glm::dmat3(view.view_from_relative) * d;
  const double x = (1 - seen.x / (seen.z * view.tan_x)) * 0.5 * side - 0.5;
  const double y = (1 + seen.y / (seen.z * view.tan_y)) * 0.5 * side - 0.5;
  const int x0 = std::clamp(int(std::floor(x)), 0, side - 2), y0 = std::clamp(int(std::floor(y)), 0, side - 2);
  const auto texel = [&](int i, int j) {
    const float* t = face.data() + (size_t(j) * size_t(side) + size_t(i)) * 4;
    return glm::dvec3(t[0], t[1], t[2]);
  };
  return glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), x - x0),
                  glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), x - x0), y - y0);
}

int face_of(glm::dvec3 d) {
  const glm::dvec3 size = glm::abs(d);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return 2 * axis + (d[axis] < 0 ? 1 : 0);
}

}  // namespace

Job probe_job(Job job, const ProbeKnobs& knobs) {
  job.width_px = job.height_px = side_of(knobs);
  job.region.reset(), job.overscan = {};
  job.layers.clear();
  job.view = "beauty";
  job.background = "transparent";
  if (job.effects == "auto" || job.effects == "none") return job;
  std::vector<std::string> kept = split(job.effects, ',');
  for (const char* left_out : {"reflections", "bloom", "fog", "volumetric", "exposure", "probes"})
    std::erase(kept, left_out);
  job.effects = kept.empty() ? "none" : fmt::format("{}", fmt::join(kept, ","));
  return job;
}

Look seen_by_probe(Look look) {
  look.fog.reset(), look.more_fog.clear(), look.volumetric.reset();
  look.bloom.reset(), look.reflections.reset(), look.probes.clear();
  look.exposure.automatic.reset();
  look.sky.blur_deg = 0;
  return look;
}

View probe_view(const ReflectionProbe& probe, int face, const ProbeKnobs& knobs) {
  const glm::dvec3 size = probe.highest - probe.lowest;
  const double near_m = std::min(0.01, 0.01 * std::min({size.x, size.y, size.z}));
  return view_of_face(probe.position, face, tan_of(knobs), near_m);
}

DecodedImage probe_image(const std::array<ProbeFace, 6>& drawn, const ProbeKnobs& knobs, float scale, size_t& dropped) {
  const int side = side_of(knobs);
  std::array<ProbeFace, 6> faces = drawn;
  dropped = 0;
  // Sums of values beyond this would overflow.
  constexpr float most = 1e30f;
  for (ProbeFace& face : faces) {
    CHECK(face.size() == size_t(side) * size_t(side) * 4);
    for (size_t i = 0; i < face.size(); i += 4) {
      bool fine = true;
      for (size_t c = 0; c < 3; ++c) fine = fine && std::abs(face[i + c] *= scale) < most;
      if (fine) continue;
      for (size_t c = 0; c < 3; ++c) face[i + c] = 0;
      ++dropped;
    }
  }
  std::array<View, 6> views;
  for (int f = 0; f < 6; ++f) views[size_t(f)] = view_of_face(glm::dvec3(0), f, tan_of(knobs), 0.01);
  DecodedImage out{4 * knobs.size_px, 2 * knobs.size_px, DecodedImage::Format::rgba32f, 3, {}};
  out.pixels.resize(size_t(out.width) * size_t(out.height) * 16);
  tbb::parallel_for(0, out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      glm::dvec3 sum(0);
      for (int k = 0; k < 4; ++k) {
        const glm::dvec3 d =
            equirect_direction((x + 0.25 + 0.5 * (k & 1)) / out.width, (y + 0.25 + 0.5 * (k >> 1)) / out.height);
        const int f = face_of(d);
        sum += look_up(faces[size_t(f)], views[size_t(f)], side, d);
      }
      const glm::vec4 texel(glm::vec3(sum / 4.0), 1);
      std::memcpy(out.pixels.data() + (size_t(y) * size_t(out.width) + size_t(x)) * 16, &texel, 16);
    }
  });
  return out;
}

IblKnobs probe_filter(const ProbeKnobs& knobs, const IblKnobs& image_light) {
  IblKnobs filter;
  filter.method = int(IblMethod::lobe);
  filter.lights = 0;
  filter.irradiance_px = 0;
  filter.size_px = std::max(2 * knobs.size_px, 32);
  filter.filter_samples = image_light.filter_samples;
  return filter;
}

void place_probes(std::span<const ReflectionProbe> probes, const View& view, shared::ProbeLights& out) {
  for (size_t i = 0; i < probes.size(); ++i) {
    const ReflectionProbe& p = probes[i];
    out.probe[i] = {glm::vec3(p.position - view.position), 0, glm::vec3(p.lowest - view.position), float(p.fade_m),
                    glm::vec3(p.highest - view.position),  0};
  }
}

}  // namespace candela
