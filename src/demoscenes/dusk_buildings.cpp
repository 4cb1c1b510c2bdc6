#include <algorithm>
#include <cmath>

#include "demoscenes/dusk.h"

// Houses of a city of about 1900: shops at the ground, windows in rows with sills and heads, cornices, a parapet, and
// on the roof tanks, chimneys and antennas. A facade is built facing +Z, x to the right, its middle at the origin.
namespace candela::dusk {
namespace {

constexpr double reveal_m = 0.22;  // how far glass lies behind the wall

struct Opening {
  glm::dvec2 low, high;
};

// A wall in the plane z with rectangular openings that lie in rows: each row's openings share bottom and top.
void wall_with_rows(MeshKit& kit, const Paint& paint, glm::dvec2 low, glm::dvec2 high, double z,
                    const std::vector<std::vector<Opening>>& rows) {
  const auto piece = [&](double x0, double y0, double x1, double y1) {
    if (x1 - x0 > 1e-6 && y1 - y0 > 1e-6) kit.quad(paint, {x0, y0, z}, {x1 - x0, 0, 0}, {0, y1 - y0, 0});
  };
  double y = low.y;
  for (const std::vector<Opening>& row : rows) {
    if (row.empty()) continue;
    piece(low.x, y, high.x, row[0].low.y);
    double x = low.x;
    for (const Opening& o : row) {
      piece(x, o.low.y, o.low.x, o.high.y);
      x = o.high.x;
    }
    piece(x, row[0].low.y, high.x, row[0].high.y);
    y = row[0].high.y;
  }
  piece(low.x, y, high.x, high.y);
}

void reveal(MeshKit& kit, const Paint& paint, glm::dvec2 low, glm::dvec2 high, double depth, bool with_floor = true) {
  const double w = high.x - low.x, h = high.y - low.y;
  kit.quad(paint, {low.x, low.y, 0}, {0, 0, -depth}, {0, h, 0});
  kit.quad(paint, {high.x, low.y, -depth}, {0, 0, depth}, {0, h, 0});
  kit.quad(paint, {low.x, high.y, -depth}, {w, 0, 0}, {0, 0, depth});
  if (with_floor) kit.quad(paint, {low.x, low.y, 0}, {w, 0, 0}, {0, 0, -depth});
}

void frame(MeshKit& kit, const Paint& paint, glm::dvec2 low, glm::dvec2 high, double z, double thick) {
  const unsigned upright = MeshKit::front | MeshKit::left | MeshKit::right;
  const unsigned lying = MeshKit::front | MeshKit::top | MeshKit::bottom;
  kit.box(paint, {low.x, low.y, z - 0.04}, {low.x + thick, high.y, z + 0.03}, upright);
  kit.box(paint, {high.x - thick, low.y, z - 0.04}, {high.x, high.y, z + 0.03}, upright);
  kit.box(paint, {low.x, low.y, z - 0.04}, {high.x, low.y + thick, z + 0.03}, lying);
  kit.box(paint, {low.x, high.y - thick, z - 0.04}, {high.x, high.y, z + 0.03}, lying);
}

WindowKind make_window(GlbWriter& out, const Materials& m, int which) {
  const glm::dvec3 white(0.55, 0.54, 0.5), dark(0.06, 0.065, 0.06), green(0.09, 0.13, 0.11);
  const Paint stone = m.stone.tinted({0.75, 0.72, 0.66});
  const Paint paint = m.matte.tinted(which == 0 || which == 3 ? white : which == 1 ? dark : green);
  WindowKind kind{0, which == 2 ? 1.9 : which == 3 ? 1.0 : 1.15, which == 1 ? 2.3 : which == 2 ? 1.6 : 1.85};
  const double w = kind.width, h = kind.height;
  MeshKit kit;
  reveal(kit, stone, {0, 0}, {w, h}, reveal_m);
  frame(kit, paint, {0, 0}, {w, h}, -reveal_m + 0.06, 0.07);
  const unsigned upright = MeshKit::front | MeshKit::left | MeshKit::right;
  const unsigned lying = MeshKit::front | MeshKit::top | MeshKit::bottom;
  const double z = -reveal_m + 0.05;
  // Glazing bars.
  kit.box(paint, {w / 2 - 0.03, 0, z - 0.03}, {w / 2 + 0.03, h, z + 0.03}, upright);
  if (which == 2) {
    kit.box(paint, {w / 4 - 0.02, 0, z - 0.03}, {w / 4 + 0.02, h, z + 0.02}, upright);
    kit.box(paint, {w * 0.75 - 0.02, 0, z - 0.03}, {w * 0.75 + 0.02, h, z + 0.02}, upright);
    kit.box(paint, {0, h * 0.72 - 0.02, z - 0.03}, {w, h * 0.72 + 0.02, z + 0.02}, lying);
  } else {
    const double bar = which == 1 ? h * 0.7 : h * 0.5;
    kit.box(paint, {0, bar - 0.03, z - 0.03}, {w, bar + 0.03, z + 0.03}, lying);
  }
  // Sill and head.
  kit.box(stone, {-0.12, -0.12, 0}, {w + 0.12, 0, 0.14}, MeshKit::all & ~unsigned(MeshKit::back));
  if (which == 0) {
    kit.box(stone, {-0.15, h, 0}, {w + 0.15, h + 0.2, 0.07}, MeshKit::all & ~unsigned(MeshKit::back));
    kit.box(stone, {-0.22, h + 0.2, 0}, {w + 0.22, h + 0.28, 0.18}, MeshKit::all & ~unsigned(MeshKit::back));
  } else if (which == 3) {  // a flat arch with a key stone
    kit.box(stone, {-0.1, h, 0}, {w + 0.1, h + 0.24, 0.04}, MeshKit::all & ~unsigned(MeshKit::back));
    kit.box(stone, {w / 2 - 0.1, h - 0.04, 0}, {w / 2 + 0.1, h + 0.32, 0.1}, MeshKit::all & ~unsigned(MeshKit::back));
  }
  if (which == 1) {  // a shallow balcony of bars
    const Paint iron = m.metal.tinted({0.12, 0.12, 0.13});
    kit.box(iron, {-0.2, -0.14, 0}, {w + 0.2, -0.06, 0.5}, MeshKit::all & ~unsigned(MeshKit::back));
    for (double y : {0.12, 0.92}) kit.box(iron, {-0.2, y, 0.44}, {w + 0.2, y + 0.05, 0.49}, lying);
    for (double x : {-0.2, w + 0.15}) kit.box(iron, {x, 0.92, 0}, {x + 0.05, 0.97, 0.49}, lying);
    const int bars = 9;
    for (int i = 0; i <= bars; ++i) {
      const double x = -0.2 + (w + 0.37) * i / bars;
      kit.box(iron, {x, -0.06, 0.45}, {x + 0.03, 0.95, 0.48}, MeshKit::front | MeshKit::left | MeshKit::right);
    }
  }
  kind.mesh = kit.write(out, "window");
  return kind;
}

int make_tank(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const Paint wood = m.matte.tinted({0.12, 0.085, 0.06}), iron = m.metal.tinted({0.12, 0.12, 0.12});
  for (int i = 0; i < 4; ++i) {
    const double x = i % 2 ? 0.8 : -0.8, z = i / 2 ? 0.8 : -0.8;
    kit.tube(iron, {x, 0, z}, 0.08, {x, 2, z}, 0.08, 5);
  }
  kit.box(iron, {-1.1, 1.95, -1.1}, {1.1, 2.1, 1.1}, MeshKit::all);
  kit.tube(wood, {0, 2.1, 0}, 1.25, {0, 4.3, 0}, 1.15, 14);
  for (double y : {2.3, 3.2, 4.1}) kit.tube(iron, {0, y, 0}, 1.27, {0, y + 0.07, 0}, 1.27, 14);
  kit.tube(wood.tinted(glm::dvec3(0.7)), {0, 4.25, 0}, 1.4, {0, 5.3, 0}, 0, 14);
  return kit.write(out, "water tank");
}

int make_chimney(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  kit.box(m.brick.tinted(glm::dvec3(0.8)), {-0.9, 0, -0.4}, {0.9, 1.9, 0.4});
  kit.box(m.stone.tinted(glm::dvec3(0.5)), {-1, 1.9, -0.5}, {1, 2.05, 0.5}, MeshKit::all);
  for (double x : {-0.6, 0.0, 0.6})
    kit.tube(m.matte.tinted({0.3, 0.15, 0.1}), {x, 2.05, 0}, 0.17, {x, 2.6, 0}, 0.14, 8, true);
  return kit.write(out, "chimney");
}

int make_antenna(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const Paint steel = m.metal.tinted(glm::dvec3(0.5));
  kit.tube(steel, {0, 0, 0}, 0.035, {0, 3.4, 0}, 0.02, 5);
  for (int i = 0; i < 5; ++i)
    kit.tube(steel, {-0.5 + 0.05 * i, 2.2 + 0.25 * i, 0}, 0.015, {0.5 - 0.05 * i, 2.2 + 0.25 * i, 0}, 0.015, 4);
  return kit.write(out, "antenna");
}

int make_cooler(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  kit.box(m.metal.tinted(glm::dvec3(0.7)), {-0.7, 0.2, -0.5}, {0.7, 1.3, 0.5});
  kit.tube(m.metal.tinted(glm::dvec3(0.2)), {0, 1.3, 0}, 0.4, {0, 1.42, 0}, 0.4, 12, true);
  return kit.write(out, "cooler");
}

struct Ground {
  double left, right, top;
};

// A shop between two pillars: a plinth, a large pane, a door beside it, a board over both, often an awning.
void add_shop(const Ground& g, const Materials& m, Rng& rng, Facade& facade, LightArrays& lights,
              const glm::dmat4& frame_of) {
  MeshKit& kit = facade.walls;
  const glm::dvec3 colors[] = {
      {0.05, 0.09, 0.08}, {0.12, 0.03, 0.03}, {0.04, 0.05, 0.1}, {0.09, 0.07, 0.05}, {0.06, 0.06, 0.06}};
  const Paint wood = m.matte.tinted(colors[rng.next() % std::size(colors)]);
  const double w = g.right - g.left, board_low = g.top - 0.85, depth = 0.35, door_w = 1.15;
  const bool door_right = rng.next() % 2;
  const double door_x = door_right ? g.right - door_w : g.left;
  const double pane_x0 = door_right ? g.left : g.left + door_w, pane_x1 = pane_x0 + w - door_w;
  kit.quad(wood, {g.left, 0, 0}, {0, 0, -depth}, {0, board_low, 0});
  kit.quad(wood, {g.right, 0, -depth}, {0, 0, depth}, {0, board_low, 0});
  kit.quad(wood, {g.left, board_low, -depth}, {w, 0, 0}, {0, 0, depth});
  kit.quad(m.pavement, {g.left, 0.02, 0}, {w, 0, 0}, {0, 0, -depth});
  // Plinth, pane and its bars.
  const double plinth = 0.55;
  kit.box(wood, {pane_x0, 0, -depth - 0.05}, {pane_x1, plinth, -depth + 0.1},
          MeshKit::front | MeshKit::top | MeshKit::right | MeshKit::left);
  const int picture = facade.next_shop++ * 3 % (shop_columns * shop_rows);
  const Cell cell = cell_of(shop_columns, shop_rows, picture);
  facade.lights.quad({m.shops}, {pane_x0, plinth, -depth}, {pane_x1 - pane_x0, 0, 0}, {0, board_low - plinth, 0},
                     cell.corner, cell.far);
  frame(kit, wood, {pane_x0, plinth}, {pane_x1, board_low}, -depth + 0.05, 0.08);
  const int panes = std::max(1, int((pane_x1 - pane_x0) / 1.4));
  for (int i = 1; i < panes; ++i) {
    const double x = pane_x0 + (pane_x1 - pane_x0) * i / panes;
    kit.box(wood, {x - 0.03, plinth, -depth}, {x + 0.03, board_low, -depth + 0.07},
            MeshKit::front | MeshKit::left | MeshKit::right);
  }
  kit.box(wood, {pane_x0, board_low - 0.62, -depth}, {pane_x1, board_low - 0.56, -depth + 0.06},
          MeshKit::front | MeshKit::top | MeshKit::bottom);
  // The door: a frame, a pane, a handle, a light over it.
  frame(kit, wood, {door_x, 0}, {door_x + door_w, 2.45}, -depth + 0.05, 0.12);
  facade.lights.quad({m.shops}, {door_x + 0.12, 0.35, -depth + 0.01}, {door_w - 0.24, 0, 0}, {0, 1.98, 0},
                     glm::mix(cell.corner, cell.far, glm::dvec2(0.1, 0.15)),
                     glm::mix(cell.corner, cell.far, glm::dvec2(0.35, 0.8)));
  kit.box(wood, {door_x + 0.12, 0, -depth}, {door_x + door_w - 0.12, 0.35, -depth + 0.04},
          MeshKit::front | MeshKit::top);
  facade.lights.quad({m.shops}, {door_x, 2.45, -depth}, {door_w, 0, 0}, {0, board_low - 2.45, 0}, cell.corner,
                     glm::mix(cell.corner, cell.far, glm::dvec2(0.3, 0.3)));
  kit.tube(m.chrome, {door_x + (door_right ? 0.2 : door_w - 0.2), 0.9, -depth + 0.1}, 0.02,
           {door_x + (door_right ? 0.2 : door_w - 0.2), 1.4, -depth + 0.1}, 0.02, 5);
  // The board and its sign.
  kit.box(wood, {g.left - 0.05, board_low, 0}, {g.right + 0.05, g.top - 0.12, 0.12},
          MeshKit::front | MeshKit::left | MeshKit::right | MeshKit::bottom);
  kit.box(m.stone.tinted(glm::dvec3(0.6)), {g.left - 0.1, g.top - 0.12, 0}, {g.right + 0.1, g.top, 0.3},
          MeshKit::all & ~unsigned(MeshKit::back));
  const int sign = facade.next_lying_sign++ * 3 % lying_signs;
  const double sign_h = std::min(0.68, (w - 0.3) / 4), sign_w = 4 * sign_h, centre = (g.left + g.right) / 2;
  const Cell text = cell_of(2, lying_signs / 2, sign);
  facade.lights.quad({m.lying_signs}, {centre - sign_w / 2, board_low + 0.03, 0.16}, {sign_w, 0, 0}, {0, sign_h, 0},
                     text.corner, text.far);
  if (rng.next() % 5 < 2) {  // an awning with stripes and a valance
    const double out_m = 1.5, high = board_low - 0.05, low = high - 0.62;
    const glm::dvec3 stripe = rng.next() % 2 ? glm::dvec3(0.3, 0.04, 0.035) : glm::dvec3(0.035, 0.12, 0.09);
    const int stripes = std::max(4, int(w / 0.4));
    for (int i = 0; i < stripes; ++i) {
      const Paint cloth = m.leaf.tinted(i % 2 ? glm::dvec3(0.5, 0.47, 0.4) : stripe);
      const double x = g.left + w * i / stripes, step = w / stripes;
      kit.quad(cloth, {x, low, out_m}, {step, 0, 0}, {0, high - low, -out_m});
      kit.quad(cloth, {x, low - 0.22, out_m}, {step, 0, 0}, {0, 0.22, 0});
    }
  }
  const auto world = [&](glm::dvec3 p) { return glm::dvec3(frame_of * glm::dvec4(p, 1)); };
  lights.add(world({(pane_x0 + pane_x1) / 2, 2.5, 1.5}), {1, 0.74, 0.45}, 10, 9, {0, 1, 0});
  lights.add(world({centre, g.top - 0.4, 1.5}), glm::mix(lying_sign_color(sign), glm::dvec3(1), 0.1), 12, 14,
             {0, 1, 0});
}

// The door of the house beside its shop.
void add_house_door(const Ground& g, const Materials& m, Rng& rng, Facade& facade) {
  MeshKit& kit = facade.walls;
  const Paint stone = m.stone.tinted({0.7, 0.68, 0.62});
  const glm::dvec3 colors[] = {{0.15, 0.02, 0.02}, {0.02, 0.06, 0.05}, {0.02, 0.03, 0.08}};
  const Paint wood = m.car_paint.tinted(colors[rng.next() % 3]);
  const double x0 = (g.left + g.right) / 2 - 0.6, x1 = x0 + 1.2, depth = 0.3;
  wall_with_rows(kit, stone, {g.left, 0}, {g.right, g.top}, 0, {{{{x0, 0}, {x1, 2.9}}}});
  for (int side = 0; side < 2; ++side)
    kit.quad(stone, {side ? x1 : x0, 0, side ? -depth : 0}, {0, 0, side ? depth : -depth}, {0, 2.9, 0});
  kit.quad(stone, {x0, 2.9, -depth}, {1.2, 0, 0}, {0, 0, depth});
  kit.quad(wood, {x0, 0.12, -depth}, {1.2, 0, 0}, {0, 2.2, 0});
  for (double px : {x0 + 0.12, x0 + 0.66})
    for (double py : {0.3, 1.25})
      kit.box(wood.tinted(glm::dvec3(0.8)), {px, py, -depth}, {px + 0.42, py + 0.8, -depth + 0.03},
              MeshKit::all & ~unsigned(MeshKit::back));
  kit.box(stone, {x0 - 0.25, 2.95, 0}, {x1 + 0.25, 3.15, 0.4}, MeshKit::all & ~unsigned(MeshKit::back));
  kit.box(stone, {x0 - 0.1, 0, -depth}, {x1 + 0.1, 0.12, 0.35});
  const Cell cell = cell_of(room_columns, room_rows, dark_rooms + int(rng.next() % 20));
  facade.lights.quad({m.rooms}, {x0, 2.35, -depth}, {1.2, 0, 0}, {0, 0.5, 0}, cell.corner, cell.far);
}

}  // namespace

BuildingKit make_building_kit(GlbWriter& out, const Materials& m) {
  BuildingKit kit;
  for (int i = 0; i < window_kinds; ++i) kit.windows[size_t(i)] = make_window(out, m, i);
  kit.roof_things = {make_tank(out, m), make_chimney(out, m), make_antenna(out, m), make_cooler(out, m)};
  return kit;
}

void add_building(const Building& b, glm::dvec3 at, double turn_rad, const Materials& m, const BuildingKit& kit,
                  Rng& rng, Facade& facade, Instances& instances, LightArrays& shop_lights) {
  const glm::dmat4 frame_of = placed(at, turn_rad);
  const auto world = [&](glm::dvec3 p) { return glm::dvec3(frame_of * glm::dvec4(p, 1)); };
  facade.walls.place(frame_of);
  facade.lights.place(frame_of);
  MeshKit& walls = facade.walls;
  const double half = b.width / 2, roof = b.ground_m + b.floors * b.floor_m;
  const WindowKind& window = kit.windows[size_t(b.window_kind)];

  // Upper floors.
  const int columns = std::max(2, int(b.width / (window.width + 1.15)));
  const double pitch = b.width / columns;
  std::vector<std::vector<Opening>> rows;
  for (int floor = 0; floor < b.floors; ++floor) {
    const double y = b.ground_m + floor * b.floor_m + (b.floor_m - window.height) * 0.42;
    std::vector<Opening> row;
    // Neighbours often belong to one flat, and have one light.
    int flat = 0, room = 0;
    for (int c = 0; c < columns; ++c) {
      const double x = -half + pitch * (c + 0.5) - window.width / 2;
      row.push_back({{x, y}, {x + window.width, y + window.height}});
      instances.add(window.mesh, world({x, y, 0}), turn_rad);
      if (flat-- <= 0) {
        flat = int(rng.next() % 2);
        const bool lit = rng.uniform() < 0.64;
        room = lit ? dark_rooms + int(rng.next() % uint64_t(room_columns * room_rows - dark_rooms))
                   : int(rng.next() % dark_rooms);
      }
      const Cell cell = cell_of(room_columns, room_rows, room);
      facade.lights.quad({facade.room_material(m)}, {x, y, -reveal_m}, {window.width, 0, 0}, {0, window.height, 0},
                         cell.corner, cell.far);
    }
    rows.push_back(std::move(row));
  }
  wall_with_rows(walls, b.wall, {-half, b.ground_m}, {half, roof}, 0, rows);
  // The other three walls and the roof, with a parapet around it.
  if (b.closed & MeshKit::right) walls.quad(b.wall, {half, 0, 0}, {0, 0, -b.depth}, {0, roof + 0.9, 0});
  if (b.closed & MeshKit::left) walls.quad(b.wall, {-half, 0, -b.depth}, {0, 0, b.depth}, {0, roof + 0.9, 0});
  if (b.closed & MeshKit::back) walls.quad(b.wall, {half, 0, -b.depth}, {-b.width, 0, 0}, {0, roof + 0.9, 0});
  if (b.closed & MeshKit::top)
    walls.quad(m.matte.tinted(glm::dvec3(0.05)), {-half, roof, 0}, {b.width, 0, 0}, {0, 0, -b.depth});
  const unsigned strip = MeshKit::all & ~unsigned(MeshKit::back);
  walls.box(b.wall, {-half, roof, -0.3}, {half, roof + 0.9, 0}, MeshKit::front | MeshKit::back | MeshKit::top);
  walls.box(b.trim, {-half - 0.06, roof + 0.9, -0.36}, {half + 0.06, roof + 1.02, 0.08}, MeshKit::all);
  // Cornice with brackets, and bands between the floors.
  walls.box(b.trim, {-half - 0.02, roof - 0.35, 0}, {half + 0.02, roof - 0.1, 0.22}, strip);
  walls.box(b.trim, {-half - 0.05, roof - 0.1, 0}, {half + 0.05, roof + 0.08, 0.5}, strip);
  const int brackets = int(b.width / 0.7);
  for (int i = 0; i < brackets; ++i) {
    const double x = -half + b.width * (i + 0.5) / brackets;
    walls.box(b.trim, {x - 0.08, roof - 0.34, 0.22}, {x + 0.08, roof - 0.1, 0.44},
              MeshKit::front | MeshKit::left | MeshKit::right | MeshKit::bottom);
  }
  if (b.window_kind != 2)
    for (int floor = 1; floor < b.floors; floor += b.window_kind == 3 ? 1 : 2)
      walls.box(b.trim, {-half, b.ground_m + floor * b.floor_m - 0.16, 0}, {half, b.ground_m + floor * b.floor_m, 0.09},
                MeshKit::front | MeshKit::top | MeshKit::bottom);
  // Corner stones.
  for (int i = 0; b.window_kind == 0 && i < int((roof - b.ground_m - 0.5) / 0.45); ++i)
    for (double side : {-1.0, 1.0}) {
      const double wide = i % 2 ? 0.3 : 0.5, x = side * (half - wide / 2);
      walls.box(b.trim, {x - wide / 2, b.ground_m + 0.45 * i, 0}, {x + wide / 2, b.ground_m + 0.45 * i + 0.41, 0.05},
                MeshKit::front | MeshKit::left | MeshKit::right | MeshKit::top);
    }

  // The ground floor: pillars, shops, and the house's door.
  const double pillar = 0.45, door_part = 2.0;
  const int shops = b.width > 11 ? 2 : 1;
  const bool door_left = rng.next() % 2;
  const double first = -half + (door_left ? door_part : 0), last = half - (door_left ? 0 : door_part);
  add_house_door(door_left ? Ground{-half, first, b.ground_m} : Ground{last, half, b.ground_m}, m, rng, facade);
  for (int s = 0; s < shops; ++s) {
    const double x0 = first + (last - first) * s / shops, x1 = first + (last - first) * (s + 1) / shops;
    add_shop({x0 + pillar, x1 - pillar, b.ground_m}, m, rng, facade, shop_lights, frame_of);
    for (double x : {x0, x1 - pillar}) {
      walls.box(b.trim, {x, 0, -0.4}, {x + pillar, b.ground_m, 0.1}, MeshKit::front | MeshKit::left | MeshKit::right);
      walls.box(b.trim, {x - 0.04, 0, -0.4}, {x + pillar + 0.04, 0.4, 0.15},
                MeshKit::front | MeshKit::left | MeshKit::right | MeshKit::top);
      walls.box(b.trim, {x - 0.04, b.ground_m - 0.3, -0.1}, {x + pillar + 0.04, b.ground_m, 0.17},
                MeshKit::front | MeshKit::left | MeshKit::right | MeshKit::bottom);
    }
  }
  walls.box(b.trim, {-half, b.ground_m - 0.02, 0}, {half, b.ground_m + 0.22, 0.24}, strip);

  // A sign that stands out from the wall, on iron.
  if (b.shop_signs > 1) {
    const int sign = facade.next_standing_sign++ * 3 % standing_signs;
    const double x = door_left ? -half + 0.4 : half - 0.4, low = b.ground_m + 0.9, tall = 3.2, wide = 0.8;
    const Cell text = cell_of(standing_signs, 1, sign);
    facade.lights.quad({m.standing_signs}, {x + 0.09, low, 0.35 + wide}, {0, 0, -wide}, {0, tall, 0}, text.corner,
                       text.far);
    facade.lights.quad({m.standing_signs}, {x - 0.09, low, 0.35}, {0, 0, wide}, {0, tall, 0}, text.corner, text.far);
    const Paint iron = m.metal.tinted(glm::dvec3(0.1));
    walls.box(iron, {x - 0.08, low - 0.05, 0.33}, {x + 0.08, low + tall + 0.05, 0.37 + wide},
              MeshKit::front | MeshKit::back | MeshKit::top | MeshKit::bottom);
    for (double y : {low + 0.3, low + tall - 0.3}) walls.box(iron, {x - 0.03, y, 0}, {x + 0.03, y + 0.06, 0.35});
    shop_lights.add(world({x, low + 0.4, 1.7}), standing_sign_color(sign), 12, 16, {0, 1, 0});
  }
  // A downpipe at the edge.
  walls.tube(m.metal.tinted(glm::dvec3(0.3)), {half - 0.12, 0, 0.12}, 0.055, {half - 0.12, roof - 0.1, 0.12}, 0.055, 6);

  for (int i = 0; i < 4 && b.closed & MeshKit::top; ++i) {
    const int mesh = kit.roof_things[size_t(rng.next() % kit.roof_things.size())];
    const double x = rng.uniform(-half + 1.6, half - 1.6), z = rng.uniform(-5.5, -1.8);
    instances.add(mesh, world({x, roof, z}), turn_rad + (rng.next() % 2 ? 0.0 : 1.5707963267948966));
  }
}

}  // namespace candela::dusk
