#include "cli/trace_options.h"

#include <cmath>

#include "base/text.h"

namespace candela::cli {
namespace {

template <class T>
Expected<T> choice(const char* option, const std::string& given,
                   const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (name == given) return value;
    names.push_back(name);
  }
  return fail(ErrorKind::usage, option, "{}", unknown_name("value", given, names));
}

}  // namespace

Expected<TraceRequest> trace_request(const TraceOptions& o, const Job& job) {
  using namespace reference;
  TraceRequest request;
  const auto mode = choice<Mode>("--mode", o.mode, {{"direct", Mode::direct}, {"path", Mode::path}});
  if (!mode) return std::unexpected(mode.error());
  const auto sampler = choice<SamplerKind>(
      "--sampler", o.sampler,
      {{"sobol", SamplerKind::sobol}, {"jittered", SamplerKind::jittered}, {"uniform", SamplerKind::uniform}});
  if (!sampler) return std::unexpected(sampler.error());
  std::vector<std::pair<std::string, std::optional<BvhBuilder>>> builders = {{"auto", std::nullopt}};
  for (const BvhBuilder b : {BvhBuilder::equal_counts, BvhBuilder::sah, BvhBuilder::sbvh, BvhBuilder::spatial_only})
    builders.emplace_back(name_of(b), b);
  const auto bvh = choice("--bvh", o.bvh, builders);
  if (!bvh) return std::unexpected(bvh.error());
  const auto visibility = choice<bool>("--visibility", o.visibility, {{"on", true}, {"off", false}});
  if (!visibility) return std::unexpected(visibility.error());
  const auto ambient = choice<Ambient>(
      "--ambient", o.ambient, {{"traced", Ambient::traced}, {"occlusion", Ambient::occlusion}, {"off", Ambient::off}});
  if (!ambient) return std::unexpected(ambient.error());
  const auto range = [](const char* option, double value) -> Expected<void> {
    if (!(value >= 0) || !std::isfinite(value))
      return fail(ErrorKind::usage, option, "{} is not a number of at least 0", value);
    return {};
  };
  for (const auto& [option, value] :
       {std::pair("--seconds", o.seconds), {"--noise", o.noise}, {"--ambient-distance", o.ambient_distance_m}})
    if (auto good = range(option, value); !good) return std::unexpected(good.error());
  if (o.bounces < 0) return fail(ErrorKind::usage, "--bounces", "{} is below 0", o.bounces);
  if (o.threads < 0) return fail(ErrorKind::usage, "--threads", "{} is below 0", o.threads);
  if (o.spp > 1u << 30) return fail(ErrorKind::usage, "--spp", "{} is above {}", o.spp, 1u << 30);
  if (*mode == Mode::path)
    for (const auto& [option, given] : {std::pair("--visibility", !*visibility),
                                        {"--ambient", *ambient != Ambient::traced},
                                        {"--ambient-distance", o.ambient_distance_m > 0}})
      if (given) return fail(ErrorKind::usage, option, "belongs to --mode direct; path follows all light as it goes");
  if (*mode == Mode::direct && o.bounces > 0) return fail(ErrorKind::usage, "--bounces", "belongs to --mode path");
  for (const auto& [option, given, least, most] : {std::tuple("--fog-steps", o.fog_steps, 1, most_fog_steps),
                                                   {"--fog-lights", o.fog_lights, 0, most_fog_lights}}) {
    if (!given) continue;
    if (*mode == Mode::path)
      return fail(ErrorKind::usage, option, "belongs to --mode direct; path follows light through fog as it goes");
    if (job.look.empty()) return fail(ErrorKind::usage, option, "needs --look FILE, which says what the fog is");
    if (*given < least || *given > most)
      return fail(ErrorKind::usage, option, "{} is outside {} to {}", *given, least, most);
  }
  constexpr uint64_t default_spp = 64;
  request.stop = {o.spp, o.seconds, o.noise};
  if (o.spp == 0 && o.seconds == 0 && o.noise == 0) request.stop.spp = default_spp;
  if (*sampler != SamplerKind::sobol && request.stop.spp == 0)
    return fail(ErrorKind::usage, "--spp",
                "the sampler {} cuts the pixel into as many cells as there are samples: give their number", o.sampler);
  request.settings.mode = *mode;
  request.settings.sampler = {*sampler, int(std::max<uint64_t>(request.stop.spp, 1)), job.seed};
  request.settings.visibility = *visibility;
  request.settings.ambient = *ambient;
  if (o.ambient_distance_m > 0) request.settings.ambient_distance_m = o.ambient_distance_m;
  request.settings.most_bounces = o.bounces;
  request.settings.footprints = o.footprints;
  if (job.look.empty())
    request.settings.fog_steps = 0;
  else if (o.fog_steps)
    request.settings.fog_steps = *o.fog_steps;
  if (o.fog_lights) request.settings.fog_lights = *o.fog_lights;
  if (*bvh) {
    request.accel.tree.builder = **bvh;
  } else {
    // A sample sends a handful of rays. A limit of time or noise says nothing of their number: as by default then.
    constexpr double rays_a_sample = 4;
    const uint64_t spp = request.stop.spp > 0 ? request.stop.spp : default_spp;
    request.accel.rays = rays_a_sample * double(spp) * job.width_px * job.height_px;
  }
  for (const std::string& text : o.settings)
    if (auto set = set_tree_knob(text, request.accel.tree); !set) return std::unexpected(set.error());
  return request;
}

void add_trace_options(CLI::App& command, TraceOptions& o) {
  command.add_option("--mode", o.mode, "direct: light that comes straight from its sources; path: bounced light too")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--spp", o.spp, "Samples a pixel; 64 if no limit is given")
      ->check(positive_number())
      ->transform(whole_number<uint64_t>())
      ->type_name("N");
  command
      .add_option("--noise", o.noise,
                  "Stop when the relative standard error (from two halves of the samples, root mean square over the "
                  "pixels) is this small; 0.01 is 1 %")
      ->type_name("SHARE");
  command.add_option("--sampler", o.sampler, "sobol (Owen-scrambled), jittered, or uniform: a grid, x4, x8, x16")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--bvh", o.bvh,
                  "How the acceleration structure is built: equal-counts, sah, sbvh, spatial-only; auto: chosen by the "
                  "number of rays. Changes time, never the picture")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--visibility", o.visibility, "direct: off lets light through everything")
      ->capture_default_str()
      ->type_name("on|off");
  command
      .add_option("--ambient", o.ambient,
                  "direct: ambient light; traced: by rays to the sky; occlusion: as render computes it, times traced "
                  "occlusion; off")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--ambient-distance", o.ambient_distance_m,
                  "direct: surfaces farther away than this do not hide the sky; 0: all surfaces do")
      ->capture_default_str()
      ->type_name("METRES");
  command.add_option("--bounces", o.bounces, "path: largest number of bounces; 0: Russian roulette decides")
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option_function<int>(
          "--fog-steps", [&o](int value) { o.fog_steps = value; },
          fmt::format("direct: points on a ray at which light through fog is followed ({}); more is less noise, the "
                      "mean is right for any number",
                      reference::TraceSettings{}.fog_steps))
      ->type_name("N");
  command
      .add_option_function<int>(
          "--fog-lights", [&o](int value) { o.fog_lights = value; },
          fmt::format("direct: with more point and spot lights than this on a ray through fog ({}), they share the "
                      "points of so many; 0: each light has its own; the mean is right for any number",
                      reference::TraceSettings{}.fog_lights))
      ->type_name("N");
  command.add_flag("--footprints", o.footprints,
                   "Average colour textures over each sample's part of the pixel, instead of reading them at points, "
                   "for what the camera sees directly");
  command.add_option("--threads", o.threads, "Threads; 0: all cores. Changes no byte of the result")
      ->capture_default_str()
      ->type_name("N");
}

}  // namespace candela::cli
