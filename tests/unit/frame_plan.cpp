#include <gtest/gtest.h>

#include "base/check.h"
#include "base/files.h"
#include "base/text.h"
#include "gltf/gltf.h"
#include "gltf_builder.h"
#include "job/frame_knobs.h"
#include "passes/shadows/lamp_knobs.h"
#include "plan/plan_frame.h"
#include "testscenes/make_scene.h"

namespace candela::test {
static bool mentions(const Notes& notes, const std::string& what) {
  return mentions(std::vector<std::string>(notes.begin(), notes.end()), what);
}
}  // namespace candela::test

namespace candela {
namespace {

Scene generated(const std::string& name) {
  const auto bytes = make_scene_bytes(name, 1, 0);
  EXPECT_TRUE(bytes) << bytes.error().text();
  auto scene = load_gltf_from_memory(*bytes, name + ".glb", "");
  EXPECT_TRUE(scene) << scene.error().text();
  return std::move(*scene);
}

Job small_job(int samples = 4) {
  Job job;
  job.width_px = 64;
  job.height_px = 36;
  job.samples = samples;
  return job;
}

PlannedFrame plan(const Scene& scene, const Job& job = small_job(), const WantedOutputs& wanted = {}) {
  auto planned = plan_frame(job, scene, wanted, 0);
  EXPECT_TRUE(planned) << planned.error().text();
  return planned ? std::move(*planned) : PlannedFrame{};
}

std::vector<std::string> kept(const PlannedFrame& frame) {
  std::vector<std::string> names;
  for (const PlanPass& pass : frame.graph().plan.passes) names.push_back(pass.name);
  return names;
}
bool has(const PlannedFrame& frame, const std::string& pass) {
  for (const PlanPass& kept : frame.graph().plan.passes)
    if (kept.pass() == pass || kept.name == pass) return true;
  return false;
}
std::string reason(const PlannedFrame& frame, const std::string& pass) {
  for (const LeftOut& left : frame.graph().plan.left_out)
    if (left.pass.substr(0, left.pass.find('.')) == pass) return left.reason;
  return {};
}
std::vector<std::string> outputs(const PlannedFrame& frame) {
  std::vector<std::string> names;
  for (const FrameOutput& o : frame.made->outputs) names.push_back(o.layer);
  return names;
}

using Names = std::vector<std::string>;

}  // namespace

TEST(Plan, AnUnlitBoxTakesNoLightAndNoSky) {
  const PlannedFrame frame = plan(generated("unlit-box"));
  EXPECT_EQ(kept(frame),
            (Names{"cull", "cull_compact", "depth_prepass", "shade_unlit", "background", "resolve", "readback"}));
  for (const char* pass : {"shade_forward", "sky", "transparent", "deform", "layers", "tonemap"})
    EXPECT_FALSE(reason(frame, pass).empty()) << pass;
  EXPECT_EQ(reason(frame, "shade_forward"), "the scene has no opaque or masked surface that takes light");
}

// Lobes are variants of the shaders that are lit, with what visible materials have of them; without any nothing is.
TEST(Plan, LobesCostNothingWhereNoMaterialHasThem) {
  const auto lobed = [](const PlannedFrame& frame) {
    return plan_text(frame.graph().plan).find("LOBE") != std::string::npos;
  };
  for (const char* name : {"spheres", "normal-mapped", "alpha", "unlit-box"})
    EXPECT_FALSE(lobed(plan(generated(name)))) << name;
  Scene scene = generated("lobes");
  const PlannedFrame frame = plan(scene);
  const std::string text = plan_text(frame.graph().plan);
  EXPECT_NE(text.find("shade_forward.frag#LOBED=1"), std::string::npos);
  EXPECT_NE(text.find("LOBES=47 LOBE_TEXTURES=47"), std::string::npos);
  EXPECT_NE(text.find("frame.lobes"), std::string::npos);
  for (Material& m : scene.materials)
    m.clearcoat = {}, m.sheen = {}, m.iridescence = {}, m.anisotropy = {}, m.diffuse_transmission = {};
  EXPECT_FALSE(lobed(plan(scene)));
  scene.materials[0].sheen.color = glm::vec3(1);
  EXPECT_NE(plan_text(plan(scene).graph().plan).find("LOBES=2"), std::string::npos);
  scene.materials[0].unlit = true;
  EXPECT_FALSE(lobed(plan(scene)));
}

// One pass a method, and the others say which one draws.
TEST(Plan, BlendedSurfacesAreDrawnByTheChosenMethod) {
  for (const std::string& method : transparency_names()) {
    Job job = small_job();
    job.transparency = method;
    const PlannedFrame frame = plan(generated("alpha"), job), without = plan(generated("unlit-box"), job);
    EXPECT_EQ(has(frame, "transparent"), method == "sorted") << method;
    EXPECT_EQ(has(frame, "weighted"), method == "weighted") << method;
    EXPECT_EQ(has(frame, "moments"), method == "moments") << method;
    EXPECT_EQ(has(frame, "fragments"), method == "layers") << method;
    if (method != "sorted")
      EXPECT_EQ(reason(frame, "transparent"), "blended surfaces are drawn by the method " + method);
    for (const char* pass : {"transparent", "weighted", "moments", "fragments"})
      EXPECT_EQ(reason(without, pass), "the scene has no blended surface") << method << " " << pass;
  }
  Job unknown = small_job();
  unknown.transparency = "weigthed";
  const auto refused = check_job(unknown);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("weighted"), std::string::npos) << refused.error().text();
}

// A knob changes the plan's hash whatever way its value takes to the shader, and its text shows it.
TEST(Plan, KnobsOfKeptPassesArePartOfIt) {
  const Scene scene = generated("spheres");
  Job off = small_job();
  off.settings = {{"cull", "enabled", "0"}};
  const FramePlan with = plan(scene).graph().plan, without = plan(scene, off).graph().plan;
  EXPECT_NE(plan_hash(with), plan_hash(without));
  EXPECT_NE(plan_text(without).find("cull.enabled"), std::string::npos);
  EXPECT_NE(plan_json(without).find("\"cull.enabled\": \"0\""), std::string::npos);
  // That of a pass which is left out does not: the work is the same.
  Job tiles = small_job();
  tiles.settings = {{"lights", "tile_px", "64"}};
  const Scene unlit = generated("unlit-box");
  EXPECT_EQ(plan_hash(plan(unlit, tiles).graph().plan), plan_hash(plan(unlit).graph().plan));
}

// A number, or the name of a value that may lie beyond the numbers.
TEST(Plan, AKnobTakesNamedValuesBesideNumbers) {
  const auto lights = [](const std::string& value) -> Expected<int> {
    Job job;
    job.settings = {{"local", "lights", value}};
    const auto knobs = frame_knobs(job);
    return knobs ? Expected<int>(knobs->get<LampKnobs>().lights) : std::unexpected(knobs.error());
  };
  EXPECT_EQ(lights("none").value_or(7), LampKnobs::none);
  EXPECT_EQ(lights("marked").value_or(7), LampKnobs::marked_alone);
  EXPECT_EQ(lights("12").value_or(7), 12);
  for (const char* wrong : {"-1", "some", "4097", "1.5", ""}) {
    ASSERT_FALSE(lights(wrong)) << wrong;
    EXPECT_EQ(lights(wrong).error().kind, ErrorKind::usage);
  }
  EXPECT_NE(lights("some").error().message.find("none, marked, or a number from 0 to 4096"), std::string::npos)
      << lights("some").error().message;
}

// What no pass draws is said once, where the scene would need it.
TEST(Plan, SaysWhatIsNotDrawnYet) {
  const auto said = [](const PlannedFrame& frame) {
    for (const std::string& note : frame.notes)
      if (note.starts_with("not drawn yet")) return note;
    return std::string();
  };
  EXPECT_EQ(said(plan(generated("unlit-box"))), "");
  EXPECT_EQ(said(plan(generated("street"))), "") << "there is no sky";
}

// What is missing says which pass would have made it, and why that was left out.
TEST(Plan, AnEmptyHandleCarriesItsReason) {
  const PlannedFrame frame = plan(generated("unlit-box"));
  EXPECT_EQ(reason(frame, "light_fill"), "the scene has no lights");
  const Scene blended = generated("alpha");
  EXPECT_FALSE(reason(plan(blended), "tile_depth").empty());
}

// Every pass of the table either runs or is left out for a reason that says something, in every scene.
TEST(Plan, EveryPassRunsOrSaysWhyNot) {
  for (const std::string_view name : scene_names()) {
    const Scene scene = generated(std::string(name));
    for (const int samples : {1, 4})
      for (const bool display : {false, true}) {
        const PlannedFrame frame = plan(scene, small_job(samples), {.linear = !display, .display = display});
        for (const std::string& pass : pass_names())
          EXPECT_TRUE(has(frame, pass) || !reason(frame, pass).empty()) << name << " " << pass;
        // Of a pass that stands there several times some may run and others not.
        for (const LeftOut& left : frame.graph().plan.left_out) {
          EXPECT_FALSE(left.reason.empty()) << left.pass;
          for (const std::string& runs : kept(frame)) EXPECT_NE(runs, left.pass) << name;
        }
      }
  }
}

// Maps and grids are no finer than the picture can show: fog and a sun took 89 MiB at 8x8.
TEST(Plan, ASmallPictureTakesLittle) {
  const Scene scene = generated("spheres");
  const std::string look = ::testing::TempDir() + "candela_small.look.json";
  ASSERT_TRUE(write_file_atomically(look, std::string_view(R"({"fog": {"extinction": 0.1}})")));
  Job job = small_job(1);
  job.look = look, job.quality = "high";
  const auto bytes = [&](int width, int height) {
    job.width_px = width, job.height_px = height;
    const PlannedFrame frame = plan(scene, job, {.linear = false, .display = true});
    EXPECT_TRUE(has(frame, "fog") && has(frame, "depth_views.sun") && has(frame, "depth_views.local"));
    uint64_t sum = 0;
    for (const uint64_t block : frame.graph().plan.block_bytes) sum += block;
    return sum;
  };
  EXPECT_LT(bytes(8, 8), 16u << 20);
  EXPECT_GT(bytes(640, 360), 80u << 20);
}

// By every technique, whether it has lists of lights or not.
TEST(Plan, EachStageTimesItself) {
  const Scene scene = generated("animated");
  for (const std::string& technique : technique_names()) {
    Job job = small_job(1);
    job.technique = technique;
    const PlannedFrame frame = plan(scene, job);
    std::vector<std::string> names;
    for (const auto& [name, ms] : frame.clock.stages()) {
      names.push_back(name);
      EXPECT_GE(ms, 0) << technique << " " << name;
    }
    EXPECT_EQ(joined(names), "animate, light_grid, sun_shadows, local_shadows, trees, plan") << technique;
  }
}

TEST(Plan, WhatIsNotWrittenIsNotReadBack) {
  const Scene scene = generated("spheres");
  const PlannedFrame png = plan(scene, small_job(), {.linear = false, .display = true});
  EXPECT_EQ(outputs(png), Names{"display"});
  EXPECT_TRUE(has(png, "tonemap"));
  const PlannedFrame exr = plan(scene, small_job(), {.linear = true, .display = false});
  EXPECT_EQ(outputs(exr), Names{"beauty"});
  EXPECT_FALSE(has(exr, "tonemap"));
  EXPECT_FALSE(reason(exr, "tonemap").empty());
  EXPECT_NE(plan_hash(png.graph().plan), plan_hash(exr.graph().plan));
}

TEST(Plan, SamplesThatAreOnlyShownAreNotResolved) {
  const Scene scene = generated("spheres");
  Job job = small_job();
  job.samples = 4;
  EXPECT_FALSE(has(plan(scene, job, {.linear = false, .display = true}), "resolve"));
  EXPECT_TRUE(has(plan(scene, job, {.linear = true, .display = true}), "resolve"));
  EXPECT_TRUE(has(plan(scene, job, {.linear = false, .display = true, .files = true}), "resolve"))
      << "pixels that are not finite are counted in the mean";
}

// Layers go into EXR alone; only those asked for have memory.
TEST(Plan, LayersAreMadeForLinearOutputsOnly) {
  Job job = small_job();
  job.layers = {"depth", "object_id"};
  const Scene scene = generated("spheres");
  EXPECT_EQ(outputs(plan(scene, job)), (Names{"beauty", "depth", "object_id"}));
  EXPECT_EQ(outputs(plan(scene, job, {.linear = false, .display = true})), Names{"display"});
  const PlannedFrame without = plan(scene);
  for (const PlanResource& r : without.graph().plan.resources)
    EXPECT_TRUE(r.first_pass < 0 || r.name().rfind("layers.", 0) != 0) << r.name();
}

// Terms of beauty have a pass and images of their own, of which a frame without them holds nothing; the passes of
// beauty are the same with them.
TEST(Plan, TermsCostNothingUnlessAskedFor) {
  const Scene scene = generated("spheres");
  const auto images = [](const PlannedFrame& frame) {
    Names names;
    for (const PlanResource& r : frame.graph().plan.resources)
      if (r.first_pass >= 0 && r.name().starts_with("terms.")) names.push_back(r.name());
    return names;
  };
  const PlannedFrame without = plan(scene);
  EXPECT_EQ(reason(without, "terms"), "no term of beauty is wanted (--layers)");
  EXPECT_EQ(images(without), Names{});
  for (const std::string& pass : kept(without)) EXPECT_EQ(pass.find("term"), std::string::npos) << pass;

  Job job = small_job();
  job.layers = {"direct_sun", "emission"};
  const PlannedFrame with = plan(scene, job);
  EXPECT_EQ(images(with), (Names{"terms.direct_sun", "terms.emission"}));
  EXPECT_EQ(outputs(with), (Names{"beauty", "direct_sun", "emission"}));
  Names expected = kept(without), of_beauty = kept(with);
  for (const char* pass : {"terms", "resolve.direct_sun", "resolve.emission"})
    EXPECT_EQ(std::erase(of_beauty, pass), 1u) << pass;
  std::ranges::sort(expected);
  std::ranges::sort(of_beauty);
  EXPECT_EQ(of_beauty, expected);
  // What lies behind everything is drawn again for its own term alone.
  EXPECT_FALSE(has(with, "background.term"));
  job.layers = {"background"};
  EXPECT_TRUE(has(plan(scene, job), "background.term"));

  // A supersampled frame divides each of its pictures, and says once that it does not.
  job.settings = {{"supersample", "n", "2"}};
  EXPECT_TRUE(has(plan(scene, job), "terms.s03"));
  job.layers.clear();
  const PlannedFrame alone = plan(scene, job);
  EXPECT_EQ(
      std::ranges::count_if(alone.graph().plan.left_out, [](const LeftOut& l) { return l.pass.starts_with("terms"); }),
      1);
}

TEST(Plan, OneSampleNeedsNoResolve) {
  const Scene scene = generated("spheres");
  const PlannedFrame one = plan(scene, small_job(1)), four = plan(scene, small_job(4));
  EXPECT_FALSE(has(one, "resolve"));
  EXPECT_TRUE(has(four, "resolve"));
  EXPECT_LT(transient_bytes(one.graph().plan), transient_bytes(four.graph().plan));
}

// A tile of a large picture needs the memory of the tile.
TEST(Plan, MemoryOfARegionIsInProportionToIt) {
  const Scene scene = generated("spheres");
  for (const char* technique : {"clustered", "deferred-tiled", "ray"})
    for (const auto& [width, height] : {std::pair(15360, 8640), {16384, 16384}}) {
      SCOPED_TRACE(technique);
      Job job = small_job(4);
      job.technique = technique, job.width_px = width, job.height_px = height;
      // What the frame needs whatever it shows: shadow maps, lists, and the border about a region.
      const auto bytes = [&](int side) {
        job.region = PixelRect{2048, 2048, side, side};
        return double(transient_bytes(plan(scene, job).graph().plan));
      };
      const double one = bytes(512), two = bytes(1024), four = bytes(2048);
      const double whole_frame = double(transient_bytes_whole(plan(scene, job).graph().plan));
      // Keys of a visibility buffer have memory for whole rows.
      if (std::string_view(technique) == "ray") {
        EXPECT_NEAR((four - two) / (two - one), 2, 1);
        EXPECT_LT(four, 0.25 * whole_frame);
      } else {
        EXPECT_NEAR((four - two) / (two - one), 4, 0.6);
        EXPECT_LT(four, 0.06 * whole_frame);
      }
      job.region.reset();
      const FramePlan whole = plan(scene, job).graph().plan;
      EXPECT_TRUE(std::ranges::none_of(whole.resources, [](const PlanResource& r) { return bool(r.resident); }));
      EXPECT_EQ(transient_bytes_whole(whole), transient_bytes(whole));
    }
}

TEST(Plan, OnlyBlendedSurfacesPlanATransparentPass) {
  EXPECT_FALSE(has(plan(generated("spheres")), "transparent"));
  EXPECT_TRUE(has(plan(generated("alpha")), "transparent"));
}

TEST(Plan, OnlyDeformedSurfacesPlanDeform) {
  EXPECT_FALSE(has(plan(generated("spheres")), "deform"));
  EXPECT_TRUE(has(plan(generated("skinned")), "deform"));
  EXPECT_TRUE(has(plan(generated("morph")), "deform"));
}

TEST(Plan, AnEmptySceneClearsAndNothingElse) {
  test::GltfBuilder b;
  b.json["nodes"] = {{{"name", "nothing"}}};
  const auto scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const PlannedFrame frame = plan(*scene, small_job(1));
  EXPECT_EQ(kept(frame), (Names{"background", "readback"}));
  EXPECT_FALSE(frame.notes.empty());
  EXPECT_EQ(kept(plan(*scene, small_job(4))), (Names{"background", "resolve", "readback"}));
}

Scene triangle_scene() {
  test::GltfBuilder b;
  test::Json& p = b.primitive({{"POSITION", b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                               {"NORMAL", b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1})}});
  p["mode"] = 4;
  auto scene = b.load();
  CHECK(scene);
  return std::move(*scene);
}

// The neutral light comes when nothing else lights the scene, says so, and needs something that it can light.
TEST(Plan, TheNeutralLightIsSaidAndOnlyWhereItIsSeen) {
  const PlannedFrame lit = plan(triangle_scene());
  EXPECT_TRUE(lit.request.neutral_light);
  EXPECT_TRUE(test::mentions(lit.notes, "neutral light"));
  EXPECT_FALSE(plan(generated("unlit-box")).request.neutral_light);
  EXPECT_FALSE(plan(generated("spheres")).request.neutral_light);
}

// --sky auto: a studio for files without light, decided for the file and not for what a time shows; it lights and is no
// background. Named skies, other lights and the bare frame leave it out.
TEST(Plan, TheStudioLightsFilesWithoutLight) {
  const auto with_sky = [](std::string_view sky, const char* effects = "auto") {
    Job job = small_job();
    job.sky = sky, job.effects = effects;
    return job;
  };
  const auto is_left_out = [](const PlannedFrame& frame, std::string_view pass) {
    return std::ranges::any_of(frame.graph().plan.left_out, [&](const LeftOut& l) { return l.pass == pass; });
  };
  const Scene dark = triangle_scene();
  const PlannedFrame studio = plan(dark, with_sky("auto"));
  EXPECT_TRUE(studio.sky.studio && studio.facts.environment && studio.facts.image_light);
  EXPECT_FALSE(studio.request.neutral_light);
  EXPECT_TRUE(test::mentions(studio.notes, "a studio lights it (--sky FILE, or none for no light)"));
  EXPECT_TRUE(studio.request.shows_through);
  EXPECT_TRUE(is_left_out(studio, "sky"));
  EXPECT_FALSE(is_left_out(studio, "background"));
  EXPECT_FALSE(test::mentions(plan(dark, with_sky("studio")).notes, "studio"));
  EXPECT_TRUE(plan(dark, with_sky("auto", "none")).request.neutral_light);
  EXPECT_TRUE(plan(dark, with_sky("neutral")).request.neutral_light);
  const PlannedFrame none = plan(dark, with_sky("none"));
  EXPECT_FALSE(none.request.neutral_light || none.facts.environment || none.facts.lights() > 0);

  Scene faded = generated("spheres");
  for (Light& light : faded.lights) light.intensity = 0;
  EXPECT_FALSE(plan(faded, with_sky("auto")).facts.environment);
  EXPECT_TRUE(plan(faded, with_sky("studio")).sky.studio);
  EXPECT_FALSE(plan(generated("unlit-box"), with_sky("auto")).facts.environment);
}

// A lamp that is dark at this time is a dark lamp, not a file without light: no flash in the middle of a fade.
TEST(Plan, ADarkLightDoesNotBringTheNeutralOne) {
  Scene scene = generated("spheres");
  for (Light& light : scene.lights) light.intensity = 0;
  const PlannedFrame dark = plan(scene);
  EXPECT_EQ(dark.facts.lights(), 0u);
  EXPECT_FALSE(dark.request.neutral_light);
}

TEST(Plan, TheSameJobGivesTheSamePlan) {
  const Scene scene = generated("alpha");
  EXPECT_EQ(plan_hash(plan(scene).graph().plan), plan_hash(plan(scene).graph().plan));
  Job other = small_job();
  other.width_px = 65;
  EXPECT_NE(plan_hash(plan(scene).graph().plan), plan_hash(plan(scene, other).graph().plan));
}

}  // namespace candela
