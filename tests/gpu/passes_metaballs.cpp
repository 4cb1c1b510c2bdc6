#include "passes/geometry/metaballs.h"

#include "passes_fixture.h"
#include "scene/metaballs.h"
#include "shared/metaballs.h"

namespace candela::gpu::test {
namespace {

PosedMetaballs body_of(std::vector<PosedBall> balls, double threshold, double cell_m) {
  PosedMetaballs body;
  body.balls = std::move(balls);
  body.threshold = threshold;
  body.lattice = make_metaball_lattice(body.balls, threshold, cell_m);
  body.chunks = metaball_chunks(body.lattice.most_triangles);
  return body;
}

std::vector<PosedBall> random_balls(uint64_t seed, size_t count) {
  Rng rng(seed);
  std::vector<PosedBall> balls;
  for (size_t i = 0; i < count; ++i)
    balls.push_back({{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)},
                     rng.uniform(0.3, 0.8),
                     i % 4 == 3 ? -0.7 : rng.uniform(0.6, 1.6)});
  return balls;
}

class Metaballs : public PassTest {
 protected:
  struct Made {
    // Of each body, as many as its items say.
    std::vector<std::vector<glm::vec3>> positions, normals, before;
    std::vector<std::vector<glm::vec4>> rounded;  // normals without noise, lifts
  };

  // Bodies one after another in all buffers, as plan/frame_upload.cpp has them; items hold nothing but their counts.
  Made polygons(const std::vector<PosedMetaballs>& bodies, const std::vector<std::vector<PosedBall>>& then = {}) {
    std::vector<shared::MetaballBody> rows;
    std::vector<shared::LatticeBall> balls;
    std::vector<shared::LatticeBallBefore> before;
    std::vector<shared::MetaballBlock> blocks;
    std::vector<uint32_t> lists;
    uint32_t words = 0, items = 0;
    constexpr uint32_t positions = 9 * metaball_chunk_triangles,
                       words_each = 2 * positions + 3 * metaball_chunk_triangles * shared::rounded_words;
    for (size_t b = 0; b < bodies.size(); ++b) {
      const PosedMetaballs& body = bodies[b];
      shared::MetaballBody row{};
      row.first_block = uint32_t(blocks.size()), row.block_count = uint32_t(body.lattice.blocks.size());
      row.first_ball = uint32_t(balls.size()), row.ball_count = uint32_t(body.balls.size());
      row.threshold = float(body.threshold), row.cell_m = float(body.lattice.cell_m);
      row.noise_amplitude = float(body.noise_amplitude), row.noise_frequency = 1;
      row.positions = words, row.normals = positions, row.chunk_words = words_each;
      row.chunk_count = body.chunks, row.first_item = items, row.before_threshold = row.threshold;
      for (const MetaballBlock& block : body.lattice.blocks)
        blocks.push_back({block.first_cell.x, block.first_cell.y, block.first_cell.z,
                          uint32_t(lists.size()) + block.first, block.count, uint32_t(b)});
      lists.insert(lists.end(), body.lattice.ball_lists.begin(), body.lattice.ball_lists.end());
      for (const LatticeBall& ball : lattice_balls(body))
        balls.push_back({ball.centre, ball.inverse_square_radius, ball.strength});
      if (!then.empty()) {
        PosedMetaballs there = body;
        there.balls = then[b];
        for (const LatticeBall& ball : lattice_balls(there))
          before.push_back({{ball.centre, ball.inverse_square_radius, ball.strength}, 0});
      }
      words += body.chunks * words_each, items += body.chunks;
      rows.push_back(row);
    }
    const Buffer row_buffer = upload(rows, "bodies"), ball_buffer = upload(balls, "balls"),
                 block_buffer = upload(blocks, "blocks"), list_buffer = upload(lists, "lists"),
                 item_buffer = upload(std::vector<shared::Item>(items), "items"),
                 before_buffer = upload(before.empty() ? std::vector<shared::LatticeBallBefore>(1) : before, "before");
    GraphBuilder builder;
    SceneInputs scene;
    scene.metaball_bodies = import(builder, row_buffer, "bodies");
    scene.metaballs = import(builder, ball_buffer, "balls");
    scene.metaball_blocks = import(builder, block_buffer, "blocks");
    scene.metaball_lists = import(builder, list_buffer, "lists");
    if (!then.empty()) scene.metaballs_before = import(builder, before_buffer, "before");
    scene.items =
        builder.import_buffer(BufferDesc{"items", items * sizeof(shared::Item)}, GraphBuilder::Import::to_fill);
    imports[scene.items.resource] = &item_buffer;
    scene.deformed_words = words;
    scene.metaball_body_count = uint32_t(rows.size());
    FrameValues values;
    values.metaball_blocks = scene.metaball_block_room = uint32_t(blocks.size());
    scene.values = &values;
    const MetaballPolygons::Out out = add(builder, MetaballPolygons{}, {scene});
    const BufferHandle vertices = read_words(builder, "vertices", out.vertices, uint64_t(words) * 4),
                       counts = read_words(builder, "counts", out.items, items * sizeof(shared::Item));
    BufferHandle earlier;
    if (!then.empty()) earlier = read_words(builder, "earlier", out.before, uint64_t(words) * 4);
    const FrameRun result = run_all(builder);
    const std::vector<float> all = values_of<float>(*result.readbacks.at(vertices.resource));
    const std::vector<shared::Item> drawn = values_of<shared::Item>(*result.readbacks.at(counts.resource));
    std::vector<float> old;
    if (!then.empty()) old = values_of<float>(*result.readbacks.at(earlier.resource));
    Made made;
    for (const shared::MetaballBody& row : rows) {
      std::vector<glm::vec3> p, n, q;
      std::vector<glm::vec4> r;
      for (uint32_t c = 0; c < row.chunk_count; ++c)
        for (uint32_t v = 0; v < drawn[row.first_item + c].index_count; ++v) {
          const size_t at = row.positions + c * row.chunk_words + 3 * v, normal = at + row.normals;
          p.push_back({all[at], all[at + 1], all[at + 2]});
          n.push_back({all[normal], all[normal + 1], all[normal + 2]});
          const size_t lift = row.positions + c * row.chunk_words + 2 * positions + 4 * v;
          r.push_back({all[lift], all[lift + 1], all[lift + 2], all[lift + 3]});
          if (!old.empty()) q.push_back({old[at], old[at + 1], old[at + 2]});
        }
      made.positions.push_back(p), made.normals.push_back(n), made.before.push_back(q);
      made.rounded.push_back(r);
    }
    return made;
  }
};

// The device's triangles are the host's, bit for bit and in its order, of which trees for rays are built.
TEST_F(Metaballs, AreTheHostsBitForBit) {
  const std::vector<PosedMetaballs> bodies = {
      body_of(random_balls(1, 6), 0.2, 0.11), body_of(random_balls(2, 3), 0, 0.15),
      body_of({{{0, 0, 0}, 4, 1}}, 27.0 / 64, 1), body_of({{{0, 0, 0}, 1, 1}}, 0.3, 0.05)};
  const Made made = polygons(bodies);
  for (size_t b = 0; b < bodies.size(); ++b) {
    const std::vector<glm::vec3> expected = polygonise(bodies[b]);
    ASSERT_FALSE(expected.empty());
    ASSERT_EQ(made.positions[b].size(), expected.size()) << b;
    EXPECT_EQ(std::memcmp(made.positions[b].data(), expected.data(), expected.size() * sizeof(glm::vec3)), 0) << b;
  }
  EXPECT_GT(made.positions[3].size(), 3 * size_t(metaball_chunk_triangles));  // more than one item
}

TEST_F(Metaballs, NormalsAreTheFieldsSlope) {
  const PosedMetaballs body = body_of(random_balls(3, 6), 0.2, 0.1);
  const Made made = polygons({body});
  for (size_t v = 0; v < made.positions[0].size(); v += 7) {
    const glm::dvec3 p = glm::dvec3(made.positions[0][v]) + body.lattice.origin_m();
    glm::dvec3 falling(0);
    for (const PosedBall& ball : body.balls) {
      const glm::dvec3 d = (p - ball.centre) / ball.radius_m;
      const double u = std::max(1 - glm::dot(d, d), 0.0);
      falling += ball.strength * u * u / ball.radius_m * d;
    }
    EXPECT_LT(glm::length(glm::normalize(falling) - glm::dvec3(made.normals[0][v])), 2e-4);
  }
}

TEST_F(Metaballs, NoiseTurnsNormalsByABoundedAngle) {
  PosedMetaballs body = body_of(random_balls(4, 4), 0.2, 0.1);
  const Made plain = polygons({body});
  body.noise_amplitude = 0.99;
  const Made turned = polygons({body});
  double most = 0;
  for (size_t v = 0; v < plain.normals[0].size(); ++v) {
    EXPECT_NEAR(glm::length(turned.normals[0][v]), 1, 1e-5);
    most = std::max(most, std::acos(std::min(double(glm::dot(plain.normals[0][v], turned.normals[0][v])), 1.0)));
  }
  EXPECT_LT(most, 0.7854);
  EXPECT_GT(most, 0.2);
}

// What shadows are asked of: normals without noise, and points that the lift brings above the surface, but not far.
TEST_F(Metaballs, LiftedPointsAreAboveTheSurface) {
  PosedMetaballs body = body_of(random_balls(7, 6), 0.2, 0.1);
  const Made plain = polygons({body});
  body.noise_amplitude = 0.5;
  const Made turned = polygons({body});
  size_t within = 0, triangles = 0;
  for (size_t v = 0; v < plain.positions[0].size(); v += 3, ++triangles) {
    const float lift = turned.rounded[0][v].w;
    glm::vec3 middle(0), normal(0);
    for (size_t k = v; k < v + 3; ++k) {
      ASSERT_EQ(glm::vec3(turned.rounded[0][k]), plain.normals[0][k]);
      ASSERT_EQ(turned.rounded[0][k].w, lift);
      middle += plain.positions[0][k] / 3.0f, normal += plain.normals[0][k] / 3.0f;
    }
    ASSERT_GT(lift, 0);
    ASSERT_LT(lift, 0.1 * std::sqrt(3.0) * 2 / 6);  // no turn is larger than of opposite normals
    const glm::dvec3 p = glm::dvec3(middle + lift * glm::normalize(normal)) + body.lattice.origin_m();
    double field = -body.threshold;
    for (const PosedBall& ball : body.balls) {
      const glm::dvec3 d = (p - ball.centre) / ball.radius_m;
      const double u = std::max(1 - glm::dot(d, d), 0.0);
      field += ball.strength * u * u * u;
    }
    within += field > 0;
  }
  EXPECT_GT(triangles, 1000u);
  EXPECT_LT(within, triangles / 100) << triangles;
}

// A body that has moved as a whole: every vertex was where it is now, less the way.
TEST_F(Metaballs, PlacesBeforeAreTheirs) {
  const PosedMetaballs body = body_of(random_balls(5, 5), 0.2, 0.1);
  std::vector<PosedBall> then = body.balls;
  for (PosedBall& ball : then) ball.centre += glm::dvec3(0.25, -0.5, 0.125);
  const Made made = polygons({body}, {then}), still = polygons({body}, {body.balls});
  for (size_t v = 0; v < made.positions[0].size(); ++v) {
    EXPECT_LT(glm::length(made.before[0][v] - made.positions[0][v] - glm::vec3(0.25, -0.5, 0.125)), 2e-5f);
    ASSERT_EQ(still.before[0][v], still.positions[0][v]);
  }
}

}  // namespace
}  // namespace candela::gpu::test
