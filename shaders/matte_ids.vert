#version 460
// Places surfaces as the depth pre-pass does, and gives each the id of its object's or, with MATERIALS, its material's
// name.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"

invariant gl_Position;
layout(location = 0) out flat float out_id;
#ifdef RELIEF
layout(location = 10) out flat uint out_item;
#endif

void main() {
  const Item item = load_item(gl_InstanceIndex);
  gl_Position = clip_position(relative_position(item, load_geometry(item.geometry), gl_VertexIndex));
  gl_PointSize = 1.0;
#ifdef RELIEF
  out_item = uint(gl_InstanceIndex);
#endif
#ifdef MATERIALS
  const uint place = item.material;
#else
  const uint place = item.object_id;
#endif
  out_id = uintBitsToFloat(WordsRef(pc.table).w[place]);
}
