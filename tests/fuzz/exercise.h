#pragma once
#include <cstddef>
#include <span>

namespace candela::fuzz {
// Loads the bytes as a glTF file and poses what comes out, at times before, among and past the keys. Gives whether it
// loaded. Every outcome but a return is a failure: a crash, a hang, memory without bound.
bool exercise_gltf(std::span<const std::byte> bytes);
}  // namespace candela::fuzz
