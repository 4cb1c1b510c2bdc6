#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/dusk_atlas.h"
#include "demoscenes/tile_maps.h"
#include "image/io.h"
#include "testscenes/mesh_kit.h"

namespace candela {
namespace {

struct Picture {
  DecodedImage image;
  std::array<int, 3> at(int x, int y) const {
    const size_t first = (size_t(y) * size_t(image.width) + size_t(x)) * 4;
    return {int(image.pixels[first]), int(image.pixels[first + 1]), int(image.pixels[first + 2])};
  }
};

Picture decoded(const std::vector<std::byte>& png) {
  auto image = decode_image(png, "a tile");
  EXPECT_TRUE(image.has_value());
  EXPECT_EQ(image->format, DecodedImage::Format::rgba8);
  return {std::move(*image)};
}

using Point = TilePoint (*)(double, double, uint64_t);
struct Material {
  const char* name;
  Point point;
  double side_m;
};
constexpr Material materials[] = {{"asphalt", asphalt_point, 4},
                                  {"pavement", pavement_point, 2.4},
                                  {"brick", brick_point, 1.92},
                                  {"plaster", plaster_point, 3},
                                  {"metal", metal_point, 1}};

TileMaps baked(const Material& m, int size) {
  return bake_tile(size, m.side_m, [&](double u, double v) { return m.point(u, v, 5); });
}

double mean_step(const Picture& p, int from, int to, bool rows) {
  double sum = 0;
  for (int i = 0; i < p.image.width; ++i)
    for (size_t c = 0; c < 3; ++c)
      sum += std::abs(rows ? p.at(i, from)[c] - p.at(i, to)[c] : p.at(from, i)[c] - p.at(to, i)[c]);
  return sum / (3 * p.image.width);
}

// From the last row to the first the picture changes no more than between any two neighbouring rows.
TEST(Tiles, OppositeEdgesContinueEachOther) {
  constexpr int size = 128;
  for (const Material& m : materials) {
    const TileMaps maps = baked(m, size);
    for (const auto* png : {&maps.color, &maps.normal, &maps.roughness}) {
      const Picture p = decoded(*png);
      for (const bool rows : {false, true}) {
        double most = 0;
        for (int i = 0; i + 1 < size; ++i) most = std::max(most, mean_step(p, i, i + 1, rows));
        EXPECT_LE(mean_step(p, size - 1, 0, rows), most + 1) << m.name << (rows ? " rows" : " columns");
      }
    }
  }
}

// The functions themselves repeat. Stones meet in a joint, on whose two sides their shades differ.
TEST(Tiles, PointsRepeat) {
  for (const Material& m : materials)
    for (double at : {0.013, 0.37, 0.71}) {
      const bool stones = m.point == pavement_point || m.point == brick_point;
      EXPECT_NEAR(m.point(at, 1e-9, 5).height_m, m.point(at, 1 - 1e-9, 5).height_m, 4e-3) << m.name;
      EXPECT_NEAR(m.point(1e-9, at, 5).color.x, m.point(1 - 1e-9, at, 5).color.x, stones ? 0.02 : 1e-4) << m.name;
    }
  for (double at : {0.013, 0.37, 0.71})
    EXPECT_NEAR(puddle_roughness(at, 0, 5), puddle_roughness(at, 1 - 1e-9, 5), 1e-6);
}

TEST(Tiles, NormalsAreUnitLongAndPointOutwards) {
  for (const Material& m : materials) {
    const Picture p = decoded(baked(m, 96).normal);
    glm::dvec3 mean(0);
    for (int y = 0; y < p.image.height; ++y)
      for (int x = 0; x < p.image.width; ++x) {
        const auto texel = p.at(x, y);
        const glm::dvec3 n = glm::dvec3(texel[0], texel[1], texel[2]) / 127.5 - 1.0;
        ASSERT_NEAR(glm::length(n), 1, 0.012) << m.name << " " << x << " " << y;
        ASSERT_GT(n.z, 0) << m.name;
        mean += n;
      }
    mean /= double(p.image.width) * p.image.height;
    // Over a repeat heights come back to where they were.
    EXPECT_NEAR(mean.x, 0, 0.02) << m.name;
    EXPECT_NEAR(mean.y, 0, 0.02) << m.name;
  }
}

// A slope that rises to the right and downwards in the image leans to the left and, with +Y up in the image, up.
TEST(Tiles, NormalsLeanAwayFromWhatRises) {
  const auto lean = [](bool along_u) {
    const TileMaps maps = bake_tile(64, 1, [&](double u, double v) {
      return TilePoint{.height_m = 0.05 * std::sin(2 * std::numbers::pi * (along_u ? u : v))};
    });
    return decoded(maps.normal).at(0, 0);  // where it rises
  };
  EXPECT_LT(lean(true)[0], 120);
  EXPECT_NEAR(lean(true)[1], 128, 1);
  EXPECT_GT(lean(false)[1], 135);
  EXPECT_NEAR(lean(false)[0], 128, 1);
}

TEST(Tiles, SrgbIsTheStandardsCurve) {
  EXPECT_EQ(srgb_of(0.0), 0);
  EXPECT_NEAR(srgb_of(1.0), 1, 1e-12);
  EXPECT_NEAR(srgb_of(0.0031308), 0.04045, 1e-5);
  EXPECT_NEAR(srgb_of(0.2140411), 0.5, 1e-6);
}

TEST(Tiles, CellsOfAnAtlasLieBesideEachOther) {
  const dusk::Cell first = dusk::cell_of(4, 2, 0), last = dusk::cell_of(4, 2, 7);
  EXPECT_GT(first.corner.x, 0);
  EXPECT_LT(first.far.x, 0.25);
  EXPECT_LT(first.far.y, first.corner.y);  // v grows downwards, and the corner is the lower one
  EXPECT_LT(first.corner.y, 0.5);
  EXPECT_GT(last.corner.x, 0.75);
  EXPECT_GT(last.far.y, 0.5);
  EXPECT_LT(last.corner.y, 1);
}

// The front of every triangle is the side its normals point to, for whatever place the parts are put in.
TEST(MeshKit, WindingAgreesWithNormals) {
  MeshKit kit;
  const Paint paint;
  for (const glm::dmat4& place : {glm::dmat4(1), placed({3, 1, -2}, 0.7)}) {
    kit.place(place);
    kit.box(paint, {-1, 0, -2}, {1, 2, 3}, MeshKit::all);
    kit.tube(paint, {0, 0, 0}, 0.5, {1, 2, 0.5}, 0.2, 9, true);
    kit.tube(paint, {0, 0, 0}, 0.5, {0, -3, 0}, 0, 5, true);
    kit.quad(paint, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1}, {1, 0});
    kit.triangle(paint, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
    const std::array<glm::dvec3, 5> pentagon{{{1, 0, 0}, {0.3, 1, 0}, {-0.8, 0.6, 0}, {-0.8, -0.6, 0}, {0.3, -1, 0}}};
    kit.polygon(paint, pentagon, {0.5, 0.5});
    std::vector<glm::dvec3> bowl;
    for (double t : {1.0, 0.5, 0.0})
      for (int i = 0; i < 8; ++i) {
        const double angle = -2 * std::numbers::pi * i / 8;
        bowl.emplace_back(t * std::cos(angle), 1 - t * t, t * std::sin(angle));
      }
    kit.surface(paint, bowl, 8, true);
  }
  const Shape& shape = kit.shapes().at(0);
  ASSERT_GT(shape.index.size(), 100u);
  for (size_t i = 0; i < shape.index.size(); i += 3) {
    const uint32_t a = shape.index[i], b = shape.index[i + 1], c = shape.index[i + 2];
    const glm::dvec3 face = glm::cross(shape.position[b] - shape.position[a], shape.position[c] - shape.position[a]);
    EXPECT_GT(glm::length(face), 1e-6) << i / 3;
    EXPECT_GT(glm::dot(face, shape.normal[a] + shape.normal[b] + shape.normal[c]), 0) << i / 3;
  }
  for (glm::dvec3 n : shape.normal) EXPECT_NEAR(glm::length(n), 1, 1e-12);
}

// Side by side quads share their texture coordinates along the edge, in repeats of the paint's tile.
TEST(MeshKit, QuadsContinueEachOthersTexture) {
  MeshKit kit;
  const Paint paint{.tile_m = 2};
  kit.quad(paint, {0, 0, 0}, {1.5, 0, 0}, {0, 3, 0});
  kit.quad(paint, {1.5, 0, 0}, {2, 0, 0}, {0, 3, 0});
  const Shape& shape = kit.shapes().at(0);
  EXPECT_EQ(shape.uv[1], shape.uv[4]);
  EXPECT_EQ(shape.uv[2], shape.uv[7]);
  EXPECT_NEAR(shape.uv[1].x - shape.uv[0].x, 0.75, 1e-12);
  EXPECT_NEAR(shape.uv[0].y - shape.uv[3].y, 1.5, 1e-12);
}

}  // namespace
}  // namespace candela
