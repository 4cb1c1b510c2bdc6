#include "scene/geometry_layout.h"

#include <cstring>

#include "scene/draw_list.h"
#include "scene/scene_size.h"
#include "scene/texture_slots.h"

namespace candela {
namespace {

bool uses_uv_set(const Material& m, bool unlit, int set) {
  const auto slot = [&](const TextureSlot& t) { return t && t.uv_set == set; };
  if (unlit) return slot(m.base_color_texture) || slot(m.relief.texture);
  bool any = false;
  for_each_slot(m, [&](const TextureSlot& t, bool) { any |= slot(t); });
  return any;
}

class Cursor {
 public:
  uint32_t take(size_t vertices, uint64_t words_each) {
    if (vertices == 0) return SectionLayout::absent;
    const uint64_t at = words_;
    words_ += uint64_t(vertices) * words_each;
    return uint32_t(at);
  }
  uint64_t words() const { return words_; }

 private:
  uint64_t words_ = 0;
};

void layout_section(const MeshSection& s, const Material* material, Cursor& cursor, SectionLayout& l) {
  const bool unlit = is_unlit(s, material);
  const auto when = [](bool wanted, const auto& array) { return wanted ? array.size() : 0; };
  l.position = cursor.take(s.position.size(), 3);
  l.normal = cursor.take(when(!unlit, s.normal), 3);
  l.tangent = cursor.take(when(!unlit && material && material->wants_tangents(), s.tangent), 4);
  // Where a relief ends stands before the texture coordinates of its heights.
  const auto relief_words = [&](int set, const auto& uvs) {
    return material && material->relief.texture && material->relief.texture.uv_set == set && !uvs.empty() ? 4 : 0;
  };
  cursor.take(size_t(relief_words(0, s.uv0)), 1);
  l.uv0 = cursor.take(when(material && uses_uv_set(*material, unlit, 0), s.uv0), 2);
  cursor.take(size_t(relief_words(1, s.uv1)), 1);
  l.uv1 = cursor.take(when(material && uses_uv_set(*material, unlit, 1), s.uv1), 2);
  l.color = cursor.take(s.color.size(), 4);
  l.joints0 = cursor.take(s.joints0.size(), 2);
  l.weights0 = cursor.take(s.weights0.size(), 4);
  l.joints1 = cursor.take(s.joints1.size(), 2);
  l.weights1 = cursor.take(s.weights1.size(), 4);
  // The table of offsets, then the deltas in its order.
  l.morph_table = cursor.take(s.morph.size(), 3);
  for (const MorphTarget& t : s.morph) {
    cursor.take(t.position.size(), 3);
    cursor.take(when(l.normal != SectionLayout::absent, t.normal), 3);
    cursor.take(when(l.tangent != SectionLayout::absent, t.tangent), 3);
  }
}

template <class T>
void copy_words(std::span<uint32_t> words, uint32_t at, const std::vector<T>& values) {
  if (at != SectionLayout::absent) std::memcpy(words.data() + at, values.data(), values.size() * sizeof(T));
}

void pack_relief_bounds(std::span<uint32_t> words, uint32_t uv_at, const std::vector<glm::vec2>& uvs) {
  const UvBounds bounds = uv_bounds(uvs);
  std::memcpy(words.data() + uv_at - 4, &bounds, sizeof bounds);
}

void pack_morphs(const MeshSection& s, const SectionLayout& l, std::span<uint32_t> words) {
  if (l.morph_table == SectionLayout::absent) return;
  uint32_t at = l.morph_table + uint32_t(3 * s.morph.size());
  for (size_t m = 0; m < s.morph.size(); ++m) {
    uint32_t* row = words.data() + l.morph_table + 3 * m;
    const auto put = [&](bool wanted, const std::vector<glm::vec3>& deltas) {
      if (!wanted || deltas.empty()) return SectionLayout::absent;
      const uint32_t here = at;
      copy_words(words, here, deltas);
      at += uint32_t(3 * deltas.size());
      return here;
    };
    row[0] = put(true, s.morph[m].position);
    row[1] = put(l.normal != SectionLayout::absent, s.morph[m].normal);
    row[2] = put(l.tangent != SectionLayout::absent, s.morph[m].tangent);
  }
}

}  // namespace

UvBounds uv_bounds(const std::vector<glm::vec2>& uvs) {
  if (uvs.empty()) return {};
  UvBounds bounds{uvs[0], uvs[0]};
  for (const glm::vec2& uv : uvs) bounds.least = glm::min(bounds.least, uv), bounds.most = glm::max(bounds.most, uv);
  return bounds;
}

Expected<GeometryLayout> layout_geometry(const Scene& scene) {
  GeometryLayout layout;
  layout.sections.resize(scene.meshes.size());
  constexpr uint64_t most = 0x7fffffff;  // SPIR-V takes array indices as signed
  Cursor cursor;
  for (const int n : scene.order) {
    const int mesh = scene.nodes[size_t(n)].mesh;
    if (mesh < 0 || !layout.sections[size_t(mesh)].empty()) continue;
    for (const MeshSection& section : scene.meshes[size_t(mesh)].sections) {
      SectionLayout l;
      l.used = true;
      l.geometry = layout.geometry_count++;
      layout_section(section, section.material >= 0 ? &scene.materials[size_t(section.material)] : nullptr, cursor, l);
      l.first_index = uint32_t(layout.index_count);
      l.index_count = uint32_t(section.index.size());
      layout.index_count += section.index.size();
      layout.sections[size_t(mesh)].push_back(l);
      if (cursor.words() > most || layout.index_count > most)
        return fail(ErrorKind::input, scene.path, "the scene's vertices do not fit into 8 GiB: split it");
    }
  }
  // Scenes of metaballs alone have no vertices of their own, but a frame that draws has the buffer.
  constexpr uint64_t least_words = 4;
  layout.vertex_words = layout.geometry_count > 0 ? std::max(cursor.words(), least_words) : cursor.words();
  layout.size_m = scene_size_m(scene);
  layout.least_light_distance_m = least_light_distance_m(scene);
  return layout;
}

void pack_geometry(const Scene& scene, const GeometryLayout& layout, std::span<uint32_t> words,
                   std::span<uint32_t> indices) {
  for (size_t m = 0; m < layout.sections.size(); ++m) {
    for (size_t i = 0; i < layout.sections[m].size(); ++i) {
      const MeshSection& s = scene.meshes[m].sections[i];
      const SectionLayout& l = layout.sections[m][i];
      copy_words(words, l.position, s.position);
      copy_words(words, l.normal, s.normal);
      copy_words(words, l.tangent, s.tangent);
      copy_words(words, l.uv0, s.uv0);
      copy_words(words, l.uv1, s.uv1);
      copy_words(words, l.color, s.color);
      copy_words(words, l.joints0, s.joints0);
      copy_words(words, l.weights0, s.weights0);
      copy_words(words, l.joints1, s.joints1);
      copy_words(words, l.weights1, s.weights1);
      pack_morphs(s, l, words);
      const Material* material = s.material >= 0 ? &scene.materials[size_t(s.material)] : nullptr;
      if (material && material->relief.texture) {
        const bool second = material->relief.texture.uv_set == 1;
        const uint32_t at = second ? l.uv1 : l.uv0;
        if (at != SectionLayout::absent) pack_relief_bounds(words, at, second ? s.uv1 : s.uv0);
      }
      std::copy(s.index.begin(), s.index.end(), indices.begin() + l.first_index);
    }
  }
}

}  // namespace candela
