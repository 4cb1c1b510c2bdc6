#include "passes/reflections/reflections.h"

#include <algorithm>
#include <bit>

#include "passes/shared/features.h"

namespace candela {
namespace {

// At most 64 pixels of the picture to a texel.
constexpr uint32_t most_levels = 7;

glm::uvec2 texels_of(const Reflections::Knobs& knobs, const SceneInputs& scene) {
  const uint32_t side = uint32_t(knobs.texel_px);
  return {(scene.width_px + side - 1) / side, (scene.height_px + side - 1) / side};
}

// A multiple of the last level's texels, so that every level is exactly half the one before.
glm::uvec2 padded(const SceneInputs& scene) {
  const uint32_t unit = 1u << (Reflections::levels(scene) - 1);
  return {(scene.width_px + unit - 1) / unit * unit, (scene.height_px + unit - 1) / unit * unit};
}

ImageHandle light_image(GraphBuilder& builder, const SceneInputs& scene, const Reflections::Knobs& knobs,
                        const char* name) {
  const glm::uvec2 texels = texels_of(knobs, scene);
  const ImageDesc desc{.name = name, .format = color_format, .width_px = texels.x, .height_px = texels.y};
  return builder.write(builder.create(desc), Access::storage_image_write);
}

uint32_t samples_of(const Reflections::Knobs& knobs, const Reflections::In& in) {
  return (uint32_t(knobs.samples) + in.scene.subsamples - 1) / in.scene.subsamples;
}

}  // namespace

std::span<const Knob> ReflectionKnobs::table() {
  constexpr std::string_view on_screen = "reflections.method=screen";
  static const Knob table[] = {
      screen_or_rays_row<ReflectionKnobs>(
          "what surfaces reflect of each other: what the picture shows, or rays to all that there is"),
      {.name = "samples",
       .member = &ReflectionKnobs::samples,
       .lowest = 1,
       .highest = 1024,
       .levels = {1, 4, 4, 64},
       .description = "rays a texel; fewer blur what rough surfaces reflect, and leave noise",
       .sweep = {1, 2, 4, 16, 64}},
      {.name = "steps",
       .member = &ReflectionKnobs::steps,
       .lowest = 0,
       .highest = 65536,
       .levels = {24, 48, 64, 0},
       .description = "depths that a ray looks at, at most; fewer miss what is narrow; 0: every pixel that it crosses",
       .sweep = {8, 16, 32, 64, 128, 0},
       .required = on_screen},
      {.name = "smooth",
       .member = &ReflectionKnobs::smooth,
       .lowest = 0,
       .highest = 1,
       .levels = {1, 1, 1, 0},
       .description =
           "1: the mean over 5 by 5 texels of the same surface, as far as the lobe is wider than they are apart; "
           "blurs contacts where rays are many",
       .sweep = {1, 0},
       .required = "reflections.samples=64"},
      {.name = "texel_px",
       .member = &ReflectionKnobs::texel_px,
       .unit = "px",
       .lowest = 1,
       .highest = 4,
       .levels = {2, 2, 1, 1},
       .description = "side of a texel of reflections: 1 full resolution, 2 half; coarser ones blur mirrors and edges",
       .sweep = {4, 2, 1},
       .only = {1, 2, 4}},
      {.name = "thickness",
       .member = &ReflectionKnobs::thickness,
       .lowest = 0,
       .highest = 1,
       .levels = {0.05, 0.02, 0.02, 0},
       .description = "thickness that a ray assumes behind visible surfaces, as a part of their distance; more finds "
                      "hidden surfaces, and some that are not there; 0: only visible surfaces",
       .sweep = {0.2, 0.05, 0.02, 0.01, 0},
       .required = on_screen},
      {.name = "fade",
       .member = &ReflectionKnobs::fade,
       .lowest = 0,
       .highest = 0.5,
       .levels = {0.05, 0.05, 0.05, 0},
       .description = "part of the picture's size at its edges where reflections fade into the sky's; 0: they end",
       .sweep = {0.2, 0.1, 0.05, 0},
       .required = on_screen},
      {.name = "roughest",
       .member = &ReflectionKnobs::roughest,
       .lowest = 0,
       .highest = 1,
       .levels = {0.4, 0.6, 0.7, 1},
       .description =
           "roughness from which surfaces reflect the sky alone, fading from three quarters of it on; 1: none does",
       .sweep = {0.3, 0.5, 0.7, 0.85, 1}},
  };
  return table;
}

Need Reflections::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (!request.draws_reflections()) return {false, "the look has no reflections of the scene (--look, --effects)"};
  return needed_if(facts.lit_items > 0, "the scene has no opaque or masked surface that takes light");
}

bool Reflections::ignores(std::string_view knob) const {
  if (knobs.method == Knobs::screen) return knob == "floor_lux" || knob == "lost";
  return knob == "steps" || knob == "thickness" || knob == "fade";
}

uint32_t Reflections::levels(const SceneInputs& scene) {
  uint32_t count = 1;
  while (count < most_levels && (std::max(scene.width_px, scene.height_px) >> count) > 0) ++count;
  return count;
}

namespace {
ImageHandle surface_image(GraphBuilder& builder, const SceneInputs& s, const char* name, VkFormat format,
                          Access access) {
  const ImageDesc desc{.name = name, .format = format, .width_px = s.width_px, .height_px = s.height_px};
  return builder.write(builder.create(desc), access);
}

// access: of images that are drawn to, or stored.
void write_surfaces(GraphBuilder& builder, const SceneInputs& s, bool has_fog, Access access, Reflections::Out& out) {
  Reflected& r = out.reflected;
  r.surface = surface_image(builder, s, "reflections.surface", VK_FORMAT_R32G32B32A32_UINT, access);
  r.reflectance = surface_image(builder, s, "reflections.reflectance", VK_FORMAT_R32G32_UINT, access);
  r.sky = surface_image(builder, s, "reflections.sky", color_format, access);
  if (has_fog) out.fog = surface_image(builder, s, "reflections.fog", color_format, access);
}
}  // namespace

void Reflections::declare_drawn(GraphBuilder& builder, const In& in, Out& out) const {
  const SceneInputs& scene = in.scene;
  declare_lights(builder, scene, in.lists);  // their addresses stand where occlusion's texels do
  declare_fog(builder, scene, in.lists, true);
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = with_fog("reflections_surface.frag", in.lists);
  choice.desc.color_formats = {VK_FORMAT_R32G32B32A32_UINT, VK_FORMAT_R32G32_UINT, color_format};
  if (in.lists.fog) choice.desc.color_formats.push_back(color_format);
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.constants = light_constants(in.lists);
  out.drawn = declare_batches(
      builder, scene, in.draws, in.deformed, [](const DrawBatch& r) { return r.solid(); }, choice);
  write_surfaces(builder, scene, bool(in.lists.fog), Access::color_attachment, out);
  out.reflected.z = surface_image(builder, scene, "reflections.z", depth_format, Access::depth_attachment);
}

void Reflections::declare_keyed(GraphBuilder& builder, const In& in, Out& out) const {
  const SceneInputs& scene = in.scene;
  declare_keyed_surfaces(builder, scene, in.keys, in.deformed);
  declare_lights(builder, scene, in.lists, ReadBy::compute());
  declare_fog(builder, scene, in.lists, true, ReadBy::compute());
  ComputePipelineDesc desc{with_fog("reflections_surface.comp", in.lists), met_constants(scene, in.lists)};
  desc.shader += surface_definitions(desc.constants);
  out.pipelines.surface = builder.pipeline(desc);
  write_surfaces(builder, scene, bool(in.lists.fog), Access::storage_image_write, out);
  out.reflected.z = surface_image(builder, scene, "reflections.z", float_format, Access::storage_image_write);
}

Reflections::Out Reflections::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& scene = in.scene;
  Out out;
  out.reflected.texel_px = uint32_t(knobs.texel_px);
  builder.begin_step();
  if (in.keys)
    declare_keyed(builder, in, out);
  else
    declare_drawn(builder, in, out);
  if (knobs.method == Knobs::by_rays)
    declare_rays(builder, in, out);
  else
    declare_march(builder, in, out);
  if (knobs.smooth == 0) return out;
  out.noisy = out.reflected.light;
  out.pipelines.smooth = builder.pipeline(ComputePipelineDesc{
      "reflections_smooth.comp", knobs.texel_px != 1 ? std::vector<SpecConstant>{{0, "SIDE", uint32_t(knobs.texel_px)}}
                                                     : std::vector<SpecConstant>{}});
  builder.begin_step();
  builder.read(scene.constants, Access::uniform_read, "the frame's constants");
  for (const ImageHandle read :
       {out.reflected.z, out.reflected.surface, out.reflected.reflectance, out.reflected.sky, out.noisy})
    builder.read(read, Access::sampled_compute, "surfaces");
  out.reflected.light = light_image(builder, in.scene, knobs, "reflections.smooth");
  return out;
}

void Reflections::declare_march(GraphBuilder& builder, const In& in, Out& out) const {
  const SceneInputs& scene = in.scene;
  const glm::uvec2 size = padded(scene);
  out.colors = builder.create(ImageDesc{.name = "reflections.colors",
                                        .format = color_format,
                                        .width_px = size.x,
                                        .height_px = size.y,
                                        .mips = levels(scene)});
  out.pipelines.color = builder.pipeline(
      ComputePipelineDesc{"reflections_color.comp",
                          in.lists.fog ? std::vector<SpecConstant>{{0, "HAS_FOG", 1}} : std::vector<SpecConstant>{}});
  builder.begin_step();
  builder.read(in.picture, Access::sampled_compute, "the picture");
  builder.read(out.reflected.z, Access::sampled_compute, "depth");
  builder.read_optional(out.fog, Access::sampled_compute);
  out.colors = builder.write(out.colors, Access::storage_image_write, ImageRange::mip(0));
  out.pipelines.down = builder.pipeline(ComputePipelineDesc{"reflections_down.comp", {}});
  for (uint32_t k = 1; k < levels(scene); ++k) {
    builder.begin_step();
    builder.read(out.colors, Access::sampled_compute, "the finer level", ImageRange::mip(k - 1));
    out.colors = builder.write(out.colors, Access::storage_image_write, ImageRange::mip(k));
  }

  std::vector<SpecConstant> constants;
  if (knobs.texel_px != 1) constants.push_back({0, "SIDE", uint32_t(knobs.texel_px)});
  if (in.has_sky) constants.push_back({1, "HAS_SKY", 1});
  out.pipelines.trace =
      builder.pipeline(ComputePipelineDesc{with_fog("reflections_trace.comp", fog_on_the_way(in.lists)), constants});
  builder.begin_step();
  builder.read(scene.constants, Access::uniform_read, "the frame's constants");
  for (const ImageHandle read :
       {out.reflected.z, out.reflected.surface, out.reflected.reflectance, out.reflected.sky, out.colors})
    builder.read(read, Access::sampled_compute, "surfaces");
  out.reflected.light = light_image(builder, in.scene, knobs, "reflections.light");
}

void Reflections::declare_rays(GraphBuilder& builder, const In& in, Out& out) const {
  const SceneInputs& s = in.scene;
  builder.begin_step();
  for (const ImageHandle read : {out.reflected.z, out.reflected.surface, out.reflected.reflectance})
    builder.read(read, Access::sampled_compute, "surfaces");
  declare_met_surfaces(builder, s, in.deformed, in.met);
  ComputePipelineDesc desc{with_fog("reflections_rays.comp", in.met), met_constants(s, in.met)};
  if (knobs.texel_px != 1) desc.constants.push_back({30, "SIDE", uint32_t(knobs.texel_px)});
  if (in.has_sky) desc.constants.push_back({31, "HAS_SKY", 1});
  desc.shader += surface_definitions(desc.constants);
  out.pipelines.trace = builder.pipeline(desc);
  out.reflected.light = light_image(builder, in.scene, knobs, "reflections.light");
}

void Reflections::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& scene = in.scene;
  const bool is_traced = knobs.method == Knobs::by_rays;
  const uint32_t step = commands.step(), last = is_traced ? 1 : levels(scene) + 1;
  if (step == 0) {
    record_surfaces(commands, in, out);
  } else if (step > last) {
    shared::ReflectionsSmoothPush push{};
    push.at = surfaces_of(commands, out.reflected);
    push.light = commands.sampled(out.noisy);
    push.smooth_light = commands.storage(out.reflected.light);
    push.rays = samples_of(knobs, in) * in.scene.subsamples;
    push.texels = texels_of(knobs, scene);
    push.subsample_ndc = scene.subsample_ndc();
    commands.bind(out.pipelines.smooth);
    commands.push(push);
    commands.dispatch(push.texels.x, push.texels.y);
  } else if (is_traced) {
    record_rays(commands, in, out);
  } else {
    record_march(commands, in, out);
  }
}

void Reflections::record_surfaces(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& scene = in.scene;
  const Reflected& r = out.reflected;
  if (!in.keys) {
    std::vector<CommandList::Attachment> colors = {{r.surface}, {r.reflectance}, {r.sky}};
    if (out.fog) colors.push_back({out.fog});
    commands.begin_picture(colors, r.z);
    record_batches(commands, scene, in.draws, in.deformed, out.drawn, &in.lists, &in.lists);
    commands.end_rendering();
    return;
  }
  OwnInputs own;
  own.table = in.keys;
  own.number =
      REFLECTIONS_SURFACE_IMAGES(commands.storage(r.z), commands.storage(r.surface), commands.storage(r.reflectance),
                                 commands.storage(r.sky), out.fog ? commands.storage(out.fog) : 0u);
  commands.bind(out.pipelines.surface);
  commands.push(draw_push(commands, scene, in.deformed, &in.lists, &in.lists, own));
  commands.dispatch_picture(scene.width_px, scene.height_px);
}

void Reflections::record_march(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& scene = in.scene;
  const uint32_t step = commands.step();
  const glm::uvec2 size = padded(scene);
  if (step == 1) {
    shared::ReflectionsColorPush push{};
    push.picture = commands.sampled(in.picture);
    push.z = commands.sampled(out.reflected.z);
    if (out.fog) push.fog = commands.sampled(out.fog);
    push.target = commands.storage(out.colors);
    push.size_px = {scene.width_px, scene.height_px};
    commands.bind(out.pipelines.color);
    commands.push(push);
    commands.dispatch(size.x, size.y);
  } else if (step <= levels(scene)) {
    shared::ReflectionsDownPush push{};
    push.source = commands.sampled(out.colors);
    push.target = commands.storage(out.colors);
    push.target_px = commands.size(out.colors, step - 1);
    commands.bind(out.pipelines.down);
    commands.push(push);
    commands.dispatch(push.target_px.x, push.target_px.y);
  } else {
    shared::ReflectionsTracePush push{};
    push.at = surfaces_of(commands, out.reflected);
    push.colors = commands.sampled(out.colors);
    push.light = commands.storage(out.noisy ? out.noisy : out.reflected.light);
    push.texels = texels_of(knobs, scene);
    push.subsample_ndc = scene.subsample_ndc();
    push.colors_px = size;
    push.last_level = float(levels(scene) - 1);
    push.samples = int(samples_of(knobs, in));
    push.steps = knobs.steps;
    push.thickness = knobs.thickness;
    push.fade = knobs.fade;
    push.roughest = knobs.roughest;
    push.first = in.scene.subsample(), push.of = in.scene.subsamples;
    push.pattern = {in.seed & 3u, in.seed >> 2 & 3u};
    commands.bind(out.pipelines.trace);
    commands.push(push);
    commands.dispatch(push.texels.x, push.texels.y);
  }
}

void Reflections::record_rays(CommandList& commands, const In& in, const Out& out) const {
  const Reflected& r = out.reflected;
  const glm::uvec2 texels = texels_of(knobs, in.scene);
  OwnInputs own;
  own.word =
      REFLECTIONS_IMAGES(uint64_t(commands.sampled(r.z)), uint64_t(commands.sampled(r.surface)),
                         uint64_t(commands.sampled(r.reflectance)),
                         uint64_t(commands.storage(out.noisy ? out.noisy : r.light))) |
      REFLECTIONS_SAMPLES(uint64_t(samples_of(knobs, in)), uint64_t(in.scene.subsamples), uint64_t(in.seed & 15u));
  own.number = std::bit_cast<uint32_t>(knobs.roughest);
  own.deformed_before = in.scene.drawn_items;
  commands.bind(out.pipelines.trace);
  commands.push(draw_push(commands, in.scene, in.deformed, &in.met, &in.met, own));
  commands.dispatch(texels.x, texels.y);
}

ReflectionsOver::Out ReflectionsOver::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  if (!in.whole) {
    out.pipeline = declare_reflected(builder, in.scene, in.reflected, in.depth.image, {color_format});
    out.color = builder.write(in.color, Access::color_attachment);
    return out;
  }
  const Reflected& r = in.reflected;
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  read_depth(builder, in.depth);
  for (const ImageHandle image : {r.light, r.z, r.surface, r.reflectance, r.sky})
    builder.read(image, Access::sampled_compute, "reflections");
  ComputePipelineDesc desc{with_depth("reflections_over.comp", in.depth), {}};
  if (r.texel_px != 1) desc.constants.push_back({0, "SIDE", r.texel_px});
  if (in.scene.samples != 1) desc.constants.push_back({1, "SAMPLES", in.scene.samples});
  out.pipeline = builder.pipeline(desc);
  out.color = builder.write(in.color, Access::storage_image_read_write);
  return out;
}

void ReflectionsOver::record(CommandList& commands, const In& in, const Out& out) const {
  if (!in.whole) {
    const CommandList::Attachment color{out.color};
    commands.begin_picture({&color, 1}, {});
    record_reflected(commands, in.scene, in.reflected, in.depth.image, out.pipeline);
    commands.end_rendering();
    return;
  }
  shared::ReflectionsOverWholePush push{};
  push.at = surfaces_of(commands, in.reflected);
  push.light = commands.sampled(in.reflected.light);
  push.color = commands.storage(out.color);
  push.texels = commands.size(in.reflected.light);
  push.subsample_ndc = in.scene.subsample_ndc();
  push_depth(commands, in.depth, push);
  commands.bind(out.pipeline);
  commands.push(push);
  commands.dispatch_picture(in.scene.width_px, in.scene.height_px);
}

}  // namespace candela
