#pragma once
#include <span>
#include <string_view>

#include "scene/scene.h"

// What a file may say of a material besides its name and modes, one row each: where it stands below the material, what
// the specification allows it to be, and where it lies in a Material. Pointers of animations, ranges of animated values
// and the list of textures come from here.
namespace candela {

// From the plainest: each has what the ones before have (scene/shading.h).
enum class Plainest : uint8_t { lambert, blinn_phong, pbr };

struct MaterialProperty {
  TargetPath path;
  std::string_view pointer;  // JSON pointer below /materials/N/
  int components;
  double lowest, highest;  // inclusive
  float* (*at)(Material&);
  Plainest plainest;              // shading that asks for it
  std::string_view name() const;  // for messages: the pointer without the object of the extension or the model
};
std::span<const MaterialProperty> material_properties();
const MaterialProperty* material_property(TargetPath path);  // null: not a material's

struct MaterialTexture {
  TextureSlotName slot;
  std::string_view pointer;  // below /materials/N/
  TextureSlot& (*at)(Material&);
  bool srgb;                      // its colours are, alpha never
  bool (*read)(const Material&);  // whether shading the material reads it
  const TextureSlot& of(const Material& m) const { return at(const_cast<Material&>(m)); }
};
std::span<const MaterialTexture> material_textures();
TextureSlot& texture_slot(Material& material, TextureSlotName slot);

}  // namespace candela
