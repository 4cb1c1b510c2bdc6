#include "job/not_drawn.h"

namespace candela {

std::vector<std::string> not_drawn(const SceneFacts& facts, const Pose& pose) {
  const bool lit = facts.takes_light();
  bool glass = false;
  for (size_t m = 0; m < pose.materials.size(); ++m)
    glass |= facts.material_used[m] && pose.materials[m].has(Lobe::transmission);
  std::vector<std::string> names;
  const auto add = [&](bool needed, const char* name) {
    if (needed) names.emplace_back(name);
  };
  add(lit && facts.environment && !facts.image_light, "sharp reflections of the sky");
  add(glass && facts.refracting_items == 0, "transmission and refraction");
  return names;
}

}  // namespace candela
