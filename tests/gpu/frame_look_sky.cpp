// Skies that a look says: gradients, two images, air, blurred backgrounds; and its exposure and tone mapping.
#include <numbers>

#include "frame_fixture.h"
#include "image/exr.h"
#include "reference/sky.h"
#include "scene/atmosphere.h"
#include "scene/environment.h"

namespace candela::test {
namespace {

class FrameLookSky : public FrameTest {
 protected:
  static constexpr int width = 48, height = 27;
  static std::string file(const std::string& end) {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    return ::testing::TempDir() + "candela_" + info->name() + end;
  }
  // Within 2 %. what: of the message.
  static void expect_same_middle(const Images& pictures, const Images& expected, double what) {
    const glm::vec4 a = expected["beauty"].at<glm::vec4>(width / 2, height / 2),
                    b = pictures["beauty"].at<glm::vec4>(width / 2, height / 2);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(b[c], a[c], 0.02 * a[c]) << what << " " << c;
  }
  static std::string write_look(const std::string& text) {
    const std::string path = file(".look.json");
    std::ofstream(path) << text;
    return path;
  }
  // Beside the look; returns its name.
  static std::string write_sky(const std::string& name, int side, const std::function<glm::dvec3(glm::dvec3)>& f) {
    FloatImage image;
    image.width = 2 * side, image.height = side;
    for (const char* channel : {"R", "G", "B"}) image.channels.push_back({channel, ChannelType::float32, {}, {}});
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const glm::dvec3 c = f(equirect_direction((x + 0.5) / image.width, (y + 0.5) / image.height));
        for (int k = 0; k < 3; ++k) image.channels[size_t(k)].f.push_back(float(c[k]));
      }
    const auto bytes = encode_exr(image, ExrCompression::zip, "sky");
    EXPECT_TRUE(bytes);
    const std::string path = file("_" + name + ".exr");
    std::ofstream(path, std::ios::binary).write(bytes->data(), long(bytes->size()));
    return std::filesystem::path(path).filename();
  }
  // An empty scene, a diffuse square or a metal one before the camera.
  enum class Body { none, diffuse, metal };
  static Job job_of(Body body, const std::string& look, std::optional<double> sun_elevation_deg = {}) {
    GltfBuilder b = empty_scene();
    if (body == Body::none) {
      add_node(b, {{"name", "nothing"}});
    } else {
      use_materials(b);
      Json metal = base_color(1, 1, 1);
      metal["roughnessFactor"] = 0.4, metal["metallicFactor"] = 1;
      const int material =
          add_material(b, body == Body::metal ? Json{{"pbrMetallicRoughness", metal}} : diffuse_material(1, 1, 1));
      add_node(b, {{"mesh", add_square_mesh(b, 2, material)}, {"rotation", {std::sin(-0.3), 0, 0, std::cos(-0.3)}}});
    }
    if (sun_elevation_deg) {
      const double half = -glm::radians(*sun_elevation_deg) / 2;  // the light shines along -Z
      add_light(b, {{"type", "directional"}, {"intensity", 2}}, {{"rotation", {std::sin(half), 0, 0, std::cos(half)}}});
    }
    Job job = job_for(write(b), width, height);
    if (!look.empty()) job.look = write_look(look);
    FrameTest::look(job, {0, 0, 3}, {0, 0, 0}, 60);
    return job;
  }
  static glm::dvec3 direction(glm::dvec3 back, double yfov_deg, int x, int y) {
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back)), up = glm::cross(back, right);
    const double tan_y = std::tan(yfov_deg * std::numbers::pi / 360), tan_x = tan_y * width / height;
    return glm::normalize(tan_x * (2 * (x + 0.5) / width - 1) * right - tan_y * (2 * (y + 0.5) / height - 1) * up -
                          back);
  }
  static void expect_background(const Image& beauty, const std::function<glm::dvec3(glm::dvec3)>& wanted,
                                double within) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const glm::dvec3 w = wanted(direction({0, 0, 1}, 60, x, y));
        const glm::vec4 p = beauty.at<glm::vec4>(x, y);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(p[c], w[c], within * (w[c] + 0.05)) << x << " " << y << " " << c;
        ASSERT_EQ(p.w, 1.0f);
      }
  }
};

constexpr const char* gradient =
    R"({"sky": {"gradient": {"zenith": [0.1, 0.3, 1], "horizon": [1, 0.9, 0.5], "ground": 0.2, "exponent": 0.7}}})";

}  // namespace

// In the background by its formula, and as light: a diffuse square gets the mean radiance about its normal.
TEST_F(FrameLookSky, GradientsAreSeenAndLight) {
  const auto formula = [](glm::dvec3 d) {
    const glm::dvec3 far = d.y > 0 ? glm::dvec3(0.1, 0.3, 1) : glm::dvec3(0.2);
    return glm::mix(glm::dvec3(1, 0.9, 0.5), far, std::pow(std::abs(d.y), 0.7));
  };
  expect_background(images_of(job_of(Body::none, gradient))["beauty"], formula, 0.02);
  for (const char* effects : {"none", "ibl"}) {
    Job job = job_of(Body::diffuse, gradient);
    job.effects = effects, job.settings = {{"ibl", "irradiance_px", "32"}};
    const glm::vec4 p = images_of(job)["beauty"].at<glm::vec4>(width / 2, height / 2);
    const glm::dvec3 n(0, std::sin(0.6), std::cos(0.6));
    glm::dvec3 sum(0);
    constexpr int side = 256;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < 2 * side; ++x) {
        const glm::dvec3 d = equirect_direction((x + 0.5) / (2 * side), (y + 0.5) / side);
        const double solid_angle = std::sin(std::numbers::pi * (y + 0.5) / side) * std::pow(std::numbers::pi / side, 2);
        sum += formula(d) * std::max(glm::dot(d, n), 0.0) * solid_angle / std::numbers::pi;
      }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p[c], sum[c], 0.03 * sum[c]) << effects << " " << c;
  }
}

TEST_F(FrameLookSky, GradientsOverTimeAreThoseOfTheirMoment) {
  Job job = job_of(Body::metal, R"({"sky": {"gradient": {"zenith": {"keys": [[0, [0, 0, 1]], [2, [1, 0, 0]]]},
                                            "horizon": 1, "ground": 0}}})");
  job.effects = "ibl";
  const auto session = open(job);
  ASSERT_TRUE(session);
  const auto at = [&](double time_s) { return images(render(*session, time_s))["beauty"]; };
  const Image first = at(0), middle = at(1), again = at(0);
  EXPECT_EQ(first, again) << "a frame is the same whatever came before it";
  Job still = job;
  still.look = write_look(R"({"sky": {"gradient": {"zenith": [0.5, 0, 0.5], "horizon": 1, "ground": 0}}})");
  EXPECT_EQ(images_of(still)["beauty"], middle) << "and as if it had always been so";
  EXPECT_NE(first, middle);
}

// Half of each of two images, of different sizes and intensities: background, diffuse and mirrored light alike.
TEST_F(FrameLookSky, BlendsTwoImages) {
  const auto day = [](glm::dvec3 d) { return glm::dvec3(2 + d.x, 2 + d.y, 2 + d.z); };
  const auto night = [](glm::dvec3 d) { return glm::dvec3(1 - d.x, 1, 1 + d.z * d.y); };
  for (const Body body : {Body::none, Body::diffuse, Body::metal}) {
    Job job = job_of(body, "");
    job.effects = "ibl";
    const std::string first = write_sky("day", 64, day), second = write_sky("night", 32, night);
    job.sky =
        ::testing::TempDir() + write_sky("both", 64, [&](glm::dvec3 d) { return 0.75 * day(d) + 0.5 * night(d); });
    const Images wanted = images_of(job);
    for (const bool on_command_line : {false, true}) {
      job.sky = on_command_line ? ::testing::TempDir() + first : "";
      const std::string image = on_command_line ? "" : R"("image": ")" + first + R"(", )";
      job.look = write_look(R"({"sky": {)" + image + R"("second": {"image": ")" + second +
                            R"(", "weight": 0.25, "intensity": 2}}})");
      const auto a = wanted["beauty"].values<glm::vec4>(), b = images_of(job)["beauty"].values<glm::vec4>();
      for (size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(b[i][c], a[i][c], 0.003 * a[i][c]) << int(body) << " " << i;
    }
  }
}

// Two images whose weights change with each frame are summed in memory that is there, into what no frame in flight
// uses.
TEST_F(FrameLookSky, AFilmOfTwoImagesAsksTheHeapForNothing) {
  const auto day = [](glm::dvec3 d) { return glm::dvec3(2 + d.x, 2 + d.y, 2 + d.z); };
  const auto night = [](glm::dvec3 d) { return glm::dvec3(1 - d.x, 1, 1 + d.z * d.y); };
  const std::string first = write_sky("day", 32, day), second = write_sky("night", 32, night);
  Job job = job_of(Body::metal, "");
  job.effects = "ibl";
  job.look = write_look(R"({"sky": {"image": ")" + first + R"(", "second": {"image": ")" + second +
                        R"(", "weight": {"keys": [[0, 0.1], [1, 0.9]]}}}})");
  std::vector<Images> frames[2];
  for (const bool validate : {false, true}) {
    RunSettings settings;
    settings.validate = validate;  // the layer has memory of its own
    settings.kept_bytes = uint64_t(64) << 20;
    const auto film = Session::open(job, {.linear = true}, settings);
    ASSERT_TRUE(film) << film.error().text();
    for (int frame = 0; frame < 8; ++frame) {
      const FrameResult result = render(**film, 0.1 * frame);
      if (!validate && frame >= 5) EXPECT_EQ(result.timings.heap_allocations, 0u) << frame;
      frames[validate].push_back(images(result));
    }
  }
  EXPECT_EQ(frames[0], frames[1]);
  for (const size_t frame : {size_t(5), size_t(7)}) {
    const auto alone = open(job, {.linear = true});
    ASSERT_TRUE(alone);
    EXPECT_EQ(images(render(*alone, 0.1 * double(frame))), frames[0][frame]) << frame;
    EXPECT_NE(frames[0][frame], frames[0][frame - 1]);
  }
}

TEST_F(FrameLookSky, TheSecondSkyFollowsTheSun) {
  const std::string night = write_sky("night", 16, [](glm::dvec3) { return glm::dvec3(0, 0, 4); });
  const std::string look = R"({"sky": {"gradient": {"zenith": 1, "horizon": 1, "ground": 1},
                               "second": {"image": ")" +
                           night + R"(", "follows_sun": {}}}})";
  for (const auto& [elevation, weight] : {std::pair(10.0, 0.0), {-9.0, 0.5}, {-18.0, 1.0}, {-60.0, 1.0}}) {
    const glm::vec4 p = images_of(job_of(Body::none, look, elevation))["beauty"].at<glm::vec4>(3, 3);
    EXPECT_NEAR(p.x, 1 - weight, 1e-4) << elevation;
    EXPECT_NEAR(p.z, 1 - weight + 4 * weight, 1e-4) << elevation;
  }
  const auto session = open(job_of(Body::none, look));
  ASSERT_TRUE(session);
  const FrameResult frame = render(*session);
  EXPECT_NE(frame.notes[0].find("no directional light"), std::string::npos);
}

// A sharp edge becomes the kernel's; the light stays as it is.
TEST_F(FrameLookSky, BlursTheBackgroundAlone) {
  const auto edge = [](glm::dvec3 d) { return glm::dvec3(d.y > 0 ? 2 : 1); };
  Job job = job_of(Body::none, R"({"sky": {"blur_deg": 8}})");
  job.sky = ::testing::TempDir() + write_sky("edge", 128, edge);
  const double deviation = glm::radians(8.0);
  const auto wanted = [&](glm::dvec3 d) {
    return glm::dvec3(1.5 + 0.5 * std::erf(std::asin(d.y) / (deviation * std::numbers::sqrt2)));
  };
  expect_background(images_of(job)["beauty"], wanted, 0.015);
  // The reference's own estimate.
  const reference::Sky sky = reference::Sky::sum(
      {}, SkyGradient{.zenith = glm::dvec3(2), .horizon = glm::dvec3(1), .ground = glm::dvec3(1), .exponent = 1e-9}, 1,
      0, 1);
  for (const double elevation : {-10.0, 0.0, 5.0, 20.0}) {
    const glm::dvec3 d(std::cos(glm::radians(elevation)), std::sin(glm::radians(elevation)), 0);
    glm::dvec3 sum(0);
    constexpr int count = 4000;
    for (int i = 0; i < count; ++i) sum += sky.blurred(glm::normalize(d + glm::dvec3(0, 0, 1e-6 * i)), deviation);
    EXPECT_NEAR(sum.x / count, wanted(d).x, 0.01) << elevation;
  }
  for (const Body body : {Body::diffuse, Body::metal}) {
    Job lit = job_of(body, "");
    lit.sky = job.sky;
    const auto sharp = images_of(lit)["beauty"];
    lit.look = write_look(R"({"sky": {"blur_deg": 8}})");
    EXPECT_EQ(sharp.at<glm::vec4>(width / 2, height / 2),
              images_of(lit)["beauty"].at<glm::vec4>(width / 2, height / 2));
  }
}

// The sky of air is that of the scene's sun: its height, its lux, its place.
TEST_F(FrameLookSky, AirFollowsTheSun) {
  const Air air({});
  for (const double elevation : {40.0, 3.0}) {
    const double e = glm::radians(elevation);
    const glm::dvec3 sun(0, std::sin(e), std::cos(e));  // the light shines along -Z, downwards
    for (const char* how : {"look", "option"}) {
      Job job = job_of(Body::none, std::string(how) == "look" ? R"({"sky": {"atmosphere": {}}})" : "", elevation);
      if (std::string(how) == "option") job.sky = "atmosphere";
      FrameTest::look(job, {0, 0, 0}, {0, 0.6, -1}, 60);
      const Images images = images_of(job);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const glm::dvec3 d = direction(glm::normalize(glm::dvec3(0, -0.6, 1)), 60, x, y),
                           wanted = 2.0 * air.radiance(d, sun);
          if (d.y < 0.02) continue;  // the horizon lies between texels
          const glm::vec4 p = images["beauty"].at<glm::vec4>(x, y);
          for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(p[c], wanted[c], 0.04 * wanted[c] + 1e-5) << x << " " << y << " " << how;
        }
    }
  }
}

TEST_F(FrameLookSky, AirOfANightIsBlackAndFinite) {
  for (const double elevation : {90.0, 0.0, -0.2, -90.0})
    for (const char* effects : {"none", "auto"}) {
      Job job = job_of(Body::metal, R"({"sky": {"atmosphere": {"haze": 5}}})", elevation);
      job.effects = effects;
      for (const glm::vec4& p : images_of(job)["beauty"].values<glm::vec4>())
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(p[c]) && p[c] >= 0) << elevation << " " << effects;
    }
  const Images night = images_of(job_of(Body::none, R"({"sky": {"atmosphere": {}}})", -90));
  for (const glm::vec4& p : night["beauty"].values<glm::vec4>()) ASSERT_EQ(p, glm::vec4(0, 0, 0, 1));
}

// The light of a square stays what it was, now with a shadow; the background shows the spot as before.
TEST_F(FrameLookSky, TakesTheSunOutOfTheImage) {
  const glm::dvec3 sun = glm::normalize(glm::dvec3(0.2, 0.8, 0.6));
  const auto radiance = [&](glm::dvec3 d) {
    return glm::dot(d, sun) > std::cos(0.03) ? glm::dvec3(900, 800, 700) : glm::dvec3(0.4, 0.5, 0.6);
  };
  Job job = job_of(Body::diffuse, "");
  job.sky = ::testing::TempDir() + write_sky("sunny", 128, radiance);
  for (const double turn_deg : {0.0, 70.0}) {
    job.effects = "ibl";
    const std::string turn = fmt::format(R"("rotation_deg": {}, "intensity": 0.5)", turn_deg);
    job.look = write_look(R"({"sky": {"extract_sun": false, )" + turn + "}}");
    const Images whole = images_of(job);
    job.look = write_look(R"({"sky": {"extract_sun": true, )" + turn + "}}");
    const auto session = open(job);
    ASSERT_TRUE(session);
    const FrameResult frame = render(*session);
    const Images divided = images(frame);
    expect_same_middle(divided, whole, turn_deg);
    ASSERT_FALSE(frame.notes.empty());
    EXPECT_NE(frame.notes[0].find("the sky image's sun is a directional light"), std::string::npos);
  }
  Job seen = job_of(Body::none, "");
  seen.sky = job.sky;
  FrameTest::look(seen, {0, 0, 0}, sun, 20);
  seen.look = write_look(R"({"sky": {"extract_sun": false}})");
  const Images of_image = images_of(seen);
  EXPECT_GT(of_image["beauty"].at<glm::vec4>(width / 2, height / 2).x, 800);
  seen.look = write_look(R"({"sky": {"extract_sun": true}})");
  EXPECT_EQ(images_of(seen)["beauty"], of_image["beauty"]);
  job.look = seen.look;
  job.effects = "none";
  job.sky = ::testing::TempDir() + write_sky("plain", 16, [](glm::dvec3) { return glm::dvec3(1); });
  const auto session = open(job);
  ASSERT_TRUE(session);
  EXPECT_NE(render(*session).notes[0].find("no spot"), std::string::npos);
}

// Each of two images has its own sun, which fades with it; all frames say the same.
TEST_F(FrameLookSky, SunsOfTwoImagesFadeApart) {
  const auto with_sun = [](glm::dvec3 sun, glm::dvec3 rest) {
    return [=](glm::dvec3 d) { return glm::dot(d, sun) > std::cos(0.02) ? glm::dvec3(2000) : rest; };
  };
  const glm::dvec3 low = glm::normalize(glm::dvec3(0.5, 0.5, 0.6)), high = glm::normalize(glm::dvec3(-0.3, 0.8, 0.5));
  Job job = job_of(Body::diffuse, "");
  job.sky = ::testing::TempDir() + write_sky("day", 128, with_sun(low, glm::dvec3(0.2, 0.3, 0.5)));
  const std::string second = write_sky("evening", 128, with_sun(high, glm::dvec3(0.3, 0.1, 0.05)));
  job.effects = "ibl";
  for (const double weight : {0.0, 0.3, 1.0}) {
    const auto look = [&](const std::string& keeps) {
      return write_look(fmt::format(R"({{"sky": {{{} "second": {{"image": "{}", "weight": {}, "intensity": 0.5}}}}}})",
                                    keeps, second, weight));
    };
    job.look = look(R"("extract_sun": false,)");
    const Images whole = images_of(job);
    job.look = look("");
    const auto session = open(job);
    ASSERT_TRUE(session);
    const FrameResult frame = render(*session);
    const Images divided = images(frame);
    expect_same_middle(divided, whole, weight);
    int suns = 0;
    for (const std::string& note : frame.notes) suns += note.find("sun is a directional light") != std::string::npos;
    EXPECT_EQ(suns, weight == 0 || weight == 1 ? 1 : 2);
  }
}

// The light that was a spot of the image stands in the way of: behind a small square the floor has the rest of the
// sky alone, beside its shadow all.
TEST_F(FrameLookSky, TheExtractedSunCastsShadows) {
  const glm::dvec3 sun(0, 1, 0);
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int white = add_material(b, diffuse_material(1, 1, 1));
  const Json lying = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};  // +Z becomes +Y
  add_node(b, {{"mesh", add_square_mesh(b, 20, white)}, {"rotation", lying}});
  add_node(b, {{"mesh", add_square_mesh(b, 1, white)}, {"rotation", lying}, {"translation", {0, 3, 0}}});
  Job job = job_for(write(b), width, height);
  job.sky = ::testing::TempDir() + write_sky("noon", 128, [&](glm::dvec3 d) {
              return glm::dot(d, sun) > std::cos(0.03) ? glm::dvec3(900) : glm::dvec3(0.5);
            });
  job.effects = "ibl,shadows";
  // From the side, below the square: its shadow's middle, and the floor four metres beside it.
  FrameTest::look(job, {0, 2, 8}, {0, 0, 0}, 60);
  const auto floor_at = [&](const Images& picture, double x_m) {
    const glm::dvec3 eye(0, 2, 8), back = glm::normalize(eye), right(1, 0, 0), up = glm::cross(back, right);
    const glm::dvec3 to = glm::dvec3(x_m, 0, 0) - eye;
    const double depth = -glm::dot(to, back), tan_y = std::tan(std::numbers::pi / 6), tan_x = tan_y * width / height;
    const int x = int((glm::dot(to, right) / depth / tan_x + 1) * width / 2),
              y = int((1 - glm::dot(to, up) / depth / tan_y) * height / 2);
    return double(picture["beauty"].at<glm::vec4>(x, y).x);
  };
  job.look = write_look(R"({"sky": {"extract_sun": false}})");
  const Images whole = images_of(job);
  job.look.clear();  // without a word of the look
  const Images divided = images_of(job);
  // The image's uppermost row alone lies in the spot; irradiance over pi.
  const double spot = 900 * 2 * (1 - std::cos(std::numbers::pi / 128));
  EXPECT_NEAR(floor_at(whole, 0), 0.5 + spot, 0.05 * spot);  // the image alone casts no shadow
  EXPECT_NEAR(floor_at(divided, 0), 0.5, 0.03);
  EXPECT_NEAR(floor_at(divided, 4), 0.5 + spot, 0.05 * spot);
}

// The frame's own luminance, whatever the exposure asked for before; EXR does not know of it.
TEST_F(FrameLookSky, ExposesByTheFramesLuminance) {
  const WantedOutputs both{.linear = true, .display = true};
  Job job = job_of(Body::diffuse, R"({"sky": {"gradient": {}}, "exposure": {"auto": {}}})");
  job.dither = false;
  const auto session = open(job, both);
  ASSERT_TRUE(session);
  const FrameResult frame = render(*session);
  const Images automatic = images(frame);
  ASSERT_FALSE(frame.notes.empty());
  float ev = 0;
  for (const std::string& note : frame.notes) std::sscanf(note.c_str(), "exposure: %f stops", &ev);
  EXPECT_NE(ev, 0.0f);
  Job fixed = job;
  fixed.look = file("_plain.look.json");
  std::ofstream(fixed.look) << R"({"sky": {"gradient": {}}})";
  const Images plain = images_of(fixed, both);
  EXPECT_EQ(automatic["beauty"], plain["beauty"]);
  EXPECT_NE(automatic["display"], plain["display"]);
  fixed.exposure_ev = ev;
  const auto a = automatic["display"].values<uint8_t>(), b = images_of(fixed, both)["display"].values<uint8_t>();
  for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1) << i;
  // Brighter by a lamp's light or not, the picture comes out alike; stops on top stay on top.
  Job bright = job;
  bright.look = file("_bright.look.json");
  std::ofstream(bright.look) << R"({"sky": {"gradient": {}, "intensity": 16}, "exposure": {"auto": {}}})";
  const auto c = images_of(bright, both)["display"].values<uint8_t>();
  for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], c[i], 1) << i;
  bright.exposure_ev = -1.0f;
  fixed.exposure_ev = ev - 1;
  const auto d = images_of(bright, both)["display"].values<uint8_t>(),
             e = images_of(fixed, both)["display"].values<uint8_t>();
  for (size_t i = 0; i < d.size(); ++i) EXPECT_NEAR(d[i], e[i], 1) << i;
  // A plan without it has nothing of it.
  Job none = job;
  none.effects = "none";
  const auto without = open(none, both);
  EXPECT_EQ(plan_text(*render(*without).plan).find("exposure."), std::string::npos);
}

TEST_F(FrameLookSky, TheCommandLineGoesBeforeTheLooksSky) {
  Job job = job_of(Body::none, gradient);
  job.sky = "none";
  EXPECT_EQ(images_of(job)["beauty"].at<glm::vec4>(3, 3), glm::vec4(0));
  job.sky = ::testing::TempDir() + write_sky("plain", 16, [](glm::dvec3) { return glm::dvec3(7); });
  EXPECT_EQ(images_of(job)["beauty"].at<glm::vec4>(3, 3), glm::vec4(7, 7, 7, 1));
}

// What a look says of the display is what the options say, and the options go before it.
TEST_F(FrameLookSky, ExposesAndToneMapsAsTheOptionsDo) {
  const std::string sky = R"("sky": {"gradient": {}})";
  const WantedOutputs display{.linear = false, .display = true};
  Job plain = job_of(Body::diffuse, "{" + sky + "}");
  plain.exposure_ev = 1.5f, plain.tonemap = "reinhard";
  const Image wanted = images_of(plain, display)["display"];
  Job looked = plain;
  looked.exposure_ev.reset(), looked.tonemap.clear();
  looked.look = file("_display.look.json");
  std::ofstream(looked.look) << "{" + sky +
                                    R"(, "exposure": {"ev": {"keys": [[0, 0], [2, 3]]}},
                                         "tone_mapping": {"curve": "reinhard"}})";
  looked.dither = plain.dither = false;
  EXPECT_EQ(images_of(looked, display, 1)["display"], images_of(plain, display, 1)["display"]);
  looked.exposure_ev = -3.0f;
  EXPECT_NE(images_of(looked, display, 1)["display"], images_of(plain, display, 1)["display"]);
  // A wider range of agx darkens its whites.
  Job agx = plain;
  agx.tonemap = "agx";
  const Image narrow = images_of(agx, display)["display"];
  agx.look = file("_agx.look.json");
  std::ofstream(agx.look) << "{" + sky + R"(, "tone_mapping": {"agx_min_ev": -12.47393, "agx_max_ev": 9}})";
  const Image wide = images_of(agx, display)["display"];
  EXPECT_LT(wide.at<uint8_t>(4 * 3, 0), narrow.at<uint8_t>(4 * 3, 0));
}

}  // namespace candela::test
