#include <algorithm>
#include <cmath>

#include "testscenes/procedural_textures.h"
#include "testscenes/street.h"
#include "testscenes/table.h"

namespace candela::street {
namespace {

// What glows, as texels of one small texture, so that lamp heads, signs and car lights share a material.
enum Glow { dark, lamp_glow, head_glow, tail_glow, first_sign_glow };
constexpr std::array<glm::dvec3, 4> sign_colors{{{1, 0.12, 0.2}, {0.1, 0.75, 1}, {0.25, 1, 0.35}, {1, 0.3, 0.9}}};
constexpr int glow_count = first_sign_glow + int(sign_colors.size());

glm::dvec3 glow_color(int glow) {
  switch (glow) {
    case dark:
      return glm::dvec3(0);
    case lamp_glow:
      return {1, 0.78, 0.5};
    case head_glow:
      return {1, 0.97, 0.9};
    case tail_glow:
      return {0.3, 0.01, 0.01};
    default:
      return 0.55 * sign_colors[size_t(glow - first_sign_glow)];
  }
}

constexpr int window_columns = 8, window_rows = 16;
constexpr double window_width_m = 2.9, floor_m = 3.2;

// A shape of rectangles, each in one colour.
class Builder {
 public:
  // Counter-clockwise: corner, corner + u, corner + u + v, corner + v. uv runs over the rectangle from uv0 to uv1.
  void rectangle(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, glm::dvec3 color, glm::dvec2 uv0, glm::dvec2 uv1) {
    const uint32_t first = uint32_t(shape_.position.size());
    const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
    for (const glm::dvec2 at : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
      shape_.position.push_back(corner + at.x * u + at.y * v);
      shape_.normal.push_back(normal);
      shape_.uv.push_back(uv0 + at * (uv1 - uv0));
      colors_.emplace_back(color, 1);
    }
    for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) shape_.index.push_back(first + k);
  }
  void glowing(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, glm::dvec3 color, int glow) {
    const glm::dvec2 texel((glow + 0.5) / glow_count, 0.5);
    rectangle(corner, u, v, color, texel, texel);
  }
  // The four sides and the top of a box.
  void block(glm::dvec3 low, glm::dvec3 high, glm::dvec3 color) {
    const glm::dvec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    glowing({low.x, low.y, high.z}, x, y, color, dark);
    glowing({high.x, low.y, low.z}, -x, y, color, dark);
    glowing(high - y, -z, y, color, dark);
    glowing(low, z, y, color, dark);
    glowing({low.x, high.y, high.z}, x, -z, color, dark);
  }
  bool empty() const { return shape_.position.empty(); }
  json primitive(GlbWriter& out, int material) const {
    json primitive = out.primitive(shape_);
    primitive["attributes"]["COLOR_0"] = out.unorm8_accessor(colors_);
    primitive["material"] = material;
    return primitive;
  }

 private:
  Shape shape_;
  std::vector<glm::dvec4> colors_;
};

struct Materials {
  int facade, palette, ground;
};

Materials make_materials(GlbWriter& out, Rng& rng) {
  out.use_extension("KHR_materials_emissive_strength");
  std::array<glm::dvec3, size_t(window_columns * window_rows)> window;
  for (glm::dvec3& light : window) {
    const double which = rng.uniform(), bright = rng.uniform(0.25, 1);
    light = bright * (which < 0.52   ? glm::dvec3(0)
                      : which < 0.8  ? glm::dvec3(0.85, 0.6, 0.32)
                      : which < 0.92 ? glm::dvec3(0.7, 0.66, 0.55)
                                     : glm::dvec3(0.3, 0.42, 0.62));
  }
  // 8 texels a window. The blind and the sill leave it 5 by 5.
  const int windows =
      out.texture("windows", png_from(window_columns * 8, window_rows * 8, 3, [&](double u, double v) {
                    const int x = int(u * window_columns * 8), y = int(v * window_rows * 8);
                    const bool glass = x % 8 >= 2 && x % 8 < 7 && y % 8 >= 2 && y % 8 < 7 && x % 8 != 4;
                    return glm::dvec4(glass ? window[size_t(y / 8 * window_columns + x / 8)] : glm::dvec3(0), 1);
                  }));
  constexpr int nearest = 9728, clamp_to_edge = 33071;
  const int glows = out.texture("glow",
                                png_from(glow_count, 1, 3,
                                         [](double u, double) {
                                           const glm::dvec3 linear = glow_color(int(u * glow_count));
                                           return glm::dvec4(glm::pow(linear, glm::dvec3(1 / 2.2)), 1);
                                         }),
                                {{"magFilter", nearest}, {"minFilter", nearest}, {"wrapS", clamp_to_edge}});
  const auto emissive = [&](const char* name, int texture, double strength, double roughness) {
    json material = pbr({1, 1, 1, 1}, 0, roughness);
    material["emissiveTexture"] = {{"index", texture}};
    material["emissiveFactor"] = {1, 1, 1};
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
    return out.material(name, material);
  };
  Materials m;
  m.facade = emissive("facade", windows, 1.2, 0.7);
  m.palette = emissive("palette", glows, 8, 0.45);
  m.ground = out.material("ground", pbr({1, 1, 1, 1}, 0, 0.42));
  return m;
}

// Walls show the window texture at its scale, from a window of its own on; roofs the dark frame between windows.
void add_house(Builder& facade, Rng& rng, glm::dvec3 low, glm::dvec3 high, glm::dvec3 color) {
  const glm::dvec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  const auto wall = [&](glm::dvec3 corner, glm::dvec3 along) {
    const double windows = std::max(1.0, std::round(glm::length(along) / window_width_m));
    const double floors = std::max(1.0, std::round(size.y / floor_m));
    const glm::dvec2 start(double(rng.next() % window_columns) / window_columns,
                           double(rng.next() % window_rows) / window_rows);
    facade.rectangle(corner, along, y, color, start + glm::dvec2(0, floors / window_rows),
                     start + glm::dvec2(windows / window_columns, 0));
  };
  wall({low.x, low.y, high.z}, x);
  wall({high.x, low.y, low.z}, -x);
  wall(high - y, -z);
  wall(low, z);
  facade.rectangle({low.x, high.y, high.z}, x, -z, 0.5 * color, {0, 0}, {0, 0});
}

constexpr std::array<glm::dvec3, 6> facade_colors{{{0.42, 0.3, 0.24},
                                                   {0.5, 0.46, 0.4},
                                                   {0.32, 0.34, 0.38},
                                                   {0.55, 0.5, 0.42},
                                                   {0.36, 0.24, 0.2},
                                                   {0.44, 0.42, 0.44}}};
constexpr std::array<glm::dvec3, 4> window_colors{{{1, 0.72, 0.4}, {1, 0.62, 0.3}, {1, 0.86, 0.66}, {0.75, 0.85, 1}}};

// Two rows of houses, back to back over a yard, and what shines in front of their four sides.
Block make_block(GlbWriter& out, Rng& rng, const Materials& materials, double tallest_m) {
  constexpr double half = block_m / 2;
  Builder facade, signs;
  for (int row = 0; row < 2; ++row) {
    const double split = rng.uniform(-9, -5), other = rng.uniform(6, 10);
    const std::array<double, 4> edge{-half, split, other, half};
    for (size_t house = 0; house < 3; ++house) {
      const double floors = std::round(rng.uniform(8.5, tallest_m) / floor_m), height = floors * floor_m;
      const double inner = rng.uniform(4, 8);
      const glm::dvec3 low(edge[house], 0, row ? inner : -half), high(edge[house + 1], height, row ? half : -inner);
      const glm::dvec3 color = facade_colors[size_t(rng.next() % facade_colors.size())];
      add_house(facade, rng, low, high, color);
      if (floors < 6) continue;
      const glm::dvec3 in(2.5, 0, 2.5);  // a storey set back
      add_house(facade, rng, glm::dvec3(low.x, height, low.z) + in, high - in + glm::dvec3(0, floor_m * 2, 0), color);
    }
  }
  Block block;
  for (int side = 0; side < 4; ++side) {
    for (int k = 0; k < windows_a_cell / 4; ++k) {
      const double along = -half + block_m * (k + rng.uniform(0.2, 0.8)) / (windows_a_cell / 4.0);
      const double up = floor_m * (1 + double(rng.next() % 2)) + 1.7;
      block.windows[size_t(side * windows_a_cell / 4 + k)] = {turned(side, {along, up, half + 0.8}),
                                                              window_colors[size_t(rng.next() % window_colors.size())]};
    }
    for (int k = 0; k < signs_a_cell / 4; ++k) {
      const int color = int(rng.next() % sign_colors.size());
      const double along = -half + block_m * (k + rng.uniform(0.25, 0.75)) / (signs_a_cell / 4.0);
      const double width = rng.uniform(2.2, 4.5), height = rng.uniform(0.6, 1.1), up = rng.uniform(2.9, 3.6);
      signs.glowing(turned(side, {along - width / 2, up - height / 2, half + 0.15}), turned(side, {width, 0, 0}),
                    {0, height, 0}, glm::dvec3(0.1), first_sign_glow + color);
      block.signs[size_t(side * signs_a_cell / 4 + k)] = {turned(side, {along, up, half + 1.1}),
                                                          sign_colors[size_t(color)]};
    }
  }
  block.mesh = out.mesh("block", facade.primitive(out, materials.facade), -1);
  out.root["meshes"][size_t(block.mesh)]["primitives"].push_back(signs.primitive(out, materials.palette));
  return block;
}

// A mast with two lamps, one over the road and one over the pavement; `across` points from the mast to the road.
void add_mast(Builder& things, glm::dvec3 foot, glm::dvec3 across, std::span<Lamp, 2> lamps) {
  constexpr double thick = 0.16, reach = 1.7;
  const glm::dvec3 along = glm::cross(across, glm::dvec3(0, 1, 0)), up(0, lamp_height_m + 0.2, 0), steel(0.12);
  const std::array<glm::dvec3, 3> corner{thick * along, thick * (-0.5 * along + 0.87 * across),
                                         thick * (-0.5 * along - 0.87 * across)};
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 a = foot + corner[i], b = foot + corner[(i + 1) % 3];
    const bool outward = glm::dot(glm::cross(b - a, up), a + b - 2.0 * foot) > 0;
    things.glowing(outward ? a : b, outward ? b - a : a - b, up, steel, dark);
  }
  const glm::dvec3 bar = 2 * reach * across, height(0, 0.1, 0), top = foot + up;
  things.glowing(top - reach * across + 0.05 * along, bar, height, steel, dark);
  things.glowing(top + reach * across - 0.05 * along, -bar, height, steel, dark);
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    const glm::dvec3 head = foot + glm::dvec3(0, lamp_height_m + 0.1, 0) + sign * (reach + 0.1) * across;
    const glm::dvec3 length = 0.8 * across, width = 0.32 * along, tall(0, 0.16, 0);
    const glm::dvec3 low = head - 0.5 * length - 0.5 * width;
    things.glowing(low, length, width, steel, lamp_glow);
    things.glowing(low + width, length, tall, steel, lamp_glow);
    things.glowing(low + length, -length, tall, steel, lamp_glow);
    lamps[size_t(side)] = {head - glm::dvec3(0, 0.1, 0), glm::normalize(glm::dvec3(0, -1, 0) + 0.12 * sign * across)};
  }
}

int make_street_mesh(GlbWriter& out, const Materials& materials, std::array<Lamp, lamps_a_cell>& lamps) {
  constexpr double half = block_m / 2 + pavement_m;
  const glm::dvec3 asphalt(0.085, 0.088, 0.095), stone(0.24, 0.235, 0.225), paint(0.55, 0.55, 0.52);
  Builder ground, things;
  // One cell of ground, from the far kerb of the street along Z to the near kerb of the next.
  ground.glowing({-half - road_m, 0, half + road_m}, {cell_m, 0, 0}, {0, 0, -cell_m}, asphalt, dark);
  ground.block({-half, 0, -half}, {half, 0.15, half}, stone);
  for (int i = 0; i < 6; ++i) {
    const double at = -half + 2 * half * (i + 0.5) / 6;
    ground.glowing({-street_centre_m - 0.08, 0.02, at + 1.5}, {0.16, 0, 0}, {0, 0, -3}, paint, dark);
    ground.glowing({at - 1.5, 0.02, street_centre_m + 0.08}, {3, 0, 0}, {0, 0, -0.16}, paint, dark);
  }
  for (int i = 0; i < 7; ++i) {  // the crossings on both sides of the junction
    const double at = (i - 3) * 1.5;
    ground.glowing({-street_centre_m + at - 0.4, 0.02, half - 0.3}, {0.8, 0, 0}, {0, 0, -2.6}, paint, dark);
    ground.glowing({-half + 0.3, 0.02, street_centre_m + at + 0.4}, {2.6, 0, 0}, {0, 0, -0.8}, paint, dark);
  }
  constexpr std::array places{21.0, 7.0, -7.0, -21.0};
  constexpr double from_centre = road_m / 2 + 0.7;
  for (size_t i = 0; i < places.size(); ++i) {
    const double side = i % 2 ? -1 : 1;
    add_mast(things, {-street_centre_m + side * from_centre, 0, places[i]}, {-side, 0, 0},
             std::span<Lamp, 2>(&lamps[4 * i], 2));
    add_mast(things, {places[i], 0, street_centre_m + side * from_centre}, {0, 0, -side},
             std::span<Lamp, 2>(&lamps[4 * i + 2], 2));
  }
  const int mesh = out.mesh("street", ground.primitive(out, materials.ground), -1);
  out.root["meshes"][size_t(mesh)]["primitives"].push_back(things.primitive(out, materials.palette));
  return mesh;
}

void add_car(Builder& car, double z, glm::dvec3 paint) {
  const glm::dvec3 at(0, 0, z), glass(0.03, 0.035, 0.045);
  car.block(at + glm::dvec3(-0.9, 0.12, -2.1), at + glm::dvec3(0.9, 0.95, 2.1), paint);
  car.block(at + glm::dvec3(-0.78, 0.95, -0.7), at + glm::dvec3(0.78, 1.45, 1.5), glass);
  for (double side : {-0.62, 0.62}) {
    car.glowing(at + glm::dvec3(side + 0.2, 0.55, -2.12), {-0.4, 0, 0}, {0, 0.2, 0}, glass, head_glow);
    car.glowing(at + glm::dvec3(side - 0.2, 0.65, 2.12), {0.4, 0, 0}, {0, 0.16, 0}, glass, tail_glow);
  }
}

CarPair make_cars(GlbWriter& out, Rng& rng, const Materials& materials) {
  constexpr std::array<glm::dvec3, 5> paints{
      {{0.5, 0.04, 0.03}, {0.6, 0.6, 0.6}, {0.04, 0.06, 0.2}, {0.05, 0.05, 0.05}, {0.5, 0.4, 0.05}}};
  CarPair cars;
  Builder builder;
  for (size_t i = 0; i < cars.z.size(); ++i) {
    cars.z[i] = (double(i) - 0.5) * cell_m / 2 + rng.uniform(-9, 9);
    add_car(builder, cars.z[i], paints[size_t(rng.next() % paints.size())]);
  }
  cars.mesh = out.mesh("cars", builder.primitive(out, materials.palette), -1);
  return cars;
}

}  // namespace

glm::dvec3 turned(int quarters, glm::dvec3 v) {
  for (int i = 0; i < (quarters & 3); ++i) v = {v.z, v.y, -v.x};
  return v;
}

Parts make_parts(GlbWriter& out, Rng& rng) {
  const Materials materials = make_materials(out, rng);
  Parts parts;
  for (double tallest_m : {15.0, 20.0, 26.0, 33.0}) parts.blocks.push_back(make_block(out, rng, materials, tallest_m));
  parts.street_mesh = make_street_mesh(out, materials, parts.lamps);
  for (int i = 0; i < 3; ++i) parts.cars.push_back(make_cars(out, rng, materials));
  return parts;
}

}  // namespace candela::street
