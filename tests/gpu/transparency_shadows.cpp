// What see-through surfaces leave of a light (ColoredShadows): known products of sheets under suns and lamps, what is
// opaque about them, and the light that bodies bend.
#include "glass_fixture.h"

namespace candela::test {

class TransparencyShadows : public GlassTest {
 protected:
  enum class Lamp { sun, point, spot };
  static constexpr double interface_left = 1 - 0.04;  // of an index of 1.5, at normal incidence

  // A light on the z axis that shines down it onto a wall at z = -1.
  static GltfBuilder lit_wall(Lamp lamp, double alpha = 1) {
    GltfBuilder b = empty_scene();
    const char* const types[] = {"directional", "point", "spot"};
    Json light = {{"type", types[int(lamp)]}, {"intensity", lamp == Lamp::sun ? 2 : 60}};
    if (lamp == Lamp::spot) light["spot"] = {{"outerConeAngle", 0.7}, {"innerConeAngle", 0.6}};
    add_light(b, light, {{"translation", {0, 0, 5}}});
    for (const char* name :
         {"KHR_materials_transmission", "KHR_materials_ior", "KHR_materials_volume", "KHR_materials_dispersion"})
      b.json["extensionsUsed"].push_back(name);
    add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, alpha < 1 ? blended(0.8, alpha) : opaque(0.8)))},
                 {"translation", {0, 0, -1}}});
    return b;
  }
  static Json opaque(double grey) { return {{"pbrMetallicRoughness", base_color(grey, grey, grey)}}; }
  static Json blended(double grey, double alpha) {
    Json m = {{"pbrMetallicRoughness", base_color(grey, grey, grey, alpha)}};
    m["alphaMode"] = "BLEND";
    return m;
  }
  // From aside: nothing but the wall is seen at its middle.
  static Job from_aside(const GltfBuilder& b, std::vector<KnobSetting> settings = {}) {
    Job job = job_for(write(b), glass_width, glass_height, 1);
    look(job, {4, 0, 1}, {0, 0, -1}, 40);
    job.effects = "refraction,shadows";
    job.transparency = "phenomenological";
    job.settings = {{"sun", "mode", "single"}, {"sun", "single_px", "512"}};
    job.settings.insert(job.settings.end(), settings.begin(), settings.end());
    return job;
  }
  static glm::dvec3 middle(const Job& job) {
    return glm::dvec3(images_of(job)["beauty"].at<glm::vec4>(glass_width / 2, glass_height / 2));
  }
  // The wall's middle over what it is without anything before it.
  static glm::dvec3 left_of_light(Lamp lamp, const std::function<void(GltfBuilder&)>& add,
                                  const std::vector<KnobSetting>& settings = {}) {
    GltfBuilder with = lit_wall(lamp);
    add(with);
    static std::map<Lamp, glm::dvec3> bare;
    if (!bare.contains(lamp)) bare[lamp] = middle(from_aside(lit_wall(lamp)));
    return middle(from_aside(with, settings)) / bare[lamp];
  }
  static void expect_left(glm::dvec3 value, glm::dvec3 expected, const std::string& what, double by = 2e-3) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], by) << what << ", channel " << c;
  }
};

TEST_F(TransparencyShadows, ASheetColoursLight) {
  const glm::dvec3 color(0.9, 0.5, 0.2);
  for (const Lamp lamp : {Lamp::sun, Lamp::point, Lamp::spot}) {
    const double transmission = lamp == Lamp::spot ? 0.5 : 1;
    expect_left(left_of_light(lamp,
                              [&](GltfBuilder& b) {
                                add_sheet(b, glass_material({.color = color, .ior = 1.5, .transmission = transmission}),
                                          0.6f, {0, 0, 0.5});
                              }),
                interface_left * transmission * color, fmt::format("light {}", int(lamp)));
  }
}

// Products, in whatever order the sheets stand; a blended one takes its part of all colours.
TEST_F(TransparencyShadows, SheetsMultiply) {
  const glm::dvec3 colors[] = {{0.9, 0.5, 0.3}, {0.4, 0.9, 0.7}, {0.8, 0.6, 1}};
  const glm::dvec3 product = colors[0] * colors[1] * colors[2] * std::pow(interface_left, 3);
  for (const Lamp lamp : {Lamp::sun, Lamp::point})
    for (const int first : {0, 2})
      expect_left(
          left_of_light(
              lamp,
              [&](GltfBuilder& b) {
                for (int i = 0; i < 3; ++i)
                  add_sheet(b, glass_material({.color = colors[(first + i) % 3], .ior = 1.5}), 0.6f, {0, 0, 0.2 * i});
                add_sheet(b, blended(0.3, 0.25), 0.6f, {0, 0, 0.7});
              }),
          0.75 * product, fmt::format("light {}, from {}", int(lamp), first));
}

// What is opaque stays dark before and behind a sheet, and is lit in full where it stands before it.
TEST_F(TransparencyShadows, OpaqueCastersStayDark) {
  const Json glass = glass_material({.color = {0.9, 0.5, 0.2}, .ior = 1.5});
  const Json card = {{"pbrMetallicRoughness", base_color(0.8, 0.8, 0.8)}};
  for (const Lamp lamp : {Lamp::sun, Lamp::point})
    for (const double z : {0.8, -0.5})
      expect_left(left_of_light(lamp,
                                [&](GltfBuilder& b) {
                                  add_sheet(b, glass, 0.6f);
                                  add_sheet(b, card, 0.3f, {0, 0, z});
                                }),
                  glm::dvec3(0), fmt::format("light {}, card at {}", int(lamp), z), 1e-6);
  // The card is what the camera sees: the sheet behind it leaves its light alone.
  GltfBuilder alone = lit_wall(Lamp::sun), before = lit_wall(Lamp::sun);
  for (GltfBuilder* b : {&alone, &before}) add_sheet(*b, card, 0.3f, {0, 0, 0.5});
  add_sheet(before, glass, 0.6f);
  const auto card_of = [](const GltfBuilder& b) {
    Job job = from_aside(b);
    look(job, {2, 0, 4}, {0, 0, 0.5}, 20);
    return middle(job);
  };
  const glm::dvec3 lit = card_of(before);
  expect_left(lit / card_of(alone), glm::dvec3(1), "a card before the sheet", 1e-6);
}

// Without bodies, surfaces that are seen through, or the method, nothing of it is there.
TEST_F(TransparencyShadows, IsLeftOutWhereNothingNeedsIt) {
  GltfBuilder b = lit_wall(Lamp::sun);
  add_sheet(b, glass_material({.color = {0.9, 0.5, 0.2}}), 0.6f, {0, 0, 0.5});
  const auto passes = [](const Job& job) { return plan_text(*render(*open(job)).plan); };
  EXPECT_NE(passes(from_aside(b)).find("colored_shadows.sun.maps"), std::string::npos);
  EXPECT_EQ(passes(from_aside(b)).find("back_positions"), std::string::npos);  // a sheet bends nothing
  const auto is_absent = [&](const Job& job) {
    return passes(job).find("colored_shadows.sun.maps") == std::string::npos;
  };
  EXPECT_TRUE(is_absent(from_aside(b, {{"colored_shadows", "scale", "off"}})));
  Job sorted = from_aside(b);
  sorted.transparency = "sorted";
  EXPECT_FALSE(is_absent(sorted));  // whatever the method
  EXPECT_TRUE(is_absent(from_aside(lit_wall(Lamp::sun))));
}

// Finer images have finer edges.
TEST_F(TransparencyShadows, MoreTexelsTendToOnePicture) {
  GltfBuilder b = lit_wall(Lamp::sun);
  for (int i = 0; i < 12; ++i) {
    const double turn = 0.1 + 0.4 * i;
    add_node(b, {{"mesh", add_square_mesh(b, 0.15f, add_material(b, glass_material({.color = {0.9, 0.3, 0.1}})))},
                 {"translation", {-1.1 + 0.55 * (i % 4), -0.5 + 0.5 * (i / 4), 0.5}},
                 {"rotation", {0, 0, std::sin(turn / 2), std::cos(turn / 2)}}});
  }
  const auto with = [&](const char* scale, const char* size_px) {
    return images_of(from_aside(b, {{"colored_shadows", "scale", scale}, {"sun", "single_px", size_px}}))["beauty"]
        .values<glm::vec4>();
  };
  const auto fine = with("full", "2048");
  const auto off_by = [&](const std::vector<glm::vec4>& a) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += std::pow(double(glm::length(a[i] - fine[i])), 2);
    return std::sqrt(sum / double(a.size()));
  };
  const double off = off_by(with("off", "256")), half = off_by(with("half", "256")), full = off_by(with("full", "256"));
  EXPECT_LT(half, 0.5 * off);
  EXPECT_LT(full, 0.75 * half);
}

// A slab straight before the light tints and absorbs as its two sides and its thickness say, whether light is bent or
// goes straight on.
TEST_F(TransparencyShadows, ASlabAbsorbs) {
  const Glass glass{
      .color = {0.9, 0.8, 0.7}, .ior = 1.5, .thickness_m = 0.2, .attenuation = {0.5, 0.8, 0.9}, .distance_m = 0.2};
  const glm::dvec3 expected = glass.color * glass.color * glass.attenuation * (interface_left / 1.04);
  for (const Lamp lamp : {Lamp::sun, Lamp::point})
    for (const char* steps : {"0", "3"})
      expect_left(left_of_light(lamp,
                                [&](GltfBuilder& b) {
                                  add_shape(b, box({1.2, 1.2, 0.2}), glass_material(glass), {0, 0, 0.3});
                                },
                                {{"colored_shadows", "steps", steps}}),
                  expected, fmt::format("light {}, {} steps", int(lamp), steps),
                  lamp == Lamp::sun ? 2e-3 : 0.06);  // a lamp's rays spread less inside: brighter behind
}

// Of the lens below: how far from its axis light lands on the wall that meets it `h` off.
double landing_m(double h) {
  const double a2 = 0.25, c2 = 0.0225, middle = -0.3;
  const auto normal = [&](glm::dvec2 p) { return glm::normalize(glm::dvec2(p.x / a2, (p.y - middle) / c2)); };
  const glm::dvec2 front(h, middle + std::sqrt(c2 * (1 - h * h / a2)));
  const glm::dvec2 inside = glm::refract(glm::dvec2(0, -1), normal(front), 1 / 1.5);
  const double towards = front.x * inside.x / a2 + (front.y - middle) * inside.y / c2;
  const glm::dvec2 back = front - inside * (2 * towards / (inside.x * inside.x / a2 + inside.y * inside.y / c2));
  const glm::dvec2 leaving = glm::refract(inside, -normal(back), 1.5);
  return back.x + leaving.x * (-1 - back.y) / leaving.y;  // no number where all is reflected
}

// A lens gathers light: bright in its middle, dark about it, and no more of it than there was; every frame alike.
TEST_F(TransparencyShadows, ALensGathersLight) {
  GltfBuilder b = lit_wall(Lamp::sun);
  Shape lens = sphere(0.5, 192, 144);
  for (auto& p : lens.position) p.z *= 0.3;
  for (auto& n : lens.normal) n = glm::normalize(n / glm::dvec3(1, 1, 0.3));
  add_shape(b, lens, glass_material({.ior = 1.5, .thickness_m = 0.2}), {0, 0, -0.3});
  const auto wall_of = [&](const GltfBuilder& scene, const char* steps, const char* size_px = "2048") {
    Job job = from_aside(scene, {{"colored_shadows", "steps", steps}, {"sun", "single_px", size_px}});
    look(job, {2.2, 0, -0.2}, {0, 0, -1}, 40);  // beside the lens
    return images_of(job)["beauty"];
  };
  const GltfBuilder wall = lit_wall(Lamp::sun);
  const Image bent = wall_of(b, "8"), bare = wall_of(wall, "8");
  EXPECT_EQ(bent, wall_of(b, "8"));
  const auto fraction = [&](const Image& a, int x) {
    return a.at<glm::vec4>(x, glass_height / 2).y / bare.at<glm::vec4>(x, glass_height / 2).y;
  };
  // Near the axis light of the lens's middle and of a ring near its rim meet: the sum over both of areas' ratios.
  for (const int x : {glass_width / 2 - 1, glass_width / 2}) {
    const glm::dvec3 eye(2.2, 0, -0.2), forward = glm::normalize(glm::dvec3(0, 0, -1) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    const double half = std::tan(glm::radians(20.0)), off = (x + 0.5 - glass_width / 2) / (glass_height / 2);
    const glm::dvec3 d = forward + half * (off * right - 0.5 / (glass_height / 2) * glm::cross(right, forward));
    const double r = glm::length(glm::dvec2(eye + d * ((-1 - eye.z) / d.z)));
    double expected = 0;
    for (double h = 1e-3, before = landing_m(h); h < 0.5; h += 1e-3) {
      const double after = landing_m(h + 1e-3);
      if (std::isnan(after)) break;
      for (const double side : {-r, r})
        if ((before < side) != (after < side))
          expected += interface_left / 1.04 * (h + 5e-4) * 1e-3 / (r * std::abs(after - before));
      before = after;
    }
    // At the focus a texel holds 0.8 to 1.5 of this as it lies (maps of 1024 to 4096): the mean over maps whose texels
    // lie differently.
    double mean = 0;
    for (const char* size_px : {"1536", "2048", "2560", "3072", "3584", "4096"})
      mean += double(fraction(wall_of(b, "8", size_px), x)) / 6;
    EXPECT_NEAR(mean, expected, 0.15 * expected) << x;
  }
  float least = 1;
  for (int x = 0; x < glass_width; ++x) least = std::min(least, fraction(bent, x));
  EXPECT_LT(least, 0.2f);
}

// Of a blended wall, which is light's last surface: the same over what it is without anything before it.
class DeepShadows : public TransparencyShadows {
 protected:
  struct Sheet {
    double z, alpha;
  };
  static GltfBuilder wall_before(Lamp lamp, const std::vector<Sheet>& sheets) {
    GltfBuilder b = lit_wall(lamp, 0.6);
    for (const Sheet& sheet : sheets) add_sheet(b, blended(0.3, sheet.alpha), 0.6f, {0, 0, sheet.z});
    return b;
  }
  static double left_of_wall(Lamp lamp, const std::vector<Sheet>& sheets, std::vector<KnobSetting> settings = {},
                             const char* technique = "clustered") {
    const auto wall = [&](const GltfBuilder& b) {
      Job job = from_aside(b, settings);
      job.transparency = "layers";
      job.technique = technique;
      return middle(job).y;
    };
    return wall(wall_before(lamp, sheets)) / wall(lit_wall(lamp, 0.6));
  }
};

TEST_F(DeepShadows, BlendedSheetsDarkenABlendedOne) {
  for (const Lamp lamp : {Lamp::sun, Lamp::point, Lamp::spot}) {
    EXPECT_NEAR(left_of_wall(lamp, {{0.5, 0.7}}), 0.3, 2e-3) << int(lamp);
    EXPECT_NEAR(left_of_wall(lamp, {{0.5, 0.7}, {0, 0.5}, {-0.5, 0.25}}), 0.3 * 0.5 * 0.75, 2e-3) << int(lamp);
  }
  for (const char* technique : {"visibility", "deferred-tiled", "deferred-volumes", "forward-plus", "ray"})
    EXPECT_NEAR(left_of_wall(Lamp::sun, {{0.5, 0.7}}, {}, technique), 0.3, 2e-3) << technique;
  EXPECT_NEAR(left_of_wall(Lamp::point, {{0.5, 0.7}}, {{"local", "method", "traced"}}), 0.3, 2e-3);
}

// One that hides nothing is not there, one that hides all is opaque; the wall itself does not darken itself.
TEST_F(DeepShadows, EndsOfAlpha) {
  for (const Lamp lamp : {Lamp::sun, Lamp::point}) {
    EXPECT_EQ(left_of_wall(lamp, {{0.5, 0}}), 1) << int(lamp);
    EXPECT_LT(left_of_wall(lamp, {{0.5, 1}}), 1e-6) << int(lamp);
    EXPECT_LT(left_of_wall(lamp, {{0.8, 0.4}, {0.5, 1}, {0, 0.4}}), 1e-6) << int(lamp);
    EXPECT_NEAR(left_of_wall(lamp, {{0.5, 0.4}, {-1.5, 1}}), 0.6, 2e-3) << int(lamp);  // behind it
    const auto alone = [&](const char* scale) {
      Job job = from_aside(lit_wall(lamp, 0.6), {{"deep_shadows", "scale", scale}});
      return middle(job).y;
    };
    EXPECT_NEAR(alone("quarter"), alone("off"), 1e-4 * alone("off")) << int(lamp);
  }
}

// The middle of many: those behind it are not before it, the more exactly the more slices there are.
TEST_F(DeepShadows, MoreSlicesTendToTheProduct) {
  std::vector<Sheet> sheets;
  double expected = 1;
  for (int i = 0; i < 12; ++i) {
    sheets.push_back({0.95 - 0.31 * i + 0.07 * (i * i % 5), 0.1 + 0.02 * i});
    if (sheets.back().z > -1) expected *= 1 - sheets.back().alpha;
  }
  const auto off_by = [&](const char* slices) {
    return std::abs(left_of_wall(Lamp::sun, sheets, {{"deep_shadows", "slices", slices}}) - expected);
  };
  const double few = off_by("4"), some = off_by("8"), many = off_by("24");
  EXPECT_GT(few, some);
  EXPECT_GT(some, many);
  EXPECT_LT(many, 0.05 * expected);
}

// A lamp among the sheets: those on its other side leave its light alone.
TEST_F(DeepShadows, ALampBetweenSheets) {
  EXPECT_NEAR(left_of_wall(Lamp::point, {{5.5, 0.8}, {6, 1}}), 1, 1e-3);
  EXPECT_NEAR(left_of_wall(Lamp::point, {{5.5, 0.8}, {4.5, 0.4}, {4, 0.5}}), 0.3, 3e-3);
}

// The air behind a coloured sheet is lit through it; behind one that hides all it is dark.
TEST_F(DeepShadows, AirIsLitThroughSheets) {
  const auto air = [](Lamp lamp, const std::function<void(GltfBuilder&)>& add, const char* method) {
    GltfBuilder b = lit_wall(lamp);
    add(b);
    Job job = job_for(write(b), glass_width, glass_height, 1);
    look(job, {0, 3, -0.2}, {0, 0, -0.2}, 8);
    job.effects = "refraction,shadows,fog";
    job.settings = {{"sun", "mode", "single"}, {"sun", "single_px", "512"}, {"fog", "method", method}};
    job.look =
        look_file(R"({"fog": {"extinction": 0.1, "bounds": {"x": [-0.3, 0.3], "y": [-0.3, 0.3], "z": [-0.8, 0.3]}}})");
    return middle(job);
  };
  const glm::dvec3 color(0.9, 0.5, 0.2);
  const auto glass = [&](GltfBuilder& b) {
    add_sheet(b, glass_material({.color = color, .ior = 1.5}), 0.6f, {0, 0, 0.5});
  };
  const auto nothing = [](GltfBuilder&) {};
  for (const Lamp lamp : {Lamp::sun, Lamp::point})
    for (const char* method : {"froxels", "march", "pixels"}) {
      const std::string what = fmt::format("light {}, {}", int(lamp), method);
      const glm::dvec3 open = air(lamp, nothing, method);
      EXPECT_GT(open.x, 0) << what;
      expect_left(air(lamp, glass, method) / open, interface_left * color, what, 5e-3);
      expect_left(air(
                      lamp,
                      [](GltfBuilder& b) {
                        add_sheet(b, blended(0.3, 0.7), 0.6f, {0, 0, 0.5});
                      },
                      method) /
                      open,
                  glm::dvec3(0.3), what + ", blended", 5e-3);
      expect_left(air(
                      lamp,
                      [](GltfBuilder& b) {
                        add_sheet(b, blended(0.3, 1), 0.6f, {0, 0, 0.5});
                      },
                      method) /
                      open,
                  glm::dvec3(0), what + ", alpha 1", 1e-4);
    }
}

// Nothing of it is there where nothing takes it.
TEST_F(DeepShadows, IsLeftOutWhereNothingNeedsIt) {
  const auto is_there = [](const Job& job) {
    return plan_text(*render(*open(job)).plan).find("deep_shadows.sun.maps") != std::string::npos;
  };
  EXPECT_TRUE(is_there(from_aside(wall_before(Lamp::sun, {}))));
  EXPECT_FALSE(is_there(from_aside(lit_wall(Lamp::sun))));
  EXPECT_FALSE(is_there(from_aside(wall_before(Lamp::sun, {}), {{"deep_shadows", "scale", "off"}})));
}

}  // namespace candela::test
