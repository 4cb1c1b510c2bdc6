#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "testscenes/table.h"

// Scenes that are made for a picture. They are a module of their own, candela_demoscenes.so, because a renderer has no
// use for their generators; src/testscenes/make_scene.cpp holds their names and opens it.
namespace candela {

void make_street_dusk(GlbWriter& out, SceneOptions& options);

struct DemoScene {
  std::string_view name;
  void (*make)(GlbWriter&, SceneOptions&);
  std::vector<std::byte> (*sky)(uint64_t seed) = nullptr;  // a Radiance HDR
};
// Null for an unknown name.
const DemoScene* find_demo_scene(std::string_view name);

}  // namespace candela
