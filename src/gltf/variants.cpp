#include "gltf/variants.h"

#include <fmt/ranges.h>
#include <algorithm>

namespace candela::gltf {
namespace {
constexpr const char* name_of_extension = "KHR_materials_variants";
}

void choose_variant(const Document& document, const std::string& wanted, Scene& scene) {
  if (const Json* all = extension(document.json, name_of_extension)) {
    const std::string path = fmt::format("/extensions/{}/variants", name_of_extension);
    const Json* list = member(*all, "variants");
    if (!list || !list->is_array()) document.refuse(path, "there is no array of variants (TYPE_MISMATCH)");
    for (size_t i = 0; i < list->size(); ++i) {
      const std::string at = fmt::format("{}/{}", path, i);
      if (!(*list)[i].is_object()) document.refuse(at, "is not an object (TYPE_MISMATCH)");
      scene.variants.push_back(text(document, (*list)[i], "name", "", at));
    }
  }
  if (wanted.empty()) return;
  const auto found = std::ranges::find(scene.variants, wanted);
  if (found == scene.variants.end())
    throw Failure{Error{ErrorKind::usage,
                        scene.variants.empty() ? fmt::format("'{}': the file has no variants of materials", wanted)
                                               : fmt::format("'{}' is none of the file's variants: {}", wanted,
                                                             fmt::join(scene.variants, ", ")),
                        "--variant"}};
  scene.variant = int(found - scene.variants.begin());
}

int material_in_variant(const Document& document, const Json& primitive, const std::string& path, const Scene& scene,
                        int otherwise) {
  const Json* const use = extension(primitive, name_of_extension);
  if (!use) return otherwise;
  const std::string where = fmt::format("{}/extensions/{}/mappings", path, name_of_extension);
  const Json* const mappings = member(*use, "mappings");
  if (!mappings || !mappings->is_array()) document.refuse(where, "there is no array of mappings (TYPE_MISMATCH)");
  int chosen = otherwise;
  for (size_t i = 0; i < mappings->size(); ++i) {
    const Json& mapping = (*mappings)[i];
    const std::string at = fmt::format("{}/{}", where, i);
    if (!mapping.is_object()) document.refuse(at, "is not an object (TYPE_MISMATCH)");
    const int material = index_of(document, mapping, "material", scene.materials.size(), at);
    const Json* const variants = member(mapping, "variants");
    if (material < 0 || !variants || !variants->is_array())
      document.refuse(at, "names no material or no variants (UNDEFINED_PROPERTY)");
    for (const Json& variant : *variants) {
      if (!variant.is_number_unsigned() || variant.get<uint64_t>() >= scene.variants.size())
        document.refuse(at + "/variants", "{} is no variant of the file (UNRESOLVED_REFERENCE)", variant.dump());
      if (int(variant.get<uint64_t>()) == scene.variant) chosen = material;
    }
  }
  return chosen;
}

}  // namespace candela::gltf
