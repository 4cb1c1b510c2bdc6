#pragma once
// The lights of a shaded point, in ascending order whatever the list: sums come out bit for bit as if every light were
// walked, for a light outside its range or cone gives exactly zero. All lanes of a subgroup walk the
// union of their lists, so a light's data is loaded once for all. In a long list, where most lights end before the
// point, each lane looks for those that reach it first. Lists with a cap (lights.cap) lack lights that reach their
// points: each lane walks its own alone, so that what it gets does not depend on the lanes beside it. Needs
// lib/light_cells.glsl and the addresses pc.lights, pc.light_cells, pc.light_entries, pc.light_tiles.
#include "lib/light_data.glsl"

#extension GL_KHR_shader_subgroup_arithmetic : require

const uint no_light = 0xffffffffu;
const uint every_cell = 0xffffffffu;  // a point that no cell holds walks every light
const uint lights_ahead = 4u;         // of a long list, whose words are loaded before the first of them is asked
// Lists are made for ranges a thousandth longer (passes/lights/light_grid.cpp): what is farther gives nothing.
const float beyond_range2 = 1.002;

uint light_cell(vec3 relative) {
  if (frame.grid.mode == light_mode_all) return every_cell;
  const vec3 p = view_position(relative);
  uvec2 tile;
  if (!light_tile(p, tile)) return every_cell;
  const uint flat_tile = tile.x + frame.grid.tiles.x * tile.y;
  const uint tiles = frame.grid.tiles.x * frame.grid.tiles.y;
  if (frame.grid.tiled == 0u) return flat_tile + tiles * light_slice(p.z);
  // A surface that the pre-pass did not see here (blended, or shaded off its sample) takes the column's list.
  const TileDepth t = TileDepthsRef(pc.light_tiles).t[flat_tile];
  const bool seen = t.mask != 0u && p.z >= t.z_near && p.z <= t.z_far;
  if (seen && (t.mask >> tile_slice(t, p.z) & 1u) != 0u) return flat_tile;
  const uvec2 column = tile / column_tiles;
  return tiles + column.x + frame.grid.columns.x * column.y;
}

struct LightWalk {
  uint light;         // where the walk stands, without a cap the same in all lanes
  uint cell;
  uint cursor, end;   // compact: entries left. Bitmask: word, and words
  uint mine;          // compact: this lane's next light. Bitmask: bits left of the word
  uint global;        // compact: place among the lights of every cell
  bool sifts;         // compact: this lane's list is long
  bool capped;
  vec3 position;
  // Of the frame, read once: a load inside the loop is a load for every light.
  uint mode, words, light_count, global_count;
  uint64_t globals;
};

// A word of the lights of every cell. The place is valid even where there are none: lanes may load ahead of a branch.
uint global_word(LightWalk w, uint place) { return ConstUintsRef(w.globals).u[min(place,
    max(w.global_count, 1u) - 1u)]; }

LightWalk begin_lights(vec3 relative) {
  LightWalk w;
  w.light = no_light;
  w.cell = light_cell(relative);
  w.cursor = 0u;
  w.mine = 0u;
  w.global = 0u;
  w.sifts = false;
  w.capped = frame.grid.cap != 0u;
  w.position = relative;
  w.mode = frame.grid.mode;
  w.words = frame.grid.words;
  w.light_count = frame.light_count;
  w.global_count = frame.grid.global_count;
  w.globals = frame.grid.globals;
  if (w.mode == light_mode_bitmask) {
    w.end = w.words;
  } else {
    w.end = w.light_count;
    w.mine = 0u < w.end ? 0u : no_light;
    if (w.cell != every_cell) {
      w.cursor = ConstUintsRef(pc.light_cells).u[w.cell];
      w.end = ConstUintsRef(pc.light_cells).u[w.cell + 1u];
      if (w.capped) w.end = min(w.end, w.cursor + frame.grid.cap);
      w.mine = w.cursor < w.end ? ConstUintsRef(pc.light_entries).u[w.cursor] : no_light;
      w.sifts = w.end - w.cursor > frame.grid.sift_over;
    }
  }
  return w;
}

bool light_reaches(uint number, vec3 position) {
  LightRef light = light_at(pc.lights, number);
  const vec2 xy = light_word(light, 0u), z_range = light_word(light, 1u);
  const vec3 to_light = vec3(xy, z_range.x) - position;
  return !(dot(to_light, to_light) * z_range.y * z_range.y >= beyond_range2);
}

// From the cursor on, this lane's next light that reaches its point.
void sift_lights(inout LightWalk w) {
  while (w.mine == no_light && w.cursor < w.end) {
    uint numbers[lights_ahead];
    bool reach[lights_ahead];
    for (uint i = 0u; i < lights_ahead; ++i)
      numbers[i] = ConstUintsRef(pc.light_entries).u[min(w.cursor + i, w.end - 1u)];
    for (uint i = 0u; i < lights_ahead; ++i) reach[i] = light_reaches(numbers[i], w.position);
    uint found = lights_ahead;
    for (uint i = lights_ahead; i-- > 0u;)
      if (reach[i]) {
        found = i;
        w.mine = numbers[i];
      }
    w.cursor += found;
  }
  // Past the end the last light was asked again.
  if (w.cursor >= w.end) w.mine = no_light;
}

bool next_light(inout LightWalk w) {
  if (w.mode == light_mode_bitmask) {
    while (w.mine == 0u) {
      if (w.cursor == w.end) return false;
      uint bits = 0xffffffffu;
      if (w.cell != every_cell) bits = ConstUintsRef(pc.light_cells).u[w.cell * w.words + w.cursor];
      w.mine = subgroupOr(bits);
      if (w.global_count != 0u) w.mine |= global_word(w, w.cursor);
      const uint left = w.light_count - 32u * w.cursor;
      if (left < 32u) w.mine &= (1u << left) - 1u;
      ++w.cursor;
    }
    // llvmpipe runs lanes that no sample covers with an empty union: findLSB's -1 would have them load light -1, and
    // crash.
    w.light = 32u * (w.cursor - 1u) + uint(max(findLSB(w.mine), 0));
    w.mine &= w.mine - 1u;
    return true;
  }
  uint global = no_light;
  if (w.global < w.global_count) global = global_word(w, w.global);
  w.light = min(w.capped ? w.mine : subgroupMin(w.mine), global);
  if (w.light == global) ++w.global;
  if (w.mine == w.light && w.mine != no_light) {
    ++w.cursor;
    w.mine = no_light;
    if (w.sifts)
      sift_lights(w);
    else if (w.cursor < w.end)
      w.mine = w.cell == every_cell ? w.cursor : ConstUintsRef(pc.light_entries).u[w.cursor];
  }
  return w.light != no_light;
}

// One point's own list, without the union of its subgroup: asked for lights in ascending order.
bool list_holds(inout LightWalk w, uint light) {
  if (w.cell == every_cell) return true;
  if (w.mode == light_mode_bitmask) {
    uint bits = ConstUintsRef(pc.light_cells).u[w.cell * w.words + light / 32u];
    if (w.global_count != 0u) bits |= global_word(w, light / 32u);
    return (bits >> (light & 31u) & 1u) != 0u;
  }
  if (w.global < w.global_count && global_word(w, w.global) == light) {
    ++w.global;
    return true;
  }
  if (w.cursor < w.end && ConstUintsRef(pc.light_entries).u[w.cursor] == light) {
    ++w.cursor;
    return true;
  }
  return false;
}
