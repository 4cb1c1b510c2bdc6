// Pictures with a shutter and a lens: the mean of several frames, against closed forms and the reference.
#include <cmath>
#include <numbers>

#include "frame_fixture.h"
#include "render/traced_frames.h"

namespace candela::test {

class FrameShutter : public FrameTest {
 protected:
  static constexpr int side = 48;  // of the pictures
  // A white unlit square of side 1 in the plane z = 0 that moves along x at so many metres a second, seen by an
  // orthographic-like distant camera: 8 m of the plane are the picture's width.
  static std::string mover(double speed_m_s, bool cut = false) {
    GltfBuilder b = empty_scene();
    b.use("KHR_materials_unlit");
    Json white = {{"extensions", {{"KHR_materials_unlit", Json::object()}}}, {"doubleSided", true}};
    const int square = add_square_mesh(b, 0.5f, add_material(b, white));
    add_node(b, {{"mesh", square}});
    b.json["cameras"] = {
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 4.0}, {"ymag", 4.0}, {"znear", 0.1}, {"zfar", 20.0}}}}};
    add_node(b, {{"camera", 0}, {"translation", {0, 0, 5}}});
    const float v = float(speed_m_s);
    const int times = b.accessor<float>("SCALAR", {0, 2}), places = b.accessor<float>("VEC3", {-v, 0, 0, v, 0, 0});
    Json samplers = {{{"input", times}, {"output", places}}},
         channels = {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}};
    if (cut) {
      const int keys = b.accessor<float>("SCALAR", {0, 1}), eyes = b.accessor<float>("VEC3", {0, 0, 5, 100, 0, 5});
      samplers.push_back({{"input", keys}, {"output", eyes}, {"interpolation", "STEP"}});
      channels.push_back({{"sampler", 1}, {"target", {{"node", 1}, {"path", "translation"}}}});
    }
    b.json["animations"] = {{{"samplers", samplers}, {"channels", channels}}};
    return write(b);
  }
  static Job picture(const std::string& path, double shutter_s, int subframes) {
    Job job = job_for(path, side, side, 1);
    job.exr_float = true;
    job.shutter_s = shutter_s;
    job.settings = {{"subframes", "n", std::to_string(subframes)}};
    return job;
  }
  static std::vector<glm::vec4> beauty(const Job& job, double time_s) {
    return images_of(job, {}, time_s)["beauty"].values<glm::vec4>();
  }
  // The part of a pixel and of the time from 1 - shutter / 2 to 1 + shutter / 2 that the mover covers.
  static double covered(int x, int y, double speed_m_s, double shutter_s) {
    const double pixel_m = 8.0 / side;
    const auto part = [&](double middle, double from, double to) {
      return std::clamp(std::min(to, middle + 0.5) - std::max(from, middle - 0.5), 0.0, pixel_m) / pixel_m;
    };
    const double left = -4 + x * pixel_m, top = 4 - y * pixel_m;
    double sum = 0;
    constexpr int moments = 4000;
    for (int i = 0; i < moments; ++i)
      sum += part(speed_m_s * shutter_s * ((i + 0.5) / moments - 0.5), left, left + pixel_m) / moments;
    return sum * part(0, top - pixel_m, top);
  }
};

// The mean tends to the closed form: a square that moves covers each pixel for a part of the time. More frames, less
// error, and light is kept.
TEST_F(FrameShutter, AMovingSquareIsCoveredForItsTime) {
  const double speed = 6, shutter = 0.25;
  const std::string path = mover(speed);
  double before = 1;
  for (const int n : {4, 16, 64}) {
    const std::vector<glm::vec4> seen = beauty(picture(path, shutter, n), 1);
    double squares = 0, light = 0, wanted = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double truth = covered(x, y, speed, shutter), value = double(seen[size_t(y * side + x)].x);
        squares += (value - truth) * (value - truth), light += value, wanted += truth;
      }
    const double rmse = std::sqrt(squares) / side;
    EXPECT_LT(rmse, 0.45 * before) << n;
    EXPECT_NEAR(light / wanted, 1, 0.6 / n) << n;
    before = rmse;
  }
  EXPECT_LT(before, 0.005);
}

// What stands still is the same picture under any shutter, but for where samples lie: a whole square of pixels is
// white, and nothing gets darker or brighter.
TEST_F(FrameShutter, AShutterChangesNoExposure) {
  const std::string path = mover(0);
  const std::vector<glm::vec4> still = beauty(picture(path, 0.04, 8), 1);
  Job lens = picture(path, 0, 8);
  lens.shutter_s.reset(), lens.f_stop = 1.4, lens.focus = "5";
  Job instant = job_for(path, side, side, 1);
  instant.exr_float = true;
  const glm::vec4 middle = beauty(instant, 1)[size_t(side / 2 * side + side / 2)];
  EXPECT_GT(middle.x, 0.9f);
  EXPECT_EQ(still[size_t(side / 2 * side + side / 2)], middle);
  EXPECT_EQ(beauty(lens, 1)[size_t(side / 2 * side + side / 2)], middle);
}

// The picture is the same whether it is rendered alone or among others, and others may be begun before it is finished.
TEST_F(FrameShutter, TheSameBytesHoweverItIsReached) {
  const Job job = picture(mover(3), 0.1, 4);
  const auto session = open(job);
  ASSERT_TRUE(session);
  const Images first = images(render(*session, 0.5));
  const auto a = session->begin(1.0), b = session->begin(0.5);
  ASSERT_TRUE(a && b);
  auto of_a = session->finish(*a), of_b = session->finish(*b);
  ASSERT_TRUE(of_a && of_b);
  EXPECT_EQ(images(*of_b), first);
  EXPECT_NE(images(*of_a), first);
  EXPECT_EQ(images_of(job, {}, 1.0), images(*of_a));
}

// A camera that jumps at 1 s: before it the square is seen, from then on nothing, and never a mixture.
TEST_F(FrameShutter, NothingIsMixedOverACut) {
  const Job job = picture(mover(0, true), 0.2, 4);
  const size_t middle = size_t(side / 2 * side + side / 2);
  EXPECT_EQ(beauty(job, 0.95)[middle].w, 1.0f);
  EXPECT_EQ(beauty(job, 1.0)[middle].w, 0.0f);
  EXPECT_EQ(beauty(job, 1.05)[middle].w, 0.0f);
}

// The cheap level: one frame, gathered along the motion. Its error against the closed form is larger than that of as
// many samples of time, and no light is lost; where nothing moves no pixel changes.
TEST_F(FrameShutter, OneFrameIsGatheredAlongItsMotion) {
  const double speed = 48, shutter = 1.0 / 24;  // 12 pixels
  const auto rmse_of = [&](const std::vector<glm::vec4>& seen) {
    double squares = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        squares += std::pow(double(seen[size_t(y * side + x)].x) - covered(x, y, speed, shutter), 2);
    return std::sqrt(squares) / side;
  };
  const std::string path = mover(speed);
  Job job = picture(path, shutter, 16);
  job.settings = {{"subframes", "gather", "1"}, {"motion_blur", "samples", "64"}};
  const auto session = open(job);
  const FrameResult frame = render(*session, 1);
  const double gathered = rmse_of(images(frame)["beauty"].values<glm::vec4>());
  EXPECT_TRUE(std::ranges::any_of(frame.plan->passes, [](const PlanPass& p) { return p.name == "motion_blur"; }));
  Job sharp = job;
  sharp.shutter_s.reset();
  const double still = rmse_of(beauty(sharp, 1));
  EXPECT_LT(gathered, 0.1 * still);
  job.scene = mover(0), sharp.scene = job.scene;
  EXPECT_EQ(beauty(job, 1), beauty(sharp, 1));
}

// Edges by their shape: nearer to 64 samples a pixel than the one sample is, and longer ends looked for are no worse.
TEST_F(FrameShutter, EdgesAreSmoothedByTheirShape) {
  GltfBuilder b = empty_scene();
  const int square = add_square_mesh(b, 0.7f, add_material(b, unlit_material(1, 1, 1)));
  b.use("KHR_materials_unlit");
  const double turn = 0.11;
  add_node(b, {{"mesh", square}, {"rotation", {0, 0, std::sin(turn / 2), std::cos(turn / 2)}}});
  Job job = job_for(write(b), side, side, 1);
  look(job, {0, 0, 3}, {0, 0, 0}, 45);
  job.exr_float = true;
  Job truth = job;
  truth.settings = {{"supersample", "n", "8"}};
  const std::vector<glm::vec4> wanted = beauty(truth, 0);
  const auto rmse = [&](int reach_px, const char* method = "shape") {
    job.settings = {{"smooth_edges", "reach_px", std::to_string(reach_px)}, {"smooth_edges", "method", method}};
    const std::vector<glm::vec4> seen = beauty(job, 0);
    double squares = 0;
    for (size_t i = 0; i < seen.size(); ++i) squares += std::pow(double(seen[i].x - wanted[i].x), 2);
    return std::sqrt(squares) / side;
  };
  const double jagged = rmse(0), near = rmse(4), far = rmse(32);
  EXPECT_LT(near, 0.6 * jagged);
  EXPECT_LT(far, 0.35 * jagged);
  EXPECT_LE(far, near);
  // The simpler method, which is nearer than nothing and not as near as lines.
  const double by_contrast = rmse(4, "contrast");
  EXPECT_LT(by_contrast, 0.75 * jagged);
  EXPECT_GT(by_contrast, far);
}

// Without shutter and lens the plan has none of it, and is that of a job that knows nothing of them.
TEST_F(FrameShutter, IsLeftOutWithoutShutterAndLens) {
  Job job = job_for(mover(1), side, side, 1);
  const auto session = open(job);
  const FrameResult plain = render(*session, 1);
  for (const PlanPass& pass : plain.plan->passes) EXPECT_FALSE(pass.name.starts_with("subframes")) << pass.name;
  EXPECT_TRUE(std::ranges::any_of(plain.plan->left_out, [](const LeftOut& p) {
    return p.pass == "subframes" && p.reason.find("--shutter") != std::string::npos;
  }));
  job.shutter_s = 0;
  EXPECT_EQ(render(*open(job), 1).plan_hash, plain.plan_hash);
}

// A small bright square far behind the plane of focus becomes the disc of the lens, whose radius similar triangles
// give: no light is lost, and the frames' mean tends to the reference's, every technique alike.
TEST_F(FrameShutter, ALensBlursAsTheReferenceDoes) {
  GltfBuilder b = empty_scene();
  b.use("KHR_materials_unlit");
  Json white = {{"extensions", {{"KHR_materials_unlit", Json::object()}}}, {"doubleSided", true}};
  const int square = add_square_mesh(b, 0.15f, add_material(b, white));
  add_node(b, {{"mesh", square}, {"translation", {-0.6, 0, 2}}});
  add_node(b, {{"mesh", square}, {"translation", {1.2, 0.5, -4}}});
  Job job = job_for(write(b), side, side, 1);
  look(job, {0, 0, 5}, {0, 0, 0}, 50);
  job.exr_float = true;
  job.f_stop = 0.08, job.focus = "3", job.sensor_mm = 24;  // an opening of 0.32 m
  auto loaded = open_reference(job, 0, {});
  ASSERT_TRUE(loaded) << loaded.error().text();
  reference::TraceSettings settings;
  settings.sampler = {reference::SamplerKind::sobol, 256};
  reference::Film film(side, side, {});
  film.add(reference::Integrator(*(*loaded)->world, settings, side, side), 256, [](double) { return true; });
  double total = 0;
  for (size_t i = 0; i < film.pixels(); ++i) total += film.mean(i).x;
  double before = 1;
  for (const int n : {16, 64, 256}) {
    job.settings = {{"subframes", "n", std::to_string(n)}};
    const std::vector<glm::vec4> seen = beauty(job, 0);
    double squares = 0, light = 0;
    for (size_t i = 0; i < film.pixels(); ++i)
      squares += std::pow(double(seen[i].x) - film.mean(i).x, 2), light += double(seen[i].x);
    const double rmse = std::sqrt(squares) / side;
    EXPECT_LT(rmse, 0.6 * before) << n;
    EXPECT_NEAR(light / total, 1, 0.01) << n;
    before = rmse;
  }
  EXPECT_LT(before, 0.006);
  job.settings = {{"subframes", "n", "8"}};
  const std::vector<glm::vec4> clustered = beauty(job, 0);
  for (const char* technique : {"visibility", "ray", "deferred-clustered", "forward-plus"}) {
    job.technique = technique;
    const std::vector<glm::vec4> other = beauty(job, 0);
    double most = 0;
    for (size_t i = 0; i < other.size(); ++i) most = std::max(most, double(std::abs(other[i].x - clustered[i].x)));
    EXPECT_LT(most, 0.13) << technique;  // an edge's sample of one of eight frames
  }
}

// Terms of beauty are means as it is, and sum to it; depth is of the picture's own time.
TEST_F(FrameShutter, LayersOfLightAreMeans) {
  GltfBuilder b = empty_scene();
  const int floor = add_square_mesh(b, 3, add_material(b, diffuse_material(0.7, 0.6, 0.5)));
  add_node(b, {{"mesh", floor}});
  add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {0, 0, 1}}});
  const int times = b.accessor<float>("SCALAR", {0, 2}), places = b.accessor<float>("VEC3", {-2, 0, 1, 2, 0, 1});
  const int lamp = int(b.json["nodes"].size()) - 1;
  b.json["animations"] = {{{"samplers", {{{"input", times}, {"output", places}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", lamp}, {"path", "translation"}}}}}}}};
  Job job = job_for(write(b), side, side, 1);
  look(job, {0, -1, 5}, {0, 0, 0}, 60);
  job.exr_float = true, job.effects = "none";
  job.shutter_s = 1, job.settings = {{"subframes", "n", "4"}};
  job.layers = {"direct_point", "depth", "background", "emission", "ambient_diffuse", "ambient_specular"};
  const Images seen = images_of(job, {}, 1);
  const auto beauty = seen["beauty"].values<glm::vec4>(), direct = seen["direct_point"].values<glm::vec4>();
  Job instant = job;
  instant.shutter_s.reset();
  const Images sharp = images_of(instant, {}, 1);
  EXPECT_EQ(seen["depth"], sharp["depth"]);
  double apart = 0;
  for (size_t i = 0; i < beauty.size(); ++i) {
    EXPECT_NEAR(beauty[i].x, direct[i].x, 2e-5f * beauty[i].x + 1e-6f);
    apart = std::max(apart, double(std::abs(beauty[i].x - sharp["beauty"].values<glm::vec4>()[i].x)));
  }
  EXPECT_GT(apart, 0.05);
}

// What comes into the picture while the shutter is open is in none of its first frames: their sums, of terms too, begin
// with nothing, and not with what memory held.
TEST_F(FrameShutter, WhatComesIntoThePictureBeginsWithNothing) {
  GltfBuilder b = empty_scene();
  b.use("KHR_materials_unlit");
  Json white = unlit_material(1, 1, 1);
  white["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 0.5f, add_material(b, white))}});
  const int times = b.accessor<float>("SCALAR", {0, 1, 2}),
            places = b.accessor<float>("VEC3", {0, 0, 1000, 0, 0, 0, 0, 0, 0});
  b.json["animations"] = {{{"samplers", {{{"input", times}, {"output", places}, {"interpolation", "STEP"}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  Job job = picture(write(b), 1, 4);
  look(job, {0, 0, 5}, {0, 0, 0}, 20);
  job.layers = {"emission", "background", "direct_point"};
  const size_t middle = size_t(side / 2 * side + side / 2);
  const auto session = open(job);
  ASSERT_TRUE(session);
  for (int round = 0; round < 2; ++round) {
    const Images seen = images(render(*session, 1));
    for (const char* layer : {"beauty", "emission"})
      EXPECT_EQ(seen[layer].values<glm::vec4>()[middle].x, 0.5f) << layer;
    for (const Image& image : seen)
      for (const float v : image.values<float>()) ASSERT_TRUE(v >= 0 && v <= 1) << image.layer;
    images(render(*session, 1.9));  // all of it is seen: its buffers hold other sums
  }
}

// The reference spreads its samples over the moments of the shutter: the same blur, and the same bytes after a pause.
TEST_F(FrameShutter, TheReferenceHasAShutterToo) {
  const double speed = 6, shutter = 0.25;
  const Job job = picture(mover(speed), shutter, 64);
  TraceRequest request;
  request.stop.spp = 128;
  request.settings.sampler = {reference::SamplerKind::sobol, 128};
  const auto frame = open_reference(job, 1, {});
  ASSERT_TRUE(frame);
  const auto traced = [&](uint64_t pause) {
    auto moments = TracedMoments::open(**frame, job, request);
    EXPECT_TRUE(moments);
    reference::Film film(side, side, {});
    for (const uint64_t spp : {pause, request.stop.spp})
      reference::refine(
          film, [&](uint64_t sample) { return moments->at(sample); }, {.spp = spp},
          [](const reference::Progress&) { return true; });
    return film;
  };
  const reference::Film film = traced(128), paused = traced(37);
  double squares = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const size_t i = size_t(y * side + x);
      squares += std::pow(film.mean(i).x - covered(x, y, speed, shutter), 2);
      EXPECT_EQ(film.mean(i), paused.mean(i));
    }
  EXPECT_LT(std::sqrt(squares) / side, 0.006);
  request.stop.spp = 0;
  EXPECT_FALSE(TracedMoments::open(**frame, job, request)) << "samples are shared out: their number must be known";
}

}  // namespace candela::test
