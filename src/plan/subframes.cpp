#include "plan/subframes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "job/frame_knobs.h"
#include "job/job_look.h"
#include "passes/post/subframes.h"
#include "plan/ask_frame.h"
#include "scene/pose.h"
#include "scene/scene_path.h"

namespace candela {
namespace {

// A concentric map (Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997).
glm::dvec2 on_disc(glm::dvec2 u) {
  const glm::dvec2 p = 2.0 * u - 1.0;
  if (p == glm::dvec2(0)) return p;
  const bool across = std::abs(p.x) > std::abs(p.y);
  const double radius = across ? p.x : p.y, quarter = std::numbers::pi / 4;
  const double angle = across ? quarter * p.y / p.x : 2 * quarter - quarter * p.x / p.y;
  return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

}  // namespace

std::pair<double, double> open_shutter(double picture_s, double shutter_s, std::span<const double> cuts_s) {
  double from = std::max(picture_s - shutter_s / 2, std::min(picture_s, 0.0)), to = picture_s + shutter_s / 2;
  const auto next = std::ranges::upper_bound(cuts_s, picture_s);
  if (next != cuts_s.end()) to = std::min(to, *next);
  if (next != cuts_s.begin()) from = std::max(from, *std::prev(next));
  return {from, to};
}

bool gathers(const PictureCamera& camera, const SubframesKnobs& knobs) {
  return camera.shutter_s > 0 && !camera.lens && knobs.gather != 0;
}

std::vector<double> camera_cuts(const Scene& scene, const Job& job) {
  std::vector<double> cuts;
  const int carried = camera_node_of(scene, job.camera);
  const auto playing = choose_animations(scene, job.animation);
  if (carried < 0 || !playing) return cuts;
  // What carries the camera, and what it looks at.
  std::vector<int> nodes;
  const auto add_chain = [&](int node) {
    for (int n = node; n >= 0 && std::ranges::find(nodes, n) == nodes.end(); n = scene.nodes[size_t(n)].parent)
      nodes.push_back(n);
  };
  add_chain(carried);
  for (size_t i = 0; scene.paths && i < nodes.size(); ++i) {
    const ScenePath* const path = scene.paths->of(size_t(nodes[i]));
    if (!path) continue;
    for (const double jump_s : path->times.jumps_s()) cuts.push_back(jump_s);
    if (path->looks == ScenePath::Looks::at_node) add_chain(path->looked_at);
  }
  for (const int a : playing->animations)
    for (const AnimationChannel& channel : scene.animations[size_t(a)].channels) {
      const bool of_node = channel.path == TargetPath::node_translation || channel.path == TargetPath::node_rotation ||
                           channel.path == TargetPath::node_scale;
      const bool of_camera =
          channel.path == TargetPath::camera_yfov && channel.object == scene.nodes[size_t(carried)].camera;
      const bool moves = of_camera || (of_node && std::ranges::find(nodes, channel.object) != nodes.end());
      if (!moves) continue;
      // Two keys at one time are a step as well.
      for (size_t k = 0; k < channel.times_s.size(); ++k)
        if (channel.interpolation == Interpolation::step || (k > 0 && channel.times_s[k] == channel.times_s[k - 1]))
          cuts.push_back(double(channel.times_s[k]));
    }
  std::ranges::sort(cuts);
  return cuts;
}

Expected<std::vector<Subframe>> subframes_of(const Job& job, const PlanContext& context, double time_s) {
  std::vector<Subframe> frames;
  if (context.face) return frames;
  const auto look = context.look_now ? Expected<Look>(*context.look_now)
                    : context.look   ? context.look->at(time_s)
                                     : look_of(job, time_s);
  if (!look) return std::unexpected(look.error());
  const auto camera = picture_camera(job, *look);
  if (!camera) return std::unexpected(camera.error());
  if (!*camera) return frames;
  const auto knobs = frame_knobs(job);
  if (!knobs) return std::unexpected(knobs.error());
  if (gathers(*camera, knobs->get<SubframesKnobs>())) return frames;
  const uint32_t count = uint32_t(knobs->get<SubframesKnobs>().n);
  const auto [from, to] = open_shutter(time_s, camera->shutter_s, camera_cuts(context.scene, job));
  // Powers of the root of x^5 = x + 1, of which the sequence's steps are the inverse.
  constexpr double root = 1.1673039782614187;
  Rng noise(Rng(job.seed).next() ^ std::bit_cast<uint64_t>(time_s));
  double shift[4];
  for (uint32_t d = 0; d < 4; ++d) shift[d] = noise.uniform();
  for (uint32_t i = 0; i < count; ++i) {
    Subframe frame{.index = i, .count = count, .picture_s = time_s};
    frame.time_s = from + (to - from) * (i + 0.5) / count;
    double u[4], step = 1;
    for (int d = 0; d < 4; ++d) {
      step /= root;
      const double x = shift[d] + (i + 1) * step;
      u[d] = x - std::floor(x);
    }
    // One frame is through the middles of pixels and of the lens.
    if (count > 1) {
      frame.offset_px = {u[0] - 0.5, u[1] - 0.5};
      frame.lens = on_disc({u[2], u[3]});
    }
    frame.camera = camera->lens;
    frames.push_back(frame);
  }
  frames.push_back({.role = SubframePart::Role::mean, .count = count, .time_s = time_s, .picture_s = time_s});
  return frames;
}

}  // namespace candela
