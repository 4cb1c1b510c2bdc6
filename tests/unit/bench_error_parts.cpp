#include "bench/error_parts.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

constexpr int width = 8, height = 4, pixels = width * height;

void add_colour(FloatImage& image, const std::string& layer, float value) {
  for (const char c : {'R', 'G', 'B'})
    image.channels.push_back({layer.empty() ? std::string(1, c) : layer + "." + c,
                              ChannelType::float32,
                              std::vector<float>(pixels, value),
                              {}});
}
std::vector<float>& plane(FloatImage& image, const std::string& name) {
  for (Channel& c : image.channels)
    if (c.name == name) return c.f;
  ADD_FAILURE() << name;
  return image.channels.front().f;
}

// One object on the left, another on the right of x = 4, each facing the camera; lit by a sun of 1 and a sky of 0.5.
FloatImage two_objects() {
  FloatImage image;
  image.width = width, image.height = height;
  add_colour(image, "", 1.5f);
  add_colour(image, "direct_sun", 1);
  add_colour(image, "ambient_diffuse", 0.5f);
  Channel objects{"object_id.X", ChannelType::uint32, {}, {}}, materials{"material_id.X", ChannelType::uint32, {}, {}};
  for (int i = 0; i < pixels; ++i) objects.u.push_back(i % width < 4 ? 1 : 2), materials.u.push_back(0);
  image.channels.push_back(std::move(objects));
  image.channels.push_back(std::move(materials));
  for (const char* part : {"normal.X", "normal.Y", "normal.Z"})
    image.channels.push_back(
        {part, ChannelType::float32, std::vector<float>(pixels, part[7] == 'Z' ? 1.0f : 0.0f), {}});
  return image;
}

}  // namespace

TEST(ErrorParts, LieAtEdgesOrInTheTermsElsewhere) {
  const FloatImage truth = two_objects();
  FloatImage picture = truth;
  // At the edge (columns 3 and 4) the sum counts, elsewhere the term.
  for (const int at : {3, 6})
    plane(picture, "direct_sun.R")[size_t(at)] += 0.25f, plane(picture, "R")[size_t(at)] += 0.25f;
  plane(picture, "ambient_diffuse.G")[1] -= 0.5f, plane(picture, "G")[1] -= 0.5f;
  const double scale = (1.5 * 1.5 + 0.01) * 3 * pixels;
  const auto parts = error_parts(truth, picture);
  EXPECT_NEAR(parts.at("part.edges"), 0.0625 / scale, 1e-12);
  EXPECT_NEAR(parts.at("part.direct_sun"), 0.0625 / scale, 1e-12);
  EXPECT_NEAR(parts.at("part.ambient_diffuse"), 0.25 / scale, 1e-12);
  EXPECT_NEAR(parts.at("part.all"), (2 * 0.0625 + 0.25) / scale, 1e-12);
}

// Two terms may be wrong where their sum is right: "model" as one number would not say so.
TEST(ErrorParts, ErrorsThatCancelAreSeen) {
  const FloatImage truth = two_objects();
  FloatImage picture = truth;
  plane(picture, "direct_sun.B")[0] += 0.5f, plane(picture, "ambient_diffuse.B")[0] -= 0.5f;
  const auto parts = error_parts(truth, picture);
  EXPECT_EQ(parts.at("part.all"), 0);
  EXPECT_GT(parts.at("part.direct_sun"), 0);
  EXPECT_EQ(parts.at("part.direct_sun"), parts.at("part.ambient_diffuse"));
}

// A sun whose shadow is missing, one that is too dark, and one that is too dim where nothing hides it; a sky whose
// occlusion is missing.
TEST(ErrorParts, ShadowsAreToldFromTheLightThatTheyTake) {
  FloatImage truth = two_objects();
  for (const char* fraction : {"shadow_sun.Y", "occlusion.Y"})
    truth.channels.push_back({fraction, ChannelType::float32, std::vector<float>(pixels, 1), {}});
  FloatImage picture = truth;
  const size_t missing = 0, dark = 6, dim = width + 1, open = width + 6;
  const auto set = [](FloatImage& image, const char* term, const char* fraction, size_t at, float light,
                      float arrives) {
    for (const char c : {'R', 'G', 'B'}) plane(image, std::string(term) + "." + c)[at] = light * arrives;
    plane(image, fraction)[at] = arrives;
  };
  set(truth, "direct_sun", "shadow_sun.Y", missing, 1, 0);
  set(truth, "direct_sun", "shadow_sun.Y", dark, 1, 0.5f), set(picture, "direct_sun", "shadow_sun.Y", dark, 1, 0.25f);
  set(picture, "direct_sun", "shadow_sun.Y", dim, 0.9f, 1);
  set(truth, "ambient_diffuse", "occlusion.Y", open, 0.5f, 0.6f);
  const double scale = (1.5 * 1.5 + 0.01) * pixels;
  const auto parts = error_parts(truth, picture);
  EXPECT_NEAR(parts.at("part.shadow.direct_sun"), (1 + 0.0625) / scale, 1e-8);
  EXPECT_NEAR(parts.at("part.direct_sun"), 0.01 / scale, 1e-8);
  EXPECT_NEAR(parts.at("part.occlusion"), 0.04 / scale, 1e-8);
  EXPECT_NEAR(parts.at("part.ambient_diffuse"), 0, 1e-12);
  EXPECT_FALSE(parts.contains("part.shadow.direct_point"));
}

// A crease is an edge; a term that the picture lacks is black there; and without layers nothing is divided.
TEST(ErrorParts, CreasesMissingTermsAndMissingLayers) {
  FloatImage truth = two_objects();
  for (int y = 0; y < height; ++y)
    plane(truth, "normal.Z")[size_t(y * width)] = 0, plane(truth, "normal.X")[size_t(y * width)] = 1;
  add_colour(truth, "indirect", 0.1f);
  FloatImage picture = two_objects();
  for (float& v : plane(picture, "R")) v += 1;
  const auto parts = error_parts(truth, picture);
  const double scale = 1.5 * 1.5 + 0.01;
  EXPECT_NEAR(parts.at("part.edges"), 4.0 / width / 3 / scale, 1e-9) << "columns 0, 1, 3 and 4";
  EXPECT_NEAR(parts.at("part.indirect"), 4.0 / width * 0.1 * 0.1 / scale, 1e-9);
  EXPECT_TRUE(error_parts(FloatImage{picture.width, picture.height}, picture).empty());
  FloatImage narrow = picture;
  narrow.width = 4, narrow.height = 8;
  EXPECT_TRUE(error_parts(truth, narrow).empty());
}

// Layers of a name are made by both renderers.
TEST(ErrorParts, BothRenderersHaveTheirLayers) {
  const std::vector<std::string> gpu = gpu_part_layers(), reference = reference_part_layers(false);
  for (const std::string& layer : gpu)
    EXPECT_NE(std::find(reference.begin(), reference.end(), layer), reference.end()) << layer;
  EXPECT_EQ(reference.size(), gpu.size() + 1) << "the reference has indirect light besides";
}

}  // namespace candela
