#pragma once
#include "scene/scene.h"

namespace candela {
// Fills section.tangent by the MikkTSpace method (Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008), as the
// glTF specification asks where a normal texture has no tangents: computed on the unindexed triangles, then vertices
// are welded again, so vertex_count may grow; joints, weights, morph targets and colours follow. uv_set 0 or 1.
// Degenerate corners get a finite unit tangent. Triangles only.
void generate_tangents(MeshSection& section, int uv_set);
// Flat normals, as the specification asks where NORMAL is missing: vertices are unshared; given tangents are dropped.
void generate_flat_normals(MeshSection& section);
}  // namespace candela
