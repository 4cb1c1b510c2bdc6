#include "gltf/vertex_remap.h"

namespace candela {
namespace {
template <class T>
void remap(std::vector<T>& values, std::span<const uint32_t> source) {
  if (values.empty()) return;
  std::vector<T> result(source.size());
  for (size_t i = 0; i < source.size(); ++i) result[i] = values[source[i]];
  values = std::move(result);
}
}  // namespace

void remap_vertices(MeshSection& section, std::span<const uint32_t> source) {
  remap(section.position, source);
  remap(section.normal, source);
  remap(section.tangent, source);
  remap(section.uv0, source);
  remap(section.uv1, source);
  remap(section.color, source);
  remap(section.joints0, source);
  remap(section.joints1, source);
  remap(section.weights0, source);
  remap(section.weights1, source);
  for (MorphTarget& target : section.morph) {
    remap(target.position, source);
    remap(target.normal, source);
    remap(target.tangent, source);
  }
  section.deformation_bounds.reset();
}
}  // namespace candela
