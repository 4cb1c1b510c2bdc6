// Reflection probes in whole frames: mirrors see where their rays meet the box, how weights fall and which box goes
// before which, against the traced layers, and what stays as it is.
#include <fmt/ranges.h>

#include <numbers>

#include "frame_fixture.h"
#include "passes/surfaces/terms.h"
#include "render/reference_frame.h"

namespace candela::test::frame_probes {
namespace {

constexpr int width = 96, height = 64;
constexpr glm::dvec3 low(-3, 0, -4), high(3, 3, 4);
constexpr double ball_radius = 0.7;
constexpr glm::dvec3 ball_at(0.3, 1.2, -0.5), eye(0.5, 1.5, 3.5);

// The colour of a point of the room's walls.
glm::dvec3 colour_at(glm::dvec3 p) { return 0.1 + 0.8 * (p - low) / (high - low); }

Json metal(double roughness) {
  Json m = {{"pbrMetallicRoughness", base_color(1, 1, 1)}};
  m["pbrMetallicRoughness"]["metallicFactor"] = 1;
  m["pbrMetallicRoughness"]["roughnessFactor"] = roughness;
  return m;
}

// Unlit, from inside, in the colours of colour_at().
void add_walls(GltfBuilder& b) {
  std::vector<float> position, color;
  std::vector<uint16_t> index;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool far : {false, true}) {
      glm::dvec3 corner = low, u(0), v(0);
      const int a = (axis + 1) % 3, c = (axis + 2) % 3;
      if (far) corner[axis] = high[axis];
      u[a] = high[a] - low[a], v[c] = high[c] - low[c];
      if (far) std::swap(u, v);
      const uint16_t first = uint16_t(position.size() / 3);
      for (const glm::dvec3 p : {corner, corner + u, corner + u + v, corner + v})
        for (int k = 0; k < 3; ++k) position.push_back(float(p[k])), color.push_back(float(colour_at(p)[k]));
      for (const int i : {0, 1, 2, 0, 2, 3}) index.push_back(uint16_t(first + i));
    }
  const Json attributes = {{"POSITION", b.accessor<float>("VEC3", position)},
                           {"COLOR_0", b.accessor<float>("VEC3", color)}};
  Json& p = b.primitive(attributes);
  p["indices"] = b.accessor<uint16_t>("SCALAR", index);
  p["material"] = add_material(b, unlit_material(1, 1, 1));
  add_node(b, {{"mesh", int(b.json["meshes"].size()) - 1}});
}

void add_ball(GltfBuilder& b, double roughness) {
  constexpr int rings = 128, segments = 256;
  std::vector<float> position, normal;
  std::vector<uint16_t> index;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j <= segments; ++j) {
      const double polar = std::numbers::pi * i / rings, turn = 2 * std::numbers::pi * j / segments;
      const glm::dvec3 n(std::sin(polar) * std::cos(turn), std::cos(polar), -std::sin(polar) * std::sin(turn));
      for (int k = 0; k < 3; ++k) normal.push_back(float(n[k])), position.push_back(float(ball_radius * n[k]));
      const auto at = [&](int r, int s) { return uint16_t(r * (segments + 1) + s); };
      if (i < rings && j < segments)
        index.insert(index.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  Json& p =
      b.primitive({{"POSITION", b.accessor<float>("VEC3", position)}, {"NORMAL", b.accessor<float>("VEC3", normal)}});
  p["indices"] = b.accessor<uint16_t>("SCALAR", index);
  p["material"] = add_material(b, metal(roughness));
  add_node(b, {{"mesh", int(b.json["meshes"].size()) - 1}, {"translation", {ball_at.x, ball_at.y, ball_at.z}}});
}

// Gives next to nothing, and keeps the neutral light away: there is no ambient light but the probes'.
void add_faint_sun(GltfBuilder& b) {
  add_light(b, {{"type", "directional"}, {"intensity", 1e-6}},
            {{"rotation", rotation_between({0, 0, -1}, {0, -1, 0})}});
}

std::string text_of(glm::dvec3 v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }
std::string probe_text(glm::dvec3 position, glm::dvec3 lowest, glm::dvec3 highest, double fade_m = 0.1,
                       double time_s = 0) {
  return fmt::format(R"({{"position": {}, "box": {{"min": {}, "max": {}}}, "fade_m": {}, "time_s": {}}})",
                     text_of(position), text_of(lowest), text_of(highest), fade_m, time_s);
}

}  // namespace

class FrameProbes : public FrameTest {
 protected:
  static std::string look_file(const std::vector<std::string>& probes, const std::string& more = "") {
    static int number = 0;
    const std::string file = fmt::format("{}candela_probes_{}.look.json", ::testing::TempDir(), number++);
    std::ofstream(file) << fmt::format(R"({{"probes": [{}]{}}})", fmt::join(probes, ", "), more);
    return file;
  }
  static std::string room_probe() { return probe_text({0.9, 2.2, 1.1}, low, high); }
  static Job room_with_ball(double roughness, const std::vector<std::string>& probes = {room_probe()}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    add_walls(b);
    add_ball(b, roughness);
    add_faint_sun(b);
    Job job = job_for(write(b), width, height);
    job.settings = {{"probes", "size_px", "32"}};
    look(job, eye, ball_at, 40);
    if (!probes.empty()) job.look = look_file(probes);
    return job;
  }
  // Of each pixel whose ray meets the ball well inside its outline: where the mirrored ray meets the room.
  static std::vector<std::pair<size_t, glm::dvec3>> mirrored() {
    const glm::dvec3 forward = glm::normalize(ball_at - eye), right = glm::normalize(glm::cross(forward, {0, 1, 0}));
    const glm::dvec3 up = glm::cross(right, forward);
    const double tan_half = std::tan(glm::radians(20.0));
    std::vector<std::pair<size_t, glm::dvec3>> list;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const glm::dvec2 ndc = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(width, height) - 1.0;
        const glm::dvec3 d =
            glm::normalize(forward + right * (ndc.x * tan_half * width / height) - up * (ndc.y * tan_half));
        const double along = glm::dot(ball_at - eye, d);
        const double off2 = glm::dot(ball_at - eye, ball_at - eye) - along * along;
        if (off2 > 0.8 * ball_radius * ball_radius) continue;
        const glm::dvec3 at = eye + d * (along - std::sqrt(ball_radius * ball_radius - off2));
        const glm::dvec3 r = glm::reflect(d, glm::normalize(at - ball_at));
        double leaves = 1e9;
        for (int k = 0; k < 3; ++k)
          if (r[k] != 0) leaves = std::min(leaves, ((r[k] > 0 ? high : low)[k] - at[k]) / r[k]);
        list.emplace_back(size_t(y) * width + size_t(x), at + leaves * r);
      }
    return list;
  }
  static void expect_finite(const Images& all, const std::string& what) {
    for (const Image& image : all)
      for (const float v : image.values<float>()) ASSERT_TRUE(std::isfinite(v)) << what << " " << image.layer;
  }
};

// The colours tell the place on the wall: what is seen is where the ray meets the box, the nearer the more texels the
// probe has. The probe itself stands elsewhere, so that its image as such is far off.
TEST_F(FrameProbes, AMirrorBallSeesWhereItsRaysMeetTheBox) {
  Job job = room_with_ball(0);
  const auto rays = mirrored();
  ASSERT_GT(rays.size(), 500u);
  const glm::dvec3 probe_at(0.9, 2.2, 1.1), to_ball = ball_at - probe_at;
  const double hidden = std::asin(ball_radius / glm::length(to_ball)) + 0.2;
  // RMSE of the colour, but for what the ball hides from the probe. A white metal reflects a little less than all.
  double reflected = 0;
  const auto error = [&](const Images& images) {
    const auto pixels = images["beauty"].values<glm::vec4>();
    double product = 0, square = 0;
    std::vector<std::pair<glm::dvec3, glm::dvec3>> pairs;
    for (const auto& [i, met] : rays) {
      if (glm::dot(glm::normalize(met - probe_at), glm::normalize(to_ball)) > std::cos(hidden)) continue;
      pairs.emplace_back(pixels[i], colour_at(met));
      product += glm::dot(pairs.back().first, pairs.back().second);
      square += glm::dot(pairs.back().second, pairs.back().second);
    }
    EXPECT_GT(pairs.size(), 500u);
    reflected = product / square;
    double sum = 0;
    for (const auto& [seen, exact] : pairs) sum += glm::dot(seen / reflected - exact, seen / reflected - exact);
    return std::sqrt(sum / (3 * double(pairs.size())));
  };
  std::vector<double> errors;
  for (const char* size : {"16", "32", "128"}) {
    job.settings = {{"probes", "size_px", size}};
    errors.push_back(error(images_of(job)));
    EXPECT_NEAR(reflected, 0.985, 0.025);
  }
  fmt::print("RMSE of the colour {:.5f}\n", fmt::join(errors, " "));
  EXPECT_LT(errors[1], errors[0]);
  EXPECT_LT(errors[2], errors[1]);
  EXPECT_LT(errors[2], 0.005);
  // A box that is too large moves everything: the test would see it.
  job.look = look_file({probe_text(probe_at, low - 1.0, high + 1.0)});
  EXPECT_GT(error(images_of(job)), 0.02);
}

// A metal floor before walls of one colour, half of it outside the box: the light falls to nothing over fade_m, evenly.
TEST_F(FrameProbes, TheWeightFallsOutsideTheBox) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  const double h = std::sqrt(0.5);
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, metal(0.5)))}, {"rotation", {-h, 0, 0, h}}});
  add_node(b, {{"mesh", add_square_mesh(b, 40, add_material(b, unlit_material(0.8, 0.8, 0.8)))},
               {"translation", {0, 6, 0}},
               {"rotation", {h, 0, 0, h}}});
  add_faint_sun(b);
  b.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 4}, {"ymag", 0.5}, {"znear", 0.1}, {"zfar", 20}}}}};
  add_node(b, {{"camera", 0}, {"translation", {0, 5, 0}}, {"rotation", {-h, 0, 0, h}}});
  Job job = job_for(write(b), 160, 20);
  job.settings = {{"probes", "size_px", "32"}};
  job.look = look_file({probe_text({-2, 2, 0}, {-9, 0, -9}, {0, 6, 9}, 1.5)});
  const auto pixels = images_of(job)["beauty"].values<glm::vec4>();
  const double inside = double(pixels[10 * 160 + 79].x);
  EXPECT_GT(inside, 0.5);
  for (int x = 0; x < 160; ++x) {
    const double at = (x + 0.5) / 20 - 4, weight = std::clamp(1 - at / 1.5, 0.0, 1.0);
    if (at < 0) continue;
    EXPECT_NEAR(double(pixels[size_t(10 * 160 + x)].x), inside * weight, 0.02 * inside) << at;
    if (at > 1.5) {
      EXPECT_LT(pixels[size_t(10 * 160 + x)].x, 1e-5f) << at;
    }
  }
}

// A red room and a green one with a wall between; a small box in both, whose probe stands in the green one: what is in
// the small box shows green, what is in the large one alone red, in whatever order the file names them.
TEST_F(FrameProbes, TheSmallerBoxGoesBefore) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  const double h = std::sqrt(0.5);
  const int red = add_material(b, unlit_material(0.9, 0.1, 0.1)),
            green = add_material(b, unlit_material(0.1, 0.9, 0.1));
  const auto square = [&](int material, glm::dvec3 at, glm::dvec3 facing) {
    add_node(b, {{"mesh", add_square_mesh(b, 2, material)},
                 {"translation", {at.x, at.y, at.z}},
                 {"rotation", rotation_between({0, 0, 1}, facing)}});
  };
  square(red, {-2, 2, 0}, {0, -1, 0}), square(red, {0, 0, 0}, {-1, 0, 0});
  square(green, {2, 2, 0}, {0, -1, 0}), square(green, {0, 0, 0}, {1, 0, 0});
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, metal(0.3)))}, {"rotation", {-h, 0, 0, h}}});
  add_faint_sun(b);
  b.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 0.5}, {"znear", 0.01}, {"zfar", 20}}}}};
  add_node(b, {{"camera", 0}, {"translation", {-2, 1.5, 0}}, {"rotation", {-h, 0, 0, h}}});
  Job job = job_for(write(b), 80, 20);
  job.settings = {{"probes", "size_px", "32"}};
  const std::string large = probe_text({-2, 1, 0}, {-4, -0.1, -4}, {4, 2, 4}, 0.05);
  const std::string small = probe_text({1, 1, 0}, {-2.5, -0.1, -2}, {1.5, 2, 2}, 0.05);
  job.look = look_file({large, small});
  const Images one = images_of(job);
  job.look = look_file({small, large});
  EXPECT_EQ(one, images_of(job));
  job.look = look_file({large});
  const auto alone = images_of(job)["beauty"].values<glm::vec4>(), both = one["beauty"].values<glm::vec4>();
  job.look = look_file({small});
  const auto little = images_of(job)["beauty"].values<glm::vec4>();
  for (int x = 0; x < 80; ++x) {
    const double at = -4 + (x + 0.5) / 20;
    const size_t i = size_t(10 * 80 + x);
    if (at > -2.45 && at < -0.5) {
      EXPECT_EQ(both[i], little[i]) << at;
      EXPECT_GT(both[i].y, 2 * both[i].x) << at;
    } else if (at < -2.6 && at > -3.5) {
      EXPECT_EQ(both[i], alone[i]) << at;
      EXPECT_GT(both[i].x, 2 * both[i].y) << at;
    }
  }
}

// No look, a look without probes, and one whose probes --effects leaves out: the same bytes, and nothing in the plan.
TEST_F(FrameProbes, FramesWithoutThemKeepTheirBytes) {
  Job job = room_with_ball(0.3, {});
  std::string notes;
  const auto plan_of = [&](const Job& of) {
    const auto session = open(of);
    if (!session) return std::string();
    const FrameResult result = render(*session);
    notes = fmt::format("{}", fmt::join(result.notes, "\n"));
    return plan_text(*result.plan);
  };
  for (const char* effects : {"none", "ibl"}) {
    job.effects = effects, job.look.clear();
    const Images bare = images_of(job);
    const std::string plan = plan_of(job);
    EXPECT_EQ(plan.find("PROBE_COUNT"), std::string::npos);
    EXPECT_EQ(plan.find("probes."), std::string::npos);
    job.look = look_file({room_probe()});
    EXPECT_EQ(images_of(job), bare);
    EXPECT_EQ(plan_of(job), plan);
    EXPECT_NE(notes.find("1 reflection probe of the look left out (--effects)"), std::string::npos) << notes;
    job.look = look_file({});
    EXPECT_EQ(images_of(job), bare);
  }
  job.effects = "auto";
  job.look = look_file({room_probe()});
  const std::string plan = plan_of(job);
  EXPECT_NE(plan.find("PROBE_COUNT"), std::string::npos);
  EXPECT_NE(plan.find("probes.size_px"), std::string::npos);
  EXPECT_NE(notes.find("1 reflection probe of the look: surfaces in its box"), std::string::npos) << notes;
}

// The images belong to the job: whichever frame comes first, from wherever it is seen, the bytes are the same; with a
// supersampled frame and a reflection layer beside it too.
TEST_F(FrameProbes, AreOfNoFrame) {
  Job job = room_with_ball(0.2);
  job.layers = {"ambient_specular"};
  const auto first = open(job);
  const Images a = images(render(*first, 0)), b = images(render(*first, 2));
  const auto second = open(job);
  EXPECT_EQ(images(render(*second, 2)), b);
  EXPECT_EQ(images(render(*second, 0)), a);
  Job elsewhere = job;
  look(elsewhere, {-2, 2, 2}, {0, 0, 0}, 70);
  const auto third = open(elsewhere);
  (void)render(*third, 0);
  third->set_camera(job.camera);
  EXPECT_EQ(images(render(*third, 0)), a);
}

// Terms sum to beauty, fog or none; fog before the room weakens what surfaces show, not what reaches them.
TEST_F(FrameProbes, TermsSumToBeauty) {
  Job job = room_with_ball(0.4);
  for (const LayerName& term : Terms::layers) job.layers.emplace_back(term.name);
  for (const bool fog : {false, true}) {
    if (fog) {
      job.look = look_file({room_probe()}, R"(, "fog": {"extinction": 0.05})");
      job.layers.push_back("fog");
    }
    const Images all = images_of(job);
    double most = 0, light = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        glm::dvec3 sum(0);
        for (const std::string& name : job.layers) sum += glm::dvec3(all[name].at<glm::vec4>(x, y));
        most = std::max(most, glm::length(sum - glm::dvec3(all["beauty"].at<glm::vec4>(x, y))));
        light += double(all["ambient_specular"].at<glm::vec4>(x, y).y);
      }
    EXPECT_LT(most, 1e-5) << fog;
    EXPECT_GT(light, 100) << fog;
  }
}

// Reflections of the screen go before probes where they meet something; where they do not, the probe's light stays.
TEST_F(FrameProbes, ReflectionsFallBackOnThem) {
  Job job = room_with_ball(0);
  const auto with = images_of(job)["beauty"].values<glm::vec4>();
  job.look = look_file({room_probe()}, R"(, "reflections": {})");
  const auto both = images_of(job)["beauty"].values<glm::vec4>();
  size_t same = 0, rays = 0;
  for (const auto& [i, met] : mirrored()) {
    // Behind the camera: the picture does not hold it.
    if (met.z < eye.z) continue;
    ++rays;
    same += glm::length(glm::vec3(both[i] - with[i])) < 1e-3f;
  }
  EXPECT_GT(rays, 50u);
  EXPECT_GT(double(same), 0.95 * double(rays));
}

// Boxes of a millimetre and of ten kilometres, a camera outside, a probe inside a wall or behind it, frames of one
// pixel: numbers, and no light below 0.
TEST_F(FrameProbes, AreNumbersWhateverTheLook) {
  const std::vector<std::string> looks = {
      probe_text(ball_at, ball_at - 5e-4, ball_at + 5e-4, 1e-3),
      probe_text(ball_at, ball_at - 5e-4, ball_at + 5e-4, 1e4),
      probe_text({0, 1, 0}, glm::dvec3(-1e4), glm::dvec3(1e4), 1e4),
      probe_text({-3, 1, 0}, low - 1.0, high + 1.0),    // in the wall
      probe_text({-3.5, 1, 0}, low - 1.0, high + 1.0),  // behind it
      probe_text(ball_at, low, high),                   // in the ball
      probe_text({1e6, 1, 0}, {-1e7, 0, -1e7}, {1e7, 3, 1e7}),
      probe_text({0, 1.0 + 1e-6, 0}, {-1, 1, -1}, {1, 1 + 2e-6, 1}, 1e-6),
  };
  for (size_t i = 0; i < looks.size(); ++i) {
    Job job = room_with_ball(i % 2 == 0 ? 0 : 1, {looks[i]});
    job.settings = {{"probes", "size_px", "16"}};
    job.layers = {"ambient_specular"};
    for (const auto& [w, h] : {std::pair(1, 1), std::pair(31, 17)}) {
      job.width_px = w, job.height_px = h;
      const auto session = open(job);
      ASSERT_TRUE(session);
      for (const glm::dvec3 from : {eye, glm::dvec3(20, 30, 40)}) {
        look(job, from, ball_at, 40);
        session->set_camera(job.camera);
        const Images all = images(render(*session));
        expect_finite(all, looks[i]);
        for (const glm::vec4& v : all["beauty"].values<glm::vec4>())
          ASSERT_TRUE(v.x >= 0 && v.y >= 0 && v.z >= 0) << looks[i];
      }
    }
  }
  // As many as a look may have.
  std::vector<std::string> many;
  for (int i = 0; i < 8; ++i) many.push_back(probe_text({0, 1, 0}, low * (1 + 0.1 * i), high * (1 + 0.1 * i)));
  Job job = room_with_ball(0.5, many);
  job.settings = {{"probes", "size_px", "8"}};
  expect_finite(images_of(job), "eight");
}

// Smooth and rough balls: the specular light of a probe is near the traced one, and the nearer the more texels it has.
// Without it there is none.
TEST_F(FrameProbes, ComeNearTheTracedLight) {
  for (const double roughness : {0.1, 0.5}) {
    // From inside the ball, whose back faces do not show: it hides nothing from the probe.
    Job job = room_with_ball(roughness, {probe_text(ball_at + glm::dvec3(0.3, 0.2, 0.1), low, high)});
    job.layers = {"ambient_specular"};
    const auto frame = open_reference(job, 0, {});
    ASSERT_TRUE(frame) << frame.error().text();
    reference::TraceSettings settings;
    reference::Film film(width, height, {.terms = true});
    film.add(reference::Integrator(*(*frame)->world, settings, width, height), 100, [](double) { return true; });
    // Of the surfaces in the middles of the ball's pixels.
    const auto error = [&](const std::vector<glm::vec4>& pixels) {
      double sum = 0;
      const auto rays = mirrored();
      for (const auto& [i, met] : rays) {
        const glm::dvec3 truth =
            film.term(reference::Term::ambient_specular, i) + film.term(reference::Term::reflections, i);
        for (int c = 0; c < 3; ++c) sum += std::pow(double(pixels[i][c]) - truth[c], 2) / (truth[c] * truth[c] + 0.01);
      }
      return sum / (3 * double(rays.size()));
    };
    std::vector<double> errors;
    for (const char* size : {"8", "32", "128"}) {
      job.settings = {{"probes", "size_px", size}};
      errors.push_back(error(images_of(job)["ambient_specular"].values<glm::vec4>()));
    }
    const double without = error(std::vector<glm::vec4>(size_t(width) * height, glm::vec4(0)));
    fmt::print("roughness {}: relMSE without {:.4f}; by size {:.5f}\n", roughness, without, fmt::join(errors, " "));
    EXPECT_GT(without, 0.8);
    EXPECT_LT(errors.back(), 0.002);  // 0.0028 of the rough ball with slices as wide as the lobe whatever the distances
    EXPECT_LE(errors[1], errors[0]);
    EXPECT_LE(errors[2], 1.05 * errors[1]);
  }
}

}  // namespace candela::test::frame_probes
