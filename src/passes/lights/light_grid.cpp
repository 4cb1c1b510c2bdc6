#include "passes/lights/light_grid.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <bit>
#include <cmath>
#include <optional>

#include "base/scratch.h"

namespace candela {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double inflated_range = 1 + 1.0 / 1024, inflated_angle_rad = 1e-3;
constexpr double half_pi = 1.5707963267948966;

struct Range {
  double low = -infinity, high = infinity;
  bool empty() const { return low > high; }
};
Range cut(Range a, Range b) { return {std::max(a.low, b.low), std::min(a.high, b.high)}; }

struct Ball {
  glm::dvec3 centre;
  double radius;
};

// x/z over the part of a ball in front of the camera, or x itself for an orthographic one. The tangents to a circle at
// angle phi from the axis lie at phi +- alpha, sin alpha = radius/distance.
Range projected(double x, double z, double radius, bool perspective) {
  if (!perspective) return {x - radius, x + radius};
  const double distance2 = x * x + z * z, t2 = distance2 - radius * radius;
  if (!(t2 > 1e-9 * distance2)) return {};
  const double t = std::sqrt(t2);
  Range r;
  if (const double cosine = z * t + x * radius; cosine > 1e-12 * distance2) r.low = (x * t - z * radius) / cosine;
  if (const double cosine = z * t - x * radius; cosine > 1e-12 * distance2) r.high = (x * t + z * radius) / cosine;
  return r;
}

// A ball round a cone with a spherical cap, smaller than the range's where the cone is narrow.
Ball ball_of_cone(glm::dvec3 apex, glm::dvec3 axis, double range, double half_angle_rad) {
  const double c = std::cos(half_angle_rad);
  if (half_angle_rad < half_pi / 2) return {apex + axis * (range / (2 * c)), range / (2 * c)};
  return {apex + axis * (range * c), range * std::sin(half_angle_rad)};
}

// How far a cone with a spherical cap reaches along a direction at `angle` from its axis.
double cone_reach(double angle_rad, double range, double half_angle_rad) {
  if (angle_rad <= half_angle_rad) return range;
  return std::max(0.0, range * std::cos(angle_rad - half_angle_rad));
}

class Grid {
 public:
  Grid(LightGridKind kind, const shared::FrameConstants& constants, const LightKnobs& knobs, uint32_t tile_px,
       double far_m, double reach_m)
      : frame_(constants), right_(constants.camera_right), up_(constants.camera_up), back_(constants.camera_back) {
    shared::LightGrid& g = g_;
    const bool perspective = constants.perspective != 0;
    g.tiled = kind == LightGridKind::tiles;
    g.tile_px = tile_px;
    g.tiles = (constants.size_px + glm::uvec2(tile_px - 1)) / tile_px;
    g.columns = g.tiled ? (g.tiles + glm::uvec2(shared::column_tiles - 1)) / shared::column_tiles : glm::uvec2(0);
    g.px_scale = glm::vec2(constants.size_px) * 0.5f / constants.tan_half;
    // What 32-bit arithmetic can do to the place of a shaded point: some units in the last place of its distance.
    const double spread = 1 + double(constants.tan_half.x) + double(constants.tan_half.y);
    const double scale = double(std::max(g.px_scale.x, g.px_scale.y));
    g.margin_px = float(1.0 / 16 + 4e-6 * scale * (perspective ? spread : reach_m));
    g.margin_z = float(4e-6 * spread + 1e-5);
    g.slices = 1;
    g.slice_shift = 23;
    if (!g.tiled) set_slices(far_m, knobs.slices_per_octave);
    g.cap = uint32_t(knobs.cap);
    g.sift_over = uint32_t(knobs.sift_over);
  }

  const shared::LightGrid& constants() const { return g_; }
  uint64_t cells() const {
    const uint64_t tiles = uint64_t(g_.tiles.x) * g_.tiles.y;
    return tiles * g_.slices + uint64_t(g_.columns.x) * g_.columns.y;
  }
  uint64_t cells_of(const shared::LightBounds& b, bool column) const {
    const glm::uvec3 n = place(b.last, column) - place(b.first, column) + 1u;
    return uint64_t(n.x) * n.y * n.z;
  }
  bool is_everywhere(const shared::LightBounds& b) const {
    return b.first == glm::uvec3(0) && b.last == glm::uvec3(g_.tiles, g_.slices) - 1u;
  }

  enum class Reach { nothing, some, everything };
  Reach bounds_of(const LightItem& light, shared::LightBounds& b) const {
    if (light.type == LightType::directional || !std::isfinite(light.range_m)) return Reach::everything;
    const glm::dvec3 position = in_view(glm::dvec3(light.position)), direction = in_view(glm::dvec3(light.direction));
    const double range = double(light.range_m) * inflated_range;
    const double half_angle = double(light.outer_cone_rad) + inflated_angle_rad;
    const bool cone = light.type == LightType::spot && half_angle < half_pi;
    b = {};
    b.position = position;
    b.radius = float(range);
    b.direction = direction;
    b.cos_outer = -2;
    const Ball ball{position, range};
    Range z{position.z - range, position.z + range};
    if (cone) {
      b.cos_outer = float(std::cos(half_angle)), b.sin_outer = float(std::sin(half_angle));
      const double angle = std::acos(std::clamp(direction.z, -1.0, 1.0));
      const double margin = 1e-3 * range;
      z = cut(z, {position.z - cone_reach(2 * half_pi - angle, range, half_angle) - margin,
                  position.z + cone_reach(angle, range, half_angle) + margin});
    }
    // The GPU's test has the bounds as floats: outward by their rounding.
    z = {z.low - std::abs(z.low) * 1e-6, z.high + std::abs(z.high) * 1e-6};
    b.z_low = float(z.low), b.z_high = float(z.high);
    Range x = projected(ball.centre.x, ball.centre.z, ball.radius, frame_.perspective != 0);
    Range y = projected(ball.centre.y, ball.centre.z, ball.radius, frame_.perspective != 0);
    if (cone) {
      Ball smaller = ball_of_cone(position, direction, range, half_angle);
      smaller.radius *= 1.0001;
      x = cut(x, projected(smaller.centre.x, smaller.centre.z, smaller.radius, frame_.perspective != 0));
      y = cut(y, projected(smaller.centre.y, smaller.centre.z, smaller.radius, frame_.perspective != 0));
    }
    return find_cells(x, y, z, b.first, b.last) ? Reach::some : Reach::nothing;
  }

  glm::dvec3 in_view(glm::dvec3 v) const { return {glm::dot(v, right_), glm::dot(v, up_), -glm::dot(v, back_)}; }

  // No fewer than the cells of any light of this range that lies in the ball, in view space.
  glm::uvec3 most_cells(const Ball& ball, double range) const {
    range *= inflated_range;
    const bool perspective = frame_.perspective != 0;
    const double reach = (ball.radius + range) * (1 + 1e-6), nearest = ball.centre.z - ball.radius;
    const double slack = 2e-6 * (std::abs(ball.centre.z) + reach);
    glm::uvec3 first, last;
    if (!find_cells(projected(ball.centre.x, ball.centre.z, reach, perspective),
                    projected(ball.centre.y, ball.centre.z, reach, perspective),
                    {ball.centre.z - reach - slack, ball.centre.z + reach + slack}, first, last))
      return glm::uvec3(0);
    glm::uvec3 most = last - first + 1u;
    // The nearest and most sidewards one is the widest, and has the most slices.
    if (perspective && !(nearest > range * 1.25)) return most;
    for (int axis = 0; axis < 2; ++axis) {
      const double aside = std::abs(ball.centre[axis]) + ball.radius;
      const double square = nearest * nearest - range * range;
      const double width = perspective ? 2 * range * std::sqrt(aside * aside + square) / square : 2 * range;
      const double px = width * double(g_.px_scale[axis]) * (1 + 1e-5) + 2 * double(g_.margin_px);
      most[axis] = uint32_t(std::min(double(most[axis]), std::floor(px / g_.tile_px) + 2));
    }
    // Twice the margins of a light's own box: slices are of another width in the middle of an octave.
    const double margin = 2 * (1e-5 + double(g_.margin_z));
    const uint32_t low = slice((nearest - range) * (1 - margin)), high = slice((nearest + range) * (1 + margin));
    if (!g_.tiled && low > 0) most.z = std::min(most.z, high - low + 2);
    return most;
  }
  // The same of columns.
  static glm::uvec3 most_columns(glm::uvec3 cells) {
    const auto columns = [](uint32_t tiles) { return (tiles + shared::column_tiles - 2) / shared::column_tiles + 1; };
    return {columns(cells.x), columns(cells.y), 1};
  }

 private:
  // From what x/z, y/z (or x and y) and depth can be.
  bool find_cells(Range x, Range y, Range z, glm::uvec3& first, glm::uvec3& last) const {
    const glm::dvec2 size(frame_.size_px), scale(g_.px_scale);
    const Range px{size.x / 2 + scale.x * x.low, size.x / 2 + scale.x * x.high};
    const Range py{size.y / 2 - scale.y * y.high, size.y / 2 - scale.y * y.low};
    const bool behind = frame_.perspective != 0 && z.high <= 0;
    if (behind || z.empty() || !tiles_of(px, size.x, g_.tiles.x, first.x, last.x) ||
        !tiles_of(py, size.y, g_.tiles.y, first.y, last.y))
      return false;
    first.z = g_.tiled ? 0 : slice(z.low - std::abs(z.low) * double(g_.margin_z));
    last.z = g_.tiled ? 0 : slice(z.high + std::abs(z.high) * double(g_.margin_z));
    return true;
  }

  static glm::uvec3 place(glm::uvec3 tile, bool column) {
    return column ? glm::uvec3(tile.x / shared::column_tiles, tile.y / shared::column_tiles, 0) : tile;
  }

  // Ten octaves of depth up to the first power of two beyond far_m; what is nearer shares the first slice.
  void set_slices(double far_m, int slices_per_octave) {
    const int per = std::bit_width(unsigned(slices_per_octave)) - 1;
    constexpr int octaves = 10;
    int exponent = 0;
    std::frexp(std::clamp(far_m, 1e-20, 1e30), &exponent);
    const float nearest = std::ldexp(1.0f, exponent - octaves);
    g_.slice_shift = uint32_t(23 - per);
    g_.slice_base = int(std::bit_cast<uint32_t>(nearest) >> g_.slice_shift);
    g_.slices = uint32_t(octaves << per);
  }
  uint32_t slice(double z) const {
    const float depth = float(std::clamp(z, 0.0, 3e38));
    const int s = int(std::bit_cast<uint32_t>(depth) >> g_.slice_shift) - g_.slice_base;
    return uint32_t(std::clamp(s, 0, int(g_.slices) - 1));
  }
  // A point may lie up to a pixel outside the image and still be looked up in the outermost tile.
  bool tiles_of(Range px, double size, uint32_t tiles, uint32_t& first, uint32_t& last) const {
    px = {px.low - double(g_.margin_px), px.high + double(g_.margin_px)};
    if (px.empty() || px.high < -1 || px.low > size + 1) return false;
    const auto tile = [&](double p) {
      return uint32_t(std::clamp(std::floor(p / g_.tile_px), 0.0, double(tiles - 1)));
    };
    first = tile(px.low), last = tile(px.high);
    return true;
  }

  const shared::FrameConstants& frame_;
  glm::dvec3 right_, up_, back_;
  shared::LightGrid g_{};
};

// Every light's box in one grid.
struct Boxes {
  ScratchVector<shared::LightBounds> bounds;
  ScratchVector<uint32_t> everywhere;
  uint64_t covered = 0;
};
Boxes boxes_of(const Grid& grid, const std::vector<LightItem>& lights, std::pmr::memory_resource* memory) {
  ScratchVector<shared::LightBounds> all(lights.size(), memory);
  ScratchVector<Grid::Reach> reach(lights.size(), memory);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, lights.size(), 1024), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      reach[i] = grid.bounds_of(lights[i], all[i]);
      all[i].light = uint32_t(i);
      if (reach[i] == Grid::Reach::some && grid.is_everywhere(all[i])) reach[i] = Grid::Reach::everything;
    }
  });
  Boxes boxes{ScratchVector<shared::LightBounds>(memory), ScratchVector<uint32_t>(memory)};
  boxes.bounds.reserve(lights.size());
  for (size_t i = 0; i < lights.size(); ++i) {
    if (reach[i] == Grid::Reach::everything) boxes.everywhere.push_back(uint32_t(i));
    if (reach[i] != Grid::Reach::some) continue;
    boxes.bounds.push_back(all[i]);
    boxes.covered += grid.cells_of(all[i], false) + (grid.constants().tiled ? grid.cells_of(all[i], true) : 0);
  }
  return boxes;
}

// Lights of which the host knows the clusters alone, in relative space.
class GroupPlaces {
 public:
  explicit GroupPlaces(const LightGroup& group) : group_(group) {
    // A matrix lengthens a vector by no more than the root of the largest eigenvalue of its square, nor than that of
    // the square's largest sum of a row.
    const glm::dmat3 square = glm::transpose(group.linear) * group.linear;
    double largest = 0;
    for (int row = 0; row < 3; ++row) largest = std::max(largest, glm::dot(glm::abs(square[row]), glm::dvec3(1)));
    stretch_ = std::sqrt(largest) * (1 + 1e-6);
  }
  // A ball about lights; the GPU has their places as floats.
  Ball ball(glm::vec3 centre, float radius_m) const {
    const glm::dvec3 at = group_.origin + group_.linear * glm::dvec3(centre);
    const double radius = stretch_ * double(radius_m);
    return {at, radius + 1e-6 * (glm::length(at) + radius)};
  }
  double range(float own_m) const { return double(own_m > 0 ? own_m : group_.light.range_m) * (1 + 1e-6); }

 private:
  const LightGroup& group_;
  double stretch_;
};

// What boxes of lights have at most.
struct MostBoxes {
  uint64_t lights = 0, cells = 0, chunks = 0;
  void add(const Grid& grid, uint64_t count, glm::uvec3 n) {
    if (n.x == 0) return;
    lights += count;
    add_cells(count, n);
    if (grid.constants().tiled) add_cells(count, Grid::most_columns(n));
  }
  MostBoxes operator+(const MostBoxes& o) const { return {lights + o.lights, cells + o.cells, chunks + o.chunks}; }

 private:
  void add_cells(uint64_t count, glm::uvec3 n) {
    const uint64_t each = uint64_t(n.x) * n.y * n.z;
    cells += count * each;
    chunks += count * ((each + shared::light_chunk_cells - 1) / shared::light_chunk_cells);
  }
};

// Of a cluster, and near the camera, where a ball of lights says little of each, of the lights themselves.
MostBoxes most_of(const Grid& grid, const LightGroup& group, const GroupPlaces& places, const LightCluster& cluster) {
  MostBoxes most;
  const Ball ball = places.ball(cluster.centre, cluster.radius_m);
  const glm::uvec3 n = grid.most_cells({grid.in_view(ball.centre), ball.radius}, places.range(cluster.range_m));
  if (n.x == 0 || glm::length(ball.centre) > 3 * ball.radius) {
    most.add(grid, cluster.count, n);
    return most;
  }
  for (const glm::vec4& p : std::span(group.set->places).subspan(cluster.first, cluster.count)) {
    const Ball light = places.ball(glm::vec3(p), 0);
    most.add(grid, 1, grid.most_cells({grid.in_view(light.centre), light.radius}, places.range(p.w)));
  }
  return most;
}

// Of all lights, where the host knows clusters of some.
MostBoxes most_of(const Grid& grid, const FrameData& data) {
  MostBoxes most;
  for (const LightItem& l : data.lights)
    if (l.type != LightType::directional && std::isfinite(l.range_m))
      most.add(grid, 1, grid.most_cells({grid.in_view(glm::dvec3(l.position)), 0}, double(l.range_m)));
  for (const LightGroup& group : data.light_groups) {
    const GroupPlaces places(group);
    const std::vector<LightCluster>& clusters = group.set->clusters;
    most = most + tbb::parallel_reduce(
                      tbb::blocked_range<size_t>(0, clusters.size(), 256), MostBoxes{},
                      [&](const auto& range, MostBoxes sum) {
                        for (size_t i = range.begin(); i < range.end(); ++i)
                          sum = sum + most_of(grid, group, places, clusters[i]);
                        return sum;
                      },
                      std::plus<>());
  }
  return most;
}

// Lights of every cell, by their places in the frame's list.
ScratchVector<uint32_t> unbounded_lights(const FrameData& data, std::pmr::memory_resource* memory) {
  ScratchVector<uint32_t> unbounded(memory);
  size_t group = 0;
  uint32_t first = 0;
  for (uint32_t i = 0; i < data.lights.size(); ++i) {
    for (; group < data.light_groups.size() && data.light_groups[group].before <= i; ++group)
      first += data.light_groups[group].set->count;
    const LightItem& l = data.lights[i];
    if (l.type == LightType::directional || !std::isfinite(l.range_m)) unbounded.push_back(first + i);
  }
  return unbounded;
}

double deepest(const FrameData& data, const shared::FrameConstants& constants) {
  const glm::dvec3 back(constants.camera_back);
  double depth = 0;
  for (const LightItem& l : data.lights)
    if (l.type != LightType::directional && std::isfinite(l.range_m))
      depth = std::max(depth, double(l.range_m) * inflated_range - glm::dot(glm::dvec3(l.position), back));
  for (const LightGroup& group : data.light_groups) {
    const GroupPlaces places(group);
    for (const LightCluster& cluster : group.set->clusters) {
      const Ball ball = places.ball(cluster.centre, cluster.radius_m);
      depth =
          std::max(depth, places.range(cluster.range_m) * inflated_range + ball.radius - glm::dot(ball.centre, back));
    }
  }
  return depth;
}

void add_refusal(LightGridKind kind, size_t lights, const LightKnobs& knobs, double reach_m, bool perspective,
                 std::string& reason) {
  if (kind == LightGridKind::none) {
    reason = "the technique walks every light for every pixel";
    return;
  }
  if (lights == 0) {
    reason = "the scene has no lights";
    return;
  }
  if (lights <= size_t(knobs.few)) {
    fmt::format_to(std::back_inserter(reason), "{} light{}: each pixel walks all (lights.few)", lights,
                   lights == 1 ? "" : "s");
    return;
  }
  if (!perspective && !std::isfinite(reach_m)) {
    reason = "an orthographic view of things without bounds";
    return;
  }
}

// Two words a cell. With more, walking words costs more than sorting entries does, on CPU and GPU (suite light-lists).
constexpr uint64_t most_bitmask_lights = 64;

}  // namespace

shared::LightBounds inflated_bounds(const LightItem& light, const shared::FrameConstants& constants) {
  shared::LightBounds bounds{};
  Grid(LightGridKind::tiles, constants, {}, 16, 1, 1).bounds_of(light, bounds);
  return bounds;
}

void LightGrid::clear() {
  constants = {}, dispatch = {};
  bounds.clear(), chunks.clear(), globals.clear(), note.clear();
  std::string reason = std::move(shape.reason);  // with its memory
  reason.clear();
  shape = {};
  shape.reason = std::move(reason);
}

void make_light_grid(LightGridKind kind, const FrameData& data, const shared::FrameConstants& constants,
                     double farthest_m, double reach_m, const LightKnobs& knobs, LightGrid& out) {
  out.clear();
  const size_t lights = data.light_count();
  out.shape.knobs = knobs;
  add_refusal(kind, lights, knobs, reach_m, constants.perspective != 0, out.shape.reason);
  if (!out.shape.reason.empty()) return;
  const bool on_device = !data.light_groups.empty();
  const double far_m = std::min(farthest_m, deepest(data, constants));
  const uint64_t words = (lights + 31) / 32, budget = uint64_t(knobs.memory_mb) << 20;
  uint32_t tile_px = kind == LightGridKind::tiles ? 16 : uint32_t(knobs.tile_px);
  for (;; tile_px *= 2) {
    const Grid grid(kind, constants, knobs, tile_px, far_m, reach_m);
    Scratch scratch;
    const Boxes boxes = on_device
                            ? Boxes{ScratchVector<shared::LightBounds>(&scratch), unbounded_lights(data, &scratch)}
                            : boxes_of(grid, data.lights, &scratch);
    const MostBoxes most = on_device ? most_of(grid, data) : MostBoxes{};
    const uint64_t covered = on_device ? most.cells : boxes.covered;
    if (covered == 0) {
      out.shape.reason = boxes.everywhere.empty() ? "no light reaches what the camera sees"
                                                  : "every light that reaches the view covers all of it";
      return;
    }
    const uint64_t bitmask = grid.cells() * words * 4, compact = covered * 8;
    const auto asked = LightList(knobs.list);
    bool use_compact = asked == LightList::compact || knobs.cap > 0;
    if (asked == LightList::automatic && knobs.cap == 0)
      use_compact =
          lights > most_bitmask_lights ? compact <= std::max(bitmask, budget) : bitmask > compact && bitmask > budget;
    const uint64_t bytes = use_compact ? compact : bitmask;
    const bool coarsest = grid.constants().tiles == glm::uvec2(1);
    const bool beyond_words =
        covered > 0xf0000000u || most.chunks > 0x80000000u || (!use_compact && grid.cells() * words > 0xf0000000u);
    if ((bytes > budget || beyond_words) && !coarsest && kind == LightGridKind::clusters) continue;
    if (beyond_words) {
      out.shape.reason = "light lists would take more than 16 GiB: each pixel walks all lights";
      out.note = out.shape.reason;
      return;
    }
    if (tile_px != uint32_t(knobs.tile_px) && kind == LightGridKind::clusters)
      fmt::format_to(std::back_inserter(out.note),
                     "light lists take tiles of {} px instead of {} to stay below {} MiB (lights.memory_mb)", tile_px,
                     knobs.tile_px, knobs.memory_mb);
    shared::LightGrid& g = out.constants = grid.constants();
    g.mode = use_compact ? shared::light_mode_compact : shared::light_mode_bitmask;
    g.words = uint32_t(words);
    if (use_compact) {
      out.globals.assign(boxes.everywhere.begin(), boxes.everywhere.end());
    } else if (!boxes.everywhere.empty()) {
      out.globals.assign(words, 0);
      for (const uint32_t light : boxes.everywhere) out.globals[light / 32] |= 1u << (light % 32);
    }
    g.global_count = uint32_t(out.globals.size());
    for (uint32_t column = 0; column <= g.tiled; ++column)
      for (uint32_t b = 0; b < boxes.bounds.size(); ++b)
        for (uint64_t first = 0; first < grid.cells_of(boxes.bounds[b], column != 0);
             first += shared::light_chunk_cells)
          out.chunks.push_back({b, uint32_t(first), column});
    out.bounds.assign(boxes.bounds.begin(), boxes.bounds.end());
    const glm::uvec2 threads = shared::light_threads(out.chunks.size() * shared::light_chunk_cells);
    out.dispatch = {uint32_t(out.chunks.size()), {threads.x / shared::light_group, threads.y, 1}};
    LightGridShape& s = out.shape;
    s.tiled = g.tiled != 0;
    s.compact = use_compact;
    s.segments = use_compact && knobs.cap == 0 && !on_device && knobs.order == int(LightOrder::segments);
    s.tile_px = g.tile_px, s.tiles_x = g.tiles.x, s.tiles_y = g.tiles.y;
    s.cells = uint32_t(grid.cells());
    s.words = (light_room(uint32_t(lights)) + 31) / 32;
    // In powers of two, so that the plan seldom changes from frame to frame.
    s.most_chunks = std::bit_ceil(on_device ? uint32_t(most.chunks) : out.dispatch.chunks);
    s.most_bounds = on_device ? std::bit_ceil(uint32_t(most.lights)) : 0;
    s.most_entries = std::bit_ceil(covered);
    return;
  }
}

}  // namespace candela
