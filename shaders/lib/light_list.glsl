// The lights of a shaded point, in ascending order whatever the list: sums come out bit for bit as if every light were walked, for
// a light outside its range or cone gives exactly zero (TECHNIQUES 6.1). All lanes of a subgroup walk the union of their lists, so a
// light's data is loaded once for all. Needs lib/light_cells.glsl and the addresses pc.light_cells, pc.light_entries, pc.light_tiles.

#extension GL_KHR_shader_subgroup_arithmetic : require

const uint no_light = 0xffffffffu;
const uint every_cell = 0xffffffffu;  // a point that no cell holds walks every light

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

// A word of the lights of every cell. The address and the place are valid even where there are none: a driver may load from a
// branch that no lane takes when all lanes agree on the address (lavapipe 25.0.7 does).
uint global_word(uint place) {
  return ConstUintsRef(frame.grid.globals).u[min(place, max(frame.grid.global_count, 1u) - 1u)];
}

struct LightWalk {
  uint light;         // where the walk stands, the same in all lanes
  uint cell;
  uint cursor, end;   // compact: entries left. Bitmask: word, and words
  uint mine;          // compact: this lane's next light. Bitmask: bits left of the word
  uint global;        // compact: place among the lights of every cell
};

LightWalk begin_lights(vec3 relative) {
  LightWalk w;
  w.light = no_light;
  w.cell = light_cell(relative);
  w.cursor = 0u;
  w.mine = 0u;
  w.global = 0u;
  if (frame.grid.mode == light_mode_bitmask) {
    w.end = frame.grid.words;
  } else {
    w.end = frame.light_count;
    w.mine = 0u < w.end ? 0u : no_light;
    if (w.cell != every_cell) {
      w.cursor = ConstUintsRef(pc.light_cells).u[w.cell];
      w.end = ConstUintsRef(pc.light_cells).u[w.cell + 1u];
      if (frame.grid.cap != 0u) w.end = min(w.end, w.cursor + frame.grid.cap);
      w.mine = w.cursor < w.end ? ConstUintsRef(pc.light_entries).u[w.cursor] : no_light;
    }
  }
  return w;
}

bool next_light(inout LightWalk w) {
  if (frame.grid.mode == light_mode_bitmask) {
    while (w.mine == 0u) {
      if (w.cursor == w.end) return false;
      uint bits = 0xffffffffu;
      if (w.cell != every_cell) bits = ConstUintsRef(pc.light_cells).u[w.cell * frame.grid.words + w.cursor];
      w.mine = subgroupOr(bits);
      if (frame.grid.global_count != 0u) w.mine |= global_word(w.cursor);
      const uint left = frame.light_count - 32u * w.cursor;
      if (left < 32u) w.mine &= (1u << left) - 1u;
      ++w.cursor;
    }
    // llvmpipe runs lanes that no sample covers with an empty union: findLSB's -1 would have them load light -1, and crash.
    w.light = 32u * (w.cursor - 1u) + uint(max(findLSB(w.mine), 0));
    w.mine &= w.mine - 1u;
    return true;
  }
  const uint global = w.global < frame.grid.global_count ? global_word(w.global) : no_light;
  w.light = min(subgroupMin(w.mine), global);
  if (w.light == global) ++w.global;
  if (w.mine == w.light && w.mine != no_light) {
    ++w.cursor;
    w.mine = no_light;
    if (w.cursor < w.end) w.mine = w.cell == every_cell ? w.cursor : ConstUintsRef(pc.light_entries).u[w.cursor];
  }
  return w.light != no_light;
}

// One point's own list, without the union of its subgroup: asked for lights in ascending order.
struct ListCursor {
  uint cell, cursor, end, global;
};
ListCursor begin_list(vec3 relative) {
  const LightWalk w = begin_lights(relative);
  return ListCursor(w.cell, w.cursor, w.end, 0u);
}
bool list_holds(inout ListCursor c, uint light) {
  if (c.cell == every_cell) return true;
  if (frame.grid.mode == light_mode_bitmask) {
    uint bits = ConstUintsRef(pc.light_cells).u[c.cell * frame.grid.words + light / 32u];
    if (frame.grid.global_count != 0u) bits |= global_word(light / 32u);
    return (bits >> (light & 31u) & 1u) != 0u;
  }
  if (c.global < frame.grid.global_count && global_word(c.global) == light) {
    ++c.global;
    return true;
  }
  if (c.cursor < c.end && ConstUintsRef(pc.light_entries).u[c.cursor] == light) {
    ++c.cursor;
    return true;
  }
  return false;
}
