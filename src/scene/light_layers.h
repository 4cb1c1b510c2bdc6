#pragma once
#include <cstdint>
#include <string_view>

namespace candela {

// Named groups of lights whose light is a layer each (--light-groups), with that of all others.
inline constexpr uint32_t most_light_groups = 16;

// Whether a name is of the pattern's form, in which each * stands for any letters.
bool matches(std::string_view name, std::string_view pattern);

}  // namespace candela
