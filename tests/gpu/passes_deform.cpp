#include "passes/geometry/deform.h"
#include "passes_fixture.h"
#include "shared/deform.h"
#include "shared/scene.h"

namespace candela::gpu::test {
namespace {

// One section's vertices in the layout of shared::DeformJob, with its values in double beside it.
struct Section {
  uint32_t vertices = 0;
  std::vector<glm::vec3> position, normal;
  std::vector<glm::vec4> tangent;
  std::vector<std::array<glm::u16vec4, 2>> joints;
  std::vector<std::array<glm::vec4, 2>> weights;
  struct Target {
    std::vector<glm::vec3> position, normal, tangent;
  };
  std::vector<Target> targets;
  std::vector<float> target_weights;
  std::vector<glm::mat4> joint_matrices;
  int sets = 0;  // of four influences
};

glm::vec3 random_vector(Rng& rng) { return {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)}; }

Section make_section(uint32_t vertices, int sets, int targets, bool tangents, uint64_t seed) {
  Rng rng(seed);
  Section s;
  s.vertices = vertices;
  s.sets = sets;
  const uint32_t joints = 20;
  for (uint32_t j = 0; j < joints && sets > 0; ++j) {  // rotations, shears, mirrors and non-uniform scales
    glm::mat4 m(1.0f);
    for (int c = 0; c < 4; ++c) m[c] = glm::vec4(random_vector(rng) * (c == 3 ? 5.0f : 1.5f), c == 3 ? 1 : 0);
    s.joint_matrices.push_back(m);
  }
  for (uint32_t v = 0; v < vertices; ++v) {
    s.position.push_back(random_vector(rng) * 3.0f);
    s.normal.push_back(glm::normalize(random_vector(rng)));
    if (tangents) s.tangent.push_back(glm::vec4(glm::normalize(random_vector(rng)), v % 2 ? 1 : -1));
    std::array<glm::u16vec4, 2> j{};
    std::array<glm::vec4, 2> w{};
    float sum = 0;
    for (int i = 0; i < 4 * sets; ++i) {
      j[size_t(i / 4)][i % 4] = uint16_t(rng.next() % joints);
      sum += w[size_t(i / 4)][i % 4] = v % 3 == 0 && i % 4 == 2 ? 0.0f : float(rng.uniform());
    }
    for (glm::vec4& set : w) set /= std::max(sum, 1e-6f);
    s.joints.push_back(j);
    s.weights.push_back(w);
  }
  for (int t = 0; t < targets; ++t) {
    Section::Target target;
    for (uint32_t v = 0; v < vertices; ++v) {
      target.position.push_back(random_vector(rng));
      if (t != 1) target.normal.push_back(random_vector(rng) * 0.5f);  // a target may lack attributes
      if (tangents && t != 2) target.tangent.push_back(random_vector(rng) * 0.5f);
    }
    s.targets.push_back(target);
    s.target_weights.push_back(t == 3 ? 0.0f : float(rng.uniform(-0.5, 1.5)));
  }
  return s;
}

// A sum in double with the sum of its terms' absolute values, which bounds the rounding of any 32-bit evaluation.
struct Tracked {
  glm::dvec3 value{0}, scale{0};
  void add(double weight, glm::dvec3 v) { value += weight * v, scale += std::abs(weight) * glm::abs(v); }
};

struct Expectation {
  Tracked position, normal, tangent;
  float handedness = 1;  // -1 where the joints mirror: the bitangent turns over
};

Expectation expected_vertex(const Section& s, uint32_t v) {
  Tracked p, n, t;
  p.add(1, s.position[v]);
  n.add(1, s.normal[v]);
  if (!s.tangent.empty()) t.add(1, glm::vec3(s.tangent[v]));
  for (size_t k = 0; k < s.targets.size(); ++k) {
    const double w = s.target_weights[k];
    p.add(w, s.targets[k].position[v]);
    if (!s.targets[k].normal.empty()) n.add(w, s.targets[k].normal[v]);
    if (!s.targets[k].tangent.empty()) t.add(w, s.targets[k].tangent[v]);
  }
  if (s.joint_matrices.empty()) return {p, n, t};
  glm::dmat4 m(0.0), m_scale(0.0);
  for (int i = 0; i < 4 * s.sets; ++i) {
    const double w = s.weights[v][size_t(i / 4)][i % 4];
    const glm::dmat4 joint(s.joint_matrices[s.joints[v][size_t(i / 4)][i % 4]]);
    m += w * joint;
    for (int c = 0; c < 4; ++c) m_scale[c] += w * glm::abs(joint[c]);
  }
  Expectation out;
  for (int c = 0; c < 3; ++c) {
    out.position.value += glm::dvec3(m[c]) * p.value[c];
    out.position.scale += glm::dvec3(m_scale[c]) * p.scale[c];
    out.tangent.value += glm::dvec3(m[c]) * t.value[c];
    out.tangent.scale += glm::dvec3(m_scale[c]) * t.scale[c];
  }
  out.position.value += glm::dvec3(m[3]);
  out.position.scale += glm::dvec3(m_scale[3]);
  // Normals by the inverse transpose, scaled by the determinant's magnitude.
  const glm::dmat3 a(m);
  out.handedness = glm::determinant(a) < 0 ? -1 : 1;
  out.normal.value = std::abs(glm::determinant(a)) * glm::transpose(glm::inverse(a)) * n.value;
  for (int c = 0; c < 3; ++c) {  // each cofactor is a difference of products: its scale is the sum of their magnitudes
    const glm::dvec3 u(m_scale[(c + 1) % 3]), w(m_scale[(c + 2) % 3]);
    out.normal.scale += n.scale[c] * glm::dvec3(u.y * w.z + u.z * w.y, u.z * w.x + u.x * w.z, u.x * w.y + u.y * w.x);
  }
  return out;
}

}  // namespace

class Deforming : public PassTest {
 protected:
  struct Packed {
    std::vector<uint32_t> words;
    std::vector<shared::DeformJob> jobs;
    std::vector<glm::mat4> joints;
    std::vector<float> weights;
    uint32_t deformed_words = 0;
  };

  static uint32_t put(std::vector<uint32_t>& words, const void* data, size_t bytes) {
    const uint32_t at = uint32_t(words.size());
    words.resize(words.size() + bytes / 4);
    std::memcpy(words.data() + at, data, bytes);
    return at;
  }
  template <class T>
  static uint32_t put(std::vector<uint32_t>& words, const std::vector<T>& values) {
    return values.empty() ? shared::absent : put(words, values.data(), values.size() * sizeof(T));
  }

  static void pack(const Section& s, Packed& out) {
    shared::DeformJob job{};
    job.vertex_count = s.vertices;
    job.position = put(out.words, s.position);
    job.normal = put(out.words, s.normal);
    job.tangent = put(out.words, s.tangent);
    uint32_t* const joints_at[] = {&job.joints0, &job.joints1};
    uint32_t* const weights_at[] = {&job.weights0, &job.weights1};
    for (int set = 0; set < 2; ++set) {
      *joints_at[set] = *weights_at[set] = shared::absent;
      if (set >= s.sets) continue;
      std::vector<glm::u16vec4> joints;
      std::vector<glm::vec4> weights;
      for (uint32_t v = 0; v < s.vertices; ++v)
        joints.push_back(s.joints[v][size_t(set)]), weights.push_back(s.weights[v][size_t(set)]);
      *joints_at[set] = put(out.words, joints);
      *weights_at[set] = put(out.words, weights);
    }
    std::vector<uint32_t> table;
    for (const Section::Target& t : s.targets)
      for (const auto* deltas : {&t.position, &t.normal, &t.tangent}) table.push_back(put(out.words, *deltas));
    job.morph_table = put(out.words, table);
    job.morph_count = uint32_t(s.targets.size());
    job.first_joint = uint32_t(out.joints.size());
    job.joint_count = uint32_t(s.joint_matrices.size());
    job.first_weight = uint32_t(out.weights.size());
    out.joints.insert(out.joints.end(), s.joint_matrices.begin(), s.joint_matrices.end());
    out.weights.insert(out.weights.end(), s.target_weights.begin(), s.target_weights.end());
    const auto take = [&](bool present, uint32_t words_each) {
      const uint32_t at = out.deformed_words;
      out.deformed_words += present ? s.vertices * words_each : 0;
      return present ? at : shared::absent;
    };
    job.out_position = take(true, 3);
    job.out_normal = take(true, 3);
    job.out_tangent = take(!s.tangent.empty(), 4);
    out.jobs.push_back(job);
  }

  std::vector<float> deform(const Packed& packed) {
    const Buffer words = upload(packed.words, "vertices"), jobs = upload(packed.jobs, "jobs"),
                 joints = upload(packed.joints, "joints"), weights = upload(packed.weights, "weights");
    shared::FrameConstants frame{};
    frame.vertices = words.address();
    const Buffer constants = upload(std::vector{frame}, "constants");
    GraphBuilder builder;
    SceneInputs scene;
    scene.constants = import(builder, constants, "constants");
    scene.vertices = import(builder, words, "vertices");
    scene.deform_jobs = import(builder, jobs, "jobs");
    if (!packed.joints.empty()) scene.joints = import(builder, joints, "joints");
    if (!packed.weights.empty()) scene.weights = import(builder, weights, "weights");
    for (const shared::DeformJob& job : packed.jobs) scene.deform_vertices.push_back(job.vertex_count);
    scene.deformed_words = packed.deformed_words;
    const BufferHandle deformed = add(builder, Deform{}, {scene}).deformed;
    const BufferHandle target = read_words(builder, "deformed", deformed, uint64_t(packed.deformed_words) * 4);
    const FrameRun result = run_all(builder);
    return values_of<float>(*result.readbacks.at(target.resource));
  }

  // Each rounding of 32-bit arithmetic moves a result by at most 2^-24 of the sum of its terms' magnitudes: about 30 in
  // a row for positions and tangents (morphs, eight influences, the product), twice that for the cofactors of normals.
  void expect_deformed(const std::vector<Section>& sections) {
    Packed packed;
    for (const Section& s : sections) pack(s, packed);
    const std::vector<float> out = deform(packed);
    ASSERT_EQ(out.size(), packed.deformed_words);
    for (size_t k = 0; k < sections.size(); ++k) {
      const shared::DeformJob& job = packed.jobs[k];
      for (uint32_t v = 0; v < job.vertex_count; ++v) {
        const Expectation e = expected_vertex(sections[k], v);
        for (uint32_t c = 0; c < 3; ++c) {
          EXPECT_NEAR(out[job.out_position + 3 * v + c], e.position.value[int(c)],
                      32 * 0x1p-24 * e.position.scale[int(c)]);
          EXPECT_NEAR(out[job.out_normal + 3 * v + c], e.normal.value[int(c)], 64 * 0x1p-24 * e.normal.scale[int(c)]);
          if (job.tangent == shared::absent) continue;
          EXPECT_NEAR(out[job.out_tangent + 4 * v + c], e.tangent.value[int(c)],
                      32 * 0x1p-24 * e.tangent.scale[int(c)]);
          EXPECT_EQ(out[job.out_tangent + 4 * v + 3], e.handedness * sections[k].tangent[v].w);
        }
        if (HasFailure()) return;
      }
    }
  }
};

TEST_F(Deforming, SkinsWithFourInfluences) { expect_deformed({make_section(200, 1, 0, true, 1)}); }
TEST_F(Deforming, SkinsWithEightInfluences) { expect_deformed({make_section(200, 2, 0, false, 2)}); }
TEST_F(Deforming, MorphsPositionsNormalsAndTangents) { expect_deformed({make_section(130, 0, 5, true, 3)}); }
TEST_F(Deforming, MorphsBeforeItSkins) { expect_deformed({make_section(65, 2, 4, true, 4)}); }
TEST_F(Deforming, SectionsDoNotMix) {
  expect_deformed({make_section(1, 1, 2, false, 5), make_section(64, 0, 3, true, 6), make_section(63, 2, 0, false, 7),
                   make_section(129, 1, 1, true, 8)});
}

}  // namespace candela::gpu::test
