// Choices that go together: each pair of two of them (technique, method of transparency, samples, quality, effect)
// stands in a row of one table, and each row's picture is that with every light at every pixel bit for bit, and the
// reference's within what its choices state. The choices are the program's own lists: a new one joins by itself, and
// needs a row in `allowed` where it is not exact.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

#include "bench/shared_renderer.h"
#include "passes/post/supersample.h"
#include "passes/surfaces/terms.h"
#include "passes/volumes/fog_layers.h"
#include "reference/bloom.h"
#include "reference/integrator.h"
#include "render/reference_frame.h"
#include "testscenes/table.h"

namespace candela::test {
namespace {

constexpr int width = 32, height = 24;

// What a choice may add to the error at each quality: the root of the mean squared relative error (t^2 + 0.01 below) of
// the pixels but the worst twentieth, which edges are, without the reference's noise. Of what is exact at a quality
// rounding is left. Measured, a choice alone with `layers` and one sample, and not more than a quarter above.
enum QualityIndex : size_t { at_draft, at_high, at_exact };
struct Allowed {
  std::string_view choice;
  std::array<double, 3> error;  // draft, high, exact
  std::string_view why;
};
constexpr Allowed allowed[] = {
    {"1 sample", {0.0005, 0.0005, 0.0005}, "corners rounded to 1/256 pixel"},
    {"4 samples", {0.015, 0.015, 0.015}, "a pixel's surface is shaded once, at the middle of its samples"},
    {"2x2 pictures", {0.0005, 0.0005, 0.0005}, "as one sample"},
    {"weighted", {0.057, 0.057, 0.057}, "the order of two sheets is not known"},
    {"moments", {0.0035, 0.0035, 0.0035}, "the nearer sheet dims itself by a quarter"},
    {"phenomenological", {0.088, 0.088, 0.088}, "the order of two sheets is not known"},
    {"shadows", {0.06, 0.06, 0}, "blended surfaces cast none into maps, and texels of maps at edges"},
    {"occlusion", {0.03, 0.029, 0.017}, "blended surfaces take none; what is seen is taken to have a thickness"},
    {"fog", {0.0041, 0.0004, 0}, "light between the nodes of a grid"},
    {"reflections", {0.0055, 0.0045, 0.0028}, "what the picture does not hold is not mirrored"},
    {"refraction", {0.001, 0.001, 0.001}, "texels between those behind"},
    {"ibl", {0.002, 0.002, 0.002}, "split sums of lobes"},
    {"probes", {0.007, 0.007, 0.007}, "the scene is taken to lie on a box"},
    {"bloom", {0.0026, 0.0027, 0.001}, "a level's kernel is no Gaussian, and that of `exact` ends at four deviations"},
    {"exposure", {0, 0, 0}, "of display output"},
    {"volumetric", {0.105, 0.024, 0}, "texels of 4 and of 2 pixels of 32, and steps of a ray"},
};
double allowed_of(const std::string& choice, QualityIndex quality) {
  for (const Allowed& a : allowed)
    if (a.choice == choice) return a.error[quality];
  return 0;
}

struct Row {
  std::string technique, transparency, samples, quality, effect;
  bool has(std::string_view other) const { return effect == other; }
  std::string text() const {
    return fmt::format("{}, {}, {}, {}, {}", technique, transparency, samples, quality, effect);
  }
  double allowed_error() const {
    const QualityIndex at = quality == "draft" ? at_draft : quality == "high" ? at_high : at_exact;
    return allowed_of(samples, at) + allowed_of(transparency, at) + allowed_of(effect, at);
  }
};

// Few rows of one level for each factor so that any two levels of two factors stand together in one: each row begins
// with the first pair that no row has yet, and takes factor by factor the level that makes most new pairs.
using Levels = std::vector<size_t>;
std::vector<Levels> covering_rows(const Levels& count) {
  const size_t factors = count.size();
  std::set<std::array<size_t, 4>> open;
  for (size_t a = 0; a < factors; ++a)
    for (size_t b = a + 1; b < factors; ++b)
      for (size_t i = 0; i < count[a]; ++i)
        for (size_t j = 0; j < count[b]; ++j) open.insert({a, b, i, j});
  const auto pair_of = [](size_t a, size_t i, size_t b, size_t j) {
    return a < b ? std::array{a, b, i, j} : std::array{b, a, j, i};
  };
  std::vector<Levels> rows;
  while (!open.empty()) {
    constexpr size_t none = size_t(-1);
    Levels row(factors, none);
    const auto [a, b, i, j] = *open.begin();
    row[a] = i, row[b] = j;
    for (size_t f = 0; f < factors; ++f) {
      if (row[f] != none) continue;
      size_t best = 0, most = 0;
      for (size_t k = 0; k < count[f]; ++k) {
        const size_t level = (k + rows.size()) % count[f];  // of equals, another one in each row
        size_t made = 0;
        for (size_t other = 0; other < factors; ++other)
          if (other != f && row[other] != none) made += open.contains(pair_of(f, level, other, row[other]));
        if (k == 0 || made > most) best = level, most = made;
      }
      row[f] = best;
    }
    for (size_t f = 0; f < factors; ++f)
      for (size_t g = f + 1; g < factors; ++g) open.erase({f, g, row[f], row[g]});
    rows.push_back(std::move(row));
  }
  return rows;
}

const std::vector<std::string> all_samples = {"1 sample", "4 samples", "2x2 pictures"};
const std::vector<std::string> all_qualities = {"draft", "high", "exact"};  // `normal` lies between

std::vector<std::string> all_effects() {
  std::vector<std::string> names = effect_names();
  names.insert(names.begin(), "none");
  return names;
}

std::vector<Row> table() {
  const std::vector<std::string> techniques = technique_names(), methods = transparency_names(),
                                 effects = all_effects();
  std::vector<Row> rows;
  for (const Levels& levels :
       covering_rows({techniques.size(), methods.size(), all_samples.size(), all_qualities.size(), effects.size()}))
    rows.push_back({techniques[levels[0]], methods[levels[1]], all_samples[levels[2]], all_qualities[levels[3]],
                    effects[levels[4]]});
  return rows;
}

// --- the scene -----------------------------------------------------------------------------------------------------

json see_through(glm::dvec3 color, double alpha) {
  json material = pbr({color, alpha}, 0, 0.6);
  material["alphaMode"] = "BLEND", material["doubleSided"] = true;
  return material;
}

// Opaque, masked, blended, lobed and glass surfaces under a sun, a lamp and a spot. The sun shines from behind and the
// lamps stand behind the glass, so that its shadow is not seen. The glass bends nothing and has no gloss: as the
// reference's `direct` has no glass, a dark sheet that covers as much stands for it.
constexpr double glass_lets_through = 0.6;
std::vector<std::byte> scene_bytes(bool stands_for_glass) {
  GlbWriter out;
  for (const char* name : {"KHR_materials_transmission", "KHR_materials_ior", "KHR_materials_specular",
                           "KHR_materials_unlit", "KHR_materials_clearcoat", "KHR_materials_sheen"})
    out.use_extension(name);
  const auto put = [&](const Shape& shape, json material, glm::dvec3 at) {
    out.node("thing", {{"mesh", out.mesh("thing", out.primitive(shape), out.material("thing", std::move(material)))},
                       {"translation", vector_json(at)}});
  };
  put(ground(9, 4, 1), pbr({0.6, 0.55, 0.5, 1}, 0, 0.8), {0, 0, 0});
  put(quad(9, 5), pbr({0.4, 0.5, 0.7, 1}, 0, 0.9), {0, 2.5, -3});
  put(box({0.9, 1.4, 0.9}), pbr({0.7, 0.3, 0.2, 1}, 0, 0.5), {-1.5, 0.7, -0.6});
  json coated = pbr({0.2, 0.4, 0.6, 1}, 0.3, 0.6);
  coated["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", 0.8}, {"clearcoatRoughnessFactor", 0.4}};
  coated["extensions"]["KHR_materials_sheen"] = {{"sheenColorFactor", {0.3, 0.2, 0.1}}, {"sheenRoughnessFactor", 0.5}};
  put(sphere(0.7, 48, 32), coated, {0.2, 0.7, -0.8});
  json metal = pbr({0.8, 0.7, 0.5, 1}, 1, 0.3);
  put(box({0.7, 0.7, 0.7}), metal, {1.5, 0.35, -0.4});
  Shape fence = quad(1.2, 1.2);
  for (size_t i = 0; i < fence.position.size(); ++i) fence.color.emplace_back(1, 1, 1, fence.position[i].x > 0 ? 1 : 0);
  json masked = pbr({0.3, 0.6, 0.2, 1}, 0, 0.7);
  masked["alphaMode"] = "MASK", masked["doubleSided"] = true;
  put(fence, masked, {-1.5, 0.6, 0.7});
  put(quad(1.8, 1.4), see_through({0.9, 0.2, 0.1}, 0.5), {-0.4, 1.5, 0.6});
  put(quad(1.8, 1.4), see_through({0.1, 0.3, 0.9}, 0.4), {-0.1, 1.3, 1});
  json glass = pbr({glm::dvec3(glass_lets_through), 1}, 0, 0);
  glass["doubleSided"] = true;
  glass["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                         {"KHR_materials_ior", {{"ior", 1}}},
                         {"KHR_materials_specular", {{"specularFactor", 0}}}};
  if (stands_for_glass) {
    glass = see_through(glm::dvec3(0), 1 - glass_lets_through);
    glass["extensions"]["KHR_materials_unlit"] = json::object();
  }
  put(quad(0.7, 0.7), glass, {0.9, 1.1, 2.4});
  add_sun(out, {-0.6, 1, -0.8}, {1, 0.95, 0.85}, 1.5);
  add_point_light(out, {-1.8, 2.6, 1.5}, {1, 0.8, 0.6}, 9);
  const int spot = out.light({{"type", "spot"},
                              {"intensity", 30},
                              {"range", 9},
                              {"color", {0.6, 0.8, 1}},
                              {"spot", {{"innerConeAngle", 0.4}, {"outerConeAngle", 0.7}}}});
  out.node("spot", {{"translation", vector_json({1.8, 3, 1.6})},
                    {"rotation", quaternion_json(rotation_about({1, 0, 0}, -0.9))},
                    {"extensions", {{"KHR_lights_punctual", {{"light", spot}}}}}});
  out.camera_node({0, 1.6, 5}, {0, 0.9, 0}, 0.7);
  return out.bytes();
}

constexpr double bloom_strength = 0.2;
json look_of(const Row& row, bool of_reference) {
  json look = {{"sky",
                {{"gradient",
                  {{"zenith", {0.2, 0.3, 0.5}},
                   {"horizon", {0.35, 0.35, 0.4}},
                   {"ground", {0.15, 0.12, 0.1}},
                   {"exponent", 1}}}}}};
  // Without the effect nothing hides the sky from the reference either.
  look["occlusion"] = {{"radius_m", 1}, {"strength", of_reference && !row.has("occlusion") ? 0 : 1}};
  if (row.has("fog")) look["fog"] = {{"extinction", 0.06}, {"albedo", 0.8}, {"anisotropy", 0.3}};
  if (row.has("volumetric")) look["volumetric"] = {{"phi", 3}, {"tau", 0.05}};
  if (row.has("reflections")) look["reflections"] = json::object();
  if (row.has("exposure")) look["exposure"] = {{"auto", json::object()}};
  if (row.has("probes"))
    look["probes"] = {{{"position", {0, 1.2, 1}}, {"box", {{"min", {-4.5, 0, -3}}, {"max", {4.5, 5, 4.5}}}}}};
  if (row.has("bloom")) look["bloom"] = {{"strength", bloom_strength}, {"weights", {1}}, {"beauty", true}};
  return look;
}

// Where a pixel's samples lie.
std::vector<glm::dvec2> places_of(const std::string& samples) {
  if (samples == "1 sample") return {{0.5, 0.5}};
  if (samples == "4 samples") return {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}};
  std::vector<glm::dvec2> places;
  for (uint32_t i = 0; i < 4; ++i) places.push_back(0.5 + subsample_offset_px({2, 2}, i));
  return places;
}

using Pixels = std::vector<glm::dvec3>;

}  // namespace

class PairsTable : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    RunSettings settings;
    settings.validate = true;
    auto opened = SharedRenderer::open(settings);
    ASSERT_TRUE(opened) << opened.error().text();
    renderer_ = std::move(*opened);
    for (const bool stands_for_glass : {false, true}) {
      const std::vector<std::byte> bytes = scene_bytes(stands_for_glass);
      std::ofstream(scene_file(stands_for_glass), std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), long(bytes.size()));
    }
  }
  static void TearDownTestSuite() { renderer_.reset(); }
  static std::string scene_file(bool stands_for_glass) {
    return ::testing::TempDir() + (stands_for_glass ? "candela_pairs_sheet.glb" : "candela_pairs.glb");
  }
  static Job job_of(const Row& row, bool of_reference) {
    Job job;
    job.scene = scene_file(of_reference && row.has("refraction"));
    job.width_px = width, job.height_px = height;
    job.tonemap = "none";
    job.technique = of_reference ? "clustered" : row.technique;
    job.transparency = row.transparency;
    job.quality = row.quality;
    job.samples = row.samples == "4 samples" ? 4 : 1;
    job.settings = {{"lights", "floor_lux", "0"},
                    {"lights", "few", "0"},
                    {"supersample", "n", row.samples == "2x2 pictures" ? "2" : "1"}};
    if (row.has("probes")) job.settings.push_back({"probes", "size_px", "64"});
    job.effects = row.effect;
    job.look = ::testing::TempDir() + (of_reference ? "candela_pairs_true.look.json" : "candela_pairs.look.json");
    std::ofstream(job.look) << look_of(row, of_reference).dump();
    return job;
  }
  struct Picture {
    Beauty beauty;
    Pixels pixels;
  };
  static Picture drawn(const Row& row, bool every_light = false) {
    Job job = job_of(row, false);
    if (every_light) job = with_every_light(job, "brute-force");
    Picture out;
    const auto loaded = renderer_->load(job.scene);
    EXPECT_TRUE(loaded) << loaded.error().text();
    const auto frame = loaded ? renderer_->frame(job, {.linear = true}, 0) : std::unexpected(loaded.error());
    EXPECT_TRUE(frame) << row.text() << ": " << frame.error().text();
    if (!frame) return out;
    out.beauty = *beauty_of(*frame);
    for (size_t i = 0; i < size_t(width) * height; ++i) {
      glm::vec4 v;
      std::memcpy(&v, out.beauty.bytes.data() + i * sizeof v, sizeof v);
      out.pixels.push_back(glm::dvec3(v) / double(frame->pre_exposure));
    }
    return out;
  }

  // Two estimates whose noise is independent.
  using Truth = std::array<Pixels, 2>;
  static Truth traced(const Row& row) {
    const Job job = job_of(row, true);
    Truth out;
    const auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << row.text() << ": " << frame.error().text();
    if (!frame) return out;
    // Lights with shadows or without; the sky and what surfaces mirror always as it is hidden, which the look bounds.
    reference::TraceSettings of_lights, of_sky;
    of_lights.visibility = row.has("shadows");
    of_lights.fog_steps = 16;
    of_sky.ambient = row.has("ibl") ? reference::Ambient::traced : reference::Ambient::occlusion;
    const reference::Integrator lights(*(*frame)->world, of_lights, width, height),
        sky(*(*frame)->world, of_sky, width, height);
    const std::vector<glm::dvec2> places = places_of(row.samples);
    const uint64_t samples = 8 / places.size();
    for (size_t half = 0; half < 2; ++half) {
      Pixels& pixels = out[half];
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          glm::dvec3 sum(0);
          for (const glm::dvec2 place : places)
            for (uint64_t i = 0; i < samples; ++i) {
              const glm::dvec2 at = glm::dvec2(x, y) + place;
              reference::TermSample terms, sky_terms;
              const reference::PixelSample sample = lights.sample_at(at, 2 * i + half, &terms);
              sky.sample_at(at, 2 * i + half, &sky_terms);
              using reference::Term;
              sum += sample.radiance;
              for (const Term term : {Term::ambient_diffuse, Term::ambient_specular, Term::reflections})
                sum += sky_terms[term] - terms[term];
            }
          pixels.push_back(sum / double(places.size() * samples));
        }
      if (row.has("bloom")) {
        const Bloom bloom{.strength = bloom_strength, .weights = {1}};
        pixels = reference::bloomed(pixels, reference::bloom_glow(pixels, width, height, bloom, 1), bloom, 1);
      }
    }
    return out;
  }

  static double error(const Pixels& pixels, const Truth& truth) {
    std::vector<double> squares, sizes;
    for (size_t i = 0; i < pixels.size(); ++i) {
      double square = 0, size = 0;
      for (int c = 0; c < 3; ++c) {
        const double mean = (truth[0][i][c] + truth[1][i][c]) / 2, below = mean * mean + 0.01;
        square += (pixels[i][c] - truth[0][i][c]) * (pixels[i][c] - truth[1][i][c]) / (3 * below);
        size += std::pow(pixels[i][c] - mean, 2) / (3 * below);
      }
      squares.push_back(square), sizes.push_back(size);
    }
    std::vector<double> sorted = sizes;
    std::sort(sorted.begin(), sorted.end());
    const double most = sorted[sorted.size() * 19 / 20];
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < squares.size(); ++i)
      if (sizes[i] <= most) sum += squares[i], ++count;
    return std::sqrt(std::max(sum / double(count), 0.0));
  }

  static inline std::unique_ptr<SharedRenderer> renderer_;
};
class Pairs : public PairsTable, public ::testing::WithParamInterface<size_t> {};

TEST_P(Pairs, AreTheReferencesPicture) {
  const Row row = table()[GetParam()];
  SCOPED_TRACE(row.text());
  const Picture picture = drawn(row);
  if (HasFailure()) return;
  if (row.technique != "brute-force")
    EXPECT_EQ(difference(picture.beauty, drawn(row, true).beauty).differing, 0u) << "lists of lights change pixels";
  const double e = error(picture.pixels, traced(row));
  fmt::print("{:.4f} of {:.4f}: {}\n", e, row.allowed_error(), row.text());
  EXPECT_LE(e, row.allowed_error());
}
// Most of a row's time goes into compiling shaders: a suite walks those rows in which a choice stands for the first
// time, and CANDELA_PAIRS=all all of them.
std::vector<size_t> walked_rows() {
  const char* which = std::getenv("CANDELA_PAIRS");
  const bool all = which && std::string_view(which) == "all";
  const std::vector<Row> rows = table();
  std::vector<size_t> walked;
  std::set<std::string> met;
  for (size_t i = 0; i < rows.size(); ++i) {
    const size_t before = met.size();
    const Row& row = rows[i];
    met.insert({row.technique, row.transparency, row.samples, row.quality, row.effect});
    if (all || met.size() > before) walked.push_back(i);
  }
  return walked;
}
INSTANTIATE_TEST_SUITE_P(Table, Pairs, ::testing::ValuesIn(walked_rows()));

TEST_F(PairsTable, HoldsEveryPair) {
  const Levels count = {3, 5, 3, 3, 11};
  const std::vector<Levels> rows = covering_rows(count);
  EXPECT_EQ(rows, covering_rows(count));
  EXPECT_LE(rows.size(), 60u);
  for (size_t a = 0; a < count.size(); ++a)
    for (size_t b = a + 1; b < count.size(); ++b) {
      std::set<std::pair<size_t, size_t>> met;
      for (const Levels& row : rows) met.emplace(row[a], row[b]);
      EXPECT_EQ(met.size(), count[a] * count[b]) << a << " and " << b;
    }
  for (const Allowed& a : allowed) {
    bool known = false;
    for (const auto& names : {transparency_names(), effect_names(), all_samples})
      known = known || std::find(names.begin(), names.end(), a.choice) != names.end();
    EXPECT_TRUE(known) << a.choice << " is no choice any more";
  }
}

// Which choices exclude each other, each with what the message says. Every technique goes with every method and effect.
TEST_F(PairsTable, RefusesWhatExcludesEachOther) {
  ASSERT_TRUE(renderer_->load(scene_file(false)));
  const Row none{"clustered", "sorted", "1 sample", "high", "none"};
  const auto refused = [&](const Job& job, ErrorKind kind, const std::string& says) {
    const auto frame = renderer_->frame(job, {.linear = true}, 0);
    ASSERT_FALSE(frame) << says;
    EXPECT_EQ(frame.error().kind, kind) << frame.error().text();
    EXPECT_NE(frame.error().text().find(says), std::string::npos) << frame.error().text() << "\nhas no: " << says;
  };
  // Layers that beauty is divided into, by methods that sum instead of compositing in order.
  std::vector<LayerName> parts(std::begin(Terms::layers), std::end(Terms::layers));
  parts.insert(parts.end(), std::begin(FogLayers::layers), std::end(FogLayers::layers));
  for (const std::string& method : transparency_names())
    for (const LayerName& part : parts) {
      Job job = job_of(none, false);
      job.transparency = method, job.layers = {std::string(part.name)};
      if (method != "sorted" && method != "layers")
        refused(job, ErrorKind::usage,
                fmt::format("{} is a part of beauty, which --transparency {} does not divide; leave it out, or take "
                            "--transparency layers or sorted",
                            part.name, method));
    }
  // Samples that the device lacks, and two numbers of them.
  const std::vector<int> possible = renderer_->samples();
  for (const int samples : {2, 3, 4, 8}) {
    Job job = job_of(none, false);
    job.samples = samples;
    if (std::find(possible.begin(), possible.end(), samples) == possible.end())
      refused(job, ErrorKind::device, fmt::format("has no {} samples a pixel; it has 1", samples));
    job.settings.push_back({"resolve", "samples", "1"});
    refused(job, ErrorKind::usage, fmt::format("resolve.samples=1 contradicts --samples {}", samples));
  }
  const auto changed = [&](const auto& change) {
    Job job = job_of(none, false);
    change(job);
    return job;
  };
  refused(changed([](Job& job) { job.width_px = 16385; }), ErrorKind::usage, "16385x24 is outside 1x1 to 16384x16384");
  refused(changed([](Job& job) { job.layers = {"crypto_object"}, job.exr_compression = ExrCompression::pxr24; }),
          ErrorKind::usage, "change the 32-bit floats whose bits are the ids of crypto_object");
  refused(changed([](Job& job) {
            job.effects = "shadows", job.settings.push_back({"sun", "draws", "1"});
          }),
          ErrorKind::usage, "more than sun.draws = 1; set sun.draws to ");
  // What no list has.
  refused(changed([](Job& job) { job.technique = "deferred"; }), ErrorKind::usage, "deferred");
  refused(changed([](Job& job) { job.transparency = "peeled"; }), ErrorKind::usage, "peeled");
  refused(changed([](Job& job) { job.effects = "shadows,lenses"; }), ErrorKind::usage, "lenses");
  refused(changed([](Job& job) { job.quality = "best"; }), ErrorKind::usage, "best");
}

// What an effect changes is more than it may be wrong by: a picture without it is not taken for one with it. Of the
// sky's light this scene shows too little for that, and nothing of it moves or is out of focus; those effects have
// tests of their own.
TEST_F(PairsTable, TellsEachEffect) {
  const std::set<std::string> subtle = {"exposure", "occlusion", "ibl", "probes", "reflections", "shutter", "lens"};
  const Row none{"brute-force", "layers", "1 sample", "high", "none"};
  const Truth bare = traced(none);
  for (const std::string& effect : effect_names()) {
    if (subtle.contains(effect)) continue;
    Row with = none;
    with.effect = effect;
    const Truth truth = traced(with);
    const double changed = error(bare[0], truth);
    const double wrong = allowed_of(effect, at_high);
    fmt::print("{} changes {:.4f}, may be wrong by {:.4f}\n", effect, changed, wrong);
    EXPECT_GT(changed, 1.5 * wrong) << effect;
  }
}

}  // namespace candela::test
