#include "plan/pack_metaballs.h"

#include <algorithm>
#include <bit>

#include "base/check.h"

namespace candela {

void add_metaballs(const FrameData& data, const DrawList& draws, FrameUpload& upload) {
  const uint32_t deformations = uint32_t(data.deformations.size());
  const size_t first_geometry = upload.geometries.size() - deformations;
  for (const PosedMetaballs& body : data.metaballs) {
    if (body.chunks == 0) continue;
    const MetaballLattice& lattice = body.lattice;
    shared::MetaballBody out{};
    out.first_block = uint32_t(upload.metaball_blocks.size()), out.block_count = uint32_t(lattice.blocks.size());
    out.first_ball = uint32_t(upload.metaballs.size()), out.ball_count = uint32_t(body.balls.size());
    out.threshold = float(body.threshold), out.cell_m = float(lattice.cell_m);
    // Reduced in double: the noise repeats after 256 of its cells.
    const glm::dvec3 noise = lattice.origin_m() * body.noise_frequency_per_m;
    out.noise_origin = glm::vec3(noise - 256.0 * glm::floor(noise / 256.0));
    out.noise_frequency = float(lattice.cell_m * body.noise_frequency_per_m);
    out.noise_amplitude = float(body.noise_amplitude);
    const shared::Geometry& first = upload.geometries[first_geometry + body.first_deformation];
    out.positions = first.position;
    out.normals = first.normal == shared::absent ? shared::absent : first.normal - first.position;
    out.chunk_words = 3 * metaball_chunk_triangles * (first.normal == shared::absent ? 3 : 6 + shared::rounded_words);
    out.chunk_count = body.chunks;
    // The chunks are drawn one after another: they are alike but for which they are.
    const auto is_first = [&](uint32_t item) { return data.items[item].deformed == int(body.first_deformation); };
    const auto found = std::ranges::find_if(draws.order, is_first);
    CHECK(found != draws.order.end());
    const uint32_t place = uint32_t(found - draws.order.begin());
    const auto span = std::ranges::find_if(
        draws.spans, [&](const DrawSpan& s) { return s.group < 0 && s.source <= place && place < s.source + s.count; });
    CHECK(span != draws.spans.end());
    out.first_item = span->first + place - span->source;
    for (const PosedBall& posed : body.balls) {
      const LatticeBall ball = lattice_ball(posed, lattice);
      upload.metaballs.push_back({ball.centre, ball.inverse_square_radius, ball.strength});
    }
    const uint32_t lists = uint32_t(upload.metaball_lists.size()), index = uint32_t(upload.metaball_bodies.size());
    for (const MetaballBlock& block : lattice.blocks)
      upload.metaball_blocks.push_back(
          {block.first_cell.x, block.first_cell.y, block.first_cell.z, lists + block.first, block.count, index});
    // In powers of two: insert() alone would take what it needs today, and more tomorrow.
    upload.metaball_lists.reserve(std::bit_ceil(upload.metaball_lists.size() + lattice.ball_lists.size()));
    upload.metaball_lists.insert(upload.metaball_lists.end(), lattice.ball_lists.begin(), lattice.ball_lists.end());
    upload.metaball_bodies.push_back(out);
  }
}

bool same_metaballs(const std::vector<PosedMetaballs>& a, const std::vector<PosedMetaballs>& b) {
  return std::ranges::equal(a, b, [](const PosedMetaballs& x, const PosedMetaballs& y) {
    return x.node == y.node && x.threshold == y.threshold && x.balls == y.balls;
  });
}

void add_metaballs_before(const FrameData& now, const FrameData& before, FrameUpload& upload) {
  CHECK(now.metaballs.size() == before.metaballs.size());
  size_t drawn = 0;
  for (size_t b = 0; b < now.metaballs.size(); ++b) {
    const PosedMetaballs &body = now.metaballs[b], &then = before.metaballs[b];
    if (body.chunks == 0) continue;
    shared::MetaballBody& out = upload.metaball_bodies[drawn++];
    out.before_shift = glm::vec3(body.lattice.origin_m() - then.lattice.origin_m());
    out.before_threshold = float(then.threshold);
    for (size_t i = 0; i < body.balls.size(); ++i) {
      const LatticeBall ball = lattice_ball(then.balls[i], body.lattice);
      upload.metaballs_before.push_back({{ball.centre, ball.inverse_square_radius, ball.strength},
                                         float(1 - then.balls[i].radius_m / body.balls[i].radius_m)});
    }
  }
}

}  // namespace candela
