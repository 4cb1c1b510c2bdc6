#include "demoscenes/demo_scenes.h"

#include "demoscenes/dusk_sky.h"

namespace candela {
namespace {

const DemoScene table[] = {
    {.name = "street-dusk", .make = make_street_dusk, .sky = make_dusk_sky},
    {.name = "city",
     .make = make_city,
     .sky = make_city_day_sky,
     .night_sky = make_city_night_sky,
     .look = city_look(),
     .sound = make_city_sound},
    {.name = "cave-film",
     .make = make_cave_film,
     .look = cave_look(),
     .texts = make_cave_texts,
     .sound = make_cave_sound},
};

}  // namespace

const DemoScene* find_demo_scene(std::string_view name) {
  for (const DemoScene& scene : table)
    if (scene.name == name) return &scene;
  return nullptr;
}

}  // namespace candela
