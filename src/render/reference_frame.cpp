#include "render/reference_frame.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file_uses.h"
#include "base/text.h"
#include "image/sky_texel.h"
#include "job/background.h"
#include "job/content_hash.h"
#include "job/job_look.h"
#include "job/light_groups.h"
#include "job/picture_camera.h"
#include "job/picture_window.h"
#include "passes/post/subframes_knobs.h"
#include "plan/choose_sides.h"
#include "reference/leaf_view.h"
#include "render/id_names.h"
#include "render/metadata.h"
#include "render/reference_layers.h"
#include "scene/neutral_light.h"
#include "scene/scene_path.h"

namespace candela {
namespace {

using Json = nlohmann::ordered_json;

glm::dvec4 background_of(const std::string& text) {
  const auto background = parse_background(text);
  CHECK_MSG(background, text);  // checked by check_job()
  const auto& [r, g, b, a] = background->linear;
  return {r, g, b, a};
}

// Suns are lights, and the background shows them where the images had them.
void show_suns(reference::Sky& traced, const FrameSky& sky) {
  for (const SkyPart& part : sky.parts)
    for (const SkyTexelBefore& before : part.image->sun_texels) {
      const SkyTexel texel = sky_texel(part.image->image, before.place);
      const glm::vec3 left(texel[0], texel[1], texel[2]);
      traced.show(before.place, glm::dvec3(part.weight) * glm::dvec3(before.radiance - left));
    }
}

// Gradients by their formula; the rest by its images.
reference::Sky traced_sky(const FrameSky& sky) {
  const double turn = glm::radians(sky.rotation_deg);
  if (sky.studio) return reference::Sky::studio(turn, sky.intensity);
  if (sky.is_plain() && !sky.gradient) {
    reference::Sky plain(sky.parts[0].image->image, turn, sky.intensity);
    show_suns(plain, sky);
    return plain;
  }
  std::vector<reference::Sky::Part> parts;
  for (const SkyPart& part : sky.parts)
    if (!part.of_gradient) parts.push_back({&part.image->image, glm::dvec3(part.weight)});
  reference::Sky sum = reference::Sky::sum(parts, sky.gradient, sky.gradient_weight, turn, sky.intensity);
  show_suns(sum, sky);
  return sum;
}

Expected<Look> look_at(const ReferenceScene& loaded, double time_s) {
  return loaded.look ? loaded.look->at(time_s) : Expected<Look>(Look{});
}

}  // namespace

std::string_view name_of(reference::Mode mode) { return mode == reference::Mode::direct ? "direct" : "path"; }
std::string_view name_of(reference::SamplerKind kind) {
  return kind == reference::SamplerKind::uniform    ? "uniform"
         : kind == reference::SamplerKind::jittered ? "jittered"
                                                    : "sobol";
}
std::string_view name_of(reference::Ambient ambient) {
  return ambient == reference::Ambient::traced      ? "traced"
         : ambient == reference::Ambient::occlusion ? "occlusion"
                                                    : "off";
}
std::string_view name_of(BvhBuilder builder) {
  return builder == BvhBuilder::equal_counts ? "equal-counts"
         : builder == BvhBuilder::sah        ? "sah"
         : builder == BvhBuilder::sbvh       ? "sbvh"
                                             : "spatial-only";
}

std::span<const TreeKnob> tree_knobs() {
  static constexpr TreeKnob knobs[] = {
      {"buckets", "planes tried on each axis, less one", least_buckets, most_buckets, true,
       [](const BvhOptions& o) { return double(o.buckets); }, [](BvhOptions& o, double x) { o.buckets = int(x); }},
      {"max-leaf", "triangles in a leaf at most", 1, most_in_leaf, true,
       [](const BvhOptions& o) { return double(o.max_leaf); },
       [](BvhOptions& o, double x) { o.max_leaf = uint32_t(x); }},
      {"block", "triangles that are tested for the price of one: 1, 2, 4, 8 as 0, 1, 2, 3", 0, 3, true,
       [](const BvhOptions& o) { return double(o.block_shift); },
       [](BvhOptions& o, double x) { o.block_shift = uint32_t(x); }},
      {"node-cost", "what a step down costs, in tests", 0, 100, false,
       [](const BvhOptions& o) { return double(o.node_cost); },
       [](BvhOptions& o, double x) { o.node_cost = float(x); }},
      {"depth", "steps down below which nodes are halved by count", 0, most_depth, true,
       [](const BvhOptions& o) { return double(o.depth); }, [](BvhOptions& o, double x) { o.depth = uint32_t(x); }},
      {"budget", "references that spatial splits may add, as a fraction of the triangles", 0, 16, false,
       [](const BvhOptions& o) { return double(o.split_budget); },
       [](BvhOptions& o, double x) { o.split_budget = float(x); }},
      {"alpha", "overlap of the children, as a fraction of the root's area, above which spatial splits are tried", 0, 1,
       false, [](const BvhOptions& o) { return double(o.overlap_alpha); },
       [](BvhOptions& o, double x) { o.overlap_alpha = float(x); }},
  };
  return knobs;
}

Expected<void> set_tree_knob(const std::string& text, BvhOptions& options) {
  const auto setting = parse_knob_setting(text);
  if (!setting) return std::unexpected(setting.error());
  std::vector<std::string> names;
  for (const TreeKnob& knob : tree_knobs()) {
    names.emplace_back("bvh." + std::string(knob.name));
    if (setting->pass != "bvh" || setting->knob != knob.name) continue;
    double value = 0;
    const char* const end = setting->value.data() + setting->value.size();
    const auto [at, error] = std::from_chars(setting->value.data(), end, value);
    if (error != std::errc() || at != end || !(value >= knob.lowest && value <= knob.highest) ||
        (knob.whole && value != std::floor(value)))
      return fail(ErrorKind::usage, "--set", "{}: '{}' is not a {}number from {} to {}", names.back(), setting->value,
                  knob.whole ? "whole " : "", knob.lowest, knob.highest);
    knob.set(options, value);
    return {};
  }
  return fail(ErrorKind::usage, "--set", "{}", unknown_name("knob", setting->pass + "." + setting->knob, names));
}

Expected<void> check_traced_layers(const std::vector<std::string>& layers) {
  const std::vector<std::string> names = reference_layer_names();
  for (const std::string& layer : layers)
    if (std::find(names.begin(), names.end(), layer) == names.end())
      return fail(ErrorKind::usage, "--layers", "{}", unknown_name("layer", layer, names));
  return {};
}

Expected<void> check_traced_view(const std::string& view, const Job& job) {
  std::vector<std::string> views = reference_layer_names();
  for (std::string& layer : light_group_layers(job)) views.push_back(std::move(layer));
  views.insert(views.begin(), "beauty");
  if (std::find(views.begin(), views.end(), view) == views.end())
    return fail(ErrorKind::usage, "--view", "{}", unknown_name("view", view, views));
  return {};
}

Expected<void> check_traced_job(const Job& job) {
  if (job.technique != traced_technique) return check_job(job);
  Job common = job;
  common.technique = Job().technique;
  common.layers.clear();
  common.view = Job().view;
  if (auto fine = check_job(common); !fine) return fine;
  if (auto fine = check_traced_layers(job.layers); !fine) return fine;
  if (auto fine = check_compression(job.layers, job.exr_compression); !fine) return fine;
  return check_traced_view(job.view, job);
}

Expected<std::shared_ptr<const ReferenceScene>> load_reference(const Job& job, reference::Mode mode) {
  if (auto fine = check_traced_job(job); !fine) return std::unexpected(fine.error());
  auto loaded = std::make_shared<ReferenceScene>();
  auto scene = load_scene(job, mode == reference::Mode::path ? LoadFor::path_tracing : LoadFor::direct_tracing);
  if (!scene) return std::unexpected(scene.error());
  loaded->scene = std::move(*scene);
  if (!job.look.empty()) {
    auto file = read_look_file(job.look);
    if (!file) return std::unexpected(file.error());
    loaded->look = std::move(*file);
  }
  const auto look = look_at(*loaded, 0);
  if (!look) return std::unexpected(look.error());
  auto sky = JobSky::read(job, *look, loaded->scene, loaded->warnings);
  if (!sky) return std::unexpected(sky.error());
  loaded->sky = std::move(*sky);
  const auto skies = sky_files(job, *look);
  if (!skies) return std::unexpected(skies.error());
  const auto content = hash_files(loaded->scene.files, *skies, job.look);
  if (!content) return std::unexpected(content.error());
  loaded->content = *content;
  if (auto fine = check_outputs(); !fine) return std::unexpected(fine.error());
  return loaded;
}

Expected<std::unique_ptr<ReferenceFrame>> open_reference(const Job& job, double time_s, const AccelOptions& accel,
                                                         reference::Mode mode) {
  auto loaded = load_reference(job, mode);
  if (!loaded) return std::unexpected(loaded.error());
  return pose_reference(std::move(*loaded), job, time_s, accel, mode);
}

Expected<std::unique_ptr<ReferenceFrame>> pose_reference(std::shared_ptr<const ReferenceScene> loaded, const Job& job,
                                                         double time_s, const AccelOptions& accel,
                                                         reference::Mode mode) {
  auto frame = std::make_unique<ReferenceFrame>();
  frame->loaded = std::move(loaded);
  frame->warnings = frame->loaded->warnings;
  const Scene& scene = frame->scene();
  frame->time_s = time_s;
  auto look = look_at(*frame->loaded, time_s);
  if (!look) return std::unexpected(look.error());
  frame->look = std::move(*look);
  expose_by_camera(job, frame->look);
  auto posed = pose_scene(scene, job, time_s, frame->look.lights.radius_m);
  if (!posed) return std::unexpected(posed.error());
  frame->pose = std::move(posed->pose), frame->view = std::move(posed->view), frame->data = std::move(posed->data);
  frame->notes = frame->view.notes;
  frame->notes.insert(frame->notes.end(), frame->pose.warnings.begin(), frame->pose.warnings.end());
  if (scene.paths) frame->notes.insert(frame->notes.end(), scene.paths->notes.begin(), scene.paths->notes.end());
  if (std::string note = clip_note(scene, job.animation); !note.empty()) frame->notes.push_back(std::move(note));

  reference::WorldInput input{scene, frame->pose, frame->view, frame->data};
  input.background = background_of(job.background);
  input.accel = accel;
  input.glass = mode == reference::Mode::path;
  input.open_sides = (job.sides == "auto" ? choose_sides(scene, job).name : job.sides) == "open";
  input.accel.open_sides = input.open_sides;
  input.fog = frame->look.fog;
  input.more_fog = frame->look.more_fog;
  input.volumetric = frame->look.volumetric;
  const auto camera = picture_camera(job, frame->look);
  if (!camera) return std::unexpected(camera.error());
  if (camera->lens) {
    const auto focus = focus_m(scene, *camera->lens, frame->pose, frame->view);
    if (!focus) return std::unexpected(focus.error());
    input.lens_radius_m = lens_radius_m(*camera->lens, frame->view), input.focus_m = *focus;
  }
  input.occlusion = frame->look.occlusion;
  if (!job.light_groups.empty()) {
    auto groups = light_group_of(job, scene, frame->data.lights);
    if (!groups) return std::unexpected(groups.error());
    input.light_group_of = std::move(*groups);
    input.other_lights = uint32_t(job.light_groups.size());
  }
  input.reflections = frame->look.reflections.has_value() || !frame->look.probes.empty();
  if (const FrameSky sky = frame->loaded->sky->at(frame->look, frame->data, frame->notes)) {
    add_sky_suns(sky, frame->data);
    input.sky = traced_sky(sky);
    input.ambient_sh = sky.ambient();
    input.sky_visible = !sky.studio;
    input.sky_blur_rad = glm::radians(sky.blur_deg);
  } else if (!has_light(scene) && job.sky != "none") {
    add_neutral_light(frame->view, frame->data);
    input.sky = reference::Sky::neutral();
    input.ambient_sh = neutral_ambient();
    frame->notes.push_back(
        "the scene has no light and no sky is given: a neutral light is used so that it is seen (--sky sets one)");
  }
  size_suns(frame->look, frame->data);
  if (any_fog(frame->look, is_endless))
    frame->notes.push_back(
        "the fog has neither falloff nor bounds: sun, sky and background lie behind all of it and give no light");
  if (frame->data.items.empty())
    frame->notes.push_back("nothing is visible at this time: the image holds the background alone");
  frame->world = std::make_unique<reference::World>(input, frame->warnings);
  if (frame->world->bends_lamps())
    frame->notes.push_back(
        "local lights without a size shine through bodies of smooth glass where light is bent or totally reflected; "
        "what such "
        "a body reflects inside it, and such light in fog, is left out (a radius of the local light brings it in)");
  if (const size_t skipped = frame->world->accel().statistics().skipped_items; skipped > 0)
    frame->notes.push_back(
        fmt::format("{} item{} of points or lines: rays do not meet them, so they are not in the picture", skipped,
                    skipped == 1 ? "" : "s"));
  return frame;
}

Expected<void> add_time_before(ReferenceFrame& frame, const Job& job, const std::vector<std::string>& layers) {
  if (std::ranges::find(layers, "motion") == layers.end()) return {};
  auto before = pose_before(frame.scene(), job, frame.time_s, frame.pose);
  if (!before) return std::unexpected(before.error());
  frame.before = std::move(*before);
  return {};
}

std::string settings_json(const reference::TraceSettings& s, const AccelOptions& accel) {
  Json j;
  j["mode"] = name_of(s.mode);
  j["sampler"] = name_of(s.sampler.kind);
  if (s.sampler.kind != reference::SamplerKind::sobol) j["spp"] = s.sampler.spp;
  j["seed"] = s.sampler.seed;
  if (s.mode == reference::Mode::direct) {
    j["visibility"] = s.visibility;
    j["ambient"] = name_of(s.ambient);
    if (std::isfinite(s.ambient_distance_m)) j["ambient-distance"] = s.ambient_distance_m;
  } else if (s.most_bounces > 0) {
    j["bounces"] = s.most_bounces;
  }
  if (s.mode == reference::Mode::direct && s.fog_steps > 0)
    j["fog-steps"] = s.fog_steps, j["fog-lights"] = s.fog_lights;
  if (s.footprints) j["footprints"] = true;
  j["bvh"] = accel.rays ? "auto" : name_of(accel.tree.builder);
  for (const TreeKnob& knob : tree_knobs())
    if (knob.get(accel.tree) != knob.get(BvhOptions{})) j["bvh." + std::string(knob.name)] = knob.get(accel.tree);
  return j.dump();
}

Hash128 film_identity(const Job& job, const ReferenceFrame& frame, const reference::TraceSettings& settings,
                      const AccelOptions& accel, bool with_terms) {
  Job picture;
  picture.animation = job.animation;
  picture.camera = job.camera;
  picture.width_px = job.width_px, picture.height_px = job.height_px;
  picture.region = job.region, picture.overscan = job.overscan, picture.light_groups = job.light_groups;
  picture.background = job.background;
  picture.shading = job.shading, picture.probe = job.probe, picture.variant = job.variant;
  picture.cut_outs = job.cut_outs, picture.up = job.up, picture.sides = job.sides;
  picture.sky = job.sky.empty() || is_sky_word(job.sky) ? job.sky : "sky";
  picture.look = job.look.empty() ? "" : "look";
  picture.shutter_s = job.shutter_s, picture.f_stop = job.f_stop, picture.focus = job.focus;
  picture.sensor_mm = job.sensor_mm, picture.motion_s = job.motion_s, picture.effects = job.effects;
  for (const KnobSetting& setting : job.settings)
    if (setting.pass == SubframesKnobs::name) picture.settings.push_back(setting);
  picture.paths = job.paths, picture.instances = job.instances;
  forget_motion_files(picture);
  return hash128(fmt::format("candela reference {}\n{}\n{}\n{}\n{:a}{}", CANDELA_VERSION, job_json(picture),
                             settings_json(settings, accel), frame.scene_content().hex(), frame.time_s,
                             with_terms ? "\nterms" : ""));
}

std::vector<std::string> reference_layer_names() {
  std::vector<std::string> names = {"variance", "fog", "fog_transmittance", "motion"};
  const std::vector<std::string> counts = {"heatmap_traversal", "heatmap_leaves"};
  for (const std::vector<std::string>& more : {term_layer_names(), surface_layer_names(), matte_layer_names(), counts})
    names.insert(names.end(), more.begin(), more.end());
  return names;
}

std::vector<float> reference_counts(const reference::Film& film, const ReferenceFrame& frame,
                                    const std::string& layer) {
  if (layer == "heatmap_leaves") return reference::leaf_counts(*frame.world, film);
  CHECK_MSG(layer == "heatmap_traversal", layer);
  std::vector<float> counts(film.pixels());
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = float(film.traversal(i));
  return counts;
}

FloatImage reference_image(const reference::Film& film, const ReferenceFrame& frame, const Job& job,
                           const std::string& settings, const std::vector<std::string>& layers,
                           std::optional<int64_t> frame_number, FrameRate rate,
                           const reference::SamplerSettings& sampler) {
  FloatImage image;
  image.width = film.width(), image.height = film.height();
  const PictureWindow window = picture_window(job);
  set_windows(image, window);
  const auto add = [&](std::string name, ChannelType type) -> std::vector<float>& {
    Channel& channel = image.channels.emplace_back();
    channel.name = std::move(name), channel.type = type;
    channel.f.resize(film.pixels());
    return channel.f;
  };
  const ChannelType type = job.exr_float ? ChannelType::float32 : ChannelType::half;
  constexpr const char* rgba[] = {"R", "G", "B", "A"};
  for (int c = 0; c < 4; ++c) {
    std::vector<float>& plane = add(rgba[c], type);
    for (size_t i = 0; i < film.pixels(); ++i) plane[i] = float(film.mean(i)[c]);
  }
  add_surface_layers(image, frame, window, layers, type);
  add_term_layers(image, film, layers, type);
  const std::vector<std::string> light_groups = light_group_layers(job);
  add_light_group_layers(image, film, light_groups, type);
  add_motion_layer(image, frame, window, layers);
  add_matte_layers(image, frame, window, layers, sampler, film.samples());
  const auto names = [](const std::vector<std::string>& these, const std::string& layer) {
    return std::find(these.begin(), these.end(), layer) != these.end();
  };
  for (const std::string& layer : layers) {
    if (names(surface_layer_names(), layer) || names(term_layer_names(), layer) || names(matte_layer_names(), layer) ||
        names(light_groups, layer) || layer == "motion")
      continue;
    if (layer.starts_with("heatmap_")) {
      add(layer + ".Y", ChannelType::float32) = reference_counts(film, frame, layer);
      continue;
    }
    for (int c = 0; c < 3; ++c) {
      std::vector<float>& plane = add(layer + "." + rgba[c], ChannelType::float32);
      for (size_t i = 0; i < film.pixels(); ++i)
        plane[i] = float((layer == "variance" ? film.variance(i)
                          : layer == "fog"    ? film.fog_light(i)
                                              : film.fog_through(i))[c]);
    }
  }
  add_view_metadata(image, frame.view, frame.time_s, frame_number, rate);
  auto& metadata = image.metadata;
  metadata.push_back(text_entry("candela:job", job_json(without_folders(job))));
  metadata.push_back(text_entry("candela:reference", settings));
  metadata.push_back(number_entry("candela:spp", MetadataEntry::Kind::number, double(film.samples())));
  metadata.push_back(number_entry("candela:mse", MetadataEntry::Kind::number, film.mean_square_error()));
  metadata.push_back(text_entry("candela:device", "reference"));
  metadata.push_back(text_entry("candela:version", CANDELA_VERSION));
  metadata.push_back(text_entry("software", "candela " CANDELA_VERSION));
  add_id_names(image, frame.scene());
  return image;
}

}  // namespace candela
