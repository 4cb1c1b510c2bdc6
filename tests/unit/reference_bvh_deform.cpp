#include "reference_bvh_fixture.h"

namespace candela {
namespace {

using namespace bvh_test;

// A square in the plane z = 0, facing +Z, of two triangles.
MeshSection square() {
  MeshSection s;
  s.position = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  s.normal.assign(4, {0, 0, 1});
  s.tangent.assign(4, {1, 0, 0, 1});
  s.index = {0, 1, 2, 0, 2, 3};
  s.bounds = {{-1, -1, 0}, {1, 1, 0}};
  return s;
}

std::unique_ptr<Made> one(MeshSection section, const Deformation& deformation) {
  auto m = std::make_unique<Made>();
  m->scene.meshes.push_back({"", {std::move(section)}, {}});
  m->place(0);
  m->frame.items[0].deformed = 0;
  m->frame.deformations.push_back(deformation);
  return m;
}

TEST(BvhDeform, MorphedTrianglesAreMetWhereTheyMovedTo) {
  MeshSection s = square();
  s.morph.push_back({std::vector<glm::vec3>(4, {0, 0, -8}), std::vector<glm::vec3>(4, {0, 1, 0}), {}});
  s.morph.push_back({std::vector<glm::vec3>(4, {0, 0, 100}), {}, {}});
  Deformation d;
  d.weight_count = 2;
  const auto m = one(s, d);
  m->frame.morph_weights = {0.5f, 0.0f};
  const Accel accel(m->scene, m->pose, m->frame);
  Ray ray;
  ray.origin = {0.25f, 0.125f, 2};
  const auto hit = accel.closest(ray);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->t, 6.0f);
  EXPECT_FALSE(hit->back);
  EXPECT_EQ(accel.deformed(0).normal[2], glm::vec3(0, 0.5f, 1));
  EXPECT_EQ(accel.surface(*hit).position, glm::vec3(0.25f, 0.125f, -4));
  // A merely morphed section still stands where its item does.
  m->frame.relative_from_local[0][3] = {0, 0, -1, 1};
  const Accel moved(m->scene, m->pose, m->frame);
  EXPECT_EQ(moved.closest(ray)->t, 7.0f);
}

TEST(BvhDeform, SkinnedTrianglesAreMetWhereTheirJointsAre) {
  MeshSection s = square();
  s.joints0.assign(4, {0, 1, 0, 0});
  s.weights0.assign(4, {0.25f, 0.75f, 0, 0});
  Deformation d;
  d.first_joint = 1, d.joint_count = 2;
  const auto m = one(s, d);
  m->frame.joint_matrices.assign(3, glm::mat4(1.0f));
  m->frame.joint_matrices[0][3].z = 1000;  // of another skin
  m->frame.joint_matrices[1][3].z = -4;
  m->frame.joint_matrices[2][3].z = -8;
  // Skinned vertices are in relative space already: the item's own transform must not apply again.
  m->frame.relative_from_local[0][3] = {50, 50, 50, 1};
  const Accel accel(m->scene, m->pose, m->frame);
  Ray ray;
  ray.origin = {0.25f, 0.125f, 0};
  const auto hit = accel.closest(ray);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->t, 7.0f);
  EXPECT_EQ(accel.triangle(0, hit->primitive).position[0].z, -7.0f);
}

TEST(BvhDeform, NormalsStayPerpendicularAndMirrorsTurnTheBitangent) {
  MeshSection s = square();
  s.joints0.assign(4, {0, 0, 0, 0});
  s.weights0.assign(4, {1, 0, 0, 0});
  Deformation d;
  d.joint_count = 1;
  const auto m = one(s, d);
  glm::mat4 joint(1.0f);  // shears z by x, which tilts the square; then mirrors x
  joint[0] = {-1, 0, 2, 0};
  m->frame.joint_matrices = {joint};
  const DeformedVertices v = deform_vertices(m->scene, m->frame, m->frame.deformations[0]);
  const glm::vec3 edge = v.position[1] - v.position[0], other = v.position[3] - v.position[0];
  EXPECT_NEAR(glm::dot(v.normal[0], edge), 0, 1e-6);
  EXPECT_NEAR(glm::dot(v.normal[0], other), 0, 1e-6);
  EXPECT_GT(v.normal[0].z, 0);
  EXPECT_EQ(v.tangent[0], glm::vec4(-1, 0, 2, -1));
}

// The front is where glTF says, also for what mirrors, whether flattened or instanced.
TEST(BvhDeform, MirroredItemsKeepTheirFronts) {
  auto m = std::make_unique<Made>();
  const uint32_t many = m->add_mesh(closed_mesh(12, 6));  // enough triangles to be instanced
  glm::mat4 mirror(1.0f);
  mirror[0][0] = -2;
  m->place(many), m->place(many, mirror);
  const uint32_t single = m->add_mesh(closed_mesh(12, 6));
  m->place(single, mirror);
  EXPECT_EQ(Accel(m->scene, m->pose, m->frame, with_instances()).statistics().instances, 2u);
  for (const size_t repeated : {size_t(0), size_t(1) << 16})
    for (uint32_t item : {0u, 1u, 2u}) {
      struct OneItem final : HitFilter {
        uint32_t item;
        explicit OneItem(uint32_t i) : item(i) {}
        bool accepts(const Hit& hit) const override { return hit.item == item; }
      } const only(item);
      AccelOptions options;
      options.always_ask_filter = true, options.repeated_triangles = repeated;
      const Accel asked(m->scene, m->pose, m->frame, options);
      Ray in;
      in.origin = {0.1f, 5, 0.1f}, in.direction = {0, -1, 0};
      Ray out;
      out.origin = {0, 0, 0}, out.direction = {0.01f, -1, 0.02f};
      ASSERT_TRUE(asked.closest(in, &only) && asked.closest(out, &only));
      const Hit outside = *asked.closest(in, &only);
      EXPECT_FALSE(outside.back) << item;
      EXPECT_TRUE(asked.closest(out, &only)->back) << item;
      EXPECT_GT(asked.surface(outside).geometric_normal.y, 0) << item;
    }
}

// The same surface by way of an instance and as triangles in relative space: the same hits but for rounding.
TEST(BvhDeform, InstancesAreWhereTheirTrianglesWouldBe) {
  const auto mesh = closed_mesh(12, 6);
  for (const glm::vec3 scale :
       {glm::vec3(1), glm::vec3(0.3f, -2, 5), glm::vec3(-1e-4f), glm::vec3(3e4f), glm::vec3(1, 1, 1e-3f)}) {
    glm::mat4 place(1.0f);
    place[0] = {0.6f * scale.x, 0.8f * scale.x, 0, 0}, place[1] = {-0.8f * scale.y, 0.6f * scale.y, 0, 0};
    place[2] = {0, 0, scale.z, 0}, place[3] = {0.5f, -0.25f, 2, 1};
    auto twice = std::make_unique<Made>();
    const uint32_t shared = twice->add_mesh(mesh);
    glm::mat4 away = place;
    away[3].x += 1e6f;
    twice->place(shared, place), twice->place(shared, away);
    auto once = std::make_unique<Made>();
    once->place(once->add_mesh(mesh), place);
    const Accel instanced(twice->scene, twice->pose, twice->frame, with_instances()),
        flat(once->scene, once->pose, once->frame);
    EXPECT_EQ(instanced.statistics().instances, 2u);
    Rng rng(7);
    size_t hits = 0, differ = 0;
    for (int i = 0; i < 1000; ++i) {  // towards the inside from around; near edges the answers may differ
      const glm::vec3 to = glm::vec3(place * glm::vec4(random_in(rng, -0.4, 0.4), 1.0f));
      Ray ray;
      ray.origin = glm::vec3(place * glm::vec4(random_in(rng, -3, 3), 1.0f));
      ray.direction = to - ray.origin;
      const auto a = instanced.closest(ray), b = flat.closest(ray);
      hits += b.has_value();
      // Flattened corners are rounded where they lie; beside a small surface that shows.
      const float rounding = 8e-6f / std::max(glm::length(ray.direction), 1e-4f);
      differ += a.has_value() != b.has_value() ||
                (a && (std::abs(a->t - b->t) > 1e-3f * b->t + rounding || a->back != b->back));
    }
    EXPECT_GT(hits, 950u) << scale.x << " " << scale.y << " " << scale.z;
    EXPECT_LE(differ, 20u) << scale.x << " " << scale.y << " " << scale.z;
  }
}

TEST(BvhDeform, PointsAndLinesAreNotMet) {
  const auto m = made("lines", {{{{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}}}});
  m->scene.meshes[0].sections[0].topology = Topology::lines;
  const Accel accel(m->scene, m->pose, m->frame);
  EXPECT_FALSE(accel.closest(Ray{}));
  EXPECT_EQ(accel.statistics().skipped_items, 1u);
}

}  // namespace
}  // namespace candela
