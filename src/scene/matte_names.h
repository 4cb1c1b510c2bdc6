#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace candela {

// Names that tell nodes or materials apart: a name that one before has, and none, get the index, "Box #7", "node #3".
// So do names whose matte_id one before has, which is rare.
std::vector<std::string> unique_names(const std::vector<std::string>& given, const std::string& kind);
std::vector<std::string> node_names(const Scene& scene);
// Of Scene::materials, and last of surfaces without a material.
std::vector<std::string> material_names(const Scene& scene);

// The bits of the 32-bit float by which Cryptomatte knows a name (Friedman, Jones, "Fully automatic ID mattes with
// support for motion blur and transparency", 2015; specification 1.2.0): MurmurHash3 of its UTF-8, with bit 23 turned
// where the float would be denormal, infinite or no number. Never 0, which stands for nothing.
uint32_t matte_id(std::string_view name);
std::vector<uint32_t> matte_ids(const std::vector<std::string>& names);

}  // namespace candela
