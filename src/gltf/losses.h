#pragma once
#include <string_view>

namespace candela {

// Whether a warning about a scene, or about a texture that could not be decoded, says that something of the picture is
// lost: a texture, a surface, a light. Other warnings are of faults that leave the picture whole.
bool tells_of_loss(std::string_view warning);

}  // namespace candela
