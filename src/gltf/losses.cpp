#include "gltf/losses.h"

#include <algorithm>

#include "scene/scene_images.h"

namespace candela {

bool tells_of_loss(std::string_view warning) {
  constexpr std::string_view phrases[] = {"is left out", "are left out", "not drawn", placeholder_note};
  return std::ranges::any_of(phrases,
                             [&](std::string_view phrase) { return warning.find(phrase) != std::string_view::npos; });
}

}  // namespace candela
