#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "math/bounds.h"
#include "scene/scene.h"

// Metaballs (Blinn, "A Generalization of Algebraic Surface Drawing", 1982) with kernels of finite support, (1 - q^2)^3
// of the distance q in radii (Wyvill, McPheeters and Wyvill, "Data structure for soft objects", 1986). The surface is
// where F = sum of strength * kernel - threshold is 0, and what it bounds is where F is greater.
namespace candela {

struct Pose;

// In the space of the body's node.
struct PosedBall {
  glm::dvec3 centre{0};
  double radius_m = 1, strength = 0;  // strength 0: not there now
  bool operator==(const PosedBall&) const = default;
};

// A block of 8^3 cells of the lattice that the surface may touch, and the balls whose supports do.
struct MetaballBlock {
  glm::ivec3 first_cell{0};       // from MetaballLattice::origin_cell
  uint32_t first = 0, count = 0;  // of MetaballLattice::ball_lists
  bool operator==(const MetaballBlock&) const = default;
};

// Where a body is polygonised: blocks of one lattice, whose cells begin at whole multiples of the cell in the node's
// space. A function of the posed balls and the cell alone.
struct MetaballLattice {
  double cell_m = 0;
  glm::i64vec3 origin_cell{0};  // that blocks and vertices are counted from, near the balls
  std::vector<MetaballBlock> blocks;
  std::vector<uint32_t> ball_lists;
  uint64_t most_triangles = 0;  // no body has more
  bool enlarged = false;        // the cell is larger than asked for: there would be too many blocks
  // Of the space of vertices: metres of the node's space from the origin.
  glm::dvec3 origin_m() const { return glm::dvec3(origin_cell) * cell_m; }
};

// A body at one frame.
struct PosedMetaballs {
  uint32_t index = 0, node = 0, mesh = 0;  // of Scene
  glm::dmat4 relative_from_node{1.0};
  uint32_t transform = 0;  // relative space from the lattice's, into FrameData::relative_from_local
  double threshold = 0, noise_amplitude = 0, noise_frequency_per_m = 1;
  std::vector<PosedBall> balls;
  MetaballLattice lattice;
  uint32_t chunks = 0, first_deformation = 0;  // of FrameData::deformations, one a chunk
};

inline constexpr int metaball_block_cells = 8;
inline constexpr uint32_t metaball_chunk_triangles = 4096;  // that one item draws
inline constexpr uint32_t most_metaballs = 1024;            // of a body
inline constexpr size_t most_metaball_blocks = 4096;

// Balls in the space of the body's node; those that are hidden, or whose places are no numbers, have strength 0.
std::vector<PosedBall> pose_metaballs(const Metaballs& body, const Pose& pose);
// The cell where the file says nothing: an eighth of the median radius.
double default_metaball_cell_m(const Metaballs& body);

// A box about all that F > 0 holds, none where that is nothing.
DAabb metaball_bounds(std::span<const PosedBall> balls, double threshold);
// The same about the polygons of a lattice, whose vertices lie up to a cell off; where there is nothing, a point.
DAabb drawn_metaball_bounds(std::span<const PosedBall> balls, double threshold, double cell_m);
MetaballLattice make_metaball_lattice(std::span<const PosedBall> balls, double threshold, double cell_m);
// The same into what is kept: no more blocks than before allocate nothing.
void lay_out_metaballs(std::span<const PosedBall> balls, double threshold, double cell_m, MetaballLattice& kept);

// The polygons as the device makes them (shaders/metaballs_emit.comp), bit for bit: three vertices a triangle, in the
// lattice's space. Marching tetrahedra: each cell is cut into six about its diagonal (Freudenthal), of which those that
// cells share agree, so that the surface is closed and each edge is of two triangles.
std::vector<glm::vec3> polygonise(const PosedMetaballs& body);
// How many chunks the frame has room for: a coarse step of what the lattice allows, so that frames share a plan.
uint32_t metaball_chunks(uint64_t triangles);

// As the device has them: in cells from the lattice's origin.
struct LatticeBall {
  glm::vec3 centre;
  float inverse_square_radius, strength;
};
LatticeBall lattice_ball(const PosedBall& ball, const MetaballLattice& lattice);
std::vector<LatticeBall> lattice_balls(const PosedMetaballs& body);

}  // namespace candela
