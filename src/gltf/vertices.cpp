#include "gltf/vertices.h"

namespace candela::gltf {
namespace {

// Sums of the triangles' area vectors at every vertex.
std::vector<glm::vec3> area_normals(const MeshSection& section) {
  std::vector<glm::vec3> sums(section.position.size(), glm::vec3(0));
  if (section.topology != Topology::triangles) return sums;
  for (size_t i = 0; i + 2 < section.index.size(); i += 3) {
    const uint32_t a = section.index[i], b = section.index[i + 1], c = section.index[i + 2];
    const glm::vec3 area =
        glm::cross(section.position[b] - section.position[a], section.position[c] - section.position[a]);
    for (const uint32_t v : {a, b, c}) sums[v] += area;
  }
  return sums;
}

constexpr float unit_tolerance = 5e-4f;  // for floats; quantized vectors are off by their rounding

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(glm::dvec3(v));
  return length > 1e-30 ? glm::vec3(glm::dvec3(v) / length) : otherwise;
}

}  // namespace

void repair_normals(Document& document, MeshSection& section, bool stored_as_float) {
  size_t wrong = 0, zero = 0;
  std::vector<glm::vec3> geometric;
  for (size_t i = 0; i < section.normal.size(); ++i) {
    glm::vec3& n = section.normal[i];
    const float length = glm::length(n);
    if (std::abs(length - 1.f) > unit_tolerance) ++wrong;
    if (length < 1e-6f) {
      if (zero++ == 0) geometric = area_normals(section);
      n = unit_or(geometric[i], glm::vec3(0, 0, 1));
    } else {
      n = unit_or(n, n);
    }
  }
  if (wrong > 0 && (stored_as_float || zero > 0))
    document.warn(section.place + "/attributes/NORMAL",
                  "{} normals were not of unit length and are made so (ACCESSOR_VECTOR3_NON_UNIT)", wrong);
}

void repair_tangents(Document& document, MeshSection& section, bool stored_as_float) {
  size_t wrong = 0, signs = 0;
  for (size_t i = 0; i < section.tangent.size(); ++i) {
    glm::vec4& t = section.tangent[i];
    const glm::vec3 n = section.normal[i];
    const glm::vec3 side =
        glm::normalize(std::abs(n.x) < 0.9f ? glm::cross(n, glm::vec3(1, 0, 0)) : glm::cross(n, glm::vec3(0, 1, 0)));
    if (std::abs(glm::length(glm::vec3(t)) - 1.f) > unit_tolerance) ++wrong;
    if (std::abs(t.w) != 1.f) ++signs;
    t = glm::vec4(unit_or(glm::vec3(t), side), t.w < 0 ? -1.f : 1.f);
  }
  const std::string path = section.place + "/attributes/TANGENT";
  if (wrong > 0 && stored_as_float)
    document.warn(path, "{} tangents were not of unit length and are made so (ACCESSOR_VECTOR3_NON_UNIT)", wrong);
  if (signs > 0 && stored_as_float)
    document.warn(path, "{} tangents have a sign that is not 1 or -1 (ACCESSOR_INVALID_SIGN)", signs);
}

void report_wrong_bounds(Document& document, const MeshSection& section, const tinygltf::Accessor& accessor,
                         const std::string& path) {
  Aabb bounds;
  for (const glm::vec3& p : section.position) bounds.add(p);
  const auto differs = [](const std::vector<double>& stated, const glm::vec3& real) {
    return stated.size() == 3 &&
           (float(stated[0]) != real.x || float(stated[1]) != real.y || float(stated[2]) != real.z);
  };
  if (differs(accessor.minValues, bounds.min))
    document.warn(path + "/min", "min is not the least of the values; the values count (ACCESSOR_MIN_MISMATCH)");
  if (differs(accessor.maxValues, bounds.max))
    document.warn(path + "/max", "max is not the greatest of the values; the values count (ACCESSOR_MAX_MISMATCH)");
}

void repair_weights(Document& document, MeshSection& section) {
  size_t off = 0, zero = 0;
  const bool second = !section.weights1.empty();
  for (size_t i = 0; i < section.weights0.size(); ++i) {
    glm::vec4 none(0);
    glm::u16vec4 no_joints(0);
    glm::vec4& a = section.weights0[i];
    glm::vec4& b = second ? section.weights1[i] : none;
    a = glm::max(a, glm::vec4(0));
    b = glm::max(b, glm::vec4(0));
    const float sum = a.x + a.y + a.z + a.w + b.x + b.y + b.z + b.w;
    if (std::abs(sum - 1.f) > 0.02f) ++off;
    if (sum > 0) {
      a /= sum;
      b /= sum;
    } else {
      a = glm::vec4(1, 0, 0, 0);
      ++zero;
    }
    glm::u16vec4& ja = section.joints0[i];
    glm::u16vec4& jb = second ? section.joints1[i] : no_joints;
    for (int c = 0; c < 4; ++c) {
      if (a[c] == 0) ja[c] = 0;
      if (b[c] == 0) jb[c] = 0;
    }
  }
  if (off > 0)
    document.warn(section.place + "/attributes/WEIGHTS_0",
                  "the weights of {} vertices do not sum to 1 and are scaled; {} have none and "
                  "follow their first joint (ACCESSOR_WEIGHTS_NON_NORMALIZED)",
                  off, zero);
}

}  // namespace candela::gltf
