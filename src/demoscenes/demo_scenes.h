#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "testscenes/table.h"

// Scenes that are made for a picture. They are a module of their own, candela_demoscenes.so, because a renderer has no
// use for their generators; src/testscenes/make_scene.cpp holds their names and opens it.
namespace candela {

void make_street_dusk(GlbWriter& out, SceneOptions& options);
void make_city(GlbWriter& out, SceneOptions& options);
std::vector<std::byte> make_city_day_sky(uint64_t seed);
std::vector<std::byte> make_city_night_sky(uint64_t seed);
std::string_view city_look();
std::vector<std::byte> make_city_sound(uint64_t seed);
std::vector<std::byte> make_cave_sound(uint64_t seed);

// A text beside the scene that its look names: the end of its name, after the scene's without its own end.
struct DemoText {
  std::string suffix, text;
};
void make_cave_film(GlbWriter& out, SceneOptions& options);
std::vector<DemoText> make_cave_texts(uint64_t seed);
std::string_view cave_look();

struct DemoScene {
  std::string_view name;
  void (*make)(GlbWriter&, SceneOptions&);
  // Radiance HDRs; a film's look blends both.
  std::vector<std::byte> (*sky)(uint64_t seed) = nullptr;
  std::vector<std::byte> (*night_sky)(uint64_t seed) = nullptr;
  std::string_view look{};  // SCENE stands for the name of the scene's file without its end
  std::vector<DemoText> (*texts)(uint64_t seed) = nullptr;
  std::vector<std::byte> (*sound)(uint64_t seed) = nullptr;  // WAV
};
// Null for an unknown name.
const DemoScene* find_demo_scene(std::string_view name);

}  // namespace candela
