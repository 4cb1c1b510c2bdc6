#include "look/look.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

namespace candela::test {
namespace {

Fog fog_of(const std::string& text) {
  const auto look = look_from_json(text, "l.json");
  EXPECT_TRUE(look) << (look ? "" : look.error().text());
  return look && look->fog ? *look->fog : Fog{};
}

}  // namespace

TEST(Look, SaysWhatFogIs) {
  const Fog fog =
      fog_of(R"({"fog": {"extinction": [0.1, 0.2, 0.3], "albedo": [1, 0.5, 0], "anisotropy": -0.98, "emission": 2,
                             "falloff": 20.7, "height": -3, "bounds": {"y": [-1, 2.5], "x": [0, 1]}}})");
  EXPECT_EQ(fog.extinction_per_m, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(fog.scattering_per_m, glm::dvec3(0.1, 0.1, 0));
  EXPECT_EQ(fog.emission_per_m, glm::dvec3(2));
  EXPECT_EQ(fog.anisotropy, -0.98);
  EXPECT_EQ(fog.falloff_per_m, 20.7);
  EXPECT_EQ(fog.height_m, -3);
  EXPECT_EQ(fog.lowest.x, 0);
  EXPECT_EQ(fog.highest.y, 2.5);
  EXPECT_EQ(fog.lowest.z, -std::numeric_limits<double>::infinity());

  const Fog parts = fog_of(R"({"fog": {"scattering": 0.25, "absorption": [0.5, 0, 1]}})");
  EXPECT_EQ(parts.extinction_per_m, glm::dvec3(0.75, 0.25, 1.25));
  EXPECT_EQ(parts.scattering_per_m, glm::dvec3(0.25));
  const auto several = look_from_json(
      R"({"fog": {"extinction": 1, "boxes": [{"extinction": 2, "bounds": {"x": [0, 1], "z": [0, 1]}, "rotation_deg": 90},
                                            {"scattering": {"keys": [[0, 1], [2, 3]]}}]}})",
      "l.json", 1);
  ASSERT_TRUE(several && several->fog);
  EXPECT_EQ(several->fog->extinction_per_m, glm::dvec3(1));
  ASSERT_EQ(several->more_fog.size(), 2u);
  EXPECT_NEAR(several->more_fog[0].turn_rad, 1.5707963267948966, 1e-12);
  EXPECT_EQ(several->more_fog[1].scattering_per_m, glm::dvec3(2));
  EXPECT_EQ(summed_fog(*several), 3u);
  const auto boxes = look_from_json(R"({"fog": {"boxes": [{"extinction": 3}]}})", "l.json");
  ASSERT_TRUE(boxes && boxes->fog);
  EXPECT_EQ(boxes->fog->extinction_per_m, glm::dvec3(3));
  EXPECT_EQ(summed_fog(*boxes), 0u) << "one medium, wherever it stands";
  EXPECT_EQ(fog_of(R"({"fog": {"extinction": 1e6}})").scattering_per_m, glm::dvec3(1e6)) << "albedo is 1 by default";
  EXPECT_FALSE(look_from_json("{}", "l.json")->fog);
}

TEST(Look, SaysHowLargeTheSunIs) {
  const auto radius = [](const char* text) {
    const auto look = look_from_json(text, "l.json");
    return look && look->sun ? look->sun->angular_radius_deg : -1;
  };
  EXPECT_EQ(radius(R"({"sun": {"angular_radius_deg": 5.5}})"), 5.5);
  EXPECT_EQ(radius(R"({"sun": {"angular_radius_deg": 0}})"), 0);
  EXPECT_EQ(radius(R"({"sun": {}})"), 0.2666) << "the real sun's by default";
  EXPECT_EQ(radius("{}"), -1);
  for (const char* wrong : {R"({"sun": {"angular_radius_deg": -1}})", R"({"sun": {"angular_radius_deg": 45.1}})",
                            R"({"sun": {"angular_radius_deg": "1"}})", R"({"sun": 1})"}) {
    const auto look = look_from_json(wrong, "l.json");
    ASSERT_FALSE(look) << wrong;
    EXPECT_EQ(look.error().kind, ErrorKind::input);
    EXPECT_NE(look.error().text().find("l.json: /sun"), std::string::npos) << look.error().text();
  }
}

TEST(Look, SaysHowLargeLampsAre) {
  const auto look = look_from_json(R"({"lights": {"radius_m": 0.05}})", "l.json");
  ASSERT_TRUE(look) << look.error().text();
  EXPECT_EQ(look->lights.radius_m, 0.05);
  EXPECT_EQ(switched_on(*look), std::vector<std::string>{"local lights of a size"});
  EXPECT_EQ(look_from_json("{}", "l.json")->lights.radius_m, 0);
  EXPECT_EQ(look_from_json(R"({"lights": {"radius_m": {"keys": [[0, 0], [2, 1]]}}})", "l.json", 1)->lights.radius_m,
            0.5);
  for (const char* wrong : {R"({"lights": {"radius_m": -1}})", R"({"lights": {"radius_m": 1e39}})",
                            R"({"lights": {"radius": 1}})", R"({"lights": 1})"}) {
    const auto refused = look_from_json(wrong, "l.json");
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().kind, ErrorKind::input);
    EXPECT_NE(refused.error().text().find("l.json: /lights"), std::string::npos) << refused.error().text();
  }
}

TEST(Look, MarksLightsForShadows) {
  const auto marks = look_from_json(R"({"shadows": {"lights": ["a", "b"]}})", "l.json");
  ASSERT_TRUE(marks) << marks.error().text();
  EXPECT_EQ(marks->shadows.lights, (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(look_from_json("{}", "l.json")->shadows.lights.empty());
  for (const char* wrong :
       {R"({"shadows": {"lights": "a"}})", R"({"shadows": {"lights": [1]}})", R"({"shadows": {"lamps": []}})"}) {
    const auto refused = look_from_json(wrong, "l.json");
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().kind, ErrorKind::input);
    EXPECT_NE(refused.error().text().find("l.json: /shadows"), std::string::npos) << refused.error().text();
  }
}

TEST(Look, SaysHowFarSurfacesHideTheSky) {
  const auto look = look_from_json(R"({"occlusion": {"radius_m": 2, "falloff": 0.5}})", "l.json");
  ASSERT_TRUE(look && look->occlusion);
  const Occlusion& o = *look->occlusion;
  EXPECT_EQ(o.strength, 1);
  EXPECT_EQ(o.hidden(0), 1);
  EXPECT_EQ(o.hidden(1), 1) << "up to (1 - falloff) radii";
  EXPECT_DOUBLE_EQ(o.hidden(1.5), 0.5);
  EXPECT_EQ(o.hidden(2), 0);
  EXPECT_EQ(o.hidden(std::numeric_limits<double>::infinity()), 0);
  EXPECT_EQ((Occlusion{1, 0, 1}.hidden(0.999)), 1) << "a hard end";
  EXPECT_FALSE(look_from_json("{}", "l.json")->occlusion);
  for (const char* wrong :
       {R"({"occlusion": {"radius_m": 0}})", R"({"occlusion": {"radius_m": -1}})", R"({"occlusion": {"falloff": 1.1}})",
        R"({"occlusion": {"strength": 2}})", R"({"occlusion": {"radius": 1}})", R"({"occlusion": 1})"}) {
    const auto refused = look_from_json(wrong, "l.json");
    ASSERT_FALSE(refused) << wrong;
    EXPECT_NE(refused.error().text().find("l.json: /occlusion"), std::string::npos) << refused.error().text();
  }
}

TEST(Look, ReadsBloomAndItsPreset) {
  const auto plain = look_from_json(R"({"bloom": {"strength": 0.1, "weights": [1, 2]}})", "l.json");
  ASSERT_TRUE(plain && plain->bloom);
  EXPECT_EQ(plain->bloom->strength, 0.1);
  EXPECT_EQ(plain->bloom->threshold, 0);
  EXPECT_EQ(plain->bloom->weights, (std::vector<double>{1, 2}));
  EXPECT_TRUE(plain->bloom->keeps);
  const auto preset = look_from_json(R"({"bloom": {"knee": 0.5, "preset": "city-lights"}})", "l.json");
  ASSERT_TRUE(preset && preset->bloom);
  EXPECT_EQ(preset->bloom->threshold, 1.5);
  EXPECT_EQ(preset->bloom->knee, 0.5) << "keys go over the preset, in any order";
  EXPECT_EQ(preset->bloom->weights, (std::vector<double>{1, 0.5, 0.25, 0.125, 0.0625}));
  for (const char* wrong :
       {R"({"bloom": {"strength": 2}})", R"({"bloom": {"weights": []}})", R"({"bloom": {"weights": [0, 0]}})",
        R"({"bloom": {"weights": [-1]}})", R"({"bloom": {"preset": "none"}})", R"({"bloom": {"keeps": 1}})"})
    EXPECT_FALSE(look_from_json(wrong, "l.json")) << wrong;
}

TEST(Look, IsEvaluatedAtATime) {
  const std::string text = R"({"bloom": {"strength": {"keys": [[1, 0.2], [3, 0.6]]}}})";
  for (const auto& [time, strength] :
       {std::pair(0.0, 0.2), std::pair(1.0, 0.2), std::pair(2.0, 0.4), std::pair(9.0, 0.6)}) {
    const auto look = look_from_json(text, "l.json", time);
    ASSERT_TRUE(look && look->bloom) << time;
    EXPECT_DOUBLE_EQ(look->bloom->strength, strength) << time;
  }
  const auto fog =
      look_from_json(R"({"fog": {"extinction": {"keys": [[0, [1, 2, 3]], [2, [3, 2, 1]]]}}})", "l.json", 1);
  ASSERT_TRUE(fog && fog->fog);
  EXPECT_EQ(fog->fog->extinction_per_m, glm::dvec3(2, 2, 2));
  for (const char* wrong :
       {R"({"bloom": {"strength": {"keys": []}}})", R"({"bloom": {"strength": {"keys": [[1, 0], [1, 1]]}}})",
        R"({"bloom": {"strength": {"keys": [[0, 0], [1, [1, 2]]]}}})"})
    EXPECT_FALSE(look_from_json(wrong, "l.json")) << wrong;
}

TEST(Look, NamesFileAndPlaceOfWhatIsWrong) {
  const std::vector<std::array<const char*, 3>> cases = {
      {R"({"fogg": {}})", "l.json: /fogg", "did you mean 'fog'"},
      {R"({"fog": {"extinction": 1, "extiction": 1}})", "l.json: /fog/extiction", "extinction"},
      {R"({"fog": {"extinction": "1"}})", "l.json: /fog/extinction", "not a number"},
      {R"({"fog": {"extinction": true}})", "l.json: /fog/extinction", "not a number"},
      {R"({"fog": {"extinction": [1, 2]}})", "l.json: /fog/extinction", "2 values"},
      {R"({"fog": {"extinction": [1, -2, 1]}})", "l.json: /fog/extinction/1", "below 0"},
      {R"({"fog": {"extinction": [1, 1, 1e39]}})", "l.json: /fog/extinction/2", "32-bit"},
      {R"({"fog": {"extinction": 1e999}})", "l.json: /fog/extinction", "out of range"},
      {R"({"fog": {"extinction": NaN}})", "l.json", "JSON"},
      {R"({"fog": {"scattering": 3e38, "absorption": 3e38}})", "l.json: /fog", "32-bit"},
      {R"({"fog": {"extinction": 1, "albedo": 1.01}})", "l.json: /fog/albedo", "at most 1"},
      {R"({"fog": {"extinction": 1, "anisotropy": 0.99}})", "l.json: /fog/anisotropy", "0.98"},
      {R"({"fog": {"extinction": 1, "anisotropy": [0, 0, 0]}})", "l.json: /fog/anisotropy", "not a number"},
      {R"({"fog": {"extinction": 1, "falloff": -0.1}})", "l.json: /fog/falloff", "below 0"},
      {R"({"fog": {"extinction": 1, "bounds": {"y": [2, 1]}}})", "l.json: /fog/bounds/y", "not below"},
      {R"({"fog": {"extinction": 1, "bounds": {"y": 2}}})", "l.json: /fog/bounds/y", "two numbers"},
      {R"({"fog": {"extinction": 1, "bounds": {"w": [1, 2]}}})", "l.json: /fog/bounds/w", "key"},
      {R"({"fog": {"extinction": 1, "scattering": 1}})", "l.json: /fog", "one pair"},
      {R"({"fog": {"albedo": 1}})", "l.json: /fog", "lacks extinction"},
      {R"({"fog": {"boxes": []}})", "l.json: /fog", "boxes that have one"},
      {R"({"fog": {"boxes": {}}})", "l.json: /fog/boxes", "not a list of objects"},
      {R"({"fog": {"boxes": [{"extinction": 1}, {"albedo": 1}]}})", "l.json: /fog/boxes/1", "lacks extinction"},
      {R"({"fog": {"albedo": 1, "boxes": [{"extinction": 1}]}})", "l.json: /fog", "lacks extinction"},
      {R"({"fog": {"boxes": [{"extinction": 1, "boxes": []}]}})", "l.json: /fog/boxes/0/boxes", "unknown key"},
      {R"({"fog": {"extinction": 1, "rotation_deg": 5}})", "l.json: /fog/rotation_deg", "bounds"},
      {R"({"fog": {"extinction": [1, 0, 1], "emission": [0, 1, 0]}})", "l.json: /fog/emission", "extinction above 0"},
      {R"({"fog": {"extinction": 1, "extinction": 2}})", "l.json: /fog/extinction", "twice"},
      {R"({"sky": {"rotation_deg": "90"}})", "l.json: /sky/rotation_deg", "not a number"},
      {R"({"sky": {"intensity": -1}})", "l.json: /sky/intensity", "below 0"},
      {R"({"sky": {"rotation": 90}})", "l.json: /sky/rotation", "rotation_deg"},
      {R"({"fog": []})", "l.json: /fog", "not an object"},
      {R"([])", "l.json", "object"},
      {R"({"fog": {"extinction": 1},})", "l.json", "JSON"},
      {"", "l.json", "JSON"},
  };
  for (const auto& [text, place, what] : cases) {
    const auto look = look_from_json(text, "l.json");
    ASSERT_FALSE(look) << text;
    EXPECT_EQ(look.error().kind, ErrorKind::input);
    EXPECT_EQ(look.error().place, place) << text;
    EXPECT_NE(look.error().message.find(what), std::string::npos) << look.error().text();
  }
  EXPECT_FALSE(read_look("no such file.json"));
}

TEST(Look, TurnsAndDimsTheSky) {
  const auto look =
      look_from_json(R"({"sky": {"rotation_deg": {"keys": [[0, 0], [2, 90]]}, "intensity": 0.5}})", "l", 1);
  ASSERT_TRUE(look) << look.error().text();
  EXPECT_EQ(look->sky.rotation_deg, 45);
  EXPECT_EQ(look->sky.intensity, 0.5);
  EXPECT_EQ(look_from_json("{}", "l")->sky.intensity, 1);
}

TEST(Look, InterpolatesAsItIsTold) {
  const auto at = [](const std::string& how, double time_s) {
    const auto look = look_from_json(
        R"({"bloom": {"strength": {"keys": [[0, 0], [1, 0], [2, 1], [4, 1]], "interpolation": ")" + how + "\"}}}", "l",
        time_s);
    EXPECT_TRUE(look) << look.error().text();
    return look ? look->bloom->strength : -1;
  };
  EXPECT_EQ(at("step", 1.99), 0);
  EXPECT_EQ(at("step", 2), 1);
  EXPECT_DOUBLE_EQ(at("linear", 1.25), 0.25);
  // Flat on both sides of the rise: a smoothstep, and never below or above its keys.
  EXPECT_DOUBLE_EQ(at("cubic", 1.25), 0.25 * 0.25 * (3 - 2 * 0.25));
  EXPECT_DOUBLE_EQ(at("cubic", 1.5), 0.5);
  for (double t = -1; t < 5; t += 0.01) {
    EXPECT_GE(at("cubic", t), 0) << t;
    EXPECT_LE(at("cubic", t), 1) << t;
  }
  // Rising throughout: the tangent at a key is the harmonic mean of its slopes, 2/(1/1 + 1/3) for equal steps.
  const auto rising = [](double t) {
    return look_from_json(R"({"bloom": {"keeps": false, "strength": {"keys": [[0, 0], [1, 1], [2, 4]],
                              "interpolation": "cubic"}}})",
                          "l", t)
        ->bloom->strength;
  };
  const double h = 1e-6;
  EXPECT_NEAR((rising(1 + h) - rising(1 - h)) / (2 * h), 1.5, 1e-5);
  for (const char* wrong : {R"({"bloom": {"strength": {"keys": [[0, 0]], "interpolation": "cubik"}}})",
                            R"({"bloom": {"strength": {"keys": [[0, 0]], "interpolation": 1}}})",
                            R"({"bloom": {"strength": {"keys": [[0, 0]], "interpolaton": "step"}}})"})
    EXPECT_FALSE(look_from_json(wrong, "l")) << wrong;
  EXPECT_NE(look_from_json(R"({"bloom": {"strength": {"keys": [[0, 0]], "interpolation": "cubik"}}})", "l")
                .error()
                .message.find("did you mean 'cubic'"),
            std::string::npos);
}

// A value that is wrong at a later key is refused when the file is read, not minutes into a sequence.
TEST(Look, IsCheckedAtAllItsKeys) {
  const std::string file = ::testing::TempDir() + "candela_keys.look.json";
  std::ofstream(file) << R"({"occlusion": {"strength": {"keys": [[0, 0.5], [7.5, 1.5]]}}})";
  const auto read = read_look_file(file);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().text().find("/occlusion/strength: at 7.5 s: 1.5 is above 1"), std::string::npos)
      << read.error().text();
}

// The first wrong key of a hundred thousand is named, and a right file is read once, for frames at any time; all of it
// in time that grows with the keys alone (a quadratic reader takes minutes over this test).
TEST(Look, OfAHundredThousandKeysIsReadOnce) {
  constexpr int count = 100'000;
  const std::string file = ::testing::TempDir() + "candela_many_keys.look.json";
  const auto write = [&](int wrong) {
    std::ofstream out(file);
    out << R"({"exposure": {"ev": {"keys": [)";
    for (int i = 0; i < count; ++i)
      out << (i > 0 ? "," : "") << '[' << i << ',' << (i >= wrong ? 1000 + i : i % 7) << ']';
    out << R"(]}}, "fog": {"extinction": {"keys": [[0, [1, 2, 3]], [99999, [3, 2, 1]]], "interpolation": "cubic"}}})";
  };
  write(count);
  const auto read = read_look_file(file);
  ASSERT_TRUE(read) << read.error().text();
  for (const int at : {0, 1, 13, 50'000, count - 2})
    EXPECT_NEAR(*read->at(at + 0.25)->exposure.ev, 0.75 * (at % 7) + 0.25 * ((at + 1) % 7), 1e-12) << at;
  EXPECT_EQ(read->at(-1)->exposure.ev, 0);
  EXPECT_EQ(read->at(1e6)->exposure.ev, (count - 1) % 7);
  EXPECT_EQ(read->at(1e6)->fog->extinction_per_m, glm::dvec3(3, 2, 1));
  write(77'777);
  const auto wrong = read_look_file(file);
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("/exposure/ev: at 77777 s: 78777 is"), std::string::npos) << wrong.error().text();
}

TEST(Look, SaysHowBrightThePictureIsAndHowItIsShown) {
  const auto look = look_from_json(
      R"({"exposure": {"ev": {"keys": [[0, 1.5], [10, -2.5]]}},
          "tone_mapping": {"curve": "agx", "agx_min_ev": -14, "agx_max_ev": {"keys": [[0, 4], [10, 1]]}}})",
      "l", 5);
  ASSERT_TRUE(look) << look.error().text();
  EXPECT_EQ(look->exposure.ev, -0.5);
  EXPECT_EQ(look->tone_mapping.curve, "agx");
  EXPECT_EQ(look->tone_mapping.agx_min_ev, -14);
  EXPECT_EQ(look->tone_mapping.agx_max_ev, 2.5);
  const auto none = look_from_json("{}", "l");
  EXPECT_FALSE(none->exposure.ev);
  EXPECT_TRUE(none->tone_mapping.curve.empty());
  for (const char* wrong : {R"({"exposure": {"ev": 101}})", R"({"tone_mapping": {"curve": "agxx"}})",
                            R"({"tone_mapping": {"agx_min_ev": 2, "agx_max_ev": 2}})"})
    EXPECT_FALSE(look_from_json(wrong, "l")) << wrong;
}

TEST(Look, SaysWhatTheSkyIs) {
  const auto look = look_from_json(
      R"({"sky": {"gradient": {"zenith": [0, 0, 1], "exponent": 2}, "blur_deg": 3,
          "second": {"image": "night", "intensity": 0.1, "follows_sun": {"from_deg": -10}}}})",
      "l");
  ASSERT_TRUE(look) << look.error().text();
  EXPECT_EQ(look->sky.gradient->zenith, glm::dvec3(0, 0, 1));
  EXPECT_EQ(look->sky.gradient->exponent, 2);
  EXPECT_EQ(look->sky.blur_deg, 3);
  EXPECT_TRUE(look->sky.second->follows_sun);
  EXPECT_EQ(look->sky.second->from_deg, -10);
  EXPECT_EQ(look->sky.second->to_deg, 0);
  EXPECT_EQ(switched_on(*look), (std::vector<std::string>{"sky gradient", "second sky", "blurred background"}));
  EXPECT_TRUE(look_from_json(R"({"sky": {"atmosphere": {}}})", "l")->sky.atmosphere);
  EXPECT_FALSE(look_from_json(R"({"sky": {"atmosphere": {}}})", "l")->sky.atmosphere->sun_lux);
  for (const char* wrong :
       {R"({"sky": {"gradient": {}, "image": "a.hdr"}})", R"({"sky": {"gradient": {}, "atmosphere": {}}})",
        R"({"sky": {"second": {"image": "n"}}})", R"({"sky": {"second": {"weight": 1}}})",
        R"({"sky": {"second": {"image": "n", "weight": 1, "follows_sun": {}}}})",
        R"({"sky": {"second": {"image": "n", "follows_sun": {"from_deg": 5, "to_deg": 5}}}})",
        R"({"sky": {"second": {"image": "", "weight": 1}}})", R"({"sky": {"blur_deg": 91}})"}) {
    const auto refused = look_from_json(wrong, "l");
    ASSERT_FALSE(refused) << wrong;
    EXPECT_NE(refused.error().text().find("l: /sky"), std::string::npos) << refused.error().text();
  }
}

TEST(Look, LiesBesideItsScene) {
  const std::filesystem::path folder = ::testing::TempDir();
  const auto file = folder / "candela_beside.look.json";
  std::ofstream(file) << "{}";
  EXPECT_EQ(look_beside(folder / "candela_beside.glb"), file);
  EXPECT_EQ(look_beside(folder / "candela_beside.gltf"), file);
  EXPECT_TRUE(look_beside(folder / "candela_nothing_beside.glb").empty());
}

}  // namespace candela::test
