#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "testscenes/demo_scene_module.h"

namespace candela {

// The bytes of a part of a demo scene, from candela_demoscenes.so, which is opened at the first call. Errors (usage):
// the module is not there.
Expected<std::vector<std::byte>> make_demo_scene(const std::string& name, CandelaDemoScenePart part, uint64_t seed,
                                                 int lights);

}  // namespace candela
