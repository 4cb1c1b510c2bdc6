#include "demoscenes/dusk_atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "base/rng.h"
#include "demoscenes/tile_maps.h"
#include "testscenes/procedural_textures.h"

namespace candela::dusk {
namespace {

double blend(double a, double b, double t) { return a + (b - a) * t; }
glm::dvec3 blend(glm::dvec3 a, glm::dvec3 b, double t) { return a + (b - a) * t; }
double bump(double distance, double width) { return std::exp(-distance * distance / (width * width)); }

Rng rng_of(uint64_t seed, int index) {
  Rng rng(seed * 0x100000001b3u + uint64_t(uint32_t(index)) * 7919);
  rng.next();
  return rng;
}

// A picture of cells; color(index, s, t) with s to the right and t downwards in [0,1].
template <class Color>
Atlas atlas_of(int columns, int rows, int cell_width, int cell_height, const Color& color) {
  Atlas atlas{columns, rows, {}};
  atlas.png = png_from(columns * cell_width, rows * cell_height, 3, [&](double u, double v) {
    const double x = u * columns, y = v * rows;
    const int column = std::min(int(x), columns - 1), row = std::min(int(y), rows - 1);
    return glm::dvec4(srgb_of(color(row * columns + column, x - column, y - row)), 1);
  });
  return atlas;
}

struct Room {
  glm::dvec3 light, wall;
  double bright, lamp_s, lamp_t, curtain, blind, shelf;
  bool plant, picture;
  double picture_s;
};

Room room_of(uint64_t seed, int index) {
  static constexpr std::array<glm::dvec3, 5> lights{
      {{1, 0.62, 0.28}, {1, 0.72, 0.42}, {1, 0.5, 0.2}, {1, 0.82, 0.6}, {0.55, 0.75, 1}}};
  Rng rng = rng_of(seed, index);
  Room r;
  r.light = lights[size_t(rng.next() % 16) % 8 % lights.size()];
  r.wall = {rng.uniform(0.6, 1), rng.uniform(0.5, 0.9), rng.uniform(0.4, 0.8)};
  r.bright = rng.uniform(0.25, 1);
  r.lamp_s = rng.uniform(0.25, 0.75);
  r.lamp_t = rng.uniform() < 0.6 ? rng.uniform(0.08, 0.2) : rng.uniform(0.5, 0.65);
  r.curtain = rng.uniform() < 0.65 ? rng.uniform(0.1, 0.3) : 0;
  r.blind = rng.uniform() < 0.3 ? rng.uniform(0.2, 0.75) : 0;
  r.shelf = rng.uniform() < 0.3 ? rng.uniform(0.3, 0.5) : 0;
  r.plant = rng.uniform() < 0.3;
  r.picture = rng.uniform() < 0.5;
  r.picture_s = rng.uniform(0.3, 0.6);
  return r;
}

glm::dvec3 room_color(uint64_t seed, int index, double s, double t) {
  const Room r = room_of(seed, index);
  if (index < dark_rooms) {  // curtains that the street lights
    const double fold = 0.5 + 0.5 * std::cos(s * 40 + 3 * r.lamp_s);
    return glm::dvec3(0.006, 0.007, 0.010) * (s < r.curtain || s > 1 - r.curtain ? 1 + fold : 0.5);
  }
  const double away = std::hypot((s - r.lamp_s) * 0.8, t - r.lamp_t);
  glm::dvec3 c = r.light * r.wall * (0.16 + 0.8 * std::exp(-2.6 * away));
  if (r.picture && std::abs(s - r.picture_s) < 0.12 && std::abs(t - 0.42) < 0.09) c *= 0.35;
  if (r.shelf > 0 && s > r.shelf && s < r.shelf + 0.35 && t > 0.3) {
    const double book = std::fmod(s * 23 + std::floor(t * 7) * 0.37, 1.0);
    c *= std::fmod(t * 7, 1.0) < 0.14 ? 0.25 : blend(0.3, 0.85, book);
  }
  if (t > 0.78) c *= 0.5;  // furniture below
  if (r.plant)
    c *= blend(1.0, 0.18, bump(std::hypot(s - 0.3, (t - 0.85) * 0.8), 0.16 + 0.04 * std::sin(s * 60 + t * 35)));
  c += r.light * 1.6 * bump(away, 0.07);
  if (t < r.blind) c = r.light * (0.34 + 0.12 * std::cos(t * 90)) * blend(0.75, 1.0, std::exp(-away));
  const double side = std::min(s, 1 - s);
  if (side < r.curtain)
    c = r.light * glm::dvec3(0.9, 0.62, 0.42) * (0.28 + 0.14 * std::cos(s * 70)) * blend(1.2, 0.6, t);
  return c * r.bright;
}

constexpr std::array<glm::dvec3, 8> shop_lights{{{1, 0.78, 0.5},
                                                 {1, 0.66, 0.34},
                                                 {0.8, 0.92, 1},
                                                 {1, 0.84, 0.62},
                                                 {1, 0.58, 0.3},
                                                 {0.95, 0.95, 0.9},
                                                 {1, 0.7, 0.45},
                                                 {1, 0.55, 0.6}}};

glm::dvec3 shop_color(uint64_t seed, int index, double s, double t) {
  Rng rng = rng_of(seed, 500 + index);
  const glm::dvec3 light = shop_lights[size_t(index) % shop_lights.size()];
  const double shelves = 3 + double(rng.next() % 3), items = 12 + double(rng.next() % 9), phase = rng.uniform();
  // Back wall between a bright ceiling and a floor; side walls draw in.
  glm::dvec3 c = light * blend(0.5, 0.16, t);
  const bool back = t > 0.22 && t < 0.8 && s > 0.08 && s < 0.92;
  if (back) {
    const double y = (t - 0.22) / 0.58 * shelves, x = (s + 0.13 * phase) * items;
    const int column = int(x), row = int(y);
    Rng item = rng_of(seed + 3, index * 4096 + row * 64 + column);
    const glm::dvec3 tint(item.uniform(0.25, 1), item.uniform(0.2, 0.9), item.uniform(0.15, 0.8));
    const double tall = item.uniform(0.35, 0.85);
    const bool thing = y - row > 1 - tall && x - column > 0.12 && x - column < 0.88;
    c = y - row > 0.93 ? light * 0.12 : thing ? light * tint * tint * 0.55 : light * 0.17 * blend(1.2, 0.7, t);
  }
  if (t <= 0.22) {  // spots along the ceiling
    const double lamp = std::fmod(s * 6 + phase, 1.0) - 0.5;
    c += light * 1.6 * bump(std::hypot(lamp * 0.5, (t - 0.12) * 1.2), 0.06);
  }
  if (t > 0.72) {  // a counter, and what stands on it, before the light
    const double stand = std::fmod(s * 5 + phase, 1.0);
    if (t > 0.8 || (stand > 0.3 && stand < 0.6)) c *= 0.3;
  }
  // Lamps that hang low.
  const double hang = std::fmod(s * 3 + 0.3 * phase, 1.0) - 0.5;
  c += light * 1.8 * bump(std::hypot(hang * 0.6, (t - 0.34) * 1.0), 0.05);
  return c * 0.8;
}

// What stands on shelves, seen from near: runs of the same bottles, jars, boxes or books, in a few colours a shop. x
// and y in shelves and items, y upwards from a shelf.
glm::dvec3 goods_color(uint64_t seed, int index, double x, double y) {
  const double row = std::floor(y), up = y - row;
  int begin = 0, end = 0, run = 0;  // of this shelf
  for (; end <= int(x); ++run) {
    Rng lengths = rng_of(seed + 5, index * 4096 + int(row) * 64 + run);
    begin = end, end += 3 + int(lengths.next() % 4);
  }
  Rng good = rng_of(seed + 7, index * 4096 + int(row) * 64 + run),
      item = rng_of(seed + 9, index * 4096 + int(row) * 64 + int(x)), shop = rng_of(seed + 11, index);
  const double hue = shop.uniform(), other = good.uniform() < 0.7 ? good.uniform(-0.06, 0.06) : good.uniform(0.2, 0.5);
  const auto wave = [&](double at) { return 0.5 + 0.5 * std::cos(6.28318530718 * (hue + other + at)); };
  const glm::dvec3 strong(wave(0), wave(0.67), wave(0.33));
  const int shape = int(good.next() % 4);
  const double tall = good.uniform(0.5, 0.78) * (shape == 3 ? item.uniform(0.8, 1) : 1);
  glm::dvec3 tint = blend(glm::dvec3(0.62, 0.52, 0.4), strong, good.uniform(0.25, 0.6)) * item.uniform(0.85, 1.1);
  if (shape == 3)
    tint *= blend(glm::dvec3(1), glm::dvec3(item.uniform(0.4, 1), item.uniform(0.4, 1), item.uniform(0.4, 1)), 0.6);
  const double across = std::abs(x - std::floor(x) - 0.5), v = up / tall;
  constexpr double none = -1;
  if (v > 1 || (shape != 3 && int(x) + 1 == end)) return glm::dvec3(none);  // a gap after each run
  double half = 0.42, shade = 1;
  if (shape == 0) half = v < 0.55 ? 0.3 : v < 0.72 ? blend(0.3, 0.1, (v - 0.55) / 0.17) : 0.1;
  if (shape == 1) half = 0.38 * std::sqrt(std::max(1 - 0.8 * std::pow(2 * v - 1, 4.0), 0.0));
  if (shape == 3) half = 0.47;
  if (across > half) return glm::dvec3(none);
  if (shape < 2) shade = 1 - 0.65 * across * across / (half * half);
  const bool label = shape != 3 && v > 0.2 && v < 0.45;
  if (label) tint = blend(tint, glm::dvec3(0.9, 0.85, 0.75), 0.6);
  if (shape == 3 && (across > 0.42 || (v > 0.75 && v < 0.8))) shade = 0.45;
  return tint * shade;
}

// As shop_color, for windows that the camera comes near to.
glm::dvec3 near_shop_color(uint64_t seed, int index, double s, double t) {
  Rng rng = rng_of(seed, 500 + index);
  const double shelves = 3 + double(rng.next() % 3), items = 16 + double(rng.next() % 9), phase = rng.uniform();
  const glm::dvec3 light = shop_lights[size_t(index) % shop_lights.size()];
  glm::dvec3 c = light * blend(0.42, 0.14, t);
  const double left = 0.07, top = 0.24, bottom = 0.8;
  if (t > top && t < bottom && s > left && s < 1 - left) {
    // Each shelf is lit from the one above it.
    const double y = (bottom - t) / (bottom - top) * shelves, up = y - std::floor(y), lit = blend(0.55, 1.25, up);
    const glm::dvec3 thing = goods_color(seed, index, (s - left) / (1 - 2 * left) * items, y);
    c = up < 0.06      ? light * 0.3
        : up > 0.95    ? light * 0.07
        : thing.x >= 0 ? light * thing * 0.5 * lit
                       : light * 0.15 * lit;
    const double post = std::abs(std::fmod((s - left) / (1 - 2 * left) * 3 + 0.5, 1.0) - 0.5);
    if (post < 0.02) c = light * 0.1;
  }
  if (t <= top) {
    const double lamp = std::fmod(s * 6 + phase, 1.0) - 0.5;
    c += light * 1.6 * bump(std::hypot(lamp * 0.5, (t - 0.12) * 1.2), 0.05);
  }
  if (t > bottom) c = light * (t < 0.82 ? 0.4 : 0.12 * blend(1.3, 0.6, (t - bottom) / (1 - bottom)));  // a counter
  return c * 0.8;
}

// Letters as strokes on a grid of 4 by 6, +Y upwards: pairs of digits are points, a space lifts the pen.
std::string_view strokes_of(char letter) {
  switch (letter) {
    case 'A':
      return "0004264440 0242";
    case 'B':
      return "00063645443303 3342413000";
    case 'C':
      return "4536160501103041";
    case 'D':
      return "00062644422000";
    case 'E':
      return "46060040 0333";
    case 'F':
      return "460600 0333";
    case 'G':
      return "453616050110304143 4323";
    case 'H':
      return "0006 4046 0343";
    case 'I':
      return "2620";
    case 'J':
      return "4641301001";
    case 'K':
      return "0600 4603 1340";
    case 'L':
      return "060040";
    case 'M':
      return "0006234640";
    case 'N':
      return "00064046";
    case 'O':
      return "051636454130100105";
    case 'P':
      return "00063645443303";
    case 'R':
      return "00063645443303 2340";
    case 'S':
      return "45361605041333424130 3010 1001";
    case 'T':
      return "0646 2620";
    case 'U':
      return "060110304146";
    case 'V':
      return "062046";
    case 'W':
      return "0610233046";
    case 'X':
      return "0640 4600";
    case 'Y':
      return "0623 4623 2320";
    case 'Z':
      return "06460040";
    case '+':
      return "2125 0343";
    default:
      return "";
  }
}

double to_segment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 along = b - a;
  const double t = std::clamp(glm::dot(p - a, along) / std::max(glm::dot(along, along), 1e-12), 0.0, 1.0);
  return glm::length(p - a - t * along);
}

// To the nearest stroke, in units of the letters' grid.
double to_letter(char letter, glm::dvec2 p) {
  const std::string_view strokes = strokes_of(letter);
  double nearest = 1e9;
  for (size_t i = 0; i + 3 < strokes.size();) {
    if (strokes[i] == ' ') {
      ++i;
      continue;
    }
    if (strokes[i + 2] == ' ') {
      i += 3;
      continue;
    }
    const glm::dvec2 a(strokes[i] - '0', strokes[i + 1] - '0'), b(strokes[i + 2] - '0', strokes[i + 3] - '0');
    nearest = std::min(nearest, to_segment(p, a, b));
    i += 2;
  }
  return nearest;
}

double to_frame(glm::dvec2 p, glm::dvec2 size, double inset) {
  const glm::dvec2 q = glm::abs(p - size / 2.0) - (size / 2.0 - inset);
  return std::abs(q.x > 0 && q.y > 0 ? glm::length(q) : std::max(q.x, q.y));
}

// A tube is nearly white inside; around it the board shines.
glm::dvec3 neon(glm::dvec3 color, double distance) {
  const double tube = 1 - smooth_step(0.22, 0.5, distance);
  return blend(color * (0.012 + 0.16 * std::exp(-distance * 1.1)), blend(color, glm::dvec3(1), 0.3), tube);
}

struct Sign {
  std::string_view text;
  glm::dvec3 letters, frame;
};
constexpr glm::dvec3 red{1, 0.06, 0.05}, pink{1, 0.1, 0.42}, cyan{0.06, 0.75, 1}, green{0.12, 1, 0.3},
    amber{1, 0.5, 0.08}, blue{0.12, 0.25, 1}, white{1, 0.85, 0.65};
constexpr std::array<Sign, lying_signs> lying{{{"CAFE LUNA", amber, white},
                                               {"BOOKS", white, cyan},
                                               {"RECORDS", pink, blue},
                                               {"NOODLES", red, amber},
                                               {"CINEMA", white, red},
                                               {"BAKERY", amber, amber},
                                               {"PHARMACY +", green, green},
                                               {"FLOWERS", pink, green}}};
constexpr std::array<Sign, standing_signs> standing{{{"HOTEL", red, white},
                                                     {"BAR", cyan, pink},
                                                     {"RAMEN", amber, red},
                                                     {"JAZZ", blue, pink},
                                                     {"OPEN", green, cyan},
                                                     {"TEA", white, green},
                                                     {"ARTS", pink, amber},
                                                     {"CLUB", pink, cyan}}};

glm::dvec3 lying_sign(int index, double s, double t) {
  const Sign& sign = lying[size_t(index)];
  constexpr double height = 11;  // of the board, in units of the letters
  const glm::dvec2 size(4 * height, height), p(s * size.x, (1 - t) * size.y);
  const double count = double(sign.text.size()), step = std::min(6.2, (size.x - 5) / count), shrink = step / 6.2;
  const double first = size.x / 2 - count * step / 2;
  const int letter = int(std::floor((p.x - first) / step));
  double nearest = 1e9;
  for (int k = std::max(letter - 1, 0); k <= std::min(letter + 1, int(sign.text.size()) - 1); ++k) {
    const glm::dvec2 at((p.x - first - k * step) / shrink - 1.1, p.y - 2.5);
    nearest = std::min(nearest, to_letter(sign.text[size_t(k)], at));
  }
  return neon(sign.letters, nearest) + neon(sign.frame, to_frame(p, size, 1.0)) * 0.55;
}

glm::dvec3 standing_sign(int index, double s, double t) {
  const Sign& sign = standing[size_t(index)];
  constexpr double width = 9;
  const glm::dvec2 size(width, 4 * width), p(s * size.x, (1 - t) * size.y);
  const double count = double(sign.text.size()), step = std::min(8.0, (size.y - 4) / count), stretch = step / 8.0;
  const double top = size.y / 2 + count * step / 2;
  const int letter = int(std::floor((top - p.y) / step));
  double nearest = 1e9;
  for (int k = std::max(letter - 1, 0); k <= std::min(letter + 1, int(sign.text.size()) - 1); ++k) {
    const glm::dvec2 at(p.x - width / 2 + 2, (p.y - (top - (k + 1) * step)) / stretch - 1);
    nearest = std::min(nearest, to_letter(sign.text[size_t(k)], at));
  }
  return neon(sign.letters, nearest) + neon(sign.frame, to_frame(p, size, 0.9)) * 0.55;
}

glm::dvec3 glow_color(int glow) {
  switch (glow) {
    case lamp_glow:
      return {1, 0.62, 0.28};
    case head_glow:
      return {0.55, 0.52, 0.46};
    case tail_glow:
      return {0.5, 0.008, 0.006};
    case red_glow:
      return {0.8, 0.02, 0.01};
    case amber_glow:
      return {0.8, 0.3, 0.02};
    case green_glow:
      return {0.03, 0.7, 0.25};
    case fairy_glow:
      return {0.4, 0.2, 0.06};
    case cool_glow:
      return {0.09, 0.07, 0.04};
    default:
      return glm::dvec3(0);
  }
}

}  // namespace

Cell cell_of(int columns, int rows, int index) {
  // Half a texel of 32 or more is left out at each side, against the neighbours' light.
  constexpr double margin = 0.012;
  const double x = index % columns, y = index / columns;
  return {{(x + margin) / columns, (y + 1 - margin) / rows}, {(x + 1 - margin) / columns, (y + margin) / rows}};
}

Atlas make_rooms(uint64_t seed) {
  return atlas_of(room_columns, room_rows, 48, 64,
                  [seed](int index, double s, double t) { return room_color(seed, index, s, t); });
}
Atlas make_shops(uint64_t seed) {
  return atlas_of(shop_columns, shop_rows, 160, 112,
                  [seed](int index, double s, double t) { return shop_color(seed, index, s, t); });
}
Atlas make_near_shops(uint64_t seed) {
  return atlas_of(shop_columns, shop_rows, 384, 256,
                  [seed](int index, double s, double t) { return near_shop_color(seed, index, s, t); });
}
Atlas make_lying_signs() { return atlas_of(2, lying_signs / 2, 320, 80, lying_sign); }
Atlas make_standing_signs() { return atlas_of(standing_signs, 1, 64, 256, standing_sign); }
glm::dvec3 lying_sign_color(int index) { return lying[size_t(index)].letters; }
glm::dvec3 standing_sign_color(int index) { return standing[size_t(index)].letters; }

Atlas make_glows() {
  return atlas_of(glow_count, 1, 4, 4, [](int index, double, double) { return glow_color(index); });
}
glm::dvec2 glow_uv(Glow glow) { return {(int(glow) + 0.5) / int(glow_count), 0.5}; }

}  // namespace candela::dusk
