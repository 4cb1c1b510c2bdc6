#include "base/rng.h"
#include "frame_fixture.h"
#include "gpu_fixture.h"

// The deferred techniques against brute-force: the same bits from a G-buffer of floats, stated errors from packed ones.
namespace candela::test {
namespace {

class FrameDeferred : public FrameTest {
 protected:
  static Json at(glm::dvec3 p) { return {{"translation", {p.x, p.y, p.z}}}; }
  // Slanted squares of several roughness, metals and dielectrics, one emissive, one unlit, one masked to nothing but an
  // edge, under a sun, points and a spot, all with ends among them.
  static GltfBuilder stage() {
    GltfBuilder b = empty_scene();
    Rng rng(11);
    for (int i = 0; i < 12; ++i) {
      Json pbr = base_color(rng.uniform(0.02, 1), rng.uniform(0.02, 1), rng.uniform(0.02, 1));
      pbr["roughnessFactor"] = rng.uniform(0.15, 1), pbr["metallicFactor"] = i % 3 == 0 ? rng.uniform(0, 1) : 0.0;
      Json material = {{"pbrMetallicRoughness", pbr}, {"doubleSided", true}};
      if (i == 4) material["emissiveFactor"] = {0.4, 0.2, 0.05};
      if (i == 7) material["extensions"]["KHR_materials_unlit"] = Json::object();
      const double turn = rng.uniform(-1, 1), x = -1.5 + 0.5 * (i % 6), y = -0.6 + 1.1 * (i / 6);
      add_node(b, {{"mesh", add_square_mesh(b, 0.45f, add_material(b, material))},
                   {"translation", {x, y, rng.uniform(-0.6, 0.2)}},
                   {"rotation", {std::sin(turn / 2) * 0.6, std::sin(turn / 2) * 0.8, 0, std::cos(turn / 2)}}});
    }
    add_light(b, {{"type", "directional"}, {"intensity", 1.5}}, {{"rotation", {-0.3, 0.2, 0, 0.93}}});
    for (int i = 0; i < 24; ++i)
      add_light(b, {{"type", "point"}, {"intensity", 0.4}, {"range", rng.uniform(0.3, 1.5)}},
                at({rng.uniform(-2, 2), rng.uniform(-1.2, 1.2), rng.uniform(-0.4, 0.9)}));
    for (int i = 0; i < 6; ++i) {
      Json node = at({rng.uniform(-1.5, 1.5), rng.uniform(-1, 1), 1.2});
      node["rotation"] = rotation_between({0, 0, -1}, {rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), -1});
      add_light(b,
                {{"type", "spot"},
                 {"intensity", 3},
                 {"range", 2.5},
                 {"spot", {{"outerConeAngle", i < 3 ? 0.3 : 1.3}, {"innerConeAngle", 0.1}}}},
                node);
    }
    return b;
  }
  static Job job_of(const std::filesystem::path& path, const std::string& technique, int samples) {
    Job job = job_for(path, 96, 64, samples);
    job.technique = technique;
    job.settings = {{"lights", "few", "0"}};
    return job;
  }
  static Job staged(const std::string& technique, int samples) {
    Job job = job_of(write(stage()), technique, samples);
    look(job, {0.2, 0.3, 2.6}, {0, 0, 0});
    return job;
  }
  static size_t differing(const Image& a, const Image& b) {
    const auto x = a.values<glm::uvec4>(), y = b.values<glm::uvec4>();
    size_t count = x.size() != y.size();
    for (size_t i = 0; i < std::min(x.size(), y.size()); ++i) count += x[i] != y[i];
    return count;
  }
  // Of all channels: the root of the mean square over the mean, and the largest over it.
  struct Error {
    double rmse = 0, most = 0;
  };
  static Error error(const Image& truth, const Image& image) {
    const auto t = truth.values<glm::vec4>(), i = image.values<glm::vec4>();
    double squares = 0, most = 0, sum = 0;
    for (size_t p = 0; p < t.size(); ++p)
      for (int c = 0; c < 3; ++c) {
        const double off = double(i[p][c]) - double(t[p][c]);
        squares += off * off, most = std::max(most, std::abs(off)), sum += double(t[p][c]);
      }
    const double n = double(3 * t.size());
    return {std::sqrt(squares / n) / (sum / n), most / (sum / n)};
  }
  static void expect_same(Job job, std::initializer_list<const char*> techniques = {"deferred-clustered"}) {
    job.technique = "brute-force";
    const Images expected = images_of(job);
    size_t lit = 0;
    for (const glm::vec4& p : expected["beauty"].values<glm::vec4>()) lit += p.x + p.y + p.z > 0;
    EXPECT_GT(lit, 100u) << "nothing is seen";
    for (const char* technique : techniques) {
      job.technique = technique;
      EXPECT_EQ(differing(expected["beauty"], images_of(job)["beauty"]), 0u) << technique << ", " << job.samples;
    }
  }
};

TEST_F(FrameDeferred, FloatsAreBruteForceBitForBit) {
  for (const int samples : {1, 4}) expect_same(staged("", samples), {"deferred-clustered", "deferred-tiled"});
}

// Lines and points, masks, glass and blended surfaces, skins, lobes, all under their default effects.
TEST_F(FrameDeferred, EverySceneIsBruteForces) {
  for (const char* name : {"primitive-modes", "alpha", "skinned", "lobes"}) {
    SCOPED_TRACE(name);
    Job job = job_of(scene(name), "", 4);
    job.width_px = 48, job.height_px = 32;
    expect_same(job);
  }
}

TEST_F(FrameDeferred, SupersampledFoggedAndShadowedItIsBruteForces) {
  Job job = staged("", 1);
  job.look = look_file(R"({"fog": {"extinction": 0.2, "albedo": 0.9}})");
  job.settings.push_back({"supersample", "n", "2"});
  expect_same(job);
}

// A scene whose only surface lets light through has no G-buffer.
TEST_F(FrameDeferred, NothingOpaqueNeedsNoGBuffer) {
  GltfBuilder b = empty_scene();
  Json pane = {{"pbrMetallicRoughness", base_color(0.5, 0.7, 0.9, 0.4)}, {"alphaMode", "BLEND"}};
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, pane))}, {"translation", {0, 0, 0}}});
  add_light(b, {{"type", "point"}, {"intensity", 5}}, at({0, 0, 1}));
  Job job = job_of(write(b), "", 4);
  look(job, {0.2, 0.3, 2.6}, {0, 0, 0});
  expect_same(job, {"deferred-clustered", "deferred-volumes"});
}

// A wall of rough metals and dielectrics that fills the picture, under lamps within 60 degrees of its normal: without
// outlines, shadows and mirrors nothing but the steps of a format comes between, and their first order bounds a pixel's
// error on every device. GGX changes by at most 6 dr/r with roughness, which is 3 d ln(alpha), and by 2 dt/alpha with
// an angle t.
TEST_F(FrameDeferred, PackedFormatsAreWrongByNoMoreThanTheirSteps) {
  constexpr double least_base = 0.2, least_roughness = 0.5, most_roughness = 0.8;
  GltfBuilder b = empty_scene();
  Rng rng(7);
  for (int i = 0; i < 24; ++i) {
    Json pbr = base_color(rng.uniform(least_base, 0.9), rng.uniform(least_base, 0.9), rng.uniform(least_base, 0.9));
    pbr["roughnessFactor"] = rng.uniform(least_roughness, most_roughness), pbr["metallicFactor"] = i % 2;
    add_node(b, {{"mesh", add_square_mesh(b, 0.5f, add_material(b, {{"pbrMetallicRoughness", pbr}}))},
                 {"translation", {i % 6 - 2.5, i / 6 - 1.5, 0}}});
  }
  for (int i = 0; i < 5; ++i)
    add_light(b, {{"type", "point"}, {"intensity", 3}}, at({0.5 * (i - 2), 0.4 * (i % 2), 2.5 + 0.1 * i}));
  const std::string wall = write(b);
  const auto half_step = [](int bits) { return 0.5 / double((1 << bits) - 1); };
  const double root_f0 = 2 * half_step(8) / 0.2, exponent = 2 / std::pow(most_roughness, 4) - 2;
  struct Format {
    const char* name;
    int samples;                       // those that do not hold where in its pixel a point is: at its middle alone
    double normal_deg, roughness, f0;  // the last two as shares of specular light
  };
  const double bits8 = 6 * half_step(8) / least_roughness;
  for (const Format& format :
       {Format{"packed", 1, 0.0038, bits8, root_f0}, Format{"packed", 4, 0.0038, bits8, root_f0},
        Format{"position", 4, glm::degrees(std::sqrt(3.0) / 1023), bits8, root_f0},
        Format{"bits128", 1, 0.12, 6 * half_step(6) / least_roughness, root_f0},
        Format{"specular", 1, 0.06, 3 * 0.5 * 0.5 / (exponent + 2), 2.4 * half_step(8) / (0.2209 + 0.055)}}) {
    Job job = job_of(wall, "brute-force", format.samples);
    job.effects = "none";
    look(job, {0, 0, 2.5}, {0, 0, 0});
    const Images truth = images_of(job);
    job.technique = "deferred-clustered";
    job.settings.push_back({"gbuffer", "format", format.name});
    const auto expected = truth["beauty"].values<glm::vec4>(), got = images_of(job)["beauty"].values<glm::vec4>();
    ASSERT_EQ(expected.size(), got.size());
    double most = 0, squares = 0;
    for (size_t p = 0; p < got.size(); ++p)
      for (int c = 0; c < 3; ++c) {
        ASSERT_GT(expected[p][c], 0.01f);
        const double off = double(got[p][c]) / double(expected[p][c]) - 1;
        most = std::max(most, std::abs(off)), squares += off * off;
      }
    const double angle = glm::radians(format.normal_deg);
    const double bound = 2.4 * half_step(8) / (0.4845 + 0.055) + std::tan(glm::radians(60.0)) * angle +
                         format.roughness + format.f0 + 2 * angle / (least_roughness * least_roughness);
    fmt::print("{}, {} samples: most {:.4f} of {:.4f}, root of the mean square {:.4f}\n", format.name, format.samples,
               most, bound, std::sqrt(squares / double(3 * got.size())));
    EXPECT_LE(most, bound) << format.name;
    EXPECT_GT(most, 0.1 * bound) << format.name << " is not in use";
  }
}

// Along the edges of triangles surfaces are shaded off the middle of the pixel: what is lit from there must not lie
// below its own plane. A sheet seen at a slant, of many triangles, that nothing else throws a shadow on.
TEST_F(FrameDeferred, PackedSurfacesDoNotShadowTheirOwnEdges) {
  GltfBuilder b = empty_scene();
  Json pbr = base_color(0.5, 0.5, 0.5);
  pbr["roughnessFactor"] = 1, pbr["metallicFactor"] = 0;
  const int mesh = add_square_mesh(b, 0.125f, add_material(b, {{"pbrMetallicRoughness", pbr}}));
  for (int i = 0; i < 256; ++i)
    add_node(b, {{"mesh", mesh}, {"translation", {0.25 * (i % 16) - 1.875, 0.25 * (i / 16) - 1.875, 0}}});
  add_light(b, {{"type", "directional"}, {"intensity", 3}},
            {{"rotation", rotation_between({0, 0, -1}, {0.5, 0.3, -1})}});
  Job job = job_of(write(b), "deferred-clustered", 4);
  look(job, {0, -1.2, 0.6}, {0, 0, 0});
  const auto expected = images_of(job)["beauty"].values<glm::vec4>();
  for (const char* format : {"specular", "bits128"}) {
    Job packed = job;
    packed.settings.push_back({"gbuffer", "format", format});
    const auto got = images_of(packed)["beauty"].values<glm::vec4>();
    ASSERT_EQ(got.size(), expected.size());
    double most = 0;
    for (size_t p = 0; p < got.size(); ++p)
      if (expected[p].w == 1) most = std::max(most, std::abs(double(got[p].x) / double(expected[p].x) - 1));
    fmt::print("{}: most {:.4f}\n", format, most);
    EXPECT_LE(most, 0.1) << format;
  }
}

// From outside of most volumes and from inside; with lists apart and the test of depth but for roundings.
TEST_F(FrameDeferred, VolumesAreBruteForceBitForBit) {
  const glm::dvec3 far(0.2, 0.3, 2.6), near(-0.6, 0.2, 0.7);
  for (const auto& [samples, eye] : {std::pair(1, near), {4, near}, {4, far}}) {
    Job job = staged("", samples);
    look(job, eye, {0, 0, 0});
    expect_same(job, {"deferred-volumes"});
  }
  Job job = staged("brute-force", 1);
  look(job, near, {0, 0, 0});
  const Images truth = images_of(job);
  job.technique = "deferred-volumes";
  job.settings.push_back({"light_volumes", "depth_test", "1"});
  const Error e = error(truth["beauty"], images_of(job)["beauty"]);
  fmt::print("tested: rmse {:.2e}, most {:.2e}\n", e.rmse, e.most);
  EXPECT_LE(e.most, 1e-4);
}

// Lamps just before a wall light it up to the ends of their ranges: a body that is no wider than its light loses that,
// as far as perspective does not make it wider.
TEST_F(FrameDeferred, VolumesHoldAllThatTheirLightsReach) {
  GltfBuilder b = empty_scene();
  const Json clay = {{"pbrMetallicRoughness", base_color(0.7, 0.6, 0.5)}, {"doubleSided", true}};
  add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, clay))}, {"translation", {0, 0, 0}}});
  for (int i = 0; i < 6; ++i) {
    add_light(b, {{"type", "point"}, {"intensity", 1}, {"range", 1.5}}, at({0.6 * i - 1.5, 0.5, 0.02}));
    add_light(b, {{"type", "spot"}, {"intensity", 5}, {"range", 1.6}, {"spot", {{"outerConeAngle", 0.3}}}},
              at({0.6 * i - 1.5, -0.5, 1.5}));
  }
  Job job = job_of(write(b), "", 1);
  look(job, {0.1, 0.2, 40}, {0, 0, 0}, 5);
  expect_same(job, {"deferred-volumes"});
}

// What keeps volumes from what they do not change: the same bytes, a stencil only where it is asked for.
TEST_F(FrameDeferred, GuardsOfVolumesChangeNoBit) {
  for (const auto& [format, samples] : {std::pair("float", 4), {"packed", 1}}) {
    Job job = staged("deferred-volumes", samples);
    look(job, {-0.6, 0.2, 0.7}, {0, 0, 0});
    job.settings.push_back({"gbuffer", "format", format});
    Images first;
    for (const char* guard : {"none", "reach", "stencil"}) {
      Job guarded = job;
      guarded.settings.push_back({"light_volumes", "guard", guard});
      const auto session = open(guarded);
      ASSERT_TRUE(session);
      const FrameResult result = render(*session);
      const bool marked = std::ranges::any_of(result.plan->resources,
                                              [](const PlanResource& r) { return r.name() == "light_volumes.marks"; });
      EXPECT_EQ(marked, std::string_view(guard) == "stencil");
      if (first.empty())
        first = images(result);
      else
        EXPECT_EQ(differing(first["beauty"], images(result)["beauty"]), 0u)
            << guard << ", " << format << ", " << samples;
    }
  }
}

// Whatever a format loses, both ways of lighting it lose the same.
TEST_F(FrameDeferred, EachFormatIsTheSameByListsAndByVolumes) {
  for (const char* format : {"specular", "bits128", "position"}) {
    Job job = staged("deferred-clustered", 4);
    job.width_px = 48, job.height_px = 32;
    job.settings.push_back({"gbuffer", "format", format});
    const Images by_lists = images_of(job);
    job.technique = "deferred-volumes";
    EXPECT_EQ(differing(by_lists["beauty"], images_of(job)["beauty"]), 0u) << format;
  }
}

// A lamp's volume holds its ball and lies in the ball about its icosahedron; a cone's lies in the cone's own outline,
// widened; what reaches everywhere, or is around the camera, covers every pixel.
TEST_F(FrameDeferred, TheLayerCountsTheVolumesThatCoverAPixel) {
  const auto counted = [](const GltfBuilder& b, int samples = 1) {
    Job job = job_of(write(b), "clustered", samples);
    look(job, {0, 0, 10}, {0, 0, 0});
    job.layers = {"debug_light_volumes"};
    return images_of(job)["debug_light_volumes"];
  };
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 0.01f, add_material(b, Json::object()))}, {"translation", {0, -3, 0}}});
  const auto lamp = [&](glm::dvec3 place, double range) {
    add_light(b, {{"type", "point"}, {"intensity", 1}, {"range", range}}, at(place));
  };
  lamp({-1, 0, 0}, 1);
  lamp({1, 0, 0}, 1.5);
  const Image two = counted(b, 4);
  ASSERT_EQ(two.pixels(), 96u * 64u);
  size_t both = 0;
  for (int y = 0; y < two.height; ++y)
    for (int x = 0; x < two.width; ++x) {
      // Where the ray through the pixel comes nearest to a lamp.
      const double tangent = std::tan(glm::radians(22.5));
      const glm::dvec3 eye(0, 0, 10), ray = glm::normalize(glm::dvec3((2 * (x + 0.5) / 96 - 1) * tangent * 1.5,
                                                                      (1 - 2 * (y + 0.5) / 64) * tangent, -1));
      double least = 0, most = 0;
      for (const auto& [place, range] : {std::pair(glm::dvec3(-1, 0, 0), 1.0), {glm::dvec3(1, 0, 0), 1.5}}) {
        const double distance = glm::length(glm::cross(place - eye, ray));
        least += distance < range, most += distance < 1.2585 * (range + 0.4);
      }
      const float count = two.at(x, y);
      EXPECT_GE(count, least) << x << ", " << y;
      EXPECT_LE(count, most) << x << ", " << y;
      both += count == 2;
    }
  EXPECT_GT(both, 10u);
  EXPECT_EQ(two.at(2, 2), 0);
  lamp({0, 0, 10}, 2);  // around the camera
  add_light(b, {{"type", "directional"}, {"intensity", 1}}, Json::object());
  lamp({0, 0, 100}, 2);  // behind it
  EXPECT_EQ(counted(b).at(2, 2), 2);
}

// Root of the mean square over the mean; measured on lavapipe, with a quarter on top.
TEST_F(FrameDeferred, SumsOfLightsAreAsExactAsTheirFormat) {
  struct Stated {
    const char* format;
    double rmse, least;
  };
  const Images truth = images_of(staged("brute-force", 1));
  for (const Stated& s : {Stated{"r11g11b10", 0.104, 1e-3}, Stated{"half", 0.0072, 1e-5}}) {
    Job job = staged("deferred-volumes", 1);
    job.settings.push_back({"light_volumes", "accumulator", s.format});
    const Error e = error(truth["beauty"], images_of(job)["beauty"]);
    fmt::print("{}: rmse {:.2e}, most {:.2e}\n", s.format, e.rmse, e.most);
    EXPECT_LE(e.rmse, s.rmse) << s.format;
    EXPECT_GE(e.rmse, s.least) << s.format;
  }
}

TEST_F(FrameDeferred, EachFrameIsTheSameBytes) {
  for (const char* technique : {"deferred-tiled", "deferred-volumes"}) {
    const auto session = open(staged(technique, 4));
    ASSERT_TRUE(session);
    const Images first = images(render(*session));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(differing(first["beauty"], images(render(*session))["beauty"]), 0u);
  }
}

// Angles between random directions and what comes back of their bits (Cigolle et al. 2014).
class Octahedral : public gpu::test::GpuTest {};

TEST_F(Octahedral, AnglesAreThoseOfThePaper) {
  struct Stated {
    uint32_t bits;
    double mean_deg, most_deg;
  };
  Rng rng(5);
  std::vector<glm::vec3> directions;
  for (const float x : {-1.0f, 0.0f, 1.0f})
    for (const float y : {-1.0f, 0.0f, 1.0f})
      for (const float z : {-1.0f, 0.0f, 1.0f})
        if (x != 0 || y != 0 || z != 0) directions.push_back(glm::normalize(glm::vec3(x, y, z)));
  while (directions.size() < 100000) {
    const glm::dvec3 d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (glm::length(d) > 0.1 && glm::length(d) < 1) directions.emplace_back(glm::normalize(d));
  }
  const uint64_t bytes = directions.size() * sizeof(glm::vec3);
  gpu::Buffer source(*device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                     gpu::Buffer::Memory::upload, gpu::Device::Purpose::scene, "directions");
  std::memcpy(source.mapped(), directions.data(), bytes);
  for (const Stated& s : {Stated{16, 0.0014, 0.0038}, Stated{11, 0.043, 0.12}}) {
    GraphBuilder builder;
    const BufferHandle in = builder.import_buffer(BufferDesc{.name = "directions", .size_bytes = bytes});
    builder.begin_pass("octahedral");
    builder.read(in, Access::compute_read, "directions");
    BufferHandle out =
        builder.create(BufferDesc{.name = "decoded", .size_bytes = bytes, .memory = BufferMemory::host_read});
    out = builder.write(out, Access::compute_write);
    const PipelineHandle pipeline =
        builder.pipeline(ComputePipelineDesc{.shader = "octahedral.comp", .constants = {{0, "BITS", s.bits}}});
    struct Push {
      uint64_t from, to;
      uint32_t count, unused;
    };
    builder.end_pass([=, count = uint32_t(directions.size())](CommandList& commands) {
      commands.bind(pipeline);
      commands.push(Push{commands.address(in), commands.address(out), count, 0});
      commands.dispatch(count);
    });
    builder.sink(out);
    const gpu::FrameRun result = run(compile_graph(builder), {}, {{in.resource, &source}});
    ASSERT_TRUE(result.readbacks.contains(out.resource));
    const auto decoded = gpu::test::values_of<glm::vec3>(*result.readbacks.at(out.resource));
    double sum = 0, most = 0;
    for (size_t i = 0; i < decoded.size(); ++i) {
      const glm::dvec3 a(directions[i]), b(decoded[i]);
      const double angle = glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
      sum += angle, most = std::max(most, angle);
    }
    fmt::print("2x{} bits: mean {:.5f}, most {:.5f} degrees\n", s.bits, sum / double(decoded.size()), most);
    EXPECT_LE(sum / double(decoded.size()), s.mean_deg);
    EXPECT_LE(most, s.most_deg);
  }
}

}  // namespace
}  // namespace candela::test
