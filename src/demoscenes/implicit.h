#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "testscenes/procedural_shapes.h"

// Bodies by formula: distances to simple shapes, put together, and the mesh of the surface between inside and outside.
namespace candela {

// --- noise over space, about -1 to 1, without a period

double noise3(glm::dvec3 p, uint64_t seed);                // gradient noise (Perlin 1985) with a quintic blend
double fbm3(glm::dvec3 p, int octaves, uint64_t seed);     // octaves, each twice as fine and half as strong
double ridged3(glm::dvec3 p, int octaves, uint64_t seed);  // 0 to 1, sharp where 1

// --- distances: below 0 inside, about metres

double to_ellipsoid(glm::dvec3 p, glm::dvec3 centre, glm::dvec3 radii);
// Two balls and the cone that touches both; at what part of the way from a to b the point lies goes to `along`.
double to_round_cone(glm::dvec3 p, glm::dvec3 a, double radius_a, glm::dvec3 b, double radius_b,
                     double* along = nullptr);
double to_triangle(glm::dvec3 p, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);  // 0 and more
// The lesser of two, blended over `k` metres (Quilez), and the greater.
double smooth_min(double a, double b, double k);
double smooth_max(double a, double b, double k);

// --- the mesh

// Below 0 inside. It changes by at most `slope` a metre (mesh_implicit), so that what is far from 0 holds no surface.
using Field = std::function<double(glm::dvec3)>;

struct ImplicitMesh {
  std::vector<glm::dvec3> position, normal;  // normals are the field's gradient
  std::vector<uint32_t> index;
};
// A vertex for each piece of the surface in a cell of the lattice, four of them about each edge that the surface cuts
// (Nielson, "Dual Marching Cubes", 2004): closed, and even triangles. Low and high are outside or the surface is open.
ImplicitMesh mesh_implicit(const Field& field, glm::dvec3 low, glm::dvec3 high, double cell_m, double slope = 1.5);

// How a triangle's corners are textured: the same `group` share vertices.
struct Texturing {
  std::function<int(glm::dvec3 middle, glm::dvec3 normal)> group;
  std::function<glm::dvec2(glm::dvec3 at, glm::dvec3 middle, int group)> uv;
  std::function<glm::dvec3(glm::dvec3 at, glm::dvec3 normal)> color;
};
Shape textured(const ImplicitMesh& mesh, const Texturing& texturing);
// Along the axis that a triangle faces most.
int box_group(glm::dvec3 normal);
glm::dvec2 box_uv(glm::dvec3 at, int group);

}  // namespace candela
